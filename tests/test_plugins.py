"""The registry of plug-ins: found by entry point, broken ones named and skipped, ids taken once."""

from __future__ import annotations

import warnings
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any

import pytest

from hystbench import models, plugins
from hystbench.errors import InputError
from hystbench.plugins import BrokenPluginWarning, Registry, UnknownPluginError

GROUP = "hystbench.tests"


def registry(monkeypatch: pytest.MonkeyPatch, points: dict[str, str], required: tuple[str, ...] = ()) -> Registry[Any]:
    found = [EntryPoint(name, value, GROUP) for name, value in points.items()]
    monkeypatch.setattr(plugins, "entry_points", lambda group: found if group == GROUP else [])
    return Registry(GROUP, "model", required=required)


def test_unknown_ids_list_the_known_ones_and_name_the_nearest() -> None:
    with pytest.raises(models.UnknownModelError) as caught:
        models.get("bouc_wenn")
    told = str(caught.value)
    assert told.startswith("unknown model 'bouc_wenn'; did you mean 'bouc-wen'?")
    for name in models.ids():
        assert name in told
    assert "\n" not in told
    # Callers may treat it as bad input, as a missing key or as a bad value.
    for kind in (InputError, KeyError, ValueError, UnknownPluginError):
        assert isinstance(caught.value, kind)


def test_an_empty_registry_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(UnknownPluginError, match=r"^unknown model 'any' Known: none\.$"):
        registry(monkeypatch, {}).get("any")


def test_plugins_load_once_when_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    found = registry(monkeypatch, {"path": "pathlib:Path", "never": "no_such_module_at_all:Thing"})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert found.get("path") is Path
        assert found.get("path") is Path
    assert found.broken == {}


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ("no_such_module_at_all:Thing", "ModuleNotFoundError: No module named 'no_such_module_at_all'"),
        ("pathlib:NoSuchName", "AttributeError"),
        ("this:s", "it lacks fit, predict"),
    ],
)
def test_a_broken_plugin_is_named_once_and_skipped(monkeypatch: pytest.MonkeyPatch, value: str, reason: str) -> None:
    good = "hystbench.models.cubic:Cubic"
    found = registry(monkeypatch, {"bad": value, "good": good}, required=("fit", "predict"))
    with pytest.warns(BrokenPluginWarning) as told:
        assert found.ids() == ["good"]
    assert len(told) == 1
    assert f"model plug-in bad ({value}) skipped: " in str(told[0].message)
    assert reason in str(told[0].message)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert found.ids() == ["good"]
        with pytest.raises(InputError, match=r"model 'bad' cannot be loaded.*repair or uninstall it"):
            found.get("bad")


def test_a_plugin_that_exits_on_import_does_not_end_the_program(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "exits_on_import.py").write_text("raise SystemExit(3)\n")
    monkeypatch.syspath_prepend(tmp_path)
    found = registry(monkeypatch, {"exits": "exits_on_import:Model"})
    with pytest.warns(BrokenPluginWarning, match="SystemExit: 3"):
        assert found.ids() == []


def test_a_taken_id_stays_with_its_owner(monkeypatch: pytest.MonkeyPatch) -> None:
    points = [
        EntryPoint("cubic", "pathlib:Path", GROUP),
        EntryPoint("cubic", "hystbench.models.cubic:Cubic", GROUP),
        EntryPoint("mine", "pathlib:PurePath", GROUP),
        EntryPoint("mine", "pathlib:Path", GROUP),
        # One package seen twice (an editable install and a wheel) is no conflict.
        EntryPoint("mine", "pathlib:PurePath", GROUP),
    ]
    monkeypatch.setattr(plugins, "entry_points", lambda group: points)
    found: Registry[Any] = Registry(GROUP, "model")
    with pytest.warns(BrokenPluginWarning) as told:
        assert found.ids() == ["cubic", "mine"]
    # The built-in one wins whatever the order; of two others the first.
    assert found.get("cubic") is models.get("cubic")
    assert found.get("mine").__name__ == "PurePath"
    messages = [str(one.message) for one in told]
    assert len(messages) == 2
    assert any("cubic (pathlib:Path) skipped: the id is taken by hystbench.models.cubic:Cubic" in m for m in messages)
    assert any("mine (pathlib:Path) skipped: the id is taken by pathlib:PurePath" in m for m in messages)
