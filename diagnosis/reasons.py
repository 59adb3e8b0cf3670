"""Why a gap does not get the name of what comes nearest to explaining it."""

from __future__ import annotations

from collections.abc import Sequence

from .effects.base import CLOCKS
from .names import MISCALIBRATION, UNKNOWN, enumerated
from .result import EffectReport
from .verdict.choice import ENOUGH, Choice

__all__ = ["reasons"]

WORTH_SAYING = 0.2
"""Share of a gap that one effect must close by itself to be told as the nearest of all."""


def reasons(choice: Choice, closed: float, reports: Sequence[EffectReport]) -> list[str]:
    """Why what would explain the gap, or comes nearest, is not named; nothing where something is.

    Parameters
    ----------
    choice : Choice
    closed : float
        Share of the gap that its hypothesis closes on samples that no fit saw.
    reports : sequence of EffectReport
        What each effect does by itself.
    """
    made = [
        f"{image.term.effect.title} would explain it at the end of its range ({image.term.form.name}), where another effect "
        "begins, one that is not known here"
        if image.term.is_an_image
        else f"{image.term.effect.title} would explain it, but on this joint "
        f"{enumerated([name.replace('_', ' ') for name in image.of])}, which is not considered here, would look the same"
        for image in choice.images
    ]
    if choice.clock:
        by, own = CLOCKS[choice.clock.clock], CLOCKS[choice.clock.term.effect.clock]
        made.append(
            f"{choice.clock.term.effect.title} would explain it, but what changes goes with {by} rather than with {own}: "
            "another effect, one that is not known here"
        )
    if choice.outsider:
        made.append(
            f"{choice.outsider.term.effect.title} would explain it, but {choice.outsider.what} does no worse: another effect, one "
            "that is not known here"
        )
    if choice.strained:
        made.append(
            "the simulator's own parameters would explain it, but several would have to be off by far more than a tenth: an effect"
            " that is not known here is likelier"
        )
    of_all = {"factor": choice.factor and 1.0 + choice.factor, "constant": choice.constant}
    made += [
        f"one {what} on the whole torque, {size:.4g}, would close it: no coincidence of several errors of parameters, but an effect that "
        "is not known here"
        for what, size in of_all.items()
        if size
    ]
    if (
        choice.verdict == [UNKNOWN]
        and not made
        and not (choice.torque_step or choice.hum or choice.spikes or choice.roughness)
    ):
        made.append(_nearest(choice, closed, reports))
    return made


def _nearest(choice: Choice, closed: float, reports: Sequence[EffectReport]) -> str:
    """How near the best explanation comes, and which effect comes nearest by itself."""
    terms = sorted(choice.hypothesis.terms, key=lambda term: term.effect.id)
    parts = [term.effect.title for term in terms]
    if choice.miscalibrated:
        parts.append("the simulator's own parameters, which would be off")
    if not parts:
        return "nothing that is known here comes near it"
    what = enumerated(parts)
    share = f"{100.0 * max(closed, 0.0):.0f} %"
    left, forgiven = choice.features["in_sample_left"], choice.features["forgiven"]
    if closed < ENOUGH:
        told = f"the nearest is {what}: on samples that no fit saw it closes only {share}"
    elif left > forgiven:
        told = (
            f"the nearest is {what}: it closes {share}, but leaves structure of {left:.2g} times the noise, and a law that is not"
            f" quite right would leave {forgiven:.2g} at most"
        )
    else:
        told = f"the nearest is {what}: it closes {share}, but not beyond doubt, for it could imitate much else"
    alone = max((r for r in reports if r.name != MISCALIBRATION), key=lambda r: r.closed, default=None)
    if len(parts) > 1 and alone and alone.closed > WORTH_SAYING:
        told += f"; by itself {alone.name.replace('_', ' ')} closes {100.0 * alone.closed:.0f} %"
    return told
