"""How well a set of effects explains a gap, beside a simulator whose own parameters may be off.

The gap is r = Σ Φ_e(θ_e) β_e + s B δ + c B' δ' + ε with the effects' columns Φ, the simulator's tangents B (fine
structure) and B' (bulk), relative parameter errors s δ and c δ', δ, δ' ~ N(0, 1), and white noise ε. Integrating them
out leaves r ~ N(Φβ, σ² V), V = 1 + (s² B Bᵀ + c² B' B'ᵀ)/σ². With s = c = 0 the simulator is taken as exact, with large
ones it is refitted freely. A small grid of them competes, so each effect is judged beside the fixed and beside the
refitted simulator by one rule, a Bayesian information criterion on the effective number of samples.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..effects.base import INPUT, SENSOR, TORQUE, Effect, Form
from ..emulator.emulation import SimulatorScene
from ..recording.noise import rms
from .boxed import boxed_least_squares

__all__ = ["Evidence", "Hypothesis", "Term", "elsewhere", "is_refitted", "spans", "trusted"]

Floats = NDArray[np.float64]
Scale = tuple[float, float]
PLAUSIBILITY: dict[Scale, float] = {
    (0.0, 0.0): 0.0, (0.005, 0.0): 0.0, (0.01, 0.0): 0.0, (0.02, 0.0): 0.0, (0.06, 0.0): -12.0,
    (0.005, 0.03): -2.0, (0.01, 0.03): -2.0, (0.02, 0.03): -2.0, (0.06, 0.03): -2.0,
    (0.02, 0.1): -6.0, (0.06, 0.1): -6.0,
}  # fmt: skip
"""Relative errors (s, c) of the simulator's fine structure and of its bulk parameters, with the logarithm of their
prior odds: a loop that is badly off in detail but exact in bulk is implausible, and so are errors beyond a tenth."""
FITTED: dict[Scale, float] = {
    (0.0, 0.0): 0.0, (0.02, 0.03): 0.0, (0.06, 0.1): 0.0,
}  # fmt: skip
"""The same for a model that was fitted to data with the effect: its parameters are off by whatever it took of it. With
still more freedom the refit would take all of the effect again."""
INADEQUACY = 0.04
"""No listed law is exact: what is left over within this share of the gap's RMS is not held against an effect."""
FINEST = 0.035
"""Misfit, as a share of the gap's RMS, that counts as much as noise of that size."""
FINE = 0.02
"""Relative error of the simulator's fine structure that is no miscalibration: no two models agree better."""
NOTICEABLE = 0.1
"""Noise levels, over the whole recording, by which the largest errors must move a direction for it to be looked at."""
OVERDONE, GUESSED = 3, 5
"""Free constants by which a law is charged that takes away what a simulator has too much of, and one that finds itself on which part it acts."""
TRUSTED = 6000.0
"""Samples beyond which evidence does not grow."""
ENOUGH = 2500
"""Samples on which laws are compared with their shapes moved; less than that would miss a stop that is seldom hit."""
KEPT = 5
"""Parts of a recording for which what is needed to judge hypotheses on them is kept: a set of folds."""
ORDER = {INPUT: 0, TORQUE: 1, SENSOR: 2}


def trusted(samples: float) -> float:
    """How many of so many samples count: no law and no emulator is so exact that more would make evidence surer."""
    return min(samples, TRUSTED)


def is_refitted(scale: Scale) -> bool:
    """Whether a scale means that the simulator's own parameters are off."""
    return scale[1] > 0.0 or scale[0] > FINE


