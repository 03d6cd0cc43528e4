"""For notebooks: drawings with sliders."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


def explore(draw: Callable[..., Any], **ranges: tuple[float, float, float]) -> Any:
    """A drawing with sliders; without a browser it is drawn at the start and at all ends, so that it is tested.

    draw   : function of the named quantities that returns what is shown
    ranges : name -> (lowest, highest, start)

    Returns the widget of ipywidgets.
    """
    import ipywidgets

    start = {name: middle for name, (_, _, middle) in ranges.items()}
    for name, (low, high, _) in ranges.items():
        for end in (low, high):
            draw(**{**start, name: end})
    controls = {
        name: ipywidgets.FloatSlider(value=middle, min=low, max=high, step=(high - low) / 100, continuous_update=False)
        for name, (low, high, middle) in ranges.items()
    }
    return ipywidgets.interactive(draw, **controls)
