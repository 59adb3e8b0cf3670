"""The search for sets of one, two and three effects."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..effects.base import TORQUE, Form
from .adequacy import left_by
from .evidence import FINE, Evidence, Hypothesis, Scale, Term, is_refitted, spans, those_behind
from .library import Library, Scored
from .refinement import refine, refine_anyhow

__all__ = ["NOTHING", "search", "successors"]

ALONE, ALIKE = 18, 4
"""Laws with shapes to move that are refined alone, and how many laws of one effect are."""
FAR = 1.0
"""Evidence a sample by which an effect alone may fall behind another for its further laws to be tried."""
NEAR = 0.2
"""The same where that other leaves nothing, and of a pair beside an exact simulator behind what a refitted one makes: then laws matter
only of what may do as well."""
DETAIL = 0.01
"""Relative error of a simulator's parameters that is none."""
NOTHING = 0.15
"""Structure over the noise that is none: what a further effect could still bring is half of what company costs."""
LEADING = 3
"""Effects whose laws that start from none that was refined are looked at."""
EXACT = 8
"""Laws that are also refined beside an exact simulator, at most two of an effect."""
INHERITED = 3
"""Sets of each size whose shapes are tried in smaller sets."""
HOPEFUL, HARDLY = 0.005, 0.001
"""Evidence a sample that a further effect must bring for still another to be looked for, and by its first law for other laws."""
GROWN, PAIRS = 4, 4
"""Sets from whose effects pairs grow beside an exact simulator where the likeliest pair is beside a refitted one, and such pairs."""
IN_COMPANY = 6
"""Steps of refinement of effects beside others."""
LAWS, EXACT_LAWS = 2, 1
"""Other laws of an effect in company that are tried, and those that are beside an exact simulator."""
NEARLY = 0.02
"""Evidence a sample by which a law may fall behind and still be refined further."""
STEPS = 3
"""Replacements of one law by another in a row."""
AT_FIRST = 0.2
"""The same for a law that only starts where another ended."""