@dataclass(frozen=True)
class Term:
    """One effect with one of its laws and values of that law's shape parameters."""

    effect: Effect
    form: Form
    shape: tuple[float, ...]
    laws: int = 1
    """How many laws of the effect were tried."""
    behind: bool = False
    """Whether it acts on the joint's own deflection, as effects on the input leave it, and not on the recorded one."""

    @property
    def law(self) -> tuple[str, str]:
        """What tells its law from all others."""
        return self.effect.id, self.form.name

    @property
    def is_an_image(self) -> bool:
        """Whether a shape has run to where another effect begins, whose image the law is there."""
        return self.form.is_at_a_border(self.shape)

    @property
    def tells_deflection(self) -> bool:
        """Whether its shape alone says by which deflection the joint moves."""
        return self.effect.acts_on == INPUT and tuple(self.form.lower) == tuple(self.form.upper)


@dataclass
class Hypothesis:
    """A set of effects, fitted.

    Attributes
    ----------
    terms : tuple of Term
        In the order in which they act.
    scale : (float, float)
        Relative errors (s, c) of the simulator's parameters.
    columns : array, shape (n, k)
    inside : array, shape (m, k)
        Their components in the simulator's tangent space, by the samples by which it was fitted.
    coefficients : array, shape (k,)
    rss : float
        Whitened sum of squares that is left.
    score : float
        Logarithm of the evidence, up to a constant of the recording.
    """

    terms: tuple[Term, ...]
    scale: Scale
    columns: Floats
    inside: Floats
    coefficients: Floats
    rss: float
    score: float
    by_scale: dict[Scale, float] = field(default_factory=dict)
    beside_exact: Hypothesis | None = None
    """The best that was found for an effect alone beside an exact simulator; its law may be another."""

    @property
    def names(self) -> frozenset[str]:
        return frozenset(term.effect.id for term in self.terms)

    @property
    def images(self) -> list[Term]:
        """Those of its terms whose law is only another effect's image."""
        return [term for term in self.terms if term.is_an_image]

    @property
    def signal(self) -> Floats:
        """What the effects add to the simulator, N·m, shape (n,)."""
        return self.columns @ self.coefficients

    def signal_on(self, scene: SimulatorScene) -> Floats:
        """What the effects would add on another recording, N·m, shape (n,)."""
        terms, coefficients = elsewhere(self.terms, self.coefficients)
        return effect_columns(scene, terms, coefficients) @ coefficients

    def part(self, name: str) -> Floats:
        """What one effect adds, N·m, shape (n,)."""
        _, own = self._of(name)
        return self.columns[:, own] @ self.coefficients[own]

    def parameters(self, name: str) -> dict[str, float]:
        """Fitted parameters of one effect by name."""
        term, own = self._of(name)
        named = dict(zip(term.form.coefficients, self.coefficients[own].tolist(), strict=True))
        named.update(zip(term.form.shapes, term.shape, strict=True))
        return {key: float(value) for key, value in named.items() if not key.startswith("_")}

    def _of(self, name: str) -> tuple[Term, slice]:
        """The term of one effect, and where its columns stand."""
        for term, own in zip(self.terms, spans(self.terms), strict=True):
            if term.effect.id == name:
                return term, own
        raise KeyError(name)


@dataclass(frozen=True)
class _Beside:
    """What simulators of some scales make of a fit, stacked; m tangent modes."""

    modes: Floats
    """Shape (scales · m, m): the modes, each by the root of its share that the refit absorbs."""
    gap: Floats
    """The gap's components in them, shape (scales, m)."""
    energy: Floats
    """What the refit leaves of the gap's energy, shape (scales,)."""
    freedom: Floats
    """What the freedom of the simulator's parameters costs, shape (scales,)."""


