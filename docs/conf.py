"""Sphinx configuration: pages of the registries are written from the code, each example is run."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from registry_pages import write_pages  # noqa: E402

from hystbench import __version__  # noqa: E402

project = "hystbench"
author = "The hystbench developers"
release = version = __version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_gallery.gen_gallery",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_enable_extensions = ["dollarmath", "colon_fence"]
exclude_patterns = ["_build", "examples/README.rst", "sg_execution_times.rst"]
html_theme = "furo"
html_title = f"hystbench {release}"
autodoc_typehints = "none"
autodoc_member_order = "bysource"
nitpicky = False
sphinx_gallery_conf = {
    "examples_dirs": str(HERE / "examples"),
    "gallery_dirs": "gallery",
    "filename_pattern": r"plot_",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "min_reported_time": 10_000,
}
# A page that names a pickled or unpicklable setting would otherwise warn, and warnings are errors here.
# The tour is a part of the README, whose headings begin lower.
suppress_warnings = ["config.cache", "myst.header"]

write_pages(HERE / "registry")
