"""The two source papers, regenerated and audited: ``hystbench paper``.

>>> from pathlib import Path
>>> from hystbench.reports.paper import write_paper
>>> write_paper(Path("hystbench-paper"))  # doctest: +SKIP
"""

from .build import collect, write, write_paper
from .expectation import compare_with_expectation, expectation, read_expectation
from .results import Results

__all__ = ["Results", "collect", "compare_with_expectation", "expectation", "read_expectation", "write", "write_paper"]
