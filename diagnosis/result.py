"""What a diagnosis found, and as CONTRACT's document."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .attribution import Place
from .hypotheses.evidence import Evidence
from .hypotheses.library import Library
from .hypotheses.precision import intervals, told
from .recording.signals import Signals
from .verdict.choice import Choice

__all__ = ["SCHEMA", "Diagnosis", "EffectReport"]

Floats = NDArray[np.float64]
SCHEMA = "hystbench/diagnosis/1"


@dataclass(frozen=True)
class EffectReport:
    """One effect's evidence; ``signal`` is what it adds on samples that its fit did not see."""

    name: str
    probability: float
    rmse_after: float
    closed: float
    closed_interval: list[float]
    adequacy: str
    parameters: dict[str, float]
    law: str
    signal: Floats


@dataclass(frozen=True)
class Diagnosis:
    """Everything that was found; ``document()`` gives CONTRACT's JSON."""

    signals: Signals
    verdict: list[str]
    confidence: float
    rmse: float
    noise_floor: float
    closed_by_recalibration: float
    closed_in_all: float
    places: list[Place]
    effects: list[EffectReport]
    ambiguous: list[list[str]]
    emulator: str
    emulator_error: float
    choice: Choice
    library: Library
    """What every effect makes by itself, and how that goes with the gap; closed."""
    waterfall: list[tuple[str, float]]
    """RMS after each step: nothing, then the verdict's effects in the order of their size, or all that comes nearest at once."""
    seed: int
    excluded: list[str]
    next_recording: dict[str, Any] | None = None
    notes: list[str] = field(default_factory=list)
    reasons: list[str] = field(default_factory=list)
    """Those of the notes that say why what would explain the gap, or comes nearest, is not named."""

    @property
    def evidence(self) -> Evidence:
        return self.library.evidence

    @cached_property
    def parameter_intervals(self) -> dict[str, dict[str, tuple[float, float] | None]]:
        """95 % intervals of the best explanation's parameters; None for what this recording does not determine."""
        return intervals(self.evidence, self.choice.hypothesis)

    def told(self, report: EffectReport) -> list[str]:
        """An effect's parameters in words, with their intervals where there are any."""
        known = self.parameter_intervals.get(report.name, {})
        return [
            f"{name} = {value:.4g}" + (f" ({told(known[name])})" if name in known else "")
            for name, value in report.parameters.items()
        ]

    def document(self) -> dict[str, Any]:
        """The diagnosis as CONTRACT's JSON document."""
        return {
            "schema": SCHEMA,
            "gap": {
                "unit": self.signals.unit,
                "rmse": _figure(self.rmse),
                "noise_floor": _figure(self.noise_floor),
                "closed_by_recalibration": _figure(self.closed_by_recalibration),
            },
            "where": [
                {
                    "coordinate": place.coordinate,
                    "share": _figure(place.share),
                    "interval": [_figure(v) for v in place.interval],
                    "range": [_figure(v) for v in place.range],
                }
                for place in self.places
            ],
            "verdict": self.verdict,
            "confidence": _figure(self.confidence),
            "effects": [
                {
                    "name": e.name,
                    "probability": _figure(e.probability),
                    "rmse_after": _figure(e.rmse_after),
                    "closed": _figure(e.closed),
                    "closed_interval": [_figure(v) for v in e.closed_interval],
                    "adequacy": e.adequacy,
                    "parameters": {name: _figure(value) for name, value in e.parameters.items()},
                    "parameter_intervals": {
                        name: None if ends is None else [_figure(end) for end in ends]
                        for name, ends in self.parameter_intervals.get(e.name, {}).items()
                    },
                }
                for e in self.effects
            ],
            "ambiguous": self.ambiguous,
            "next_recording": self.next_recording,
            "simulator": {"emulated_by": self.emulator, "emulation_error": _figure(self.emulator_error)},
            "closed": _figure(self.closed_in_all),
            "waterfall": [{"after": name, "rmse": _figure(rmse)} for name, rmse in self.waterfall],
            "seed": self.seed,
            "excluded": self.excluded,
            "notes": self.notes,
        }

    def to_json(self) -> str:
        """The document as text."""
        return json.dumps(self.document(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _figure(value: float) -> float:
    """Six significant digits: more is noise, and the same on every machine."""
    return float(f"{float(value):.6g}")
