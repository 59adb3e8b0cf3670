"""The page of ``hystbench diagnose``: one self-contained file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from markupsafe import Markup
from matplotlib.collections import LineCollection

from .. import __version__
from ..diagnosis.attribution import profile
from ..diagnosis.diagnosis import NEAREST
from ..diagnosis.names import UNKNOWN, spoken
from ..diagnosis.result import Diagnosis
from ..diagnosis.wording import sentence
from ..files import write_text
from .svg import COLOURS, INK, MEASURED, STYLE
from .svg import canvas as _figure
from .svg import extremes as _extremes
from .svg import svg as _svg
from .templating import template

__all__ = ["write_diagnosis"]

UNITS = {
    "time": "s", "position": "rad", "direction": "", "speed": "rad/s", "acceleration": "rad/s²",
    "distance_since_reversal": "rad", "amplitude": "rad", "travel": "rad",
}  # fmt: skip
SHOWN_PLACES = 3


def _unit(found: Diagnosis, coordinate: str) -> str:
    return found.signals.unit if coordinate == "load" else UNITS.get(coordinate, "")


def write_diagnosis(
    found: Diagnosis, out: Path, model: Any | None, files: Sequence[str], simulators: Sequence[str]
) -> Diagnosis:
    """Write ``diagnosis.html``, ``diagnosis.json``, ``corrected.json``, ``formula.txt`` and, where effects stay
    ambiguous, ``next.csv`` to ``out``; return the diagnosis with what to record next."""
    from ..diagnosis.corrected import calibrated, corrected_simulator, formula
    from ..diagnosis.excitation import design_next

    out.mkdir(parents=True, exist_ok=True)
    found = replace(found, next_recording=design_next(found, out / "next.csv"))
    emulator = calibrated(found, model)
    text = formula(found, emulator)
    if text:
        write_text(out / "formula.txt", text + "\n")
        corrected_simulator(found, emulator).save(out / "corrected.json")
    write_text(out / "diagnosis.json", found.to_json())
    page = template("diagnosis.html.j2").render(
        version=__version__,
        sentence=sentence(found),
        gap={"rmse": f"{found.rmse:.3g}", "noise_floor": f"{found.noise_floor:.3g}", "recalibration": _percent(found.closed_by_recalibration)},
        hums=found.choice.hum > 0.0,
        samples=found.signals.x.size,
        unit=found.signals.unit,
        places=[
            {
                "coordinate": spoken(p.coordinate),
                "share": _percent(p.share),
                "interval": f"{_percent(p.interval[0])} to {_percent(p.interval[1])}",
                "range": f"{p.range[0]:.3g} to {p.range[1]:.3g} {_unit(found, p.coordinate)}",
            }
            for p in found.places
        ],
        where_figures=_where_figures(found),
        closing_figures=_closing_figures(found),
        effects=[
            {
                "name": spoken(e.name),
                "named": e.name in found.verdict,
                "probability": f"{e.probability:.2f}",
                "rmse_after": f"{e.rmse_after:.3g}",
                "closed": f"{e.closed:.2f}",
                "interval": f"{e.closed_interval[0]:.2f} to {e.closed_interval[1]:.2f}",
                "law": e.law,
                "adequacy": e.adequacy,
                "parameters": ", ".join(found.told(e)).replace("_", " "),
            }
            for e in found.effects
        ],
        ambiguous=[" and ".join(map(spoken, pair)) for pair in found.ambiguous],
        next_recording=found.next_recording,
        formula=text,
        files=files,
        simulators=simulators,
        excluded=found.excluded,
        seed=found.seed,
        reasons=[reason[:1].upper() + reason[1:] for reason in found.reasons],
        notes=[note for note in found.notes if note not in found.reasons],
    )  # fmt: skip
    write_text(out / "diagnosis.html", page)
    return found


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"


def _where_figures(found: Diagnosis) -> list[dict[str, Any]]:
    signals = found.signals
    made = []
    with mpl.rc_context(STYLE):
        figure, axes = _figure(9.2, 4.0, 1, 1)
        axis = axes[0, 0]
        judged = np.flatnonzero(signals.judged)
        limit = float(np.quantile(np.abs(signals.gap[judged]), 0.98)) or 1.0
        thin = judged[np.unique(np.linspace(0, judged.size - 1, min(judged.size, 1500)).astype(int))]
        points = np.column_stack([signals.x[thin], signals.y_real[thin]])
        pieces = np.stack([points[:-1], points[1:]], axis=1)
        lines = LineCollection(list(pieces), cmap="coolwarm", norm=mpl.colors.Normalize(-limit, limit), linewidths=1.2)
        lines.set_array(signals.gap[thin][:-1])
        axis.add_collection(lines)
        axis.autoscale()
        axis.set_xlabel("deflection, rad")
        axis.set_ylabel(f"recorded torque, {signals.unit}")
        figure.colorbar(lines, ax=axis, label=f"gap, {signals.unit}")
        made.append({"svg": Markup(_svg(figure, "gap on the loop", "Recorded loop, coloured by the gap")),
                     "caption": "The gap (recording minus simulator) as colour on the recorded loop."})  # fmt: skip
        shown = [p for p in found.places if p.coordinate in signals.coordinates][:SHOWN_PLACES]
        if shown:
            figure, axes = _figure(9.2, 2.8, 1, len(shown), sharey=True)
            for axis, place in zip(axes.flat, shown, strict=True):
                centres, means, rms = profile(signals.coordinates[place.coordinate][judged], signals.gap[judged])
                axis.axhline(found.noise_floor, color=MEASURED, linewidth=0.8, linestyle="--")
                axis.plot(centres, rms, color=COLOURS[1], linewidth=1.2, marker="o", markersize=2.5, label="RMS")
                axis.plot(centres, means, color=COLOURS[0], linewidth=1.0, label="mean")
                axis.locator_params(axis="x", nbins=5)
                named = spoken(place.coordinate), _unit(found, place.coordinate)
                axis.set_xlabel(", ".join(filter(None, named)))
            axes.flat[0].set_ylabel(f"gap, {signals.unit}")
            axes.flat[0].legend()
            made.append({"svg": Markup(_svg(figure, "gap over coordinates", "Gap over each leading coordinate")),
                         "caption": "Mean and RMS of the gap over each leading coordinate; dashed: the noise."})  # fmt: skip
    return made


def _closing_figures(found: Diagnosis) -> list[dict[str, Any]]:
    signals = found.signals
    left = signals.gap - found.choice.explained
    gap, left = signals.gap[signals.judged], left[signals.judged]
    # Several recordings have no time in common.
    at_times = signals.timed and len(signals.runs) == 1
    along = (signals.time if at_times else np.arange(signals.x.size))[signals.judged]
    added = NEAREST if found.verdict == [UNKNOWN] else "the verdict"
    made = []
    with mpl.rc_context(STYLE):
        figure, axes = _figure(9.2, 2.6, 1, 1)
        axis = axes[0, 0]
        for series, colour, label in ((gap, MEASURED, "gap"), (left, COLOURS[1], "left over")):
            kept = _extremes(series)
            axis.plot(along[kept], series[kept], color=colour, linewidth=0.7, label=label)
        axis.set_xlabel("time, s" if at_times else "sample")
        axis.set_ylabel(signals.unit)
        axis.legend()
        made.append({"svg": Markup(_svg(figure, "gap over time", "Gap over time, and what is left of it")),
                     "caption": f"The gap over time, and what is left once {added} is added, on samples the fit never saw."})  # fmt: skip
        figure, axes = _figure(9.2, 0.5 * len(found.waterfall) + 0.9, 1, 1)
        axis = axes[0, 0]
        names = [spoken(name) for name, _ in found.waterfall]
        axis.barh(range(len(names)), [rmse for _, rmse in found.waterfall], color=COLOURS[0], height=0.6)
        axis.axvline(found.noise_floor, color=INK, linewidth=0.8, linestyle="--")
        axis.set_yticks(range(len(names)), [names[0], *(f"+ {name}" for name in names[1:])])
        axis.invert_yaxis()
        axis.set_xlabel(f"RMS of what is left, {signals.unit} (dashed: noise)")
        made.append({"svg": Markup(_svg(figure, "waterfall", "Gap after each effect")),
                     "caption": "The gap after each effect, in the order in which they close most."})  # fmt: skip
    return made
