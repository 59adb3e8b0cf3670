"""How pages are rendered: names and messages of plug-ins and files are escaped, and nothing may be left undefined."""

from __future__ import annotations

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined, Template

__all__ = ["environment", "template"]


def environment(*packages: str) -> Environment:
    """The templates of these packages' folders ``templates``, in this order, and then of ``hystbench.reports``."""
    return Environment(
        loader=ChoiceLoader([PackageLoader(package) for package in (*packages, "hystbench.reports")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def template(name: str, *packages: str) -> Template:
    """One of the templates that :func:`environment` finds."""
    return environment(*packages).get_template(name)
