"""The manual: `sphinx-build -W docs docs/_build`."""

import sys
from importlib.metadata import version as installed
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "extension"), str(HERE.parent / "scripts")]

project = "meshdepict"
author = "The meshdepict developers"
version = release = installed("meshdepict")
html_title = f"meshdepict {release}"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "numpydoc",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
    "before_after",
    "mathml",
    "licence_table",
    "method_pages",
    "start_pictures",
    "reference_pages",
]
exclude_patterns = [
    "_build",
    "accuracy_predictions.md",
    "extension",
    "methods/index.in.md",
    "examples",
    "gallery/*.py",
    "**/*.ipynb",
]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
nitpicky = False

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_typehints = "none"
autodoc_member_order = "bysource"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

sphinx_gallery_conf = {
    "examples_dirs": ["examples"],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"[/\\]\d",
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "min_reported_time": 5,
    "matplotlib_animations": False,
}

html_theme = "pydata_sphinx_theme"
html_static_path = ["static"]
html_css_files = ["manual.css"]
html_js_files = ["before_after.js"]
html_show_sourcelink = False
html_favicon = "static/favicon.svg"
html_context = {"default_mode": "auto"}
html_theme_options = {
    "show_prev_next": True,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "header_links_before_dropdown": 6,
    "show_toc_level": 2,
}
