"""A diagnosis in words: one sentence, and a few lines for the terminal."""

from __future__ import annotations

import click

from .names import MISCALIBRATION, UNKNOWN, enumerated, spoken
from .result import Diagnosis

__all__ = ["sentence", "summary"]


def sentence(found: Diagnosis) -> str:
    """The verdict in one sentence."""
    gap = f"The gap of {found.rmse:.3g} {found.signals.unit}"
    sure = f"(confidence {100.0 * found.confidence:.0f} %)"
    if not found.verdict:
        return f"No gap beyond the noise of {found.noise_floor:.3g} {found.signals.unit} {sure}."
    if found.choice.torque_step > 0.0:
        step = f"{found.choice.torque_step:.3g} {found.signals.unit}"
        return f"{gap} is the torque sensor's: it counts in steps of {step} {sure}."
    if found.choice.hum > 0.0:
        return f"{gap} is a hum at {found.choice.hum:.3g} Hz, no effect of the joint {sure}."
    if found.choice.roughness > 0.0:
        return f"{gap} is real, though it looks like noise: it is {found.choice.roughness:.2g} times stronger while the joint moves {sure}."
    if found.verdict == [UNKNOWN] and found.choice.spikes > 0.0:
        stand_out = f"spikes in {100.0 * found.choice.spikes:.2g} % of the samples"
        return f"{gap} is {stand_out}, no effect of the joint {sure}."
    if found.verdict == [UNKNOWN]:
        return f"{gap} is real, but no effect that is known here explains it {sure}."
    titles = {report.name: spoken(report.name) for report in found.effects}
    too_much = {term.effect.id for term in found.choice.hypothesis.terms if term.form.overdone} & set(found.verdict)
    titles |= {name: f"too much {titles[name]} in the simulator" for name in too_much}
    named = [titles.get(name, name) + _instead(found, name) for name in found.verdict if name != MISCALIBRATION]
    if MISCALIBRATION in found.verdict:
        named.append("the simulator's own parameters, which are off")
    closed = min(max(found.closed_in_all, 0.0), 1.0)
    return f"{gap} comes from {enumerated(named)}; {'correcting' if too_much else 'adding'} that closes {100.0 * closed:.0f} % of it {sure}."


def _instead(found: Diagnosis, name: str) -> str:
    """What may stand in the place of one of the verdict's effects, in parentheses."""
    pairs = (set(pair) for pair in found.ambiguous if name in pair)
    others = sorted(other for pair in pairs for other in pair - set(found.verdict))
    told = ["the simulator's own parameters" if other == MISCALIBRATION else spoken(other) for other in others]
    return f" (or {' or '.join(told)})" if told else ""


def summary(found: Diagnosis, designed: bool) -> list[str]:
    """A few lines for the terminal; ``designed`` if a next recording was looked for."""
    lines = [sentence(found), *found.reasons]
    if found.places:
        lines.append(
            "where: " + ", ".join(f"{place.coordinate} {100.0 * place.share:.0f} %" for place in found.places[:3])
        )
    for report in found.effects:
        if report.name in found.verdict:
            low, high = report.closed_interval
            closes = "closes" if len(found.verdict) == 1 else "by itself closes"
            lines.append(
                f"{report.name}: {report.law}, {', '.join(found.told(report))}; "
                f"{closes} {report.closed:.2f} [{low:.2f}, {high:.2f}], {report.adequacy}"
            )
    for pair in found.ambiguous:
        lines.append(f"this recording cannot tell apart: {' and '.join(pair)}")
    if found.next_recording:
        lines.append(f"record next: {found.next_recording['file']} ({found.next_recording['why']})")
    elif found.ambiguous:
        lines.append(
            "record next: no motion within the recorded deflection, speed and acceleration would tell them apart"
            if designed
            else "record next: name --out, and the shortest motion that would tell them apart is written there"
        )
    return [click.unstyle(line) for line in lines]
