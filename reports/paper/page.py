"""The page: the papers' tables, audit and figures on one self-contained HTML page."""

from __future__ import annotations

import base64
import math
import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from ... import __version__
from ..tables import Cell, Table, number
from ..templating import template
from .audit import SEVERITIES
from .dimensions import EQUATIONS
from .figures import UNDETERMINED, PaperFigure
from .fits import PAPER_MODELS
from .printed import PAPERS
from .results import Results

__all__ = ["Drawn", "render_page"]

GOOD = ("exact", "within rounding", "within 10 %")


@dataclass(frozen=True)
class Drawn:
    """A figure as drawn: its SVG text and its caption."""

    figure: PaperFigure
    svg: str
    caption: str

    @property
    def source(self) -> str:
        """The SVG as a data URI, so that several figures' element names cannot meet."""
        return "data:image/svg+xml;base64," + base64.b64encode(self.svg.encode()).decode()


def render_page(results: Results, drawn: Sequence[Drawn]) -> str:
    """The page as HTML; it loads nothing from anywhere."""
    by_severity = Counter(row.severity for row in results.audit)
    return template("paper.html.j2", "hystbench.reports.paper").render(
        version=__version__,
        date=_source_date(),
        papers=PAPERS,
        summary=_summary(results),
        severities=[(name, by_severity[name]) for name in SEVERITIES],
        audit=results.audit,
        tables=[_determined(results, n, title) for n, title in TITLES.items()],
        scores=[_scores(results, 4), _scores(results, 5)],
        failures=[
            f"{model}, seed {seed}: {fitted.message}"
            for (model, seed), fitted in results.fits.results.items()
            if fitted.message
        ],
        seeds=results.fits.seeds,
        sensitivity=_sensitivity(results),
        drawn=drawn,
        undetermined=UNDETERMINED,
        equations=_equations(results),
        stiffness=_stiffness(results),
        dimensions=_dimensions(),
        conditions=results.conditions,
        objectives=_objectives(results),
        integrals=_integrals(results),
    )


