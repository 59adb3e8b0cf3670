"""Whether a JSON document has the shape that hystbench writes: it may have been edited, damaged or made by others."""

from __future__ import annotations

import math
from typing import Any

__all__ = ["CELL", "DIAGNOSES", "RUN", "fits"]


class Partly(dict[str, Any]):
    """A shape of a mapping any of whose keys may be absent; of other mappings none may."""


class Each:
    """A shape of a mapping from any names to values of one shape."""

    def __init__(self, shape: Any) -> None:
        self.shape = shape


class OrNull(Each):
    """A shape, or null."""


class MayLack(Each):
    """A shape of what a mapping may also lack."""


def text(value: Any) -> bool:
    return isinstance(value, str)


def flag(value: Any) -> bool:
    return isinstance(value, bool)


def number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and (value != value or abs(value) < 1e300)


def whole(value: Any) -> bool:
    return number(value) and isinstance(value, int) and abs(value) < 2**63


def pair(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(number(part) for part in value)


def figure(value: Any) -> bool:
    """A number that a table prints: what is not finite is written as null."""
    return number(value) and math.isfinite(value)


METRICS = dict.fromkeys(("mae", "mre", "rmse", "max_abs", "nrmse"), OrNull(number))
RUN = Partly(
    started=text,
    command=[text],
    versions=Each(text),
    machine=Each(lambda value: True),
    commit=OrNull(text),
    seeds=[whole],
    models=Each(Partly(title=text, summary=text, source=text, hyperparameters=Each(text))),
    datasets=Each(
        Partly(
            **dict.fromkeys(
                ("title", "kind", "x_name", "x_unit", "y_name", "y_unit", "split", "source", "licence"), text
            ),
            x_sigma=OrNull(figure),
            y_sigma=OrNull(figure),
            assumptions=[text],
            n_train=whole,
            n_test=whole,
            test_recordings=[text],
            references=Each({**METRICS, "recordings": [METRICS]}),
        )
    ),
    data=Each({"sha256": text}),
    skipped=[{"what": text, "why": text}],
    cells_total=whole,
    cells_done=whole,
    cells=[text],
    superseded=[text],
    diagnosed=text,
    part=OrNull(pair),
    parts_absent=[text],
    run=text,
    fresh=flag,
    finished=flag,
    elapsed_s=OrNull(figure),
    compile_s=Each(OrNull(number)),
    sessions=[text],
)
PLACE = {"model": text, "dataset": text, "condition": text, "seed": whole}
CONDITIONS = [{"name": text, "detail": text, "holds": flag}]
ROW = {
    **PLACE,
    "task": text,
    "status": text,
    "message": text,
    "n": MayLack(whole),
    **{name: MayLack(OrNull(number)) for name in (*METRICS, "fit_s", "predict_ns_per_sample", "step_ns")},
}
CELL = {
    **PLACE,
    "rows": [ROW],
    "session": MayLack(text),
    "run": MayLack(text),
    "fit": MayLack(OrNull(Partly(conditions=CONDITIONS, notes=[text]))),
    "compile_s": MayLack(number),
    **{name: MayLack(OrNull(Each(OrNull(number)))) for name in ("timing", "filter", "uncompensated")},
}
DIAGNOSES = {
    "diagnoses": [
        {
            "model": text,
            "dataset": text,
            "status": text,
            "message": text,
            "known_cause": OrNull({"effects": [text], "reason": text, "agrees": OrNull(flag)}),
            "diagnosis": OrNull(
                {
                    "verdict": [text],
                    "confidence": figure,
                    "closed": figure,
                    "gap": {"unit": text, "rmse": figure, "noise_floor": figure},
                    "where": [{"coordinate": text, "share": figure, "range": pair}],
                }
            ),
        }
    ]
}


def fits(value: Any, shape: Any) -> bool:
    """Whether a document has a shape; it may hold further keys."""
    if isinstance(shape, OrNull):
        return value is None or fits(value, shape.shape)
    if isinstance(shape, MayLack):
        return fits(value, shape.shape)
    if isinstance(shape, Each):
        return isinstance(value, dict) and all(fits(item, shape.shape) for item in value.values())
    if isinstance(shape, list):
        return isinstance(value, list) and all(fits(item, shape[0]) for item in value)
    if isinstance(shape, dict):
        return isinstance(value, dict) and all(
            fits(value[key], inner) if key in value else isinstance(shape, Partly) or isinstance(inner, MayLack)
            for key, inner in shape.items()
        )
    return bool(shape(value))
