"""Figures of both papers that their text determines: one function each, which returns the figure and its caption.

Captions say what is data (printed in the paper) and what is assumed. Measured curves of the papers are not printed as
figures, so wherever a figure shows a measurement, the published loop of Tables 1 and 2 with assumed motion and sensor
noise stands in for it; nothing is digitised.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from ... import models
from ...datasets.published_loop import (
    ASCENDING,
    DESCENDING,
    PRINTED_ELEMENTS,
    PRINTED_Q4_TORQUE,
    TRANSITION_NEG,
    TRANSITION_POS,
    VERTICES,
    lower_branch,
    upper_branch,
)
from ...datasets.vsa_minor_loops import minor_loop_plant
from ...files import replacing
from .. import figures as report_figures
from .appendix_a import ASSUMED, CONFIGURATIONS, torque_a9
from .fits import PAPER_MODELS, Fits
from .loop import derived_limits, element_sum, stiffnesses
from .passivity import STROKE, example_choi, loop_types, turning_trajectory

__all__ = ["FIGURES", "UNDETERMINED", "PaperFigure", "save"]

Floats = NDArray[np.float64]
BLACK, GREY = "#1b1f24", "#8a8a8a"
BLUE, RED, GREEN, PINK, OCHRE = report_figures.COLOURS[:5]
MODEL_COLOURS = dict(zip(PAPER_MODELS, (BLUE, RED, GREEN), strict=True))
STYLE = {
    **{k: BLACK if v == report_figures.INK else v for k, v in report_figures.STYLE.items()},
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}
X, TORQUE = "deflection x, rad", "torque, N·m"
STAND_IN = (
    "The paper's measurement is not printed; the published loop of Tables 1 and 2 (data) under an assumed motion at "
    "0.5 rad/s stands in for it, seen through assumed sensor noise of 0.02 N·m and 0.001 rad and a Kalman filter."
)


@dataclass(frozen=True)
class PaperFigure:
    """A figure of one of the papers, and how to draw it."""

    paper: int
    number: int
    title: str
    draw: Callable[[Fits], tuple[Figure, str]]

    @property
    def id(self) -> str:
        return f"paper{self.paper}-fig{self.number:02d}"


FIGURES: list[PaperFigure] = []
_Draw = Callable[[Fits], tuple[Figure, str]]


def _figure_of(paper: int, number: int, title: str) -> Callable[[_Draw], _Draw]:
    def register(draw: _Draw) -> _Draw:
        FIGURES.append(PaperFigure(paper, number, title, draw))
        return draw

    return register


def save(figure: PaperFigure, fits: Fits, folder: Any) -> tuple[str, str]:
    """Write ``folder/<id>.svg`` and ``.png``; return the SVG text and the caption. The same fits give the same bytes."""
    with mpl.rc_context({**STYLE, "svg.hashsalt": figure.id}):
        drawn, caption = figure.draw(fits)
        with replacing(folder / f"{figure.id}.svg") as path:
            FigureCanvasSVG(drawn).print_svg(path, metadata={"Date": None, "Creator": None})
        drawn.set_dpi(130)
        with replacing(folder / f"{figure.id}.png") as path:
            FigureCanvasAgg(drawn).print_png(path, metadata={"Software": None})
    return (folder / f"{figure.id}.svg").read_text(encoding="utf-8"), caption


def _panels(
    rows: int = 1, columns: int = 1, width: float = 6.4, height: float = 3.6, **shared: Any
) -> tuple[Figure, Any]:
    figure = Figure(figsize=(width, height), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **shared)
    return figure, axes


def _label(axis: Any, x: str, y: str, title: str = "") -> None:
    axis.set_xlabel(x)
    axis.set_ylabel(y)
    if title:
        axis.set_title(title, loc="left")


def _thin(series: Floats, limit: int = 900) -> NDArray[np.intp]:
    """Indices of at most ``limit`` samples, evenly spread."""
    return np.unique(np.linspace(0, series.size - 1, min(limit, series.size)).round().astype(int))


def _scored(fits: Fits) -> tuple[Floats, Floats, Floats, NDArray[np.bool_]]:
    keep = fits.keep
    return fits.truth.time[keep], fits.truth.x[keep], fits.truth.y[keep], keep


# ---- first paper ---------------------------------------------------------------------------------------------------


@_figure_of(1, 6, "Torque over deflection for N = 2, 4, 6 at 5 N preload")
def configurations(fits: Fits) -> tuple[Figure, str]:
    figure, axes = _panels()
    axis = axes[0, 0]
    theta = np.linspace(-1.0, 1.0, 201)
    for count, colour in zip(CONFIGURATIONS, (BLUE, RED, GREEN), strict=True):
        axis.plot(theta, torque_a9(theta, replace(ASSUMED, count=count)), color=colour, label=f"A.9, N = {count}")
    for k, branch in enumerate((upper_branch(), lower_branch())):
        axis.plot(*branch.T, color=GREY, linewidth=1.6, label="published loop, N = 6" if k == 0 else None)
    _label(axis, "deflection, rad", TORQUE)
    axis.legend()
    return figure, (
        "Data: the loop for N = 6 (Tables 1 and 2), N and the preload of 5 N. Assumed: crank 20 mm, link 45 mm and belt "
        "stiffness 1050 N/m, which the paper does not print, so the size of the coloured curves is not the paper's. "
        "A.9 is elastic: it has no hysteresis; the loops measured for N = 2 and 4 are not printed."
    )


@_figure_of(1, 8, "Sliding of the elastic units of transition 1")
def sliding(fits: Fits) -> tuple[Figure, str]:
    figure, axes = _panels(1, 2, 7.6, 3.2)
    k, eta = stiffnesses(TRANSITION_POS), derived_limits(TRANSITION_POS)
    length = TRANSITION_POS[-1, 0] - TRANSITION_POS[0, 0]
    distance = np.linspace(0.0, 1.2 * length, 361)
    for i, colour in enumerate((BLUE, RED, GREEN, PINK)):
        axes[0, 0].plot(distance, np.minimum(k[i] * distance, eta[i]), color=colour, label=f"f_{i + 1}")
    axes[0, 1].plot(distance, element_sum(distance, k, eta), color=BLACK)
    slopes = np.cumsum(k[::-1])[::-1]
    middle = 0.5 * (TRANSITION_POS[1:, 0] + TRANSITION_POS[:-1, 0]) - TRANSITION_POS[0, 0]
    for j, at in enumerate(middle):
        place = (at, float(element_sum(np.array([at]), k, eta)[0]))
        axes[0, 1].annotate(
            f"S_{j + 1} = {slopes[j]:.2f}", place, xytext=(8, -12), textcoords="offset points", fontsize=8
        )
    axes[0, 0].legend(loc="lower right")
    _label(axes[0, 0], "x − x(P1)", "unit's torque, N·m", "each unit")
    _label(axes[0, 1], "x − x(P1)", "sum, N·m", "sum of the units")
    return figure, (
        "Data: Table 2. Stiffnesses by Eq. 16, limits by Eq. 17 as derived (Table 3's first column contradicts both). "
        "S_j is the sum of the stiffnesses that still stick, Σ k_i from i = j."
    )


@_figure_of(1, 9, "One Maxwell-slip element over a cycle")
def element(fits: Fits) -> tuple[Figure, str]:
    figure, axes = _panels(width=5.2)
    axis = axes[0, 0]
    k, eta = float(stiffnesses(TRANSITION_POS)[0]), float(derived_limits(TRANSITION_POS)[0])
    slip = eta / k
    corners = {
        "a": (0.0, 0.0),
        "b": (slip, eta),
        "c": (2.5 * slip, eta),
        "e": (0.5 * slip, -eta),
        "f": (-1.5 * slip, -eta),
    }
    axis.plot(*np.array(list(corners.values())).T, color=BLUE)
    back = np.array([corners["f"], (0.5 * slip, eta), corners["c"]])
    axis.plot(*back.T, color=BLUE, linestyle="--")
    for name, place in corners.items():
        axis.annotate(name, place, xytext=(4, 5), textcoords="offset points")
    _label(axis, "displacement x", "torque of the unit, N·m")
    return figure, (
        f"Eq. 3 for the first element of transition 1, k = {k:.4f} and η = {eta:.2f} N·m from Table 2 through Eqs. 16 and 17. "
        "The stroke is chosen freely. From e it slips at −η (the text says −f). Dashed: the way back, which the text does not describe."
    )


def _vertices(axis: Any, exchanged: bool = False) -> None:
    for branch in (upper_branch(), lower_branch()):
        axis.plot(*(branch.T[::-1] if exchanged else branch.T), color=GREY, linewidth=1.4)
    for name, (x, y) in VERTICES.items():
        if name == "G":
            continue
        place = (y, x) if exchanged else (x, y)
        axis.plot(*place, "o", color=BLUE, markersize=3)
        above = name in "ABCLKJ"
        axis.annotate(
            "A = G" if name == "A" else name, place, xytext=(-9, 4) if above else (5, -9), textcoords="offset points"
        )


@_figure_of(1, 11, "The constructed hysteresis model with its vertices")
def constructed(fits: Fits) -> tuple[Figure, str]:
    figure, axes = _panels(height=4.2)
    _vertices(axes[0, 0])
    _label(axes[0, 0], X, TORQUE)
    return (
        figure,
        "Data: the vertices of Table 1 and the transitions of Table 2 (Q4 read as −5.62). x is read as the deflection in rad.",
    )


@_figure_of(1, 12, "Transition phases 1 and 2")
def transitions(fits: Fits) -> tuple[Figure, str]:
    figure, axes = _panels(1, 2, 7.6, 3.4)
    for axis, name, points, marks, sign in (
        (axes[0, 0], "P", TRANSITION_POS, ("k", "eta"), 1.0),
        (axes[0, 1], "Q", TRANSITION_NEG, ("k'", "eta'"), -1.0),
    ):
        axis.plot(*points.T, "o-", color=BLUE, markersize=4, label="Table 2")
        axis.plot(*points[[0, -1]].T, color=GREY, linestyle="--", label="mean slope k")
        distance = np.linspace(0.0, abs(points[-1, 0] - points[0, 0]), 121)
        k, eta = (np.array(PRINTED_ELEMENTS[m]) for m in marks)
        built = points[0, 1] + sign * element_sum(distance, k, eta)
        axis.plot(points[0, 0] + sign * distance, built, color=RED, linewidth=1.0, label="from Table 3 as printed")
        for i, place in enumerate(points):
            axis.annotate(f"{name}{i + 1}", place, xytext=(5, -11), textcoords="offset points")
        _label(axis, X, TORQUE, f"transition {1 if sign > 0 else 2}")
        axis.legend(loc="lower right" if sign > 0 else "upper left")
    return figure, (
        f"Data: Tables 2 and 3; Q4 is printed as +{PRINTED_Q4_TORQUE} and drawn at −{PRINTED_Q4_TORQUE}. Table 3's elements (red) "
        "give transition 2 and miss transition 1."
    )


@_figure_of(1, 14, "The proposed hysteresis model by phase")
def phases(fits: Fits) -> tuple[Figure, str]:
    figure, axes = _panels(height=4.0)
    axis = axes[0, 0]
    for points, colour, style, name in (
        (ASCENDING, RED, "-", "ascending phase"),
        (DESCENDING, GREEN, "-", "descending phase"),
        (TRANSITION_POS, BLUE, "--", "transition phase 1"),
        (TRANSITION_NEG, BLACK, "--", "transition phase 2"),
    ):
        axis.plot(*points.T, color=colour, linestyle=style, label=name)
    _label(axis, X, TORQUE)
    axis.legend()
    return figure, "Data: Tables 1 and 2, in the colours that the paper's text names (Q4 read as −5.62)."


@_figure_of(1, 15, "Torque over time: loop and proposed model")
def torque_over_time(fits: Fits) -> tuple[Figure, str]:
    time, _, y, keep = _scored(fits)
    figure, axes = _panels()
    part = _thin(time)
    axes[0, 0].plot(time[part], y[part], color=GREY, linewidth=2.2, label="published loop")
    axes[0, 0].plot(
        time[part], _torque(fits, "maxwell-slip")[keep][part], color=BLUE, linewidth=0.9, label="proposed model"
    )
    _label(axes[0, 0], "time, s", TORQUE)
    figure.legend(loc="outside upper center", ncols=2)
    return (
        figure,
        f"{STAND_IN} The model was identified on other cycles of that loop. The paper's time scale is not printed.",
    )


def _torque(fits: Fits, model: str) -> Floats:
    torque = fits.first(model).torque
    return np.full(fits.truth.x.size, np.nan) if torque is None else torque


def _deflection(fits: Fits, model: str) -> Floats:
    deflection = fits.first(model).deflection
    return np.full(fits.truth.x.size, np.nan) if deflection is None else deflection


@_figure_of(1, 16, "Torque error of the proposed model")
def torque_error(fits: Fits) -> tuple[Figure, str]:
    time, _, y, keep = _scored(fits)
    figure, axes = _panels(height=2.8)
    part = _thin(time, 1800)
    axes[0, 0].plot(time[part], (_torque(fits, "maxwell-slip")[keep] - y)[part], color=BLUE, linewidth=0.7)
    _label(axes[0, 0], "time, s", "error, N·m")
    return figure, f"{STAND_IN} The paper states a largest deviation of 0.2 N·m on its own recording."


@_figure_of(1, 17, "Measured torque, simulated torque and error")
def measured_and_simulated(fits: Fits) -> tuple[Figure, str]:
    _, x, y, keep = _scored(fits)
    figure, axes = _panels(height=4.0)
    part = _thin(x)
    simulated = _torque(fits, "maxwell-slip")[keep]
    for series, colour, width, name in (
        (y, GREY, 2.2, "1: published loop"),
        (simulated, BLUE, 0.9, "2: proposed model"),
        (simulated - y, RED, 0.7, "3: error"),
    ):
        axes[0, 0].plot(x[part], series[part], color=colour, linewidth=width, label=name)
    _label(axes[0, 0], X, TORQUE)
    axes[0, 0].legend()
    return figure, STAND_IN


@_figure_of(1, 18, "Torque of the three models")
def three_models(fits: Fits) -> tuple[Figure, str]:
    _, x, y, keep = _scored(fits)
    figure, axes = _panels(1, 3, 8.6, 3.0, sharey=True)
    part = _thin(x)
    for axis, model in zip(axes[0], PAPER_MODELS, strict=True):
        axis.plot(x[part], y[part], color=GREY, linewidth=2.2, label="published loop")
        axis.plot(x[part], _torque(fits, model)[keep][part], color=MODEL_COLOURS[model], linewidth=0.9, label="model")
        _label(axis, X, TORQUE if model == PAPER_MODELS[0] else "", model)
    axes[0, 0].legend()
    return (
        figure,
        f"{STAND_IN} All three were identified by this project on the same training cycles; the paper's parameters of the cubic and the Bouc-Wen model are not printed.",
    )


@_figure_of(1, 19, "Torque error of the three models")
def three_errors(fits: Fits) -> tuple[Figure, str]:
    time, _, y, keep = _scored(fits)
    figure, axes = _panels(3, 1, 6.8, 4.2, sharex=True, sharey=True)
    part = _thin(time, 1200)
    worst = []
    for axis, model in zip(axes[:, 0], PAPER_MODELS, strict=True):
        error = _torque(fits, model)[keep] - y
        worst.append(f"{model} {np.max(np.abs(error)):.2f}")
        axis.plot(time[part], error[part], color=MODEL_COLOURS[model], linewidth=0.7)
        _label(axis, "time, s" if model == PAPER_MODELS[-1] else "", "error, N·m", model)
    return (
        figure,
        f"{STAND_IN} Largest deviations here, N·m: {', '.join(worst)}; the paper states 0.2, 0.5 and more than 0.5.",
    )


@_figure_of(1, 20, "The inverse model: axes exchanged")
def inverse_model(fits: Fits) -> tuple[Figure, str]:
    figure, axes = _panels(height=4.2)
    _vertices(axes[0, 0], exchanged=True)
    _label(axes[0, 0], TORQUE, X)
    return figure, "Data: Tables 1 and 2 with exchanged axes, as section 5 builds the inverse (Q4 read as −5.62)."


@_figure_of(1, 21, "Inverse model against the loop")
def inverse_loop(fits: Fits) -> tuple[Figure, str]:
    _, x, y, keep = _scored(fits)
    figure, axes = _panels(height=4.0)
    part = _thin(x)
    axes[0, 0].plot(y[part], x[part], color=GREY, linewidth=2.2, label="published loop")
    axes[0, 0].plot(
        y[part],
        _deflection(fits, "maxwell-slip")[keep][part],
        color=BLUE,
        linewidth=0.9,
        label="inverse of the proposed model",
    )
    _label(axes[0, 0], TORQUE, X)
    axes[0, 0].legend()
    return figure, STAND_IN


@_figure_of(1, 22, "Deflection over time: loop and inverse model")
def deflection_over_time(fits: Fits) -> tuple[Figure, str]:
    time, x, _, keep = _scored(fits)
    figure, axes = _panels()
    part = _thin(time)
    axes[0, 0].plot(time[part], x[part], color=GREY, linewidth=2.2, label="published loop")
    axes[0, 0].plot(
        time[part],
        _deflection(fits, "maxwell-slip")[keep][part],
        color=BLUE,
        linewidth=0.9,
        label="inverse of the proposed model",
    )
    _label(axes[0, 0], "time, s", X)
    figure.legend(loc="outside upper center", ncols=2)
    return figure, STAND_IN


@_figure_of(1, 23, "Deflection error of the inverse model")
def deflection_error(fits: Fits) -> tuple[Figure, str]:
    time, x, _, keep = _scored(fits)
    figure, axes = _panels(height=2.8)
    part = _thin(time, 1800)
    axes[0, 0].plot(time[part], (_deflection(fits, "maxwell-slip")[keep] - x)[part], color=BLUE, linewidth=0.7)
    _label(axes[0, 0], "time, s", "error, rad")
    return figure, f"{STAND_IN} The paper states a largest error below 0.15 rad on its own recording."


# ---- second paper --------------------------------------------------------------------------------------------------

SPRING = "The second paper's spring data are not in the text at hand; {} stands in for it. Only the procedure is the paper's."


@_figure_of(2, 20, "Identification trajectory and torque")
def choi_trajectory(fits: Fits) -> tuple[Figure, str]:
    time, x, y, _ = _scored(fits)
    figure, axes = _panels(1, 2, 7.6, 3.0)
    part = _thin(time)
    axes[0, 0].plot(time[part], x[part], color=BLUE)
    axes[0, 1].plot(x[part], y[part], color=BLUE)
    _label(axes[0, 0], "time, s", X, "a: constant speed, end to end")
    _label(axes[0, 1], X, TORQUE, "b: torque")
    return figure, SPRING.format("the first paper's published loop (Tables 1 and 2)")


@_figure_of(2, 21, "The four functions, their difference and derivatives")
def choi_functions(fits: Fits) -> tuple[Figure, str]:
    model = example_choi()
    figure, axes = _panels(1, 2, 8.0, 3.4)
    for side, grid in (("neg", np.linspace(STROKE[0], 0.0, 161)), ("pos", np.linspace(0.0, STROKE[1], 161))):
        ascending, descending = (Polynomial(model.parameters_[f"{b}_{side}"]) for b in ("ascending", "descending"))
        first = side == "neg"
        for curve, colour, name in ((ascending, RED, "ascending"), (descending, GREEN, "descending")):
            axes[0, 0].plot(grid, curve(grid), color=colour, label=name if first else None)
            axes[0, 1].plot(grid, curve.deriv()(grid), color=colour, linestyle="-.", label=name if first else None)
        axes[0, 0].plot(
            grid,
            (ascending - descending)(grid),
            color=BLACK,
            linestyle="--",
            label="difference (Eq. 14)" if first else None,
        )
        slope = model.parameters_[f"slope_{side}"]
        axes[0, 1].plot(grid[[0, -1]], [slope, slope], color=BLUE, label="s−, s+ (assumed)" if first else None)
    _label(axes[0, 0], X, TORQUE, "a: functions")
    _label(axes[0, 1], X, "slope, N·m/rad", "b: derivatives (Eqs. 15, 19, 20)")
    for axis in axes[0]:
        axis.legend()
    return figure, SPRING.format(
        "the curves of the first paper's Table 1, fitted by polynomials of degree 5 through the origin,"
    ) + (" Transition slopes of 1.5 times the steepest derivative are assumed.")


@cache
def _choi_on_many_turns() -> tuple[Floats, Floats, Floats, Floats]:
    time, x = turning_trajectory()
    measured = minor_loop_plant(time, x)
    return time, x, measured, np.asarray(models.get("choi-backlash")().fit(x, measured).predict(x))


@_figure_of(2, 22, "Many turns: trajectory, measured and estimated torque")
def choi_turns(fits: Fits) -> tuple[Figure, str]:
    time, x, measured, estimated = _choi_on_many_turns()
    figure, axes = _panels(1, 3, 8.8, 3.0)
    half = int(np.argmax(x < 0.0))
    part = _thin(time)
    axes[0, 0].plot(time[part], x[part], color=BLUE)
    _label(axes[0, 0], "time, s", X, "a: trajectory")
    for axis, series, title in ((axes[0, 1], measured, "b, c: measured"), (axes[0, 2], estimated, "d, e: estimated")):
        axis.plot(x[:half][::2], series[:half][::2], color=GREEN, linewidth=0.9, label="x > 0")
        axis.plot(x[half:][::2], series[half:][::2], color=RED, linewidth=0.9, label="x < 0")
        _label(axis, X, TORQUE, title)
    axes[0, 1].legend()
    return figure, SPRING.format("the plant of vsa-minor-loops (assumed stop operators on the published branches)") + (
        " Estimated: choi-backlash identified on this very recording with squared errors in Eqs. 42 and 43."
    )


@_figure_of(2, 23, "The four types of loop")
def choi_loops(fits: Fits) -> tuple[Figure, str]:
    model = example_choi()
    figure, axes = _panels(2, 2, 7.4, 5.4)
    for axis, loop in zip(axes.flat, loop_types(model), strict=True):
        corners = [0.0, *loop.approach, loop.high, loop.low, loop.high, loop.low, loop.high]
        x = np.concatenate([np.linspace(a, b, 201) for a, b in pairwise(corners)])
        y = np.asarray(model.predict(x))
        axis.plot(x[:-402], y[:-402], color=GREY, linewidth=0.7, linestyle="--")
        axis.plot(x[-402:], y[-402:], color=BLUE)
        for name, place in loop.corners.items():
            axis.annotate(name, place, xytext=(4, -9), textcoords="offset points")
        if loop.path in ("GIJHG", "KLK"):
            # Small loops: the way from zero would leave them a few pixels.
            places = np.array(list(loop.corners.values()))
            margin = 0.4 * np.ptp(places, axis=0)
            axis.set_xlim(places[:, 0].min() - margin[0], places[:, 0].max() + margin[0])
            axis.set_ylim(places[:, 1].min() - margin[1], places[:, 1].max() + margin[1])
        _label(axis, X, TORQUE, f"{loop.path}: Eq. {loop.equation}, {loop.printed:.4f} J")
    return figure, SPRING.format("the polynomial example of Fig. 21") + (
        " Turning points are chosen freely; dashed: the way to the loop. The work is the printed sum of integrals."
    )


UNDETERMINED = (
    (1, "1-5", "drawings and photographs of the device"),
    (1, "7", "schematic of the elements, without figures"),
    (1, "10", "block diagram"),
    (1, "13", "photograph of the test bench"),
    (2, "1-19", "only named; the main text was not at hand"),
)
"""(paper, figures, why they are not drawn)."""
