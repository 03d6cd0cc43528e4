"""Settings of the documentation site: Markdown by MyST, the reference from docstrings without importing."""

from __future__ import annotations

import ast
import html
from pathlib import Path
from typing import Any

from docutils import nodes

ROOT = Path(__file__).resolve().parent.parent
project = "navsym"
author = "navsym contributors"
html_title = "navsym"
extensions = ["myst_parser"]
myst_enable_extensions = ["dollarmath", "deflist"]
html_theme = "furo"
html_math_renderer = "source"            # pages ask no network for anything: formulas stay as LaTeX source
exclude_patterns = ["_build"]
suppress_warnings: list[str] = []

ROOMS = {
    "claims": "Statements, verdicts, claims and papers",
    "text": "Everything that comes from outside",
    "models": "Models, as symbols",
    "numeric": "Arrays and compiled loops",
    "proof": "What decides statements",
    "methods": "What a user asks for",
    "report": "Pages and errata",
    "export": "Code with certificates",
}


def public_parts(path: Path) -> list[str]:
    """Signature and docstring of every documented function and class of a file, as Markdown."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    dotted = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    head = (ast.get_docstring(tree) or "").splitlines()
    lines = [f"## {dotted}", "", head[0] if head else "", ""]
    for node in tree.body:
        if not isinstance(node, ast.FunctionDef | ast.ClassDef) or node.name.startswith("_"):
            continue
        if doc := ast.get_docstring(node):
            lines += [f"### {node.name}", "", "````text", signature(node), "", *doc.splitlines(), "````", ""]
    return lines


def signature(node: ast.FunctionDef | ast.ClassDef) -> str:
    if isinstance(node, ast.ClassDef):
        return f"class {node.name}"
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return f"{node.name}({ast.unparse(node.args)}){returns}"


def write_reference(folder: Path) -> None:
    """One page for each room of the package."""
    folder.mkdir(exist_ok=True)
    for room, title in ROOMS.items():
        lines = [f"# {room}: {title.lower()}", ""]
        for path in sorted((ROOT / "navsym" / room).glob("*.py")):
            lines += public_parts(path)
        text = "\n".join(lines) + "\n"
        target = folder / f"{room}.md"
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def inline_formula(writer: Any, node: Any) -> None:
    writer.body.append(f'<code class="math">{html.escape(node.astext())}</code>')
    raise nodes.SkipNode


def displayed_formula(writer: Any, node: Any) -> None:
    writer.body.append(f'<pre class="math">{html.escape(node.astext())}</pre>')
    raise nodes.SkipNode


def setup(app: Any) -> None:
    """The reference is written before the sources are read; formulas are shown without a script."""
    app.add_html_math_renderer("source", (inline_formula, None), (displayed_formula, None))
    app.connect("builder-inited", lambda app: write_reference(Path(app.srcdir) / "reference"))