def search(library: Library, wide: int = 9, most: int = 3) -> list[Hypothesis]:
    """Fitted hypotheses, the empty one first, then by number of effects and evidence.

    Every effect is fitted alone; the best ``wide`` of them are extended by every other effect, the best pairs again,
    up to ``most`` effects. The candidates of each size are refined with their shapes free.
    """
    evidence = library.evidence
    if evidence.fitted:
        # Beside a model that was fitted to the joint, the largest causes are asked for; a third only bends its law.
        most = min(most, 2)
    found = [evidence.fit(())]
    exact: dict[frozenset[str], Hypothesis] = {}
    best_of_smaller = found[0].score
    beam: list[tuple[tuple[int, ...], Sequence[Scale]]] = [((), evidence.scales)]
    for size in range(1, most + 1):
        sets: dict[frozenset[str], Scored] = {}
        for base, scales in beam:
            for score, numbers in library.extend(base, scales):
                names = frozenset(library.terms[k].effect.id for k in numbers)
                if size == 1:
                    names = names | {library.terms[numbers[0]].form.name}
                if names not in sets or score > sets[names][0]:
                    sets[names] = (score, numbers)
        if not sets:
            # No more effects are considered than these already take.
            break
        ranked = sorted(sets.values(), key=lambda item: -item[0])
        count = wide
        if size == 1:
            # The best laws of an effect are refined, the others cannot overtake all.
            ranked, count = _worth_refining(library, ranked)
        refined: dict[frozenset[str], tuple[Hypothesis, tuple[int, ...]]] = {}
        leading, far = found[0], FAR
        for _, numbers in ranked[:count]:
            # Sets grow from refined shapes: these need fewer steps.
            fitted = _refined(evidence, [library.terms[k] for k in numbers])
            made = [fitted]
            if fitted.score > leading.score:
                leading, far = fitted, NEAR if size == 1 and _leaves_nothing(evidence, fitted) else FAR
            # An effect that explains far less needs another before its law matters.
            if size == 1 and fitted.score > leading.score - far * evidence.effective:
                made += [*successors(evidence, fitted), *_siblings(evidence, fitted)]
                best = max(made, key=lambda hypothesis: hypothesis.score)
                if best.score > leading.score:
                    # A law that leads by starting from another may itself be where a better one starts.
                    made += successors(evidence, best)
            for better in made:
                _keep(refined, better, numbers)
                _note_exact(exact, better)
        if size == 1:
            if not _leaves_nothing(evidence, leading):
                _take(_behind_other_laws(library, ranked[:count], refined), refined, exact)
            _take(_beside_exact(library), refined, exact)
        if size == 2 and is_refitted(max(refined.values(), key=lambda item: item[0].score)[0].scale):
            _take(_pairs_beside_exact(library, exact), refined, exact)
        if size == 2 and not any(_leaves_nothing(evidence, fitted, FINE) for fitted, _ in refined.values()):
            at_hand = [(_with_a_law_at_hand(evidence, fitted), numbers) for fitted, numbers in refined.values()]
            _take([(better, numbers) for better, numbers in at_hand if better], refined, exact)
        least = best_of_smaller + HARDLY * evidence.effective
        if size > 1 and max(fitted.score for fitted, _ in refined.values()) > least:
            # In company only the most likely sets are worth other forms.
            for fitted, numbers in sorted(refined.values(), key=lambda item: -item[0].score)[: 4 - size]:
                if _leaves_nothing(evidence, fitted, FINE):
                    continue
                for better in (
                    *successors(evidence, fitted),
                    *_siblings(evidence, fitted),
                    *_other_laws(library, fitted),
                    *_what_they_image(library, fitted),
                ):
                    _keep(refined, better, numbers)
                    _note_exact(exact, better)
        if size == 1:
            # Every effect is reported on, also those that are far from the best.
            for _, numbers in ranked[count:]:
                fitted = evidence.fit([library.terms[k] for k in numbers])
                _keep(refined, fitted, numbers)
        ordered = sorted(refined.values(), key=lambda item: -item[0].score)
        found += [fitted for fitted, _ in ordered]
        if size > 1 and ordered[0][0].score - best_of_smaller < HOPEFUL * evidence.effective:
            break
        if _leaves_nothing(evidence, ordered[0][0]) or (size == 1 and _leaves_nothing(evidence, found[0])):
            break
        best_of_smaller = ordered[0][0].score
        if size < most:
            grown = [term for fitted, _ in ordered[:wide] for term in fitted.terms]
            added = iter(library.add(grown))
            beam = [(tuple(next(added) for _ in fitted.terms), _likely_scales(fitted)) for fitted, _ in ordered[:wide]]
    found = _with_shapes_of_larger(evidence, found, exact)
    for hypothesis in found:
        if hypothesis.names in exact:
            hypothesis.beside_exact = evidence.fit(exact[hypothesis.names].terms, evidence.exact)
    return found


def _refined(evidence: Evidence, terms: Sequence[Term], scales: Sequence[Scale] = ()) -> Hypothesis:
    """The terms with their shapes refined, a single effect beside the likeliest simulator of ``scales``, by default of all.

    Beside an exact one only some are, where a refitted one is likelier: see :func:`_beside_exact`.
    """
    if len(terms) > 1:
        return _or_behind(evidence, refine_anyhow(evidence, terms, IN_COMPANY))
    refined = refine(evidence, evidence.fit(terms, scales), 10, scales)
    return evidence.fit(refined.terms) if scales else refined


def _or_behind(evidence: Evidence, fitted: Hypothesis, scales: Sequence[Scale] = ()) -> Hypothesis:
    """The same, or with effects that act on the joint's own deflection where those on the input tell it, whichever is better."""
    terms = [replace(term, behind=term.effect.acts_on == TORQUE) for term in fitted.terms]
    if not those_behind(terms) or those_behind(fitted.terms):
        return fitted
    behind = evidence.fit(terms, scales)
    if behind.score <= fitted.score:
        return fitted
    return refine(evidence, behind, IN_COMPANY, scales)


def _leaves_nothing(evidence: Evidence, hypothesis: Hypothesis, detail: float = DETAIL) -> bool:
    """Whether a simulator that is exact, its parameters to within ``detail``, leaves nothing beside it that could have a cause."""
    return max(hypothesis.scale) <= detail and left_by(evidence, hypothesis) < NOTHING


def _worth_refining(library: Library, ranked: Sequence[Scored]) -> tuple[list[Scored], int]:
    """Single laws without those that the best of their effect leave no chance, and how many from the first on are refined."""
    leading = _at_most(ranked, ALIKE, lambda numbers: library.terms[numbers[0]].effect.id)
    costly = [item for item in leading if library.terms[item[1][0]].shape]
    later = costly[ALONE:]
    first = [item for item in leading if item not in later]
    return first + later, len(first)


