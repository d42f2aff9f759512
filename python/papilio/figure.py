"""Figures."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from . import _arguments, _papilio
from ._storing import put
from .errors import ArgumentError

__all__ = ["Figure"]


class Figure:
    """A figure as SVG, which a notebook displays."""

    __slots__ = ("name", "svg")

    def __init__(self, name: str, svg: str) -> None:
        #: Name of a file for the figure, without suffix.
        self.name = name
        #: The SVG text.
        self.svg = svg

    def png(self, scale: float = 2.0) -> bytes:
        """Returns the figure as a PNG image, with ``scale`` pixels per unit of the SVG."""
        number = _arguments.reals("scale", scale, least=0.01, most=20.0)
        if number.ndim:
            raise ArgumentError(f"scale: expected one number, not {_arguments.described(scale)}")
        return _papilio.png(_arguments.text("svg", self.svg, "an SVG text"), float(number))

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the figure as SVG or PNG, according to the suffix of the path."""
        where = Path(path)
        if where.suffix == ".svg":
            put(where, self.svg.encode())
        elif where.suffix == ".png":
            put(where, self.png())
        else:
            raise ArgumentError(f"path: expected a name that ends with .svg or .png, not {where.name!r}")

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<papilio.Figure {self.name!r}>"
