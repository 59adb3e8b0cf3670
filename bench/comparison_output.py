"""A comparison for people, for GitHub's job summary and for programs."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from typing import Any

from .compare import WORSE, Comparison, Difference

__all__ = ["FORMATS", "write"]

SCHEMA = "hystbench/compare/1"


def _summary(comparison: Comparison, untimed: str) -> str:
    times = f"{comparison.timed} times compared" if not untimed else f"times not compared: {untimed}"
    return (
        f"{comparison.compared} cells compared at {comparison.tolerance:.3g} tolerance, "
        f"{comparison.worse} worse; {times}"
    )


def _figures(difference: Difference) -> str:
    pair = [f"{value:.4g}" if math.isfinite(value) else "–" for value in (difference.base, difference.new)]
    return "" if pair == ["–", "–"] else " -> ".join(pair)


def _text(comparison: Comparison, untimed: str) -> str:
    lines = [
        f"{d.kind:<14}{d.cell}  {_figures(d)}  {' '.join(d.message.split())}".rstrip() for d in comparison.differences
    ]
    return "\n".join([*lines, _summary(comparison, untimed)])


def _cell(text: str) -> str:
    """Text that Markdown and HTML leave as it is, in one table cell."""
    return re.sub(r"([\\`*_{}\[\]<>|~#&])", r"\\\1", " ".join(text.split()))


def _markdown(comparison: Comparison, untimed: str) -> str:
    verdict = f"{comparison.worse} worse" if comparison.worse else "nothing got worse"
    lines = [f"## hystbench: {verdict}", "", _summary(comparison, untimed) + ".", ""]
    if comparison.differences:
        lines += ["| | cell | base → new | |", "|---|---|---|---|"]
        for d in comparison.differences:
            kind = f"**{d.kind}**" if d.kind in WORSE else d.kind
            figures = _figures(d).replace("->", "→")
            lines.append(f"| {kind} | {_cell(d.cell)} | {figures} | {_cell(d.message)} |")
    return "\n".join(lines)


def _json(comparison: Comparison, untimed: str) -> str:
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "compared": comparison.compared,
        "timed": comparison.timed,
        "times_not_compared": untimed or None,
        "tolerance": comparison.tolerance,
        "worse": comparison.worse,
        "counts": dict(Counter(d.kind for d in comparison.differences)),
        "differences": [
            {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in vars(d).items()}
            for d in comparison.differences
        ],
    }
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)


FORMATS = {"text": _text, "markdown": _markdown, "json": _json}


def write(comparison: Comparison, form: str, untimed: str) -> str:
    """The comparison in one of :data:`FORMATS`; ``untimed`` says why times were not compared, if they were not."""
    return FORMATS[form](comparison, untimed)
