"""`hystbench data`: what a person sees, the exit codes, and packages that describe what they hold."""

from __future__ import annotations

import hashlib
import json
import re
import urllib.parse
from collections.abc import Callable
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import frictionless
import numpy as np
import pandas as pd
import pytest

from hystbench.bench.cli import cli
from hystbench.bench.console import execute
from hystbench.datasets import Dataset, Recording, catalogue, get
from hystbench.datasets.catalogue import CatalogueEntry, CatalogueFile
from hystbench.datasets.datapackage import catalogue_package, write_datapackage
from hystbench.datasets.recording_files import read_recording
from hystbench.errors import InputError

CONTENT = b"time_s,deflection_rad,torque_nm\n"
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def data(capsys: pytest.CaptureFixture[str]) -> Run:
    def run(*arguments: str) -> tuple[int, str, str]:
        code = execute(cli, ["data", *arguments])
        told = capsys.readouterr()
        return code, told.out, told.err

    return run


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A data folder beside a catalogue of two free datasets and a share-alike one, two files each, and no server."""
    digest = hashlib.sha256(CONTENT).hexdigest()

    def made_up(name: str, licence: str) -> CatalogueEntry:
        files = tuple(CatalogueFile(f"owner/{name}", "0" * 40, p, len(CONTENT), digest) for p in ("one.csv", "two.csv"))
        return CatalogueEntry(name, f"title of {name}", licence, f"author of {name}", files)

    known = {name: made_up(name, licence) for name, licence in (("a", "MIT"), ("b", "CC0-1.0"), ("c", "CC-BY-SA-4.0"))}
    monkeypatch.setattr(catalogue, "catalogue", lambda: known)
    monkeypatch.setenv("HYSTBENCH_DATA", str(tmp_path / "data"))
    monkeypatch.setenv("HYSTBENCH_DATA_URL", "http://127.0.0.1:9")
    monkeypatch.setattr("hystbench.datasets.store.RETRIES", 0)
    return tmp_path / "data"


def put(folder: Path, *names: str, content: bytes = CONTENT) -> None:
    for name in names:
        dataset, _, file = name.partition("/")
        for one in [file] if file else ["one.csv", "two.csv"]:
            path = folder / "owner" / dataset / ("0" * 40) / one
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


def test_list_says_what_is_here(data: Run, folder: Path) -> None:
    put(folder, "a", "b/one.csv")
    code, out, err = data("list")
    assert code == 0
    lines = {line.split()[0]: line for line in out.splitlines()}
    assert list(lines) == ["a", "b", "c"]
    assert "present" in lines["a"]
    assert "1/2 files" in lines["b"]
    assert "0/2 files" in lines["c"]
    assert "CC-BY-SA-4.0" in lines["c"]
    assert str(folder) in err


def test_list_for_machines(data: Run, folder: Path) -> None:
    put(folder, "a")
    code, out, _ = data("list", "--json")
    told = json.loads(out)
    assert code == 0
    assert told["folder"] == str(folder)
    assert [(row["id"], row["files"], row["present"], row["bytes"]) for row in told["datasets"]] == [
        ("a", 2, 2, 2 * len(CONTENT)), ("b", 2, 0, 2 * len(CONTENT)), ("c", 2, 0, 2 * len(CONTENT)),
    ]  # fmt: skip


def test_fetch_works_offline_and_leaves_out_what_needs_acceptance(data: Run, folder: Path) -> None:
    put(folder, "a", "b")
    code, out, err = data("fetch")
    assert code == 0
    assert [line.split(":")[0] for line in out.splitlines()] == ["a", "b"]
    assert "author of a" in out
    assert "c left out: CC-BY-SA-4.0" in err
    assert "--accept-licence" in err


def test_fetch_fails_in_one_line(data: Run, folder: Path) -> None:
    for arguments, what in (
        (["c"], "--accept-licence"),
        (["a"], "check the network"),
        (["c", "--accept-licence"], "check the network"),
        (["aa"], "did you mean 'a'"),
    ):
        code, out, err = data("fetch", *arguments)
        assert (code, out) == (2, "")
        assert what in err
        assert len(err.splitlines()) == 1


def test_verify_finds_tampered_files_and_absent_ones_of_named_datasets(data: Run, folder: Path) -> None:
    put(folder, "a")
    code, out, _ = data("verify")
    assert code == 0
    assert "a: 2 present" in out
    assert "b: 2 absent" in out
    assert data("verify", "a")[0] == 0
    code, out, _ = data("verify", "b")
    assert code == 1
    assert "two.csv" in out
    put(folder, "a/two.csv", content=CONTENT.upper())
    for arguments in ([], ["a"]):
        code, out, _ = data("verify", *arguments)
        assert code == 1
        assert re.search(r"^damaged .*two\.csv$", out, re.MULTILINE)
        assert "a: 1 present, 1 damaged" in out
    assert data("verify", "nothing")[0] == 2


@pytest.mark.parametrize("command", ["list", "fetch", "verify", "export"])
def test_every_command_has_an_example(data: Run, command: str) -> None:
    code, out, _ = data(command, "--help")
    assert code == 0
    assert re.search(rf"Examples?:\n\s+hystbench data {command}", out)


# ---- export --------------------------------------------------------------------------------------------------------


def test_an_exported_dataset_reads_back_as_it_was(data: Run, tmp_path: Path) -> None:
    code, out, _ = data("export", "vsa-physical", "--out", str(tmp_path / "out"))
    assert code == 0
    package = json.loads(Path(out.strip()).read_text(encoding="utf-8"))
    wanted = get("vsa-physical")().load()
    recordings = [("train", r) for r in wanted.train] + [("test", r) for r in wanted.test]
    assert len(package["resources"]) == len(recordings) == len(list((tmp_path / "out").glob("*.csv")))
    for resource, (part, recording) in zip(package["resources"], recordings, strict=True):
        path = tmp_path / "out" / resource["path"]
        assert (resource["part"], resource["title"], resource["warm_up_rows"]) == (
            part,
            recording.name,
            recording.warm_up,
        )
        assert resource["bytes"] == path.stat().st_size
        assert resource["hash"] == "sha256:" + hashlib.sha256(path.read_bytes()).hexdigest()
        assert list(pd.read_csv(path)) == [field["name"] for field in resource["schema"]["fields"]]
        # The default column names: no option is needed to read the export of an angle and a torque.
        found = read_recording(path)
        for name in ("time", "x", "y"):
            assert np.array_equal(getattr(found, name), getattr(recording, name))


def test_the_same_dataset_gives_the_same_bytes(data: Run, tmp_path: Path) -> None:
    written = []
    for name in ("one", "two"):
        assert data("export", "vsa-published", "--out", str(tmp_path / name))[0] == 0
        written.append({path.name: path.read_bytes() for path in (tmp_path / name).iterdir()})
    assert written[0] == written[1]
    assert "datapackage.json" in written[0]


@pytest.mark.parametrize("name", ["vsa-published", "vsa-minor-loops", "vsa-physical"])
def test_packages_follow_the_standard(tmp_path: Path, name: str) -> None:
    path = write_datapackage(get(name)().load(), tmp_path)
    report = frictionless.validate(str(path))
    assert report.valid, report.flatten(["type", "message"])
    # Sizes and checksums are part of what was validated.
    damaged = next(tmp_path.glob("*.csv"))
    damaged.write_text(damaged.read_text().replace("1", "2", 1))
    assert not frictionless.validate(str(path)).valid


# ---- the catalogue as a package --------------------------------------------------------------------------------------


def test_the_catalogues_package_follows_the_standard_and_names_every_file(data: Run) -> None:
    code, out, _ = data("list", "--datapackage")
    assert code == 0
    package = json.loads(out)
    report = frictionless.Package.validate_descriptor(package)
    assert report.valid, report.flatten(["type", "message"])
    published = [(found.id, file) for found in catalogue.catalogue().values() for file in found.files]
    assert len(package["resources"]) == len(published) > 50
    assert len({resource["name"] for resource in package["resources"]}) == len(published)
    for resource, (name, file) in zip(package["resources"], published, strict=True):
        assert resource["dataset"] == name
        assert (resource["bytes"], resource["hash"]) == (file.bytes, f"sha256:{file.sha256}")
        address = urllib.parse.urlsplit(resource["path"])
        assert address.hostname == "raw.githubusercontent.com"
        assert urllib.parse.unquote(address.path) == f"/{file.place}"
        assert " " not in resource["path"]


def test_a_broken_package_would_be_noticed() -> None:
    for broken in ({"name": "no path"}, {"name": "no text", "path": 3}):
        package = catalogue_package()
        package["resources"][0] = broken
        assert not frictionless.Package.validate_descriptor(package).valid


def test_the_committed_package_is_the_catalogues() -> None:
    text = files("hystbench.datasets").joinpath("datapackage.json").read_text(encoding="utf-8")
    # Made by `hystbench data list --datapackage > datasets/datapackage.json`.
    assert json.loads(text) == catalogue_package()


def small(**changes: object) -> Dataset:
    time = np.arange(4.0)
    one = Recording("only", time, time, time, channels={"pressure_bar": time + 1.0}, conditions={"current": "1 A"})
    data = Dataset(
        id="small", title="small", train=[one], test=[one], split="none", x_name="displacement", x_unit="mm",
        y_name="force", y_unit="kN/m", source="a thesis", licence="MIT", x_sigma=0.0, y_sigma=0.0,
    )  # fmt: skip
    return replace(data, **changes)  # type: ignore[arg-type]


def test_units_channels_and_conditions_are_told(tmp_path: Path) -> None:
    package = json.loads(write_datapackage(small(), tmp_path).read_text(encoding="utf-8"))
    resource = package["resources"][0]
    assert [(field["name"], field.get("unit")) for field in resource["schema"]["fields"]] == [
        ("time_s", "s"), ("displacement_mm", "mm"), ("force_kn_per_m", "kN/m"), ("pressure_bar", None),
    ]  # fmt: skip
    assert resource["conditions"] == {"current": "1 A"}
    assert list(pd.read_csv(tmp_path / resource["path"])["pressure_bar"]) == [1.0, 2.0, 3.0, 4.0]


@pytest.mark.parametrize(
    ("told", "name"),
    [
        ("MIT", "MIT"),
        ("CC-BY-SA-4.0", "CC-BY-SA-4.0"),
        ("facts from the paper; generated data CC0-1.0", "CC0-1.0"),
        ("Apache-2.0.", "Apache-2.0"),
        ("only for LIMITED use, ask Ann", "only-for-LIMITED-use-ask-Ann"),
    ],
)
def test_every_licence_has_a_name(tmp_path: Path, told: str, name: str) -> None:
    package = json.loads(write_datapackage(small(licence=told), tmp_path).read_text(encoding="utf-8"))
    assert package["licenses"] == [{"name": name, "title": told}]


def test_recorded_datasets_name_their_repositories(tmp_path: Path) -> None:
    package = json.loads(write_datapackage(small(id="steel-coupons"), tmp_path).read_text(encoding="utf-8"))
    assert [source["path"] for source in package["sources"]] == catalogue.entry("steel-coupons").urls
    assert len(package["sources"]) == 2


def test_exports_that_cannot_be(data: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "file"
    file.write_text("kept")
    assert data("export", "vsa-published", "--out", str(file))[0] == 2
    assert file.read_text() == "kept"
    assert data("export", "vsa-publshed", "--out", str(tmp_path / "out"))[0] == 2
    monkeypatch.setenv("HYSTBENCH_DATA", str(tmp_path / "nothing"))
    code, _, err = data("export", "mr-damper", "--out", str(tmp_path / "out"))
    assert code == 2
    assert "hystbench data fetch mr-damper" in err
    clash = replace(small().train[0], channels={"displacement_mm": np.zeros(4)})
    with pytest.raises(InputError, match="displacement_mm"):
        write_datapackage(small(train=[clash]), tmp_path / "out")
