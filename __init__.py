"""hystbench: benchmark, identification and reports for hysteresis models.

Rooms: :mod:`hystbench.models` (the plug-in registry of models), :mod:`hystbench.datasets` (synthetic and recorded
loops), :mod:`hystbench.bench` (command line, runs, metrics, timing), :mod:`hystbench.reports` (the HTML report) and
:mod:`hystbench.diagnosis` (effects that explain a sim-to-real gap).
"""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("hystbench")
except PackageNotFoundError:  # a source tree on sys.path that was never installed
    __version__ = "0+unknown"

__all__ = ["__version__"]