def _source_date() -> str:
    """The day of SOURCE_DATE_EPOCH, the only date that may appear; empty without it."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    return datetime.fromtimestamp(int(epoch), UTC).date().isoformat() if epoch.isdigit() else ""


TITLES = {
    1: "Table 1: slopes from the vertices",
    2: "Table 2: torques from Table 1 and from Table 3's elements",
    3: "Table 3: stiffnesses and limits from Table 2",
}


def _summary(results: Results) -> list[tuple[str, str]]:
    told = []
    for n in TITLES:
        counted = Counter(row.verdict for row in results.tables if row.table == n)
        total = sum(counted.values())
        text = ", ".join(f"{counted[v]} {v}" for v in ("exact", "within rounding", "contradicts") if counted[v])
        told.append((f"Table {n}", f"{total} comparisons: {text}"))
    for n in (4, 5):
        rmse = {m: results.fits.median(m, "forward" if n == 4 else "inverse", "rmse") for m in PAPER_MODELS}
        ranked = sorted(PAPER_MODELS, key=lambda m: (math.isnan(rmse[m]), rmse[m]))
        order = (
            "the printed order by RMSE holds"
            if ranked == list(PAPER_MODELS)
            else "the printed order by RMSE does not hold"
        )
        told.append((f"Table {n}", f"{order}: {', '.join(f'{m} {number(rmse[m])}' for m in ranked)}"))
    kept = Counter(r.study for r in results.sensitivity if r.as_printed)
    of = Counter(r.study for r in results.sensitivity)
    text = ", ".join(f"{study} {kept[study]} of {of[study]}" for study in of)
    told.append(("Ranking of Table 4", f"as printed under: {text}"))
    told.append(("Audit", f"{len(results.audit)} contradictions"))
    return told


def _cell(value: float, digits: int = 4) -> Cell:
    finite = math.isfinite(value)
    # Figures are sorted as shown: the last bits differ between machines and must not reach the page.
    return Cell(number(value, digits), sort=float(f"{value:.6g}") if finite else math.inf, muted=not finite)


def _determined(results: Results, n: int, title: str) -> Table:
    rows = [
        [Cell(r.cell, sort=r.cell), Cell(r.how, sort=r.how), _cell(r.printed, 6), _cell(r.recomputed, 6), _cell(r.ratio),
         Cell(r.verdict, sort=r.verdict, best=r.verdict in GOOD)]
        for r in results.tables if r.table == n
    ]  # fmt: skip
    return Table(title, ["Cell", "Recomputed from", "Printed", "Recomputed", "Ratio", "Verdict"], rows)


def _scores(results: Results, n: int) -> Table:
    what, unit = ("torque", "N·m") if n == 4 else ("deflection of the inverse", "rad")
    rows = [
        [Cell(r.cell, sort=r.cell), Cell(r.unit, sort=r.unit), _cell(r.printed), _cell(r.recomputed), _cell(r.ratio),
         Cell(r.verdict, sort=r.verdict, best=r.verdict in GOOD, muted=r.verdict == "not in the paper")]
        for r in results.tables if r.table == n
    ]  # fmt: skip
    caption = (
        f"Table {n}: {what} error on the published loop, condition {results.fits.condition}, in {unit}; MRE has no unit"
    )
    return Table(caption, ["Cell", "Unit", "Printed", "Recomputed", "Ratio", "Verdict"], rows)


def _sensitivity(results: Results) -> list[Table]:
    tables = []
    for study in dict.fromkeys(r.study for r in results.sensitivity):
        rows = [
            [Cell(f"{r.variant}, {r.metric.upper()}", sort=f"{r.variant} {r.metric}"),
             *(_cell(r.values[m], 3) for m in PAPER_MODELS),
             Cell("as printed" if r.as_printed else r.order, sort=r.order, best=r.as_printed), _cell(r.closest, 3)]
            for r in results.sensitivity if r.study == study
        ]  # fmt: skip
        tables.append(Table(f"Variant: {study}", ["Variant, metric", *PAPER_MODELS, "Order", "Closest ratio"], rows))
    return tables


def _equations(results: Results) -> Table:
    rows = [
        [Cell(e.equation, sort=e.equation), Cell(e.against, sort=e.against), Cell(e.unit, sort=e.unit), _cell(e.printed),
         _cell(e.derived), Cell("agrees" if e.agrees else "differs", sort=str(e.agrees), best=e.agrees)]
        for e in results.equations
    ]  # fmt: skip
    return Table(
        "A.1 to A.12 at 1 rad with assumed lengths and belt stiffness (A.5 defines what A.6 and A.8 are compared with)",
        ["Equation", "Compared with", "Unit", "As printed", "As derived", "Verdict"],
        rows,
    )


def _stiffness(results: Results) -> Table:
    rows = [
        [Cell(f"{s.expression}, N = {s.count}, {s.preload:g} N", sort=s.expression), _cell(s.at_one_rad),
         _cell(s.difference_at_one_rad), Cell(f"{s.worst:.1%}", sort=float(f"{s.worst:.3g}")),
         Cell("agrees" if s.holds else "differs", sort=str(s.holds), best=s.holds)]
        for s in results.stiffness
    ]  # fmt: skip
    return Table(
        "Joint stiffness against central differences of the torque A.9, N·m/rad; assumed lengths and belt stiffness",
        ["Expression", "at 1 rad", "dT/dθ at 1 rad", "worst deviation", "Verdict"],
        rows,
    )


def _dimensions() -> Table:
    rows = [
        [Cell(f"paper {e.paper}, {e.number}", sort=f"{e.paper} {e.number}"),
         Cell("; ".join(f"{term}: {d}" for term, d in e.terms.items()), sort=e.number),
         Cell("consistent" if e.consistent else "inconsistent", sort=str(e.consistent), best=e.consistent)]
        for e in EQUATIONS
    ]  # fmt: skip
    return Table("Every term's dimension; x has the dimension of Eq. 6", ["Equation", "Terms", "Verdict"], rows)


def _objectives(results: Results) -> Table:
    rows: list[list[Cell]] = [
        [Cell(f"Eq. {42 if o.side == 'pos' else 43}", sort=o.side), _cell(o.true), _cell(o.signed_finds), _cell(o.squared_finds),
         Cell(f"{number(float(o.grid[0]), 4)} to {number(float(o.grid[-1]), 4)}", sort=float(f"{o.grid[0]:.6g}"))]
        for o in results.objectives
    ]  # fmt: skip
    return Table(
        "Transition slope found on noise-free data of the example, N·m/rad",
        ["Equation", "true s", "signed sum (printed)", "sum of squares", "searched"],
        rows,
    )


def _integrals(results: Results) -> Table:
    rows: list[list[Any]] = [
        [Cell(f"{r.model}, {r.path}", sort=r.model), Cell(r.equation, sort=r.equation), Cell(f"{r.low:.3f} to {r.high:.3f}", sort=r.low),
         _cell(r.printed, 5), Cell(f"{r.driven:.5f}".replace("-0.00000", "0.00000"), sort=float(f"{r.driven:.4g}")),
         Cell("passive" if r.passive else "NEGATIVE", sort=str(r.passive), best=r.passive)]
        for r in results.integrals
    ]  # fmt: skip
    return Table(
        "Work ∮ τ dθ over a repeating cycle, J: printed integrals and driven models",
        ["Model, path", "Eq.", "θ, rad", "Printed integrals", "Driven", "Verdict"],
        rows,
    )
