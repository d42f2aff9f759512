"""Figures of arrays: curves and maps, in the style of the program's figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _papilio
from ._arguments import described, one_of, reals, text
from .errors import ArgumentError
from .figure import Figure

__all__ = ["curves", "map"]


def __dir__() -> list[str]:
    return __all__

_KINDS = ("line", "dashed", "points")

#: The largest number of cells in a map; larger figures are too large for a page.
MOST_CELLS = 10_000


def curves(
    x: ArrayLike | Mapping[str, ArrayLike],
    ys: Mapping[str, ArrayLike],
    *,
    x_label: str = "",
    y_label: str = "",
    title: str = "",
    logarithmic: bool = False,
    kinds: Mapping[str, str] | None = None,
) -> Figure:
    """Draws curves over a common axis, with the name at the end of each curve.

    Args:
        x: one-dimensional; or ``{name: x}`` with an array for each curve.
        ys: ``{name: y}``; NaN interrupts a curve.
        x_label: label of the axis, with the unit.
        y_label: label of the axis of values, with the unit.
        title: title of the figure.
        logarithmic: whether the axis of values is logarithmic.
        kinds: "line", "dashed" or "points" for some of the names.

    Returns:
        The figure, which a notebook shows.

    Example:
        >>> papilio.plot.curves([400, 550, 700], {"white": [0.4, 0.6, 0.5]}, x_label="Wavelength (nm)")
        <papilio.Figure 'curves'>
    """
    if not isinstance(ys, Mapping):
        raise ArgumentError(f"ys: expected a dict of names and numbers, not {described(ys)}")
    named = {} if kinds is None else kinds
    if not isinstance(named, Mapping):
        raise ArgumentError(f"kinds: expected a dict of names and kinds, not {described(kinds)}")
    drawn = []
    for name, y in ys.items():
        values = reals(f"ys[{name!r}]", y, missing=True)
        places = x.get(name) if isinstance(x, Mapping) else x
        along = reals("x", [] if places is None else places, missing=True)
        if values.ndim != 1 or along.shape != values.shape:
            raise ArgumentError(f"ys[{name!r}]: expected a number for each x, shape {along.shape}, not {values.shape}")
        kind = one_of(f"kinds[{name!r}]", named.get(name, "line"), _KINDS)
        drawn.append((text("ys", name, "names"), kind, along.tolist(), values.tolist()))
    words = [text(of, label, "text") for of, label in [("x_label", x_label), ("y_label", y_label), ("title", title)]]
    return Figure("curves", _papilio.curves(words[0], words[1], bool(logarithmic), drawn, words[2]))


def map(  # noqa: A001 (the field's word)
    x: ArrayLike, y: ArrayLike, values: ArrayLike, *, x_label: str = "", y_label: str = "", title: str = "", name: str = "value"
) -> Figure:
    """Draws numbers over two axes as colours.

    Args:
        x, y: values of the axes, numbers or strings.
        values: shape [y, x], at most 10,000 cells; NaN cells are empty.
        x_label, y_label: labels of the axes, with the units.
        title: title of the figure.
        name: name of the metric, for the scale.

    Returns:
        The figure, which a notebook shows.

    Example:
        >>> papilio.plot.map([1, 2, 3], [10, 20], [[0.1, 0.2, 0.3], [0.2, 0.3, 0.4]], name="contrast")
        <papilio.Figure 'map'>
    """
    cells = reals("values", values, missing=True)
    across, up = _texts("x", x), _texts("y", y)
    if cells.shape != (len(up), len(across)):
        raise ArgumentError(f"values: expected shape {(len(up), len(across))}, one number for each y and x, not {cells.shape}")
    if cells.size > MOST_CELLS:
        raise ArgumentError(f"values: expected at most {MOST_CELLS} cells, not {cells.size}")
    flat: list[float] = cells.reshape(-1).tolist()
    labels = {"x_label": x_label, "y_label": y_label, "title": title, "name": name}
    words = {of: text(of, label, "text") for of, label in labels.items()}
    svg = _papilio.map(words["name"], (words["x_label"], across), (words["y_label"], up), flat, words["title"])
    if svg is None:
        raise ArgumentError("values: expected at least one number that is not NaN")
    return Figure("map", svg)


def _texts(name: str, values: ArrayLike) -> list[str]:
    """Returns the values of an axis, numbers or strings, as strings."""
    try:
        line: Any = np.asarray(values)
    except ValueError as error:
        raise ArgumentError(f"{name}: expected numbers or strings: {error}") from None
    if line.ndim != 1 or not line.size:
        raise ArgumentError(f"{name}: expected values in one dimension, not shape {line.shape}")
    if line.dtype.kind == "U":
        return [text(name, str(word), "numbers or strings") for word in line]
    return [f"{number:.6g}" for number in reals(name, values)]
