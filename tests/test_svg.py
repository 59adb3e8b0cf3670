"""Pictures within a page."""

from __future__ import annotations

import re

from hystbench.reports.svg import canvas, svg


def test_small_values_on_an_axis_keep_their_digits() -> None:
    figure, axes = canvas(4.0, 2.0, 1, 1)
    axes[0, 0].barh([0, 1], [0.0101, 0.0013])
    text = svg(figure, "bars", "Two bars")
    ticks = re.findall(r"<text[^>]*>\s*(0\.0\d+)\s*</text>", text)
    assert len(set(ticks)) == len(ticks) >= 3
    # Coordinates are cut: they make most of a page.
    assert not re.search(r'\bd="[^"]*\d\.\d{3}', text)
