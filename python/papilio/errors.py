"""The exceptions of papilio, with the messages and positions that the program ``papilio`` prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

__all__ = ["ArgumentError", "ClusterError", "DesignError", "DisplayError", "FileError", "InternalError", "Mistake", "PapilioError", "PapilioWarning", "ScenarioError"]


def __dir__() -> list[str]:
    return __all__


class Mistake(NamedTuple):
    """One error in a text."""

    #: Description of the error.
    message: str
    #: Name of the file or text.
    file: str
    #: Line, from 1; None: the whole text.
    line: int | None = None
    #: Column in characters, from 1.
    column: int | None = None
    #: Expected input.
    expected: str | None = None
    #: How to correct the error.
    hint: str | None = None
    #: Dotted path of the key: ``display.pixel.film.1.thickness_nm``.
    path: str | None = None


class PapilioError(Exception):
    """Base class of all exceptions of papilio."""


class PapilioWarning(UserWarning):
    """Warning of a computation. The program prints the same text, and ``warnings`` of the result contains it."""


class _Placed(PapilioError, ValueError):
    """Errors in a text. ``str()`` shows the position in the manner of a compiler."""

    def __init__(self, text: str, mistakes: Sequence[Mapping[str, Any]] = ()) -> None:
        super().__init__(text)
        #: All errors, in the order of the text; at least one.
        self.mistakes: list[Mistake] = [Mistake(**one) for one in mistakes] or [Mistake(text, "")]

    @property
    def file(self) -> str:
        """The file of the first error."""
        return self.mistakes[0].file

    @property
    def line(self) -> int | None:
        """The line of the first error, from 1."""
        return self.mistakes[0].line

    @property
    def column(self) -> int | None:
        """The column of the first error, from 1."""
        return self.mistakes[0].column

    @property
    def hint(self) -> str | None:
        """How to correct the first error."""
        return self.mistakes[0].hint

    @property
    def path(self) -> str | None:
        """The dotted path of the key of the first error."""
        return self.mistakes[0].path

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], [one._asdict() for one in self.mistakes])


class ScenarioError(_Placed):
    """An invalid scenario: its TOML, a key, a value, or a file that it names."""


class FileError(_Placed):
    """A data file that is invalid or cannot be read."""


class DisplayError(PapilioError, ValueError):
    """A display that cannot be computed, although its scenario is valid."""

    def __init__(self, text: str, mistakes: Sequence[Mapping[str, Any]] = ()) -> None:
        super().__init__(text)


class ArgumentError(PapilioError, ValueError):
    """An invalid argument of a function; the message begins with its name."""

    def __init__(self, text: str, mistakes: Sequence[Mapping[str, Any]] = ()) -> None:
        super().__init__(text)


class DesignError(PapilioError, ValueError):
    """An invalid design among the designs of a call."""

    def __init__(self, text: str, design: int | tuple[int, ...]) -> None:
        super().__init__(text)
        #: Index of the design in the arrays of designs.
        self.design = design

    def __str__(self) -> str:
        return f"design {self.design}: {self.args[0]}"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], self.design)


class ClusterError(PapilioError, RuntimeError):
    """A cluster that was closed, that lost a batch too often, or whose workers have another version or other files."""


class InternalError(PapilioError, RuntimeError):
    """A fault of papilio itself, and not of its input: please report the call, its files and the message."""
