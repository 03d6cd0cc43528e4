"""Writing an export: nothing outside its folder, nothing through a link, nothing overwritten unasked."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path

from navsym.core.errors import NavsymError

PLAIN = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*(?:/[A-Za-z0-9][A-Za-z0-9._-]*){0,3}")


class FolderError(NavsymError):
    """An output folder that must not be written."""

    kind = "output"


def write_folder(out: Path, files: Mapping[str, str], *, force: bool = False) -> list[Path]:
    """Write files below a folder, all or none of them; raises FolderError before the first one is in its place.

    files : relative name -> text
    force : replace files that are there (links are refused all the same)
    """
    targets = require_free(out, files, force=force)
    root = Path(os.path.realpath(out))
    staged: list[tuple[Path, Path]] = []
    try:
        for name, target in targets.items():
            target.parent.mkdir(parents=True, exist_ok=True)
            stage(target, files[name], staged)
        for written, target in staged:
            os.replace(written, target)
    except OSError as error:
        undo(root, staged)
        got = error.strerror or type(error).__name__
        message = f"expected a folder with room that can be written; got '{got}'; nothing was written; choose another"
        raise FolderError(message, where=str(out)) from None
    except BaseException:
        undo(root, staged)
        raise
    return list(targets.values())


def undo(root: Path, staged: list[tuple[Path, Path]]) -> None:
    """Take away what was staged, and the folders that are empty without it."""
    for written, target in staged:
        written.unlink(missing_ok=True)
        for folder in (target.parent, *target.parent.parents):
            with contextlib.suppress(OSError):
                folder.rmdir()  # only an empty one goes
            if folder == root:
                break


def require_free(out: Path, files: Mapping[str, str], *, force: bool = False) -> dict[str, Path]:
    """The target of every name; FolderError when one must not be written."""
    root = folder_for(out)
    targets = {name: target_for(root, name) for name in files}
    taken = [target for target in targets.values() if os.path.lexists(target)]
    if taken and not force:
        raise FolderError(
            f"expected new files; got {len(taken)} that are there already, {taken[0].name} among them; "
            "add force=True, or choose another folder",
            where=str(out),
        )
    return targets


def folder_for(out: Path) -> Path:
    """The folder itself, made when its parent is there; a link is refused."""
    if out.is_symlink():
        raise FolderError("expected a folder; got a symbolic link; name the folder itself", where=str(out))
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise FolderError(
            f"expected a folder that can be made; got '{reason}'; choose another", where=str(out)
        ) from None
    return Path(os.path.realpath(out))


def is_plain(name: str) -> bool:
    """True for a relative name that cannot leave its folder."""
    return PLAIN.fullmatch(name) is not None and ".." not in name


def target_for(root: Path, name: str) -> Path:
    """The path of one file; names that could leave the folder or pass a link are refused."""
    if not is_plain(name):
        raise FolderError(f"expected a plain relative name; got {name!r}; report this", where=str(root))
    target = root / name
    for part in (target, *target.parents):
        if part == root:
            return target
        if part.is_symlink():
            raise FolderError(
                f"expected files and folders; got the symbolic link {part.name}; remove it", where=str(root)
            )
        if part != target and part.exists() and not part.is_dir():
            raise FolderError(f"expected a folder; got the file {part.name}; remove it", where=str(root))
    raise FolderError(f"expected a name inside the folder; got {name!r}; report this", where=str(root))


def stage(target: Path, text: str, staged: list[tuple[Path, Path]]) -> None:
    """A temporary file beside the target, to be renamed when all are written."""
    if target.is_dir():
        raise FolderError(f"expected a file; got the folder {target.name}; remove it", where=str(target.parent))
    handle, name = tempfile.mkstemp(prefix=".export.", dir=target.parent)
    staged.append((Path(name), target))
    with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
        file.write(text)
    os.chmod(name, 0o644)
