"""Any arguments and any files: exit 0, 1 or 2, never a traceback, and for 2 one line that says why.

The commands' own options are read off the command line's definition, so that a new option is fuzzed from its first day.
What takes long and no argument reaches, the cells of a run, the papers and the blind check, is replaced.
"""

from __future__ import annotations

import io
import json
import os
import shutil
import warnings
import zlib
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import click
import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from hystbench import models
from hystbench.bench.cells import fallback_cell, run_cell
from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.errors import InputError

FILES = (
    "loop.csv",
    "model.json",
    "bad.csv",
    "bad.json",
    "bad.parquet",
    "bad.npz",
    "bad.mat",
    "empty.csv",
    "folder",
    "run",
    "none.csv",
)
JUNK = st.one_of(
    st.sampled_from(["", " ", "-", "--", "-1", "0", "1e999", "nan", "5%", "a,b", ",", "?x=1", "loop.csv?x=", "%", "\udcff", "ä", "<b>"]),
    # No program can be given a null byte, and nothing is to be written outside of the test's folder.
    st.text(st.characters(exclude_characters="\x00/~"), max_size=6),
)  # fmt: skip
VALUES = st.one_of(
    st.sampled_from([*FILES, "cubic", "maxwell-slip", "vsa-published", "viscous_friction", "torque_nm"]), JUNK
)


def commands(group: click.Group, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], click.Command]]:
    for name, command in group.commands.items():
        if isinstance(command, click.Group):
            yield from commands(command, (*path, name))
        else:
            yield (*path, name), command


COMMANDS = dict(commands(cli))


@st.composite
def arguments(draw: st.DrawFn) -> list[str]:
    """A command with some of its options and any number of arguments, most of them of the right kind."""
    path = draw(st.sampled_from(sorted(COMMANDS)))
    words = list(path)
    for parameter in COMMANDS[path].params:
        if isinstance(parameter, click.Argument):
            words += draw(
                st.lists(VALUES, min_size=0, max_size=2)
                if parameter.nargs < 0
                else st.lists(VALUES, min_size=1, max_size=1)
            )
        elif parameter.name != "debug" and draw(st.integers(0, 9)) < (9 if parameter.required else 3):
            words.append(draw(st.sampled_from([*parameter.opts, *parameter.secondary_opts])))
            if not getattr(parameter, "is_flag", False):
                choices = getattr(parameter.type, "choices", None)
                words.append(draw(st.sampled_from(list(choices)) if choices and draw(st.booleans()) else VALUES))
    if draw(st.integers(0, 9)) == 0:
        words.insert(draw(st.integers(0, len(words))), draw(JUNK))
    return words


ANY = st.floats(allow_nan=True, allow_infinity=True, allow_subnormal=True)
CELL = st.one_of(
    ANY.map(repr),
    st.sampled_from(["", "nan", "1,5", "x", '"', '"a\nb"', "1e999", "-0", "5e-324", "True", "2024-01-01"]),
)
NAMES = st.sampled_from(
    ["time_s", "deflection_rad", "torque_nm", "t", "angle", "force", "time_ms", "", "x", "y", "<b>", "torque_nm "]
)


@st.composite
def csv_texts(draw: st.DrawFn) -> bytes:
    """Tables in which anything may stand, and anything at all."""
    if draw(st.integers(0, 5)) == 0:
        return draw(st.binary(max_size=40))
    header = draw(st.one_of(st.just(["time_s", "deflection_rad", "torque_nm"]), st.lists(NAMES, max_size=4)))
    separator = draw(st.sampled_from([",", ";", "\t"]))
    rows = draw(st.lists(st.lists(CELL, min_size=len(header), max_size=len(header)), max_size=14))
    return "\n".join(separator.join(row) for row in [header, *rows]).encode(draw(st.sampled_from(["utf-8", "utf-16"])))