def _keep(
    best: dict[frozenset[str], tuple[Hypothesis, tuple[int, ...]]], fitted: Hypothesis, numbers: tuple[int, ...]
) -> None:
    """Keep in ``best`` what does best of each set of effects, with the terms it started from."""
    if fitted.names not in best or fitted.score > best[fitted.names][0].score:
        best[fitted.names] = (fitted, numbers)


def _take(
    found: Sequence[tuple[Hypothesis, tuple[int, ...]]],
    refined: dict[frozenset[str], tuple[Hypothesis, tuple[int, ...]]],
    exact: dict[frozenset[str], Hypothesis],
) -> None:
    """Keep what of ``found`` does best of each set of effects, also beside an exact simulator."""
    for better, numbers in found:
        _keep(refined, better, numbers)
        _note_exact(exact, better)


def _note_exact(best: dict[frozenset[str], Hypothesis], fitted: Hypothesis) -> None:
    """Keep in ``best`` what does best of each set of effects beside an exact simulator."""

    if fitted.names not in best or _score_beside_exact(fitted) > _score_beside_exact(best[fitted.names]):
        best[fitted.names] = fitted


def _score_beside_exact(fitted: Hypothesis) -> float:
    return max(score for scale, score in fitted.by_scale.items() if not is_refitted(scale))


def _behind_other_laws(
    library: Library,
    moved: Sequence[Scored],
    refined: Mapping[frozenset[str], tuple[Hypothesis, tuple[int, ...]]],
) -> list[tuple[Hypothesis, tuple[int, ...]]]:
    """Of each of the best effects the best of the laws that start only from such as were not refined, refined.

    Those ``moved`` were. What starts where a law ends that is only right of a small effect may be far better than that.
    """
    evidence = library.evidence
    best: dict[str, float] = {}
    for fitted, _ in refined.values():
        name = fitted.terms[0].effect.id
        best[name] = max(best.get(name, -np.inf), fitted.score)
    least = max(best.values()) - NEAR * evidence.effective
    near = {name for name in sorted(best, key=best.__getitem__)[-LEADING:] if best[name] > least}
    tried = {library.terms[numbers[0]].law for _, numbers in moved}
    first: dict[str, tuple[Hypothesis, tuple[int, ...]]] = {}
    for number, term in enumerate(library.terms[: library.candidates]):
        name = term.effect.id
        if name not in near or term.law in tried:
            continue
        for terms in _from_there(evidence, evidence.fit([term])):
            form = terms[0].form
            if not form.guessed and not any((name, simpler) in tried for simpler in form.refines):
                made = evidence.fit(terms)
                if name not in first or made.score > first[name][0].score:
                    first[name] = made, (number,)
    return [
        (_refined(evidence, made.terms), numbers)
        for name, (made, numbers) in first.items()
        if made.score > best[name] - AT_FIRST * evidence.effective
    ]


def _beside_exact(library: Library) -> list[tuple[Hypothesis, tuple[int, ...]]]:
    """The effects that alone do best beside an exact simulator, refined there, and the laws that start from them.

    Where a law is not yet close, a refitted simulator makes up for what it leaves, and leads its shapes astray.
    """
    evidence, made = library.evidence, []
    exact = evidence.exact
    ranked = sorted(library.extend((), exact), key=lambda item: -item[0])
    for _, numbers in _at_most(ranked, 2, lambda numbers: library.terms[numbers[0]].effect.id)[:EXACT]:
        terms = [library.terms[k] for k in numbers]
        if not terms[0].shape or evidence.fit(terms).scale in exact:
            continue
        fitted = refine(evidence, evidence.fit(terms, exact), 10, exact)
        made += [(better, numbers) for better in (evidence.fit(fitted.terms), *successors(evidence, fitted, exact))]
    return made


