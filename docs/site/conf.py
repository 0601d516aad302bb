"""Sphinx: how the site looks, and how docstrings become pages. `make docs` builds it."""

import re
from importlib.metadata import version as version_of
from typing import Any

project = "manyhands"
author = "the authors of manyhands"
copyright = "MIT licence"
version = release = version_of("manyhands")

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx_design", "sphinx_copybutton"]
# `type` and `Model` are several things; a signature that cannot tell which goes without a link.
suppress_warnings = ["ref.python"]
myst_enable_extensions = ["colon_fence", "deflist", "attrs_inline"]
myst_heading_anchors = 4
exclude_patterns = ["**/README.md"]
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 90
add_module_names = False
default_role = "code"
toc_object_entries = False
toc_object_entries_show_parents = "hide"

html_title = "manyhands"
html_theme = "pydata_sphinx_theme"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_favicon = html_logo = "static/logo.svg"
html_show_sourcelink = False
html_copy_source = False
html_sidebars = {"index": []}
html_theme_options = {
    "logo": {"text": "manyhands"},
    "navbar_align": "left",
    "navigation_depth": 3,
    "show_nav_level": 1,
    "show_toc_level": 2,
    "show_prev_next": True,
    "header_links_before_dropdown": 6,
    "footer_start": ["copyright"],
    "footer_end": ["sphinx-version"],
    "pygments_light_style": "a11y-light",
    "pygments_dark_style": "github-dark",
}
copybutton_exclude = ".linenos, .gp, .go"


def as_restructured_text(line: str) -> str:
    """A line of a docstring: `code` is code, and all other signs are meant as they stand."""
    pieces = re.split(r"(`+[^`]*`+)", line)
    for k, piece in enumerate(pieces):
        pieces[k] = f"``{piece.strip('`')}``" if piece.startswith("`") else re.sub(r"([*|_\\])", r"\\\1", piece)
    return "".join(pieces)


def process_docstring(app: Any, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Docstrings are plain text: paragraphs, lists, fenced code, blocks that are indented. A getter's type is not a
    sentence."""
    del app, what, name, obj, options
    out: list[str] = []
    fenced = False
    for line in lines:
        if re.match(r"\(self\) -> |Alias for field number", line):
            continue
        if line.startswith("```"):
            fenced = not fenced
            out += ["", f".. code-block:: {line.strip('`') or 'text'}", ""] if fenced else [""]
        elif fenced:
            out.append(f"   {line}")
        else:
            out += plain_line(line, out[-1] if out else "")
    lines[:] = out


def plain_line(line: str, before: str) -> list[str]:
    """A line of words, with the empty lines that lists and indented blocks need around them."""
    bullet = re.match(r"\s*[-*] ", line)
    if bullet:
        gap = [] if not before or re.match(r"\s*[-*] |  ", before) else [""]
        return [*gap, bullet[0] + as_restructured_text(line.removeprefix(bullet[0]))]
    is_indented, was_indented = line.startswith("  "), before.startswith(("  ", "- ", "* "))
    if line and before and is_indented != was_indented:
        return ["", as_restructured_text(line)]
    return [as_restructured_text(line)]


def process_signature(
    app: Any, what: str, name: str, obj: Any, options: Any, signature: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """Names of the public modules, not of those that they are defined in."""
    del app, what, name, obj, options

    def shorter(text: str | None) -> str | None:
        if text is None:
            return None
        text = re.sub(r"\bmanyhands\._core\.(?:[a-z_]+\.)*", "manyhands.", text)
        text = re.sub(r"\bnumpy\.typing\.|\bcollections\.abc\.|\btyping\.", "", text)
        return re.sub(r"\b(os|pathlib)\.(?=Path)", "", text)

    return shorter(signature), shorter(returns)


def setup(app: Any) -> None:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", process_docstring)
    app.connect("autodoc-process-signature", process_signature)