@st.composite
def recordings(draw: st.DrawFn) -> bytes:
    """Proper tables of improper figures: constant, huge, denormal, jumping."""
    n = draw(st.one_of(st.integers(8, 30), st.just(260)))
    series = []
    for _ in range(2):
        shape = draw(
            st.sampled_from(["any", "constant", "sine", "steps"] if n <= 30 else ["constant", "sine", "steps", "chirp"])
        )
        scale = draw(st.sampled_from([5e-324, 1e-29, 1e-9, 1.0, 1e9, 1e29, 1.7e308]))
        if shape == "any":
            series.append(draw(st.lists(st.floats(allow_nan=False, allow_infinity=False), min_size=n, max_size=n)))
        elif shape == "constant":
            series.append([scale] * n)
        elif shape == "chirp":
            series.append((scale * np.sin(1e-3 * np.arange(n) ** 2)).tolist())
        elif shape == "sine":
            series.append((scale * np.sin(np.arange(n))).tolist())
        else:
            series.append([scale * (k % 3) for k in range(n)])
    step = draw(st.sampled_from([1e-29, 1e-12, 0.01, 1e25]))
    rows = [f"{k * step!r},{a!r},{b!r}" for k, (a, b) in enumerate(zip(*series, strict=True))]
    return "\n".join(["time_s,deflection_rad,torque_nm", *rows]).encode()


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | ANY | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("fuzz")
    for name, n in (("loop.csv", 120), ("long.csv", 900)):
        t = 0.05 * np.arange(n)
        x = np.sin(2.0 * t)
        y = 2.0 * x + 0.3 * np.sign(np.cos(2.0 * t)) + 0.02 * np.cos(37.0 * t)
        pd.DataFrame({"time_s": t, "deflection_rad": x, "torque_nm": y}).to_csv(path / name, index=False)
    models.get("cubic")().fit(x, y).save(path / "model.json")
    for name in ("empty.csv", "bad.csv", "bad.json", "bad.parquet", "bad.npz", "bad.mat"):
        (path / name).write_bytes(b"" if name == "empty.csv" else b"\x00not a file")
    (path / "folder").mkdir()
    (path / "run").mkdir()
    (path / "run" / "results.parquet").write_bytes(b"PAR1")
    (path / "run" / "run.json").write_text('{"finished": false, "cells": [1], "diagnosed": []}')
    return path


@pytest.fixture(scope="module", autouse=True)
def _quick_and_offline(folder: Path) -> Iterator[None]:
    def cells(specs: list[Any], where: Path, jobs: int) -> Iterator[dict[str, Any]]:
        where.mkdir(parents=True, exist_ok=True)
        for spec in specs:
            real = spec.dataset == "long.csv"
            yield run_cell(spec, where) if real else fallback_cell(spec, where, "failed", "not computed")

    def no_download(file: Any) -> None:
        raise InputError(f"{file.place}: cannot be downloaded; there is no network")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hystbench.bench.run.compute_here", cells)
        patch.setattr("hystbench.reports.paper.write_paper", lambda out: out / "paper.html")
        patch.setattr("hystbench.diagnosis.blind.check.check", lambda *args: ["checked"])
        patch.setattr("hystbench.datasets.store._download", no_download)
        patch.setattr("hystbench.bench.dask_backend.CONNECT_TIMEOUT", "10ms")
        patch.setenv("HYSTBENCH_DATA", str(folder / "data"))
        patch.chdir(folder)
        assert (
            execute(
                cli,
                ["run", "--quick", "--models", "cubic", "--datasets", "long.csv", "--diagnose", "--out", "good-run"],
            )
            == 0
        )
        yield


def outcome(words: list[str]) -> tuple[int, str, str]:
    out, err = io.StringIO(), io.StringIO()
    showing = warnings.showwarning
    try:
        with redirect_stdout(out), redirect_stderr(err):
            code = execute(cli, words)
    finally:
        warnings.showwarning = showing
    return code, out.getvalue(), err.getvalue()


def behaves(words: list[str]) -> int:
    code, out, err = outcome(words)
    assert code in (0, 1, 2), err
    assert "Traceback" not in out + err
    lines = err.splitlines()
    assert all(line.startswith("hystbench: ") for line in lines), err
    errors = [line for line in lines if line.startswith("hystbench: error: ")]
    assert len(errors) == (code == 2), err
    assert all(len(line) > len("hystbench: error: ") + 10 for line in errors)
    return code


MORE = int(os.environ.get("HYSTBENCH_FUZZ", "0"))
"""Examples of a longer search, other ones each time."""


