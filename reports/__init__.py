"""The HTML report of a run: one self-contained file.

>>> from hystbench.reports import render  # doctest: +SKIP
>>> render("hystbench-report")  # doctest: +SKIP
"""

from .export import export, figure
from .page import render

__all__ = ["export", "figure", "render"]
