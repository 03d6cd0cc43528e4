"""Settings of the documentation site: Markdown and notebooks by MyST, the reference from docstrings without importing.

Notebooks are shown as they stand; ``NAVSYM_DOCS_EXECUTE=1`` runs them and shows what they show (some minutes).
"""

from __future__ import annotations

import html
import os
import re
import sys
from pathlib import Path
from typing import Any

from docutils import nodes

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "docs")]
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))  # of the kernels
project = "navsym"
author = "navsym contributors"
html_title = "navsym"
extensions = ["myst_nb"]
myst_enable_extensions = ["dollarmath", "deflist"]
html_theme = "furo"
html_theme_options = {"top_of_page_buttons": []}
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_math_renderer = "mathml"  # pages ask no network for anything
exclude_patterns = ["_build"]
nb_execution_mode = "force" if os.environ.get("NAVSYM_DOCS_EXECUTE") else "off"
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_render_text_lexer = "text"
nb_ipywidgets_js: dict[str, Any] = {}  # sliders live in the notebook itself; the page asks no network
suppress_warnings: list[str] = []


def write_notebooks(folder: Path) -> None:
    """The notebooks of the project as pages; a page is only written when it has changed."""
    import jupytext

    folder.mkdir(exist_ok=True)
    for path in sorted((ROOT / "notebooks").glob("*.py")):
        target = folder / f"{path.stem}.ipynb"
        if not target.exists() or target.stat().st_mtime < path.stat().st_mtime:
            jupytext.write(jupytext.read(path), target)


def formula(source: str, display: bool) -> str:
    """MathML of a formula; what the small converter does not know stays as its source."""
    from navsym.core.errors import NavsymError
    from navsym.report.formula.latex import mathml

    try:
        return str(mathml(source.strip(), display=display))
    except NavsymError:
        return f"<code>{html.escape(source.strip())}</code>"


def inline_formula(writer: Any, node: Any) -> None:
    writer.body.append(f'<span class="math">{formula(node.astext(), False)}</span>')
    raise nodes.SkipNode


def displayed_formula(writer: Any, node: Any) -> None:
    writer.body.append(f'<p class="math" style="overflow-x:auto">{formula(node.astext(), True)}</p>')
    raise nodes.SkipNode


#: What the theme writes -> the same for the keyboard and for screen readers: levels of captions, scrolling parts.
ACCESSIBLE = {
    'role="heading">': 'role="heading" aria-level="2">',
    "<pre": '<pre tabindex="0"',
    '<div class="table-wrapper': '<div tabindex="0" class="table-wrapper',
    '<div style="border-left': '<div tabindex="0" style="border-left',
}
#: The same for what stands outside the body of a page: parts of one kind are told apart by a name.
LANDMARKS = {
    '<aside class="sidebar-drawer">': '<aside class="sidebar-drawer" aria-label="Site">',
    '<aside class="toc-drawer">': '<aside class="toc-drawer" aria-label="Contents of this page">',
}


def finished(app: Any, pagename: str, templatename: str, context: dict[str, Any], doctree: Any) -> None:
    """The page as it leaves: for the keyboard too, and with the formulas that a notebook sets in type by a script."""
    for part in {"body", "furo_navigation_tree"} & set(context):
        for written, better in ACCESSIBLE.items():
            context[part] = context[part].replace(written, better)
    if pagename.startswith("notebooks/") and "body" in context:
        found = re.compile(r"\$\\displaystyle (.+?)\$", re.S)
        context["body"] = found.sub(lambda match: formula(html.unescape(match[1]), True), context["body"])


def name_landmarks(app: Any, failure: Exception | None) -> None:
    """Names of landmarks in the pages as they were written; the theme's own template has none."""
    for path in Path(app.outdir).rglob("*.html") if failure is None else ():
        text = better = path.read_text(encoding="utf-8")
        for written, named in LANDMARKS.items():
            better = better.replace(written, named)
        if better != text:
            path.write_text(better, encoding="utf-8")


def generate(app: Any) -> None:
    from reference_pages import write_reference

    write_reference(Path(app.srcdir) / "reference")
    write_notebooks(Path(app.srcdir) / "notebooks")


def setup(app: Any) -> None:
    """Reference and notebooks are written before the sources are read; formulas are shown without a script."""
    app.add_html_math_renderer("mathml", (inline_formula, None), (displayed_formula, None))
    app.connect("builder-inited", generate)
    app.connect("html-page-context", finished, priority=900)  # behind the theme, which makes the navigation
    app.connect("build-finished", name_landmarks)
