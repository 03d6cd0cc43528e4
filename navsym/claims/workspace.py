"""A workspace: any folder with ``navsym.toml``, which lists the claims, models, audits and papers of its owner.

Inside it, or below, every verb knows what is listed; ledger, cache and pages are kept there and nowhere else.
"""

from __future__ import annotations

import contextlib
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from navsym.core.answers import Answer
from navsym.core.errors import (
    DomainError,
    DuplicateError,
    EmptyError,
    ExpressionSyntaxError,
    NavsymError,
    OutputError,
    ShapeError,
)
from navsym.core.store import default_path
from navsym.language.files import write_text
from navsym.language.names import expect_keys, join_place, quote, require_path
from navsym.language.tomlfile import read_toml

FILE = "navsym.toml"
#: What a workspace lists, and how the names of these files end.
ENDINGS = {"claims": ".toml", "models": ".toml", "audits": ".toml", "papers": ".py"}
SCHEMAS = Path(__file__).parent.parent / "schemas"
#: The examples of the documentation: in the wheel, and in a checkout.
EXAMPLES = (SCHEMAS.parent / "examples", SCHEMAS.parent.parent / "examples")
WILD = re.compile(r"[*?\[]")


@dataclass(frozen=True, slots=True, repr=False)
class Workspace(Answer):
    """The folder of a ``navsym.toml``, and what it lists.

    root     : the folder
    patterns : kind -> patterns of file names, relative to the folder; kinds are claims, models, audits, papers

    >>> import navsym as nav
    >>> workspace = nav.init("my work")
    >>> workspace.list_files("claims"), workspace.list_files("models")
    (['claims/baro.toml'], ['models/alignment.toml'])
    """

    root: Path
    patterns: Mapping[str, tuple[str, ...]]

    def __repr__(self) -> str:
        return f"<workspace {self.root.name}: {', '.join(self.names()) or 'nothing is listed'}>"

    def document(self) -> dict[str, Any]:
        """The JSON document of ``navsym init``."""
        return {"root": str(self.root), "files": {kind: self.list_files(kind) for kind in ENDINGS}}

    @property
    def ledger_file(self) -> Path:
        """The file of its verdicts."""
        return self.root / "ledger.json"

    @property
    def certificates_file(self) -> Path:
        """The file of their certificates."""
        return self.root / "certificates.json"

    @property
    def papers_folder(self) -> Path:
        """Where a new derivation module belongs: the folder of the first pattern."""
        parent = PurePosixPath(next(iter(self.patterns["papers"]), "papers/*.py")).parent
        return self.root / ("papers" if WILD.search(str(parent)) else parent)

    def names(self) -> dict[str, Path]:
        """The name of every listed source -> its file: ``claims/baro.toml``, and the module name of a paper.

        Raises DuplicateError for a file that is listed as two kinds, and for two papers of one name.
        """
        found: dict[str, Path] = {}
        for kind in ENDINGS:
            for file in self.list_files(kind):
                name = PurePosixPath(file).stem if kind == "papers" else file
                if name in found:
                    message = f"expected every name once; got {name} as {kind} and before; list it once"
                    raise DuplicateError(message, where=str(self.root / FILE))
                found[name] = self.root / file
        return found

    def list_files(self, kind: str) -> list[str]:
        """Listed files of a kind, relative to the folder, in the order of the patterns."""
        return list(dict.fromkeys(name for pattern in self.patterns[kind] for name in self.match(pattern)))

    def match(self, pattern: str) -> Iterator[str]:
        """Files of a pattern; raises NavsymError for a name without a file and for one that leads out of the folder."""
        if not WILD.search(pattern) and not (self.root / pattern).is_file():
            message = f"expected a readable file; got nothing at {pattern}; write it, or take it off the list"
            raise NavsymError(message, where=str(self.root / FILE), kind="missing-file")
        for path in sorted(self.root.glob(pattern)):
            inside = path.relative_to(self.root)
            if WILD.search(pattern) and is_private(inside):
                continue
            if not path.is_file() or owner_of(path.parent) != self.root:  # one inside this one has its own list
                continue
            if not path.resolve().is_relative_to(self.root.resolve()):
                message = f"expected files of this folder; got a link to {path.resolve()}; copy the file"
                raise DomainError(message, where=str(path))
            if ":" in inside.as_posix():
                message = f"expected a name without a colon, which ends it in ids; got {inside}; rename the file"
                raise ExpressionSyntaxError(message, where=str(path))
            yield inside.as_posix()


def cache_file() -> Path:
    """The file of what need not be searched twice: in the workspace, in a folder that git leaves out, or the user's."""
    workspace = find_workspace()
    if workspace is None:
        return default_path()
    folder = workspace.root / ".navsym"
    with contextlib.suppress(OSError, OutputError):  # who opens the store says what is wrong
        folder.mkdir(exist_ok=True)
        if not (folder / ".gitignore").exists():
            write_text(folder / ".gitignore", "*\n")
    return folder / "results.sqlite"


def is_private(path: Path) -> bool:
    """True for what a pattern does not mean: the list itself, hidden files, and helpers such as ``_model.py``."""
    return (
        path.name == FILE
        or any(part.startswith(".") for part in path.parts)
        or (path.suffix == ".py" and path.name.startswith("_"))
    )


