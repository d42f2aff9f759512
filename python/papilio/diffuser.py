"""Files of measured scattering: audit, fits of lobes, conversion to other formats."""

from __future__ import annotations

import json
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, Literal

from . import _messages, _papilio
from ._arguments import one_of
from .errors import ArgumentError, FileError
from .figure import Figure
from .scenario import _checked_path

__all__ = ["Diffuser", "lobe_names"]


def __dir__() -> list[str]:
    return __all__

_FORMATS = ("bsdf", "csv", "xml", "npz")


def lobe_names() -> list[str]:
    """Returns the names of the analytic lobes that `Diffuser.fit` fits."""
    return _papilio.lobe_names()


class Diffuser:
    """A file of measured scattering, in any format that ``papilio diffuser`` reads (detected from its contents).

    Raises:
        FileError: if the file is invalid; with the position of the error.

    Warns:
        PapilioWarning: each suspicious but readable property of the file; ``warnings`` contains it.
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self._path = _checked_path("path", path)
        self._core = _papilio.Diffuser(self._path)
        _messages.warn(self.warnings)

    @property
    def warnings(self) -> list[str]:
        """Suspicious but readable properties of the file."""
        return self._core.warnings

    @property
    def parts(self) -> list[str]:
        """The measured sides and modes of scattering: "front transmission", ..."""
        return self._core.parts()

    @cached_property
    def _audit(self) -> tuple[str, str, list[tuple[str, str]]]:
        return self._core.audit()

    def audit(self) -> dict[str, Any]:
        """Returns the audit of the file, as ``papilio diffuser inspect --json`` prints it."""
        return dict(json.loads(self._audit[0]))

    def figures(self) -> dict[str, Figure]:
        """Returns the figures of the lobes, by name."""
        return {name: Figure(name, svg) for name, svg in self._audit[2]}

    def fit(self, model: str | None = None, *, part: str | None = None) -> dict[str, Any]:
        """Fits all analytic lobes, or one `model`, to a part (default: the first); the best fit is the first.

        The result is that of ``papilio diffuser fit --json``.
        """
        kind = None if model is None else one_of("model", model, lobe_names())
        at = 0 if part is None else self.parts.index(one_of("part", part, self.parts))
        return dict(json.loads(self._core.fit(at, kind)))

    def convert(self, output: str | PathLike[str], format: Literal["bsdf", "csv", "xml", "npz"] | None = None) -> list[str]:
        """Writes the measurement in another format, and returns descriptions of the data that this format cannot store.

        ``format``: "bsdf" (Radiant, Zemax), "csv", "xml" (Klems) or "npz" (papilio's own); by default from the suffix of the name.
        """
        where = _checked_path("output", output)
        by_name = Path(where).suffix.removeprefix(".")
        chosen = one_of("format", by_name if format is None else format, _FORMATS)
        if Path(where).exists() and Path(where).samefile(self._path):
            raise ArgumentError(f"output: expected another file than the input {where}, which would be overwritten")
        if not Path(where).parent.is_dir():
            raise FileError(f"{where}: the file cannot be written: there is no folder {str(Path(where).parent)!r}")
        return self._core.convert(where, chosen)

    def __str__(self) -> str:
        return self._audit[1]

    def __repr__(self) -> str:
        return f"<papilio.diffuser.Diffuser {self._path!r}: {', '.join(self.parts)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._path,)

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(str(self))}</pre>" + "".join(figure.svg for figure in self.figures().values())