def _pairs_beside_exact(
    library: Library, exact: dict[frozenset[str], Hypothesis]
) -> list[tuple[Hypothesis, tuple[int, ...]]]:
    """The pairs that do best beside an exact simulator, grown from each effect of the sets that do best there, and refined there.

    Where one effect alone leaves much, a refitted simulator takes a part of both, and other effects come out ahead.
    """
    evidence = library.evidence
    leading = max(hypothesis.score for hypothesis in exact.values())
    sets = [evidence.fit(hypothesis.terms, evidence.exact) for hypothesis in exact.values()]
    sets = sorted(sets, key=lambda h: -h.score)[:GROWN]
    bases = library.add([term for hypothesis in sets for term in hypothesis.terms])
    ranked = sorted(
        (item for base in bases for item in library.extend((base,), evidence.exact)), key=lambda item: -item[0]
    )
    pairs: dict[frozenset[str], tuple[int, ...]] = {}
    for _, numbers in ranked:
        pairs.setdefault(frozenset(library.terms[k].effect.id for k in numbers), numbers)
    made = []
    for numbers in list(pairs.values())[:PAIRS]:
        start = evidence.fit([library.terms[k] for k in numbers], evidence.exact)
        refined = refine(evidence, start, IN_COMPANY, evidence.exact)
        fitted = evidence.fit(_or_behind(evidence, refined, evidence.exact).terms)
        made.append((fitted, numbers))
        # Of what is far behind what a refitted simulator makes no law matters.
        if _score_beside_exact(fitted) > leading - NEAR * evidence.effective:
            made += [(better, numbers) for better in _siblings(evidence, fitted)]
    return made


def _with_shapes_of_larger(
    evidence: Evidence, found: Sequence[Hypothesis], exact: dict[frozenset[str], Hypothesis]
) -> list[Hypothesis]:
    """The same sets of effects with the shapes that the best larger sets found, where those are better.

    What does better beside an exact simulator is noted in ``exact``.

    An effect in company may end in a better minimum than alone; the company should not get the credit.
    """
    best = {hypothesis.names: hypothesis for hypothesis in found}
    for size in (3, 2):
        larger = sorted((h for h in best.values() if len(h.terms) == size), key=lambda h: -h.score)[:INHERITED]
        for hypothesis in larger:
            for k in range(size):
                fewer = evidence.fit(hypothesis.terms[:k] + hypothesis.terms[k + 1 :])
                # Single effects are tried beside an exact simulator anyway.
                if size > 2:
                    _note_exact(exact, fewer)
                if fewer.names not in best:
                    continue
                if fewer.score > best[fewer.names].score:
                    best[fewer.names] = refine(evidence, fewer)
                if size > 2 and hypothesis is larger[0]:
                    # What is dropped may only have made up for the law of another.
                    for better in _siblings(evidence, best[fewer.names], 2):
                        _note_exact(exact, better)
                        if better.score > best[fewer.names].score:
                            best[fewer.names] = better
    return sorted(best.values(), key=lambda h: (len(h.terms), -h.score))


def successors(evidence: Evidence, fitted: Hypothesis, scales: Sequence[Scale] = ()) -> list[Hypothesis]:
    """The same effects with one form replaced by those that start where it ended, refined beside simulators of ``scales``."""
    return [_refined(evidence, terms, scales) for terms in _from_there(evidence, fitted)]


def _from_there(evidence: Evidence, fitted: Hypothesis, alike: bool = False) -> Iterator[list[Term]]:
    """The terms with one law replaced by each of those that start where it ended.

    If ``alike``, also by those with the same shape parameters, or such within the same limits.
    """
    for k, (term, own) in enumerate(zip(fitted.terms, spans(fitted.terms), strict=True)):
        for form in evidence.forms_of(term.effect):
            if term.form.name in form.refines:
                shape = form.start(term.shape, fitted.coefficients[own]) if form.start else term.shape
                yield _with_law(fitted, k, form, shape)
            elif (
                alike
                and form.name != term.form.name
                and (form.shapes == term.form.shapes or (form.shapes and form.limits == term.form.limits))
            ):
                yield _with_law(fitted, k, form, term.shape)


def _with_a_law_at_hand(evidence: Evidence, fitted: Hypothesis) -> Hypothesis | None:
    """The same effects with one law replaced by the best that can start from its shape, where that is better as it starts.

    This takes no refinement of each, and no set falls behind for a law that only alone was the best.
    """
    made = None
    for _ in range(STEPS):
        others = (evidence.fit(terms) for terms in _from_there(evidence, fitted, alike=True))
        best = max(others, key=lambda hypothesis: hypothesis.score, default=fitted)
        if best.score <= fitted.score + HARDLY * evidence.effective:
            break
        fitted = made = _refined(evidence, best.terms)
    return made


def _with_law(fitted: Hypothesis, k: int, form: Form, shape: Sequence[float]) -> list[Term]:
    """The terms with the law of the ``k``-th replaced, its shape moved within the law's limits."""
    terms = list(fitted.terms)
    inside = tuple(float(np.clip(v, low, high)) for v, (low, high) in zip(shape, form.limits, strict=True))
    terms[k] = replace(terms[k], form=form, shape=inside)
    return terms


