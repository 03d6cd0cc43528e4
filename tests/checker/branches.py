"""Lines and branches of the checker that its certificates do not reach: ``python tests/checker/branches.py``.

A branch is a pair of lines inside one function that the source allows to follow each other; what the trace
never saw is printed. Without the package coverage, which is not needed for this.
"""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from types import FrameType
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
SOURCE = ROOT / "navsym" / "checker.py"


def decisions(source: str) -> dict[tuple[int, str], set[int]]:
    """(line of a statement that decides, its kind) -> lines on which it may go on."""
    found: dict[tuple[int, str], set[int]] = {}
    for body in (getattr(node, "body", None) for node in ast.walk(ast.parse(source))):
        if not isinstance(body, list):
            continue
        for place, node in enumerate(body):
            after = body[place + 1].lineno if place + 1 < len(body) else 0
            if isinstance(node, ast.If | ast.While | ast.For):
                other = node.orelse[0].lineno if node.orelse else after
                always = isinstance(node, ast.While) and isinstance(node.test, ast.Constant)
                targets = {node.body[0].lineno, *({other} if other and not always else ())}
                found[node.lineno, type(node).__name__] = targets
            if isinstance(node, ast.Match):
                found |= {(case.pattern.lineno, "case"): {case.body[0].lineno} for case in node.cases}
    return found


def lines_of(source: str) -> set[int]:
    """First lines of the statements inside functions."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef):
            for inner in ast.walk(node):
                if isinstance(inner, ast.stmt) and inner is not node and not is_words(inner):
                    found.add(inner.lineno)
    return found


def is_words(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def traced() -> tuple[set[int], set[tuple[int, int]]]:
    """Lines, and pairs of lines that followed each other in one call, while the certificates are judged."""
    from navsym import checker
    from tests.checker.forgeries import discrepancies

    seen: set[int] = set()
    pairs: set[tuple[int, int]] = set()

    def local(frame: FrameType, event: str, _: Any, last: dict[str, int]) -> Any:
        if event == "line":
            seen.add(frame.f_lineno)
            pairs.add((last.get("line", 0), frame.f_lineno))
            last["line"] = frame.f_lineno
        return lambda f, e, a: local(f, e, a, last)

    def enter(frame: FrameType, event: str, argument: Any) -> Any:
        return local(frame, event, argument, {}) if frame.f_code.co_filename == checker.__file__ else None

    sys.settrace(enter)
    try:
        wrong = list(discrepancies(checker))
    finally:
        sys.settrace(None)
    assert not wrong, wrong
    return seen, pairs


def unreached() -> list[str]:
    source = SOURCE.read_text(encoding="utf-8")
    seen, pairs = traced()
    missing = [f"line {line}" for line in sorted(lines_of(source) - seen)]
    text = source.splitlines()
    for (line, kind), targets in sorted(decisions(source).items()):
        after = {b for a, b in pairs if a == line}
        missing += [f"branch {line} ({kind}) to {t}: {text[line - 1].strip()}" for t in sorted(targets - after)]
    return missing


if __name__ == "__main__":
    found = unreached()
    print("\n".join(found) or "every line and every branch is reached")
    sys.exit(bool(found))
