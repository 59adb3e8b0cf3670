"""BibTeX of the models that were used."""

from __future__ import annotations

import re

import pytest

from hystbench import models


def test_each_source_is_named_once() -> None:
    text = models.citation("maxwell-slip", "cubic", "bouc-wen")
    assert re.findall(r"@\w+\{([^,]+),", text) == ["qin-maxwell-slip-vsa", "wen1976"]
    assert text.count("{") == text.count("}")


def test_every_published_model_has_a_source() -> None:
    six = ["maxwell-slip", "cubic", "bouc-wen", "preisach", "prandtl-ishlinskii", "choi-backlash"]
    for name in six:
        assert "author = " in models.citation(name)
    assert set(re.findall(r"@\w+\{([^,]+),", models.citation())) >= {"mayergoyz1991", "choi2017", "krejci-kuhnen2001"}


def test_a_plugin_may_carry_its_own_entry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(models.get("cubic"), "references", ("@misc{mine, title = {Mine}}", "wen1976"))
    assert models.citation("cubic").startswith("@misc{mine,")
    assert "wen1976" in models.citation("cubic")
    with pytest.raises(models.UnknownModelError):
        models.citation("cubist")
