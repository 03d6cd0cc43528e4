"""Files: their bytes as text, the name of a place in one, and writing one whole or not at all."""

from __future__ import annotations

import codecs
import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from navsym.core.errors import EmptyError, ExpressionSyntaxError, NavsymError, OutputError, TooLargeError, printable

MARKS = {
    codecs.BOM_UTF16_LE: "UTF-16",
    codecs.BOM_UTF16_BE: "UTF-16",
    b"PK\x03\x04": "a zip archive",
    b"\x1f\x8b": "a gzip archive",
    b"\x7fELF": "a program",
    b"%PDF": "a PDF document",
}


def name_file(path: str | os.PathLike[str]) -> str:
    """The path as it may stand in a message."""
    return printable(os.fspath(path))


@contextlib.contextmanager
def file_in_errors(source: object, otherwise: str = "") -> Iterator[None]:
    """Errors name the file that is read inside, if they do not begin with it.

    source : path of the file, or what was given in place of one; otherwise : the name of that, none where empty
    """
    name = name_file(source) if isinstance(source, str | os.PathLike) else otherwise
    try:
        yield
    except NavsymError as error:
        if name and not error.where.startswith(name):
            error.at(name)
        raise


def read_text(path: str | os.PathLike[str], limit: int) -> str:
    """The text of a regular UTF-8 file of at most ``limit`` bytes.

    Raises NavsymError of kind ``missing-file``, TooLargeError, EmptyError or ExpressionSyntaxError.
    """
    return decode(read_bytes(path, limit), name_file(path))


def read_bytes(path: str | os.PathLike[str], limit: int) -> bytes:
    """The bytes of a regular file, at most ``limit`` of them; no device or pipe is opened."""
    where = name_file(path)
    try:
        if not Path(path).is_file():
            raise missing_file(where, "a directory or device" if Path(path).exists() else "nothing there")
        with open(path, "rb") as file:
            data = file.read(limit + 1)
    except (OSError, ValueError) as failure:  # ValueError: a NUL in the name
        raise missing_file(where, getattr(failure, "strerror", None) or "a name that no file can have") from None
    if len(data) > limit:
        raise TooLargeError(f"expected at most {limit} bytes; got a larger file; split it", where=where)
    return data


def missing_file(where: str, got: str) -> NavsymError:
    """The error for a file that cannot be read."""
    message = f"expected a readable file; got {got}; check the path and the permissions"
    return NavsymError(message, where=where, kind="missing-file")


def decode(data: bytes, where: str) -> str:
    """UTF-8 text without NUL; a byte order mark, which some editors and spreadsheets write, is no part of it.

    Raises ExpressionSyntaxError for other bytes, and EmptyError when nothing but white space is in it.
    """
    for mark, what in MARKS.items():
        if data.startswith(mark):
            raise not_text(f"{what} at the start", where)
    data = data.removeprefix(codecs.BOM_UTF8)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as failure:
        row = data.count(b"\n", 0, failure.start) + 1
        got = f"the byte 0x{data[failure.start]:02x}"
        raise not_text(got, f"{where}: line {row}, byte {failure.start + 1}") from None
    if "\0" in text:
        row = text.count("\n", 0, text.index("\0")) + 1
        raise not_text("a NUL character", f"{where}: line {row}")
    if not text.strip():
        raise EmptyError("expected some text; got an empty file; fill it in", where=where)
    return text


def not_text(got: str, where: str) -> NavsymError:
    """The error for bytes that are not plain UTF-8."""
    return ExpressionSyntaxError(f"expected plain UTF-8 text; got {got}; save it as UTF-8", where=where)


def make_folder(path: Path, remedy: str) -> None:
    """Make a folder where there is none; raises OutputError with the remedy where it cannot be made."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"expected a folder that can be made; got '{error.strerror}'; {remedy}"
        raise OutputError(message, where=str(path)) from error


def write_text(path: str | os.PathLike[str], text: str, *, durable: bool = True) -> None:
    """Write a file whole or not at all: temporary file beside it, fsync, rename.

    durable : whether to wait until the disk has it; not for thousands of files that are made again in seconds

    Raises OutputError when the folder is missing or cannot be written.
    """
    write_bytes(path, text.encode("utf-8"), durable=durable)


def write_bytes(path: str | os.PathLike[str], data: bytes, *, durable: bool = True) -> None:
    """Like :func:`write_text`, for bytes."""
    target = Path(os.path.realpath(path))
    try:
        if target.exists() and not target.is_file():  # a pipe or /dev/stdout cannot be renamed over
            target.write_bytes(data)
        else:
            replace_file(target, data, durable)
    except OSError as error:
        reason = error.strerror or type(error).__name__
        message = f"expected a file that can be written; got '{reason}'; choose another path"
        raise OutputError(message, where=str(path)) from error


def replace_file(target: Path, data: bytes, durable: bool) -> None:
    """The temporary file has the mode of a new file, or that of the one it replaces."""
    handle, name = tempfile.mkstemp(prefix=f".{target.name[:50]}.", dir=target.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            if durable:
                os.fsync(file.fileno())
        os.chmod(name, file_mode(target))
        os.replace(name, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise


def file_mode(target: Path) -> int:
    """Permission bits of the file that stands there, or what the umask leaves of 0666."""
    if target.exists():
        return target.stat().st_mode & 0o777
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask
