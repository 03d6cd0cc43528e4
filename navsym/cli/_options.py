"""The options of the verbs: their words and flags from one table, and how errors of functions name them."""

from __future__ import annotations

import functools
import inspect
import re
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

from navsym.core.errors import NavsymError

if TYPE_CHECKING:
    from navsym.cli.output import Told

#: A remedy of the Python call that sets a switch.
FLAG = re.compile(r"\b([a-z_]+)=True\b")


@functools.cache
def read_table() -> dict[str, dict[str, Any]]:
    """Verb -> parameter -> words; what verbs have alike stands under ``all``."""
    return tomllib.loads(Path(__file__).with_name("options.toml").read_text(encoding="utf-8"))


def words_of(verb: str, parameter: str) -> dict[str, Any]:
    """The flag of a parameter, its help, and its least and largest value where it has some."""
    name, table = parameter.rstrip("_"), read_table()
    words = table.get(verb, {}).get(name) or table["all"][name]
    return {"flag": f"--{name.replace('_', '-')}"} | ({"help": words} if isinstance(words, str) else words)


#: The option of every verb.
JSON = inspect.Parameter("json_", inspect.Parameter.KEYWORD_ONLY, default=False)


def with_options(command: Callable[..., Told], verb: str) -> Callable[..., Any]:
    """The command of a verb as typer takes it: parameters by keyword only are options, the others arguments.

    It prints what the verb tells, with ``--json`` as a document, also of a verb that was interrupted and tells so far.
    """
    import typer

    hints, parameters = get_type_hints(command) | {JSON.name: bool}, []
    for parameter in (*inspect.signature(command).parameters.values(), JSON):
        words = words_of(verb, parameter.name)
        flag = words.pop("flag")
        is_option = parameter.kind is inspect.Parameter.KEYWORD_ONLY
        shown = typer.Option(flag, **words) if is_option else typer.Argument(**words)
        parameters.append(parameter.replace(annotation=Annotated[hints[parameter.name], shown]))

    @functools.wraps(command)
    def described(*positional: Any, json_: bool, **named: Any) -> int:
        try:
            return command(*positional, **named).print(json_)
        except KeyboardInterrupt as error:
            if (so_far := getattr(error, "told", None)) is not None:
                so_far.print(json_)
            raise

    described.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    described.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return described


@contextmanager
def called_options(function: str) -> Iterator[None]:
    """Errors in words of the command line: ``limits: noise`` becomes ``--noise``, and ``force=True`` ``--force``."""
    try:
        yield
    except NavsymError as error:
        if error.where.startswith(f"{function}: "):
            names = error.where.removeprefix(f"{function}: ").replace("values", "set").split(", ")
            error.where = ", ".join(f"--{name}" for name in names)
        switched = FLAG.sub(lambda found: f"--{found[1].replace('_', '-')}", error.remedy)
        error.message = error.message.removesuffix(error.remedy) + switched
        raise