def examples(count: int) -> settings:
    """Settings of a test that is to take a few seconds, or of a longer search."""
    slow = list(HealthCheck)
    if MORE:
        return settings(
            max_examples=MORE, phases=[Phase.generate], derandomize=False, deadline=None, suppress_health_check=slow
        )
    return settings(max_examples=count, deadline=None, suppress_health_check=slow)


@examples(400)
@given(words=arguments())
def test_any_arguments(words: list[str]) -> None:
    behaves(words)


FIT = st.sampled_from(["cubic", "maxwell-slip", "prandtl-ishlinskii", "choi-backlash", "linear", "preisach"])


@examples(150)
@given(
    content=st.one_of(csv_texts(), recordings()),
    model=FIT,
    what=st.sampled_from(["fit", "check", "predict", "invert", "diagnose", "run"]),
)
def test_any_recording(folder: Path, content: bytes, model: str, what: str) -> None:
    (folder / "given.csv").write_bytes(content)
    words = {
        "fit": ["fit", "given.csv", "--model", model, "--out", "fitted.json"],
        "check": ["data", "check", "given.csv", "--json"],
        "predict": ["predict", "model.json", "given.csv", "--out", "out.csv"],
        "invert": ["invert", "model.json", "given.csv", "--out", "out.csv", "--approximate"],
        "diagnose": ["diagnose", "given.csv", "--sim", "given.csv", "--json", "-"],
        "run": ["run", "--quick", "--datasets", "given.csv", "--models", model, "--out", "made"],
    }
    if behaves(words[what]) == 0 and what == "fit":
        assert behaves(["predict", "fitted.json", "given.csv", "--out", "out.csv"]) == 0


@examples(80)
@given(data=st.data())
def test_any_model_file(folder: Path, data: st.DataObject) -> None:
    document = json.loads((folder / "model.json").read_text())
    if data.draw(st.integers(0, 4)):
        part = document
        while True:
            key = data.draw(st.sampled_from(sorted(part)))
            if not (isinstance(part[key], dict) and part[key] and data.draw(st.booleans())):
                break
            part = part[key]
        part[key] = data.draw(JSON)
    else:
        document = data.draw(JSON)
    text = json.dumps(document)
    (folder / "odd.json").write_text(text)
    for words in (["predict"], ["invert", "--approximate"]):
        behaves([*words, "odd.json", "loop.csv", "--out", "out.csv"])
    # What takes a hundred times as long is asked of every tenth; numbers that are drawn would be zero much more often.
    if zlib.crc32(text.encode()) % 10 == 0:
        behaves(["diagnose", "loop.csv", "--sim", "odd.json"])


@st.composite
def mutated(draw: st.DrawFn, document: Any) -> Any:
    """A document in which something, however deep, is something else or missing."""
    if not draw(st.integers(0, 5)) or not document or not isinstance(document, dict | list):
        return draw(JSON)
    keys = sorted(document) if isinstance(document, dict) else range(len(document))
    key, copy = draw(st.sampled_from(keys)), document.copy()
    if draw(st.integers(0, 5)):
        copy[key] = draw(mutated(document[key]))
    else:
        del copy[key]
    return copy


@examples(15)
@given(
    data=st.data(),
    file=st.sampled_from(["run.json", "diagnoses.json", "cells", "results.parquet"]),
    finished=st.booleans(),
)
def test_any_run_folder(folder: Path, data: st.DataObject, file: str, finished: bool) -> None:
    place = folder / "odd-run"
    shutil.rmtree(place, ignore_errors=True)
    shutil.copytree(folder / "good-run", place)
    document = json.loads((place / "run.json").read_text())
    (place / "run.json").write_text(json.dumps({**document, "finished": finished}))
    if file == "results.parquet":
        (place / file).write_bytes(data.draw(st.binary(max_size=20)))
    else:
        path = next(place.glob("cells/*.json")) if file == "cells" else place / file
        path.write_text(json.dumps(data.draw(mutated(json.loads(path.read_text())))))
    words = [
        ["report", "odd-run"],
        ["compare", "good-run", "odd-run"],
        ["history", "odd-run", "good-run"],
        ["report", "odd-run", "good-run", "--out", "merged"],
    ]
    behaves(data.draw(st.sampled_from(words)))
