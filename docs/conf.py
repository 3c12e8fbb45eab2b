# SPDX-License-Identifier: BSD-3-Clause
"""How the documentation is built: python -m sphinx -W --keep-going -b html docs docs/_build/html."""

import sys
from pathlib import Path

import matplotlib

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parent), str(HERE / "_extensions")]
# pictures of the gallery are drawn without a screen
matplotlib.use("agg")

import sklvalve  # noqa: E402

project = "sklvalve"
author = "the sklvalve developers"
project_copyright = author
version = release = sklvalve.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "numpydoc",
    "sphinx_gallery.gen_gallery",
    "sphinx_copybutton",
    "constants",
    "gallery_links",
    "mathml",
]
exclude_patterns = ["_build", "_extensions", "_templates", "examples"]
templates_path = ["_templates"]
# in docstrings `name` is a link where there is such a thing, and code where there is not
default_role = "py:obj"

# the pages are read as plain Markdown as well: links to headings as a forge makes them
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4

autosummary_generate = True
autodoc_member_order = "bysource"
autodoc_typehints = "none"
toc_object_entries_show_parents = "hide"
numpydoc_show_class_members = False

html_theme = "furo"
html_title = f"sklvalve {release}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#0b5c8a", "color-brand-content": "#0b5c8a"},
    "dark_css_variables": {"color-brand-primary": "#6cb8e6", "color-brand-content": "#6cb8e6"},
}
pygments_style = "friendly"
pygments_dark_style = "github-dark"

copybutton_prompt_text = r">>> |\.\.\. "
copybutton_prompt_is_regexp = True

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "auto_examples",
    "backreferences_dir": "generated/backreferences",
    "doc_module": ("sklvalve",),
    "within_subsection_order": "FileNameSortKey",
    "abort_on_example_error": True,
    # the plain form of an object holds its address, another one at each build
    "capture_repr": ("_repr_html_",),
    "min_reported_time": 1,
    "download_all_examples": False,
    "write_computation_times": False,
    "show_signature": False,
    "remove_config_comments": True,
}
