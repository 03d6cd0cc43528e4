"""For notebooks: drawings with sliders, and bars of progress."""

from __future__ import annotations

import html
import io
import os
import sys
import time
from collections.abc import Callable
from contextlib import nullcontext, redirect_stdout
from types import ModuleType
from typing import Any, cast

from navsym.core.choice import one_of
from navsym.core.errors import DomainError, MissingEngineError, NavsymError, ShapeError
from navsym.language.declarations import read_range
from navsym.language.names import quote
from navsym.language.printer import to_text
from navsym.language.values import write_declaration
from navsym.models.model import Model
from navsym.report.plots import plot

BETWEEN_UPDATES = 0.2  # seconds
STOPS = 60  # steps of a slider of exact numbers


def explore(what: Model | str | os.PathLike[str] | Callable[..., Any], target: str | None = None, **ranges: Any) -> Any:
    """A drawing with sliders: the guaranteed estimator of a model by its parameters, or whatever a function draws.

    what   : a model or its file, or a function of the named quantities that returns what is shown
    target : of a model; its first one when none is given
    ranges : name -> (lowest, highest), exact, for parameters of a model, by default as it declares them; or
             name -> (lowest, highest, start), floats, for a function

    Returns the widget of ipywidgets. The stops of a model's slider are exact numbers; where one has no estimator, the
    reason stands in the place of the picture. A function is drawn at its start and at all ends, so that it is tried
    without a browser. Raises NavsymError: ``domain`` for a parameter without two ends, ``missing`` without ipywidgets.

    >>> import navsym as nav
    >>> model = nav.Model(states="y1 y2 y3", F=[["0", "-1", "0"], ["0", "0", "1"], ["0", "-1", "0"]],
    ...                   H=[["1", "0", "0"]], sigma=["1"], interval="T", targets={"drift": "y3"}, T=("0", "2*pi"))
    >>> nav.explore(model).children[0].value
    'pi'
    """
    if isinstance(what, str | os.PathLike):
        what = Model.load(what)
    if isinstance(what, Model):
        return explore_model(what, target or next(iter(what.targets)), ranges)
    for name, ends in ranges.items():
        if not (isinstance(ends, list | tuple) and len(ends) == 3 and ends[0] <= ends[2] <= ends[1] != ends[0]):
            message = f"expected (lowest, highest, start); got {quote(ends)}; write {name}=(0.0, 2.0, 1.0)"
            raise ShapeError(message, where=f"explore: {name}")
    start = {name: middle for name, (_, _, middle) in ranges.items()}
    for name, (low, high, _) in ranges.items():
        for end in (low, high):
            what(**{**start, name: end})
    widgets = load_widgets()
    controls = {
        name: widgets.FloatSlider(value=middle, min=low, max=high, step=(high - low) / 100, continuous_update=False)
        for name, (low, high, middle) in ranges.items()
    }
    return connect(what, controls)


def explore_model(model: Model, target: str, ranges: dict[str, Any]) -> Any:
    """The estimator of a target with a slider for each parameter."""
    from navsym.guaranteed.solver import solve

    one_of(target, model.targets, "explore: target")

    def draw(**values: str) -> Any:
        try:
            estimator = solve(model, target, digits=12, values=values)
        except NavsymError as error:
            return print(error)
        figure = plot(estimator)
        figure.suptitle(f"{target}: guaranteed error {float(estimator.value):.6g}")
        return figure

    widgets, controls = load_widgets(), {}
    for name, (low, high) in read_ends(model, ranges).items():
        exact = [low + (high - low) * k / STOPS for k in range(STOPS + 1)]
        options = [(f"{float(value):.4g}", to_text(value)) for value in exact]
        controls[name] = widgets.SelectionSlider(
            options=options, index=STOPS // 2, description=name, continuous_update=False
        )
    return connect(draw, controls)


def connect(draw: Callable[..., Any], controls: dict[str, Any]) -> Any:
    """The widget of a drawing and its sliders; without a notebook it is made without the control letters of one."""
    from IPython import get_ipython

    with nullcontext() if get_ipython() else redirect_stdout(io.StringIO()):
        return load_widgets().interactive(draw, **controls)


def read_ends(model: Model, ranges: dict[str, Any]) -> dict[str, tuple[Any, Any]]:
    """The two ends of each parameter: as asked for, else as declared; raises NavsymError for one without."""
    found = {}
    for name, parameter in model.parameters.items():
        if name in ranges:
            where, ends = f"explore: {name}", ranges[name]
            if not isinstance(ends, list | tuple) or len(ends) != 2:
                remedy = f'write {name}=("1", "6"), or nav.solve(model, {name}="5") for one value'
                raise ShapeError(f"expected two ends of a slider; got {quote(ends)}; {remedy}", where=where)
            found[name] = read_range(write_declaration(ends, where, parameter.unit), where, parameter.unit)
        elif parameter.lower is None or parameter.upper is None:
            message = f'expected two ends of {name}; got {parameter.kind}; write {name}=("1/2", "2")'
            raise DomainError(message, where="explore")
        else:
            found[name] = parameter.lower, parameter.upper
    if idle := sorted({*ranges} - {*found}):
        raise DomainError(f"expected parameters of the model; got {idle[0]}; leave it out", where="explore")
    return found


def load_widgets() -> ModuleType:
    """The module ipywidgets; raises MissingEngineError without it."""
    try:
        import ipywidgets
    except ImportError:
        message = "expected ipywidgets for sliders; got none; install it with pip install ipywidgets"
        raise MissingEngineError(message, where="explore") from None
    return ipywidgets


class ProgressBar:
    """A bar in a notebook, a line in a terminal, for every call with ``progress``.

    ``nav.verify(progress=nav.ProgressBar())`` is one.

    It takes whatever such a call tells: how much is done, how much there is, what is being done. When all is done, the
    bar gives way to one line of text.

    >>> bar = ProgressBar()
    >>> bar.tell(3, 12, "paper:4.1")
    '3 of 12 paper:4.1'
    """

    def __init__(self) -> None:
        self.count, self.handle, self.shown = 0, cast(Any, None), 0.0

    def tell(self, *told: Any) -> str:
        """One step in words; a call that names no count is one step more."""
        numbers = [part for part in told if isinstance(part, int) and not isinstance(part, bool)]
        self.count = numbers[0] if len(numbers) > 1 else self.count + 1
        total = f" of {numbers[-1]}" if numbers else ""
        return " ".join([f"{self.count}{total}", *(part for part in told if isinstance(part, str))])

    def __call__(self, *told: Any) -> None:
        """Show one step; several within a fifth of a second are shown once."""
        from IPython import get_ipython
        from IPython.display import display

        words, now = self.tell(*told), time.monotonic()
        total = next((int(part) for part in reversed(told) if isinstance(part, int)), 0)
        is_over = 0 < total <= self.count
        if now - self.shown < BETWEEN_UPDATES and not is_over:
            return
        self.shown = now
        if not hasattr(get_ipython(), "kernel"):  # a terminal: one line that is written again and again
            sys.stderr.write(f"\r{words}\x1b[K" + "\n" * is_over)
            sys.stderr.flush()
            return
        bar = f'<progress value="{self.count}" max="{total}"></progress> ' if total else ""
        page = ("" if is_over else bar) + html.escape(words)
        shown = {"text/plain": words, "text/html": page}
        if self.handle is None:
            self.handle = display(shown, raw=True, display_id=True)
        else:
            self.handle.update(shown, raw=True)
