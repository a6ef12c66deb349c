"""Settings of the documentation site; ``docs/build.py`` prepares the pages and runs Sphinx with them."""

import os
import sys
import warnings
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]

import matplotlib
from docstrings import as_rst
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

import stickslip

matplotlib.use("agg")
pages = Path(os.environ["STICKSLIP_PAGES"])  # the prepared pages, of docs/build.py
galleries = sorted(folder.name for folder in (pages / "scripts").iterdir())

project = "stickslip"
copyright = "the stickslip authors"
version = release = stickslip.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc"] + ["sphinx_gallery.gen_gallery"] * bool(galleries)
exclude_patterns = ["scripts", "**/GALLERY_HEADER.rst", "**/*.md5"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_heading_anchors = 4
myst_enable_extensions = ["colon_fence"]
suppress_warnings = ["config.cache", "misc.highlighting_failure"]
highlight_language = "none"  # commands and reports; what is Python says so

html_theme = "furo"
html_title = f"stickslip {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = html_show_sourcelink = False
html_theme_options = {"navigation_with_keys": True}

autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True, "show-inheritance": False}


def drawn(block: Any, values: dict[str, Any], settings: dict[str, Any]) -> str:
    """Show the figure that the last line of an example gives; a figure of the package belongs to no window."""
    figure = values["example_globals"].get("___")
    if not isinstance(figure, Figure):
        return ""
    values["example_globals"]["___"] = None  # shown once
    path = str(next(values["image_path_iterator"]))
    figure.savefig(path, dpi=100, bbox_inches="tight")
    return str(figure_rst([path], settings["src_dir"]))


sphinx_gallery_conf: dict[str, Any] = {
    "examples_dirs": [f"scripts/{name}" for name in galleries],
    "gallery_dirs": galleries,
    "filename_pattern": r"\.py$",
    "abort_on_example_error": True,
    "capture_repr": (),
    "image_scrapers": (drawn,),
    "matplotlib_animations": False,
    "remove_config_comments": True,
    "show_memory": False,
    "write_computation_times": False,
    "min_reported_time": 1e9,
    "show_signature": False,
    "thumbnail_size": (320, 224),
    "within_subsection_order": "FileNameSortKey",
    "default_thumb_file": str(pages / "images" / "loop.png"),
}


def _plain(app: Any, what: str, name: str, it: Any, options: Any, lines: list[str]) -> None:
    lines[:] = as_rst(lines)


def setup(app: Any) -> None:
    """Let docstrings be read as they are written."""
    warnings.filterwarnings("ignore", category=UserWarning, message=".*non-interactive.*")
    app.connect("autodoc-process-docstring", _plain)
