"""The command ``navsym``: finds the verb, runs it, and turns every error into one clear line.

A verb is a file of this folder with a function ``command`` that returns what it has to say; its name is the file name
with ``-`` for ``_``, its help line the first line of the file, and the words of its options stand in ``options.toml``.
Help lines are read without importing the files, and only the verb that was called is imported: engines are slow to
load, and ``navsym --help`` is not.
"""

from __future__ import annotations

import ast
import contextlib
import difflib
import functools
import gc
import importlib
import os
import sys
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NoReturn

from navsym import __version__
from navsym.cli._options import with_options
from navsym.cli._progress import Ticker
from navsym.cli.output import OutputError, dumps, put, visible, wants_colour
from navsym.core.errors import ExpressionSyntaxError, MissingEngineError, NavsymError

FOLDER = Path(__file__).parent
NOT_VERBS = frozenset({"main", "output"})

INTERRUPTED = 130  # 128 + SIGINT, as shells have it
BROKEN_PIPE = 141  # 128 + SIGPIPE


class Stopped(Exception):
    """Carries an interruption or a broken pipe past typer, which has answers of its own for them."""


class EndOfFile(Exception):
    """The same for the end of a file, which typer takes for an answer to a question that it never asked."""


def main() -> NoReturn:
    """Entry point of the console script and of ``python -m navsym``."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(AttributeError, ValueError):
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    gc.set_threshold(200_000)  # a tenth of the time of loading the algebra went into looking for cycles in its modules
    status = run(sys.argv[1:])
    gc.freeze()  # at the end nobody looks for cycles in all modules: a third of the time of a short command
    sys.exit(status)


def run(arguments: Sequence[str]) -> int:
    """Run one command line (without the program's name) and return the exit status.

    0 done and all as declared · 1 a verdict differs or a check failed · 2 bad input ·
    3 something is missing on this machine · 130 interrupted · 141 the reader went away.
    """
    as_json = "--json" in arguments
    try:
        status = dispatch(list(arguments))
        sys.stdout.flush()
        return status
    except (KeyboardInterrupt, BrokenPipeError, Stopped) as error:
        return stopped(error.__cause__ if isinstance(error, Stopped) else error)
    except NavsymError as error:
        return report(error, as_json)
    except Exception as error:
        return report(translated(error, arguments), as_json)


def dispatch(arguments: list[str]) -> int:
    """Global options here; everything else belongs to the verb."""
    if not arguments or arguments[0] in ("-h", "--help"):
        put(overview())
        return 0 if arguments else 2
    if arguments[0] in ("-V", "--version"):
        put(f"navsym {__version__}\n")
        return 0
    if arguments[:2] == ["completion", "words"]:  # at every press of Tab: without typer
        return complete(arguments[2:])
    return call(module_of(arguments[0]), arguments[0], arguments[1:])


def complete(arguments: list[str]) -> int:
    """Print what may come next, one word a line, for the scripts of ``navsym completion``."""
    from navsym.cli._completion import candidates

    found = candidates(" ".join(arguments), verbs())
    put("".join(f"{word}\n" for word in found))
    return 0


# Verbs


def verbs() -> dict[str, Path]:
    """Verb -> file, in alphabetical order, by listing the folder."""
    files = sorted(FOLDER.glob("*.py"))
    names = [p for p in files if p.stem not in NOT_VERBS and not p.stem.startswith("_")]
    return {path.stem.replace("_", "-"): path for path in names}


def help_line(path: Path) -> str:
    """First line of a file's docstring, read without importing the file."""
    try:
        doc = ast.get_docstring(ast.parse(path.read_bytes()))
    except (OSError, SyntaxError, ValueError):
        doc = None
    return doc.strip().splitlines()[0] if doc and doc.strip() else "(no description)"


def overview() -> str:
    """The text of ``navsym --help``."""
    found = verbs()
    width = max(map(len, found), default=0)
    lines = [f"  {verb.ljust(width)}  {help_line(path)}" for verb, path in found.items()]
    return "\n".join(
        [
            "usage: navsym VERB [FILE] [options]      (navsym VERB --help shows the options)",
            "",
            *lines,
            "",
            "  --json in any verb prints one JSON document; -V, --version prints the version.",
            "  exit status: 0 as declared, 1 a verdict differs, 2 bad input, 3 something is missing.",
            "",
        ]
    )


def module_of(verb: str) -> str:
    """Dotted name of the verb's module; raises a ``syntax`` error for an unknown verb."""
    found = verbs()
    if verb in found:
        return f"navsym.cli.{found[verb].stem}"
    close = difflib.get_close_matches(verb, found, n=1)
    advice = f"did you mean {close[0]}?" if close else "see navsym --help"
    message = f"expected one of {', '.join(found)}; got {verb[:60]}; {advice}"
    raise ExpressionSyntaxError(message, where="command line")


def call(module: str, verb: str, arguments: list[str]) -> int:
    """Import the verb and run it; its result, when it is a number, is the exit status."""
    import typer

    app = typer.Typer(
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,  # square brackets in help are TOML, not markup
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    with Ticker(verb):
        app.command(name=verb)(guarded(with_options(importlib.import_module(module).command, verb)))
        result = app(args=arguments, prog_name=f"navsym {verb}", standalone_mode=False)
    return result if isinstance(result, int) else 0


def guarded(command: Callable[..., Any]) -> Callable[..., Any]:
    """The command with what typer would answer itself handed to :func:`run`."""

    @functools.wraps(command)
    def inner(*positional: Any, **named: Any) -> Any:
        try:
            return command(*positional, **named)
        except (KeyboardInterrupt, BrokenPipeError) as error:
            raise Stopped from error
        except EOFError as error:
            raise EndOfFile(str(error)) from error

    return inner


# Errors


def stopped(error: BaseException | None) -> int:
    """Exit status after the user, or the reader of our output, has had enough."""
    if isinstance(error, BrokenPipeError):
        silence_stdout()
        return BROKEN_PIPE
    notes = getattr(error, "__notes__", ())
    complain(" ".join(["interrupted", *(notes or ["and nothing is kept: the same command starts again"])]))
    return INTERRUPTED


def translated(error: Exception, arguments: Sequence[str]) -> NavsymError:
    """A NavsymError that says the same: usage errors of typer, missing engines, our own defects."""
    if hasattr(error, "format_message"):
        return usage_error(error, arguments)
    if os.environ.get("NAVSYM_DEBUG"):
        traceback.print_exception(error, file=sys.stderr)
    # A module of this project that is missing is a defect, not the machine.
    ours = (getattr(error, "name", None) or "navsym").partition(".")[0] in ("navsym", "navsym_papers")
    return missing_module(error) if isinstance(error, ModuleNotFoundError) and not ours else internal(error)


def usage_error(error: Any, arguments: Sequence[str]) -> NavsymError:
    """``expected …; got …; remedy`` for a wrong option, argument or value."""
    verb = arguments[0]
    got = " ".join(arguments[1:])[:200] or "nothing after the verb"
    text = error.format_message().strip().rstrip(".").replace("\n", " ")
    message = f"expected options and arguments of {verb} ({text}); got {got}; see navsym {verb} --help"
    return ExpressionSyntaxError(message, where="command line")


def missing_module(error: ModuleNotFoundError) -> NavsymError:
    """An engine that is not installed is the machine's trouble, with status 3."""
    message = f"expected the Python package {error.name}; got none; run navsym doctor, it says how to get it"
    return MissingEngineError(message)


def internal(error: Exception) -> NavsymError:
    """A defect of navsym: one line, status 1, and the way to the traceback."""
    what = " ".join(f"{type(error).__name__}: {error}".split())[:300]
    wrapped = NavsymError(
        f"expected no error here; got {what}; run again with NAVSYM_DEBUG=1 for the traceback and report it",
        kind="internal",
    )
    wrapped.status = 1
    return wrapped


def report(error: NavsymError, as_json: bool) -> int:
    """Print the error where it belongs and return its exit status."""
    line = ": ".join(part for part in (error.kind, error.where, error.message) if part)
    try:
        if as_json:
            put(dumps(error.as_json()) + "\n")
        else:
            complain(line)
        if error.where == "standard output":  # what did not get out waits for the interpreter's last flush
            silence_stdout()
    except BrokenPipeError:
        silence_stdout()
    except OutputError:  # standard output is full or closed: the line goes where it can
        silence_stdout()
        complain(line)
    return error.status


def complain(text: str) -> None:
    """One line on standard error, the program's name in red on a terminal; nothing where there is no standard error."""
    if sys.stderr is None:
        return
    name = "\x1b[1;31mnavsym\x1b[0m" if wants_colour(sys.stderr) else "navsym"
    put(f"{name}: {visible(text)}\n", sys.stderr)


def silence_stdout() -> None:
    """After a broken pipe or a full disk: let the interpreter's last flush go nowhere."""
    with contextlib.suppress(OSError, ValueError, AttributeError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