def _siblings(evidence: Evidence, fitted: Hypothesis, tried: int = 1) -> list[Hypothesis]:
    """The same effects with the law of one replaced by the best of those with the same shape parameters.

    The starting values of a law are few; where another law has ended it may be better than at all of them. One
    replacement may lead to the next.
    """
    made = []
    for k in range(len(fitted.terms)):
        best = fitted
        for _ in range(STEPS):
            other = _best_sibling(evidence, best, k, tried)
            if other is None or other.score <= best.score:
                break
            made.append(other)
            best = other
    return made


def _best_sibling(evidence: Evidence, fitted: Hypothesis, k: int, tried: int) -> Hypothesis | None:
    """The best of the laws of the ``k``-th effect with the same shape parameters; None if all are far behind.

    The ``tried`` best of them are refined.
    """
    term, others = fitted.terms[k], []
    for form in evidence.forms_of(term.effect) if term.shape else ():
        if form.shapes != term.form.shapes or form.name == term.form.name:
            continue
        others.append(evidence.fit(_with_law(fitted, k, form, term.shape)))
    near = [other for other in others if other.score >= fitted.score - AT_FIRST * evidence.effective]
    near = sorted(near, key=lambda hypothesis: -hypothesis.score)[:tried]
    refined = (_refined(evidence, other.terms) for other in near)
    return max(refined, key=lambda hypothesis: hypothesis.score, default=None)


def _other_laws(library: Library, fitted: Hypothesis) -> list[Hypothesis]:
    """The same effects with the law of one chosen anew: another may have been better before the others were there."""
    evidence, made = library.evidence, []
    own = library.add(fitted.terms)
    for k, term in enumerate(fitted.terms):
        others = own[:k] + own[k + 1 :]
        tried: dict[str, tuple[int, ...]] = {}
        # A refitted simulator makes up for a wrong law: beside an exact one another may be right.
        for scales, count in (
            ((fitted.scale,), LAWS),
            (evidence.exact, EXACT_LAWS if is_refitted(fitted.scale) else 0),
        ):
            laws = library.extend(others, scales, term.effect.id)
            laws = [(s, numbers) for s, numbers in laws if library.terms[numbers[-1]].form.name != term.form.name]
            # Where one of those with the same shape parameters leads, the others are tried from there.
            unlike = _at_most(
                sorted(laws, reverse=True), 1, lambda numbers: str(library.terms[numbers[-1]].form.shapes)
            )
            for _, numbers in unlike[:count]:
                tried.setdefault(library.terms[numbers[-1]].form.name, numbers)
        for numbers in tried.values():
            other = _refined(evidence, [library.terms[number] for number in numbers])
            made += [other, *(_siblings(evidence, other) if other.score > fitted.score else ())]
            if other.score > fitted.score - NEARLY * evidence.effective:
                made += successors(evidence, other)
    return made


def _what_they_image(library: Library, fitted: Hypothesis) -> list[Hypothesis]:
    """The same sets with an effect replaced by one of which it may be the image, by the best of its laws beside these others."""
    own, made = library.add(fitted.terms), []
    for k, term in enumerate(fitted.terms):
        for name in term.effect.image_of:
            laws = library.extend(own[:k] + own[k + 1 :], (fitted.scale,), name)
            if laws:
                made.append(_refined(library.evidence, [library.terms[number] for number in max(laws)[1]]))
    return made


def _at_most(ranked: Sequence[Scored], count: int, key: Callable[[tuple[int, ...]], str]) -> list[Scored]:
    """At most ``count`` of each kind, the order kept."""
    seen: dict[str, int] = {}
    kept = []
    for item in ranked:
        kind = key(item[1])
        seen[kind] = seen.get(kind, 0) + 1
        if seen[kind] <= count:
            kept.append(item)
    return kept


def _likely_scales(fitted: Hypothesis, count: int = 4) -> list[Scale]:
    """The scales of parameter errors worth trying with one more effect: its best, and those with the least refit."""
    ranked = sorted(fitted.by_scale, key=lambda scale: -fitted.by_scale[scale])[:count]
    exact = [scale for scale in fitted.by_scale if scale[0] > 0.0 and not is_refitted(scale)]
    return [*ranked, *(scale for scale in exact if scale not in ranked)]
