"""Writes one page for each registered model, dataset and effect, with pictures, from the code itself."""

from __future__ import annotations

import inspect
import shutil
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from hystbench import datasets, diagnosis, models
from hystbench.datasets import DatasetUnavailableError, concatenate

__all__ = ["write_pages"]

KINDS = (("models", models.registry), ("datasets", datasets.registry), ("effects", diagnosis.registry))
SPEED = Path(__file__).with_name("speed.md")
PICTURE_DATASET = "vsa-minor-loops"


def write_pages(folder: Path) -> None:
    """Write the pages to ``folder``, which is made anew."""
    shutil.rmtree(folder, ignore_errors=True)
    with mpl.rc_context({"svg.hashsalt": "hystbench", "font.size": 9.0}):
        for kind, registry in KINDS:
            (folder / kind).mkdir(parents=True)
            names = registry.ids()
            for name in names:
                plugin: Any = registry.get(name)
                page = {"models": _model, "datasets": _dataset, "effects": _effect}[kind](name, plugin, folder / kind)
                (folder / kind / f"{name}.md").write_text(page, encoding="utf-8")
            index = [f"# {kind.capitalize()}", ""]
            index += [f"- [`{name}`]({name}.md): {registry.get(name).summary}" for name in names]
            index += ["", "```{toctree}", ":hidden:", "", *names, "```", ""]
            (folder / kind / "index.md").write_text("\n".join(index), encoding="utf-8")


def _docstring(plugin: Any) -> str:
    return "```{eval-rst}\n" + f".. autoclass:: {plugin.__module__}.{plugin.__qualname__}\n   :no-members:\n" + "```\n"


def _module(plugin: Any) -> str:
    text = inspect.getdoc(inspect.getmodule(plugin)) or ""
    return "\n".join(f"> {line}" if line else ">" for line in text.splitlines()) + "\n"


def _model(name: str, plugin: Any, folder: Path) -> str:
    lines = [f"# {plugin.title}", "", f"`{name}`: {plugin.summary}.", ""]
    data = datasets.get(PICTURE_DATASET)().load()
    x, y, groups = concatenate(data.train)
    fitted = plugin().fit(x, y, groups=groups)
    test = data.test[0]
    _picture(folder / f"{name}.svg", fitted, test.x, test.y, np.ptp(x))
    lines += [
        f"![What the model makes of a shrinking sine, and of a test loop]({name}.svg)",
        "",
        "*Left: the fitted model's output over a motion that shrinks. Right: a test recording of "
        f"`{PICTURE_DATASET}` (grey) and the prediction after a fit to its training recordings.*",
        "",
        _docstring(plugin),
        "## When to use it",
        "",
        *([f"Use it for {plugin.use_for}.", ""] if plugin.use_for else []),
        *([f"Not for {plugin.not_for}.", ""] if plugin.not_for else []),
        "## How it works",
        "",
        _module(plugin),
    ]
    if getattr(fitted, "conditions_", None):
        lines += ["## Conditions that a fit checks", ""]
        lines += [f"- {condition.name}" for condition in fitted.conditions_]
        lines.append("")
    lines += ["## Cost", "", *_cost(name), ""]
    lines += [f"Source: {plugin.source}.", ""]
    return "\n".join(lines)


def _cost(name: str) -> list[str]:
    """The model's rows of the speed page."""
    rows, title = ["| what | | time |", "|---|---|---:|"], ""
    for line in SPEED.read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            title = line[3:]
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if not line.startswith("| ") or cells[0].split(",")[0] != name:
            continue
        if title.startswith(("Predicting", "Models without")):
            rows.append(
                f"| predict, {title.removeprefix('Predicting ').split(' (')[0].split('C counterpart, ')[-1]} | {cells[0]} | {float(cells[1]):.3g} ms |"
            )
        elif title.startswith("One `stepper.step`"):
            rows.append(f"| one step from Python | {cells[0]} | {float(cells[3]) / 1e3:.2g} µs |")
        elif title == "Identification":
            rows.append(f"| fit, {cells[1]} samples | {cells[0]} | {float(cells[2]):.2g} s |")
    if len(rows) == 2:
        return ["Not measured; [the speed page](../../speed.md) has the others."]
    return [*rows, "", "How it was measured, and beside what: [speed](../../speed.md)."]


def _picture(path: Path, fitted: Any, x: np.ndarray, y: np.ndarray, reach: float) -> None:
    t = np.linspace(0.0, 1.0, 1500)
    motion = 0.45 * reach * (1.0 - 0.85 * t) * np.sin(2.0 * np.pi * 5.0 * t)
    figure = Figure(figsize=(7.5, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(motion, fitted.predict(motion), linewidth=0.9)
    right.plot(x, y, color="0.6", linewidth=2.5, label="plant")
    right.plot(x, fitted.predict(x), linewidth=0.9, label="model")
    right.legend(frameon=False)
    for axis in (left, right):
        axis.set_xlabel("deflection, rad")
        axis.spines[["top", "right"]].set_visible(False)
    left.set_ylabel("torque, N·m")
    figure.savefig(path, metadata={"Date": None})


def _dataset(name: str, plugin: Any, folder: Path) -> str:
    lines = [
        f"# {plugin.title}",
        "",
        f"`{name}`: {plugin.summary}.",
        "",
        f"- Kind: {plugin.kind}",
        f"- Licence: {plugin.licence}",
    ]
    try:
        data = plugin().load()
    except DatasetUnavailableError:
        lines += ["", f"Get it with `hystbench data fetch {name}`.", "", "## About", "", _module(plugin)]
        return "\n".join(lines)
    lines += [f"- Source: {data.source}", f"- Split: {data.split}", ""]
    figure = Figure(figsize=(7.5, 3.0), layout="constrained")
    for axis, title, part in zip(
        figure.subplots(1, 2, sharex=True, sharey=True), ("train", "test"), (data.train, data.test), strict=True
    ):
        for recording in part:
            axis.plot(recording.x[recording.warm_up :], recording.y[recording.warm_up :], linewidth=0.6)
        axis.set_title(title)
        axis.set_xlabel(f"{data.x_name}, {data.x_unit}")
        axis.spines[["top", "right"]].set_visible(False)
    figure.axes[0].set_ylabel(f"{data.y_name}, {data.y_unit}")
    figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
    lines += [f"![Training and test recordings]({name}.svg)", "", "## Assumptions", ""]
    lines += [f"- {text}" for text in data.assumptions]
    lines += ["", "## About", "", _module(plugin)]
    return "\n".join(lines)


def _effect(name: str, plugin: Any, folder: Path) -> str:
    lines = [f"# {plugin.title}", "", f"`{name}`: {plugin.summary}.", ""]
    lines += [f"- Equation: {plugin.equation}", f"- Shows over: `{plugin.coordinate}`", ""]
    lines += ["| parameter | unit | meaning |", "|---|---|---|"]
    lines += [f"| {p.name} | {p.unit} | {p.meaning} |" for p in plugin.parameters]
    if plugin.confused_with:
        lines += ["", f"Easily confused with: {', '.join(f'`{other}`' for other in plugin.confused_with)}."]
    return "\n".join([*lines, ""])
