"""The exceptions of papilio, with the texts and places that the program ``papilio`` prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

__all__ = ["ArgumentError", "ClusterError", "DesignError", "DisplayError", "FileError", "Mistake", "PapilioError", "PapilioWarning", "ScenarioError"]


class Mistake(NamedTuple):
    """One thing that is wrong with a text."""

    #: What is wrong.
    message: str
    #: The file or text that it is in, as it was named.
    file: str
    #: Line, from 1; None: the text as a whole.
    line: int | None = None
    #: Column in characters, from 1.
    column: int | None = None
    #: What was expected there.
    expected: str | None = None
    #: What to do about it.
    hint: str | None = None
    #: The key that it concerns: ``display.pixel.film.1.thickness_nm``.
    path: str | None = None


class PapilioError(Exception):
    """What went wrong, in words; every exception of papilio's own is one."""


class PapilioWarning(UserWarning):
    """What the user of a result should know: the warnings that the program prints, which the result has as ``warnings``, too."""


class _Placed(PapilioError, ValueError):
    """A mistake in a text. ``str()`` shows the place as compilers do."""

    def __init__(self, text: str, mistakes: Sequence[Mapping[str, Any]] = ()) -> None:
        super().__init__(text)
        #: All that is wrong, in the order of the text; at least one.
        self.mistakes: list[Mistake] = [Mistake(**one) for one in mistakes] or [Mistake(text, "")]

    @property
    def file(self) -> str:
        """The file of the first mistake."""
        return self.mistakes[0].file

    @property
    def line(self) -> int | None:
        """The line of the first mistake, from 1."""
        return self.mistakes[0].line

    @property
    def column(self) -> int | None:
        """The column of the first mistake, from 1."""
        return self.mistakes[0].column

    @property
    def hint(self) -> str | None:
        """What to do about the first mistake."""
        return self.mistakes[0].hint

    @property
    def path(self) -> str | None:
        """The key that the first mistake concerns."""
        return self.mistakes[0].path

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], [one._asdict() for one in self.mistakes])


class ScenarioError(_Placed):
    """A scenario that is wrong: its TOML, a key, a value, or a file that it names."""


class FileError(_Placed):
    """A data file that is wrong or cannot be read."""


class DisplayError(PapilioError, ValueError):
    """A display that cannot be computed, though its scenario is well-formed."""

    def __init__(self, text: str, mistakes: Sequence[Mapping[str, Any]] = ()) -> None:
        super().__init__(text)


class ArgumentError(PapilioError, ValueError):
    """An argument of a function that is wrong; the text begins with its name."""

    def __init__(self, text: str, mistakes: Sequence[Mapping[str, Any]] = ()) -> None:
        super().__init__(text)


class DesignError(PapilioError, ValueError):
    """A design, of many in one call, that cannot be computed."""

    def __init__(self, text: str, design: int | tuple[int, ...]) -> None:
        super().__init__(text)
        #: Which one: its index in the arrays of designs.
        self.design = design

    def __str__(self) -> str:
        return f"design {self.design}: {self.args[0]}"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.args[0], self.design)


class ClusterError(PapilioError, RuntimeError):
    """A cluster that was closed, that lost a batch too often, or whose workers are not like this program."""