class Evidence:
    """Scores sets of effects on chosen samples of a recording.

    Parameters
    ----------
    scene : SimulatorScene
    rows : bool array, shape (n,), optional
        Samples that count (default: all that are judged).
    fitted : bool
        Whether the simulator was fitted to data that contain what it lacks.
    """

    def __init__(
        self,
        scene: SimulatorScene,
        rows: NDArray[np.bool_] | None = None,
        fitted: bool = False,
    ) -> None:
        self.scene = scene
        self.fitted = fitted
        self.plausibility = FITTED if fitted else PLAUSIBILITY
        self.scales = tuple(self.plausibility)
        self.rows = scene.signals.judged if rows is None else rows
        self._whole = bool(self.rows.all())
        self.gap = scene.signals.gap[self.rows]
        self.thinning = trusted(self.gap.size / scene.signals.correlated) / max(self.gap.size, 1)
        self.sigma = scene.signals.noise_floor
        if not fitted:
            # Noise far below the gap makes any misfit significant, and no two models agree that well.
            self.sigma = max(self.sigma, FINEST * rms(scene.signals.gap))
        structure, bulk = scene.emulator.structure[self.rows], scene.emulator.bulk[self.rows]
        # In units of the noise, for the largest errors: directions that even these move by less are the noise's.
        largest = np.max(self.scales, axis=0)
        weights = np.repeat(largest / self.sigma, [structure.shape[1], bulk.shape[1]])
        tangents = np.hstack([structure, bulk])
        # Products have no digits of directions below the smallest that are looked at, and take far less than rows.
        squares, right = np.linalg.eigh((tangents.T @ tangents) * np.outer(weights, weights))
        singular = np.sqrt(np.maximum(squares, 0.0))
        kept = singular > max(NOTICEABLE, 1e-5 * float(singular[-1]))
        self._singular, self._right = singular[kept], right.T[kept]
        # Combinations of tangents that are as well on every sample, those that this fit does not see included.
        self._to_basis = weights[:, None] * (self._right.T / self._singular)
        self._basis = tangents @ self._to_basis
        factor = self._singular[:, None] * self._right
        split = structure.shape[1]
        self.gap_inside = self.inside(self.gap)
        """The gap's components in the simulator's tangent space, shape (m,)."""
        self.gap_energy = float(self.gap @ self.gap)
        self._modes: dict[Scale, tuple[Floats, Floats, float]] = {}
        self._stacked: dict[tuple[Scale, ...], _Beside] = {}
        for scale in self.scales:
            share = np.asarray(scale) / largest
            weighed = np.hstack([share[0] * factor[:, :split], share[1] * factor[:, split:]])
            ratio, rotation = np.linalg.eigh(weighed @ weighed.T)
            ratio = np.maximum(ratio, 0.0)
            absorbed = ratio / (1.0 + ratio)
            self._modes[scale] = absorbed, rotation, 0.5 * float(np.sum(np.log1p(self.thinning * ratio)))
        self._parts: dict[bytes, Evidence] = {}
        self._forms: dict[Effect, list[Form]] = {}
        self.inadequacy = (INADEQUACY**2) * max(self.gap_energy / self.gap.size - self.sigma**2, 0.0)
        self.inadequacy += scene.signals.jitter**2

    @property
    def size(self) -> int:
        return self.gap.size

    @functools.cached_property
    def exact(self) -> tuple[Scale, ...]:
        """The scales at which the simulator's own parameters are right."""
        return tuple(scale for scale in self.scales if not is_refitted(scale))

    def rms_of(self, series: Floats) -> float:
        """Root mean square of a ``series`` (n,) over the samples that are looked at: a beginning that is left out may be large."""
        return rms(series[self.rows])

    @property
    def effective(self) -> float:
        """Samples that count."""
        return self.thinning * self.size

    def is_beside_refit(self, hypothesis: Hypothesis) -> bool:
        """Whether effects are judged beside a simulator that is off, for other reasons than that it was fitted without them."""
        return bool(hypothesis.terms) and is_refitted(hypothesis.scale) and not self.fitted

    @functools.cached_property
    def fewer(self) -> Evidence:
        """The same on some thousand samples spread over the recording, which are enough to move the shapes of laws."""
        return self._every(self.size // ENOUGH)

    @functools.cached_property
    def sparse(self) -> Evidence:
        """The same on as few as half of those, which are enough to compare laws and where their shapes start."""
        return self._every(round(self.size / ENOUGH))

    def _every(self, step: int) -> Evidence:
        """The same on every so manieth of its samples."""
        if step < 2:
            return self
        rows = np.zeros_like(self.rows)
        rows[np.flatnonzero(self.rows)[::step]] = True
        return self.on(rows)

    def on(self, rows: NDArray[np.bool_]) -> Evidence:
        """The same on some samples only, kept for the next hypothesis that is judged on them."""
        key = np.packbits(rows).tobytes()
        if key not in self._parts:
            if len(self._parts) >= KEPT:
                del self._parts[next(iter(self._parts))]
            self._parts[key] = Evidence(self.scene, rows, self.fitted)
        return self._parts[key]

    def forms_of(self, effect: Effect) -> list[Form]:
        """The effect's laws; a model that was fitted to the joint has nothing too much of which it would not have got rid.

        Nor is it asked what laws find that its refit would make up for. Some look at the gap, so that they are made once.
        """
        if effect not in self._forms:
            made = effect.forms(self.scene)
            self._forms[effect] = [f for f in made if not (self.fitted and (f.overdone or f.guessed))]
        return self._forms[effect]

    def inside(self, columns: Floats) -> Floats:
        """Components in the simulator's tangent space, shape (m,) or (m, k)."""
        return self._basis.T @ columns

    def shrink(self, scale: Scale) -> tuple[Floats, Floats]:
        """Share that the refit absorbs of each tangent mode, shape (m,), and the modes, shape (m, m)."""
        absorbed, rotation, _ = self._modes[scale]
        return absorbed, rotation

    def complexity(self, scale: Scale) -> float:
        """Half the log determinant of V: what the freedom of the simulator's parameters costs."""
        return self._modes[scale][2]

    def score(self, rss: Floats, scales: Sequence[Scale], unknowns: int) -> Floats:
        """Logarithm of the evidence up to a constant where ``rss``, shape (…, scales), is left."""
        effective = self.effective
        misfit = np.maximum(rss / self.size, 1e-4 * self.sigma**2) + self.inadequacy
        freedom = self._beside(tuple(scales)).freedom
        return np.asarray(-0.5 * effective * np.log(misfit) - freedom - 0.5 * unknowns * np.log(max(effective, 3.0)))

    def reduced(
        self, gram: Floats, moment: Floats, inside: Floats, scales: Sequence[Scale]
    ) -> tuple[Floats, Floats, Floats]:
        """Whitened Φ'V⁻¹Φ, Φ'V⁻¹r and r'V⁻¹r at each scale, from the plain products and Φ's tangent components ``inside``."""
        beside = self._beside(tuple(scales))
        shrunk = (beside.modes @ inside).reshape(len(scales), len(inside), moment.size)
        turned = shrunk.transpose(0, 2, 1)
        return gram - turned @ shrunk, moment - (turned @ beside.gap[:, :, None])[:, :, 0], beside.energy

    def taken(self, inside: Floats, scale: Scale) -> tuple[Floats, Floats, float]:
        """What a refit at a scale takes, from tangent components ``inside`` (m, k) of columns.

        Rows (k, m) whose products are to be taken from the columns' products, what is to be taken from their moments (k,), and
        what is left of the gap's energy.
        """
        beside = self._beside((scale,))
        rows = np.ascontiguousarray((beside.modes @ inside).T)
        return rows, rows @ beside.gap[0], float(beside.energy[0])

    def _beside(self, scales: tuple[Scale, ...]) -> _Beside:
        """The simulators of these scales, stacked."""
        if scales not in self._stacked:
            modes = [np.sqrt(absorbed)[:, None] * rotation.T for absorbed, rotation in map(self.shrink, scales)]
            gaps = [each @ self.gap_inside for each in modes]
            freedom = [self.complexity(scale) - self.plausibility[scale] for scale in scales]
            energy = [self.gap_energy - float(gap @ gap) for gap in gaps]
            self._stacked[scales] = _Beside(np.vstack(modes), np.array(gaps), np.array(energy), np.array(freedom))
        return self._stacked[scales]

    def whitened(self, series: Floats, scale: Scale, inside: Floats | None = None) -> Floats:
        """V^(−1/2) applied to ``series``, shape (n,) or (n, k), whose components in the tangent space may be known."""
        absorbed, rotation = self.shrink(scale)
        if not np.any(absorbed):
            return series
        root = 1.0 - np.sqrt(1.0 - absorbed)
        modes = rotation.T @ (self.inside(series) if inside is None else inside)
        return series - self._basis @ (rotation @ (root * modes.T).T)

    def absorbed(self, residual: Floats, scale: Scale) -> Floats:
        """What the refitted simulator takes of ``residual`` (over this fit's rows), on every sample, shape (n,)."""
        absorbed, rotation = self.shrink(scale)
        modes = rotation @ (absorbed * (rotation.T @ (self._basis.T @ residual)))
        scene = self.scene
        return np.hstack([scene.emulator.structure, scene.emulator.bulk]) @ (self._to_basis @ modes)

    def errors(self) -> Floats:
        """The simulator's errors that best make the gap by themselves, shape (p,): of each parameter, over the largest errors."""
        seen = self._singular / (self._singular**2 + 1.0 / self.thinning)
        return np.asarray(self._right.T @ (seen * self.gap_inside)) / self.sigma

    def recalibration(self, hypothesis: Hypothesis) -> Floats:
        """What refitting the simulator beside a hypothesis adds to its output, N·m, on every sample, shape (n,)."""
        return self.absorbed(self.gap - hypothesis.signal[self.rows], hypothesis.scale)

    def left_over(self, hypothesis: Hypothesis) -> Floats:
        """What a hypothesis and the refitted simulator leave, shape (n,); zero where this fit does not look."""
        return (self.scene.signals.gap - hypothesis.signal - self.recalibration(hypothesis)) * self.rows

    # ---- fitting ---------------------------------------------------------------------------------------------------

    def fit(self, terms: Sequence[Term], scales: Sequence[Scale] = ()) -> Hypothesis:
        """Best coefficients and scale (of ``scales``, by default of all) for given shapes."""
        ordered = tuple(sorted(terms, key=lambda term: ORDER[term.effect.acts_on]))
        lower = np.array([value for term in ordered for value in term.form.lower])
        upper = np.array([value for term in ordered for value in term.form.upper])
        tried = scales or self.scales

        def beside_each(columns: Floats) -> list[Hypothesis]:
            chosen = columns if self._whole else columns[self.rows]
            inside = self.inside(chosen)
            grams, moments, energies = self.reduced(chosen.T @ chosen, chosen.T @ self.gap, inside, tried)
            beta, reduction = boxed_least_squares(grams, moments, lower, upper)
            rss = np.maximum(energies - reduction, 1e-12 * self.gap_energy)
            each = zip(tried, beta, rss.tolist(), self.score(rss, tried, unknowns).tolist(), strict=True)
            return [Hypothesis(ordered, scale, columns, inside, b, left, score) for scale, b, left, score in each]

        unknowns = count_unknowns(ordered)
        found = beside_each(effect_columns(self.scene, ordered))
        for _ in range(passes_of(self.scene, ordered)):
            # The first pass takes the effects as independent, the second lets later ones act on what earlier ones made:
            # beside a refitted simulator, and beside an exact one, where that may be quite another torque.
            kinds = ([h for h in found if is_refitted(h.scale) == refitted] for refitted in (False, True))
            guesses = [max(kind, key=lambda h: h.score).coefficients for kind in kinds if kind]
            passes = [beside_each(effect_columns(self.scene, ordered, guess)) for guess in guesses]
            found = [max(of_scale, key=lambda h: h.score) for of_scale in zip(*passes, strict=True)]
        best = max(found, key=lambda h: h.score)
        best.by_scale = {h.scale: h.score for h in found}
        return best


def effect_columns(scene: SimulatorScene, terms: Sequence[Term], guess: Floats | None = None) -> Floats:
    """Columns of all terms, shape (n, k); effects of the sensor see the torque that the others changed.

    ``guess`` are coefficients, shape (k,), from which that torque is made.
    """
    made: list[Floats] = []
    recorded, ordered = scene, sorted(terms, key=lambda term: ORDER[term.effect.acts_on])
    own_motion = _of_the_joint(scene, ordered)
    for term, at in zip(ordered, spans(ordered), strict=True):
        scene = own_motion if term.behind else recorded
        follows = guess is not None and bool(made) and ORDER[term.effect.acts_on] > 0
        if guess is None or not (term.form.about or (follows and scene.is_of_torque(term.law))):
            # A search moves one shape at a time: the other terms' columns are there already.
            make = functools.partial(term.form.columns, scene, term.shape)
            own = scene.columns_of(term.law, term.shape, make)
            # Of a law that was not asked before it is known only now.
            if not (follows and scene.is_of_torque(term.law)):
                made.append(own)
                continue
        assert guess is not None
        seen = scene.with_torque(scene.torque + np.hstack(made) @ guess[: at.start]) if follows else scene
        if term.form.about:
            made.append(term.form.about(seen, term.shape, guess[at]))
        else:
            made.append(term.form.columns(seen, term.shape))
    if len(made) == 1:
        return made[0]
    return np.hstack(made) if made else np.empty((scene.signals.x.size, 0))


def those_behind(terms: Sequence[Term]) -> list[Term]:
    """Those of the terms that act on a deflection which others tell."""
    return [term for term in terms if term.behind] if any(term.tells_deflection for term in terms) else []


def _of_the_joint(scene: SimulatorScene, terms: Sequence[Term]) -> SimulatorScene:
    """The scene at the deflection by which the joint moves, as effects on the input leave it, where some act on that."""
    if not those_behind(terms):
        return scene
    telling = [term for term in terms if term.tells_deflection]

    def deflection() -> Floats:
        x = scene.signals.x.copy()
        for term in telling:
            asking = scene.asking()
            make = functools.partial(term.form.columns, asking, term.shape)
            asking.columns_of(term.law, term.shape, make)
            if asking.asked is None:
                # Its columns are remembered, but not what it asked for.
                make()
            if asking.asked is not None:
                x += asking.asked - scene.signals.x
        return x

    return scene.moved_to(tuple((term.law, term.shape) for term in telling), deflection)


def spans(terms: Sequence[Term]) -> list[slice]:
    """Where the columns and the coefficients of each term stand among those of all."""
    ends = np.cumsum([0, *(len(term.form.coefficients) for term in terms)]).tolist()
    return [slice(start, stop) for start, stop in itertools.pairwise(ends)]


def elsewhere(terms: Sequence[Term], coefficients: Floats) -> tuple[list[Term], Floats]:
    """What of terms, and of their ``coefficients`` (k,), holds on other motions."""
    lasting, kept = [], []
    for term, own in zip(terms, spans(terms), strict=True):
        form = term.form.elsewhere or term.form
        lasting.append(replace(term, form=form))
        kept.append(coefficients[own][: len(form.coefficients)])
    return lasting, np.concatenate(kept) if kept else coefficients


def passes_of(scene: SimulatorScene, terms: Sequence[Term]) -> int:
    """How often coefficients must be known to make the columns: where some of the terms, in their order, act on what those before
    made or where they leave the joint, or are not linear.
    """
    if any(term.form.about for term in terms):
        return 2
    if those_behind(terms):
        return 1
    return int(any(ORDER[term.effect.acts_on] > 0 and scene.is_of_torque(term.law) for term in terms[1:]))


def count_unknowns(terms: Sequence[Term]) -> int:
    """Free coefficients and shapes, and what laws are charged for besides that take away a part of the simulator or find one."""
    free = sum(lo != up for term in terms for lo, up in zip(term.form.lower, term.form.upper, strict=True))
    return free + sum(len(t.shape) + OVERDONE * t.form.overdone + GUESSED * t.form.guessed for t in terms)
