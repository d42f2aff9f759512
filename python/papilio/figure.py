"""Figures."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from . import _arguments, _papilio
from .errors import ArgumentError

__all__ = ["Figure"]


class Figure:
    """A figure as SVG; a notebook shows it."""

    __slots__ = ("name", "svg")

    def __init__(self, name: str, svg: str) -> None:
        #: What a file of it would be called, without its end.
        self.name = name
        #: The text.
        self.svg = svg

    def png(self, scale: float = 2.0) -> bytes:
        """The figure as a PNG picture, with so many pixels for each unit of the SVG."""
        number = _arguments.reals("scale", scale, least=0.01, most=20.0)
        if number.ndim:
            raise ArgumentError(f"scale: expected one number, not {_arguments.described(scale)}")
        return _papilio.png(_arguments.text("svg", self.svg, "an SVG text"), float(number))

    def save(self, path: str | PathLike[str]) -> None:
        """Writes ``.svg`` or ``.png``, as the path ends."""
        where = Path(path)
        if where.suffix == ".svg":
            where.write_text(self.svg, encoding="utf-8")
        elif where.suffix == ".png":
            where.write_bytes(self.png())
        else:
            raise ArgumentError(f"path: expected a name that ends in .svg or .png, not {where.name!r}")

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<papilio.Figure {self.name!r}>"