def find_workspace(start: str | os.PathLike[str] | None = None) -> Workspace | None:
    """The workspace of a folder, by default the current one: the nearest ``navsym.toml`` there or above; else None.

    Raises NavsymError for a ``navsym.toml`` that is none.
    """
    try:
        root = owner_of(Path(start or Path.cwd()).absolute())
    except OSError:  # the current folder is gone
        return None
    return None if root is None else read_workspace(root)


def owner_of(folder: Path) -> Path | None:
    """The nearest folder with a ``navsym.toml``, from this one upwards."""
    return next((place for place in (folder, *folder.parents) if (place / FILE).is_file()), None)


def read_workspace(root: Path) -> Workspace:
    """What the ``navsym.toml`` of a folder lists; raises a NavsymError that names the file and the key."""
    where = str(root / FILE)
    document = read_toml(root / FILE)
    expect_keys(document, ("workspace",), where)
    place = join_place(where, "workspace")
    table = document.get("workspace", {})
    if not isinstance(table, dict):
        raise ShapeError(f"expected a table; got {quote(table)}; write [workspace] and keys below it", where=place)
    expect_keys(table, tuple(ENDINGS), place)
    return Workspace(root, {kind: read_patterns(table.get(kind), kind, join_place(place, kind)) for kind in ENDINGS})


def read_patterns(value: Any, kind: str, where: str) -> tuple[str, ...]:
    """Patterns of one kind; none where the key is missing or the list empty."""
    example = f'["{kind}/*{ENDINGS[kind]}"]'
    if value is None:
        return ()
    if not isinstance(value, list):
        raise ShapeError(f"expected a list of patterns; got {quote(value)}; write {example}", where=where)
    for i, pattern in enumerate(value):
        path, place = PurePosixPath(str(pattern)), join_place(where, i)
        if not isinstance(pattern, str) or not pattern.strip():
            raise EmptyError(f"expected a pattern in quotes; got {quote(pattern)}; write {example}", where=place)
        if path.is_absolute() or ".." in path.parts or "\\" in pattern:
            message = f"expected a pattern inside the workspace; got {pattern}; write it relative to {FILE}, with /"
            raise DomainError(message, where=place)
        if path.suffix != ENDINGS[kind]:
            message = f"expected names of {kind} that end in {ENDINGS[kind]}; got {pattern}; correct it"
            raise DomainError(message, where=place)
    return tuple(value)


def example_files() -> dict[str, str]:
    """The list of a new workspace, and a small example of each kind; the paper is kept as text, which nobody runs."""
    folder = Path(__file__).with_name("example")
    paths = [folder / FILE, *sorted(folder.glob("*/*"))]
    return {path.relative_to(folder).as_posix().removesuffix(".txt"): path.read_text("utf-8") for path in paths}


def editor_files() -> dict[str, str]:
    """JSON schemas of the files, and the list of them in the form in which editors look for it."""
    texts = {f"schemas/{path.name}": path.read_text(encoding="utf-8") for path in sorted(SCHEMAS.glob("*.json"))}
    rules = [('"claims/*.toml", "symbols/*.toml", "**/*.claims.toml"', "claims"), (f'"{FILE}"', "workspace")]
    rules += [(f'"{kind}/*.toml"', kind) for kind in ("models", "audits")]
    blocks = [f'[[rule]]\ninclude = [{files}]\nschema.path = "schemas/{kind}.schema.json"\n' for files, kind in rules]
    return {**texts, ".taplo.toml": "\n".join(blocks)}


def copy_examples(root: Path) -> Workspace:
    """The examples of the documentation in a new folder, which lists nothing."""
    source = next(place for place in EXAMPLES if place.is_dir())
    try:
        shutil.copytree(source, root)
    except FileExistsError:
        message = "expected a folder without examples; got one that is there; choose another or remove it"
        raise DuplicateError(message, where=str(root)) from None
    except OSError as error:
        message = f"expected a folder that can be written; got '{error.strerror}'; choose another"
        raise OutputError(message, where=str(root)) from error
    return Workspace(root, dict.fromkeys(ENDINGS, ()))


def init(folder: str | os.PathLike[str] = ".", *, examples: bool = False) -> Workspace:
    """Make a workspace: ``navsym.toml``, and folders for claims, models, audits and papers with a small example each.

    folder   : made when it is not there; files of other names in it stay
    examples : make no workspace, and copy the examples of the documentation into ``examples`` of the folder

    Raises DuplicateError where a file of the workspace is there already, and OutputError where none can be written.

    >>> import navsym as nav
    >>> nav.init("drive")
    <workspace drive: claims/baro.toml, models/alignment.toml, audits/ekf.toml, pendulum>
    """
    root = require_path(folder, "init: folder").absolute()
    if examples:
        return copy_examples(root / "examples")
    files = {**example_files(), **editor_files()}
    for name in files:
        if os.path.lexists(root / name):
            message = "expected a folder without a workspace; got one with this file; choose another or remove it"
            raise DuplicateError(message, where=str(root / name))
    try:
        for kind in (*ENDINGS, "schemas"):
            (root / kind).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"expected a folder that can be written; got '{error.strerror}'; choose another"
        raise OutputError(message, where=str(root)) from error
    for name, text in sorted(files.items(), key=lambda item: item[0] == FILE):  # the list last: half is no workspace
        write_text(root / name, text)
    return read_workspace(root)
