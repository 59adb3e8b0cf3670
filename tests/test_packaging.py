"""The package as its users get it: every folder is in the wheel, every entry point loads, the version is one."""

from __future__ import annotations

import re
import tomllib
from importlib.metadata import entry_points, version
from pathlib import Path

import pytest

from sample_site import ROOT, hystbench, install_wheel

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return install_wheel(ROOT, tmp_path_factory.mktemp("wheel"))


def test_every_folder_with_python_files_is_listed() -> None:
    folders = {
        "hystbench." + ".".join(path.parent.relative_to(ROOT).parts)
        for path in ROOT.rglob("__init__.py")
        if path.parent != ROOT and not {"tests", "build", "docs"} & set(path.relative_to(ROOT).parts)
        and not any(part.startswith(".") for part in path.relative_to(ROOT).parts)
    }  # fmt: skip
    assert folders == set(PROJECT["tool"]["setuptools"]["packages"])


def test_every_module_at_the_top_is_listed() -> None:
    modules = {f"hystbench.{path.stem}" for path in ROOT.glob("*.py")} - {"hystbench.noxfile"}
    assert modules == set(PROJECT["tool"]["setuptools"]["py-modules"])


def test_the_wheel_works_in_an_empty_place(site: Path, tmp_path: Path) -> None:
    packed = {str(p.relative_to(site)) for p in site.rglob("*") if p.is_file()}
    assert "hystbench/models/py.typed" in packed
    assert "hystbench/datasets/catalogue.json" in packed
    assert {f"hystbench/reports/templates/{p.name}" for p in (ROOT / "reports" / "templates").glob("*.j2")} <= packed
    assert not any(name.startswith(("tests/", "hystbench/tests", "hystbench/noxfile")) for name in packed)
    arguments = ("run", "--quick", "--models", "cubic", "--datasets", "vsa-published", "--out", "out")
    done = hystbench(*arguments, cwd=tmp_path, site=site)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "report.html").stat().st_size > 10_000


@pytest.mark.parametrize("group", ["hystbench.models", "hystbench.datasets", "hystbench.effects"])
def test_every_entry_point_loads_what_carries_its_id(group: str) -> None:
    mine = PROJECT["project"]["entry-points"][group]
    found = {point.name: point for point in entry_points(group=group) if point.value.startswith("hystbench.")}
    assert found.keys() == mine.keys()
    for name, point in found.items():
        assert point.load().id == name


def test_versions_agree() -> None:
    import hystbench

    declared = PROJECT["project"]["version"]
    assert hystbench.__version__ == version("hystbench") == declared
    assert f"version: {declared}" in (ROOT / "CITATION.cff").read_text()
    assert f"## {declared}" in (ROOT / "CHANGELOG.md").read_text()


def test_every_dependency_is_justified() -> None:
    table = (ROOT / "CONTRIBUTING.md").read_text()
    for requirement in PROJECT["project"]["dependencies"]:
        name = re.match(r"[\w-]+", requirement)[0]
        assert f"| {name} |" in table


def test_the_first_fenced_block_of_quick_start_holds_two_commands() -> None:
    text = (ROOT / "README.md").read_text().split("## Quick start")[1]
    block = re.search(r"```\w*\n(.*?)```", text, re.DOTALL)[1]
    assert len(block.strip().splitlines()) == 2
    first = re.search(r"```\w*\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)[1]
    assert first == block
