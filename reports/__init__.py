"""The HTML report of a run: one self-contained file.

>>> from hystbench.reports import render  # doctest: +SKIP
>>> render("hystbench-report")  # doctest: +SKIP
"""

from .page import render

__all__ = ["render"]
