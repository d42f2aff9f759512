"""Results without the extension module's objects: what a pickle carries.

All that a result can be asked for is computed before, so that it needs no file, no scenario and no computation where it is
unpickled. It takes the place of the object of `_papilio` and has its methods.
"""

from __future__ import annotations

import pickle
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _papilio

Reals = NDArray[np.float64]
Arrays = tuple[dict[str, Reals], dict[str, Reals]]

__all__ = ["Arrays", "KeptCone", "KeptProduction", "KeptRun", "fixed", "packed", "unpacked"]


def fixed(array: NDArray[Any]) -> NDArray[Any]:
    """The array, which nobody can change from now on."""
    array.flags.writeable = False
    return array


def fixed_arrays(arrays: tuple[Mapping[str, Reals], Mapping[str, Reals]]) -> Arrays:
    """Arrays by name, which nobody can change."""
    one, other = ({name: fixed(array) for name, array in some.items()} for some in arrays)
    return one, other


def packed(kept: object) -> bytes:
    """A kept result, made small: most of it is figures."""
    return zlib.compress(pickle.dumps(kept, protocol=5), 1)


def unpacked(content: bytes) -> Any:
    """What was packed."""
    return pickle.loads(zlib.decompress(content))


@dataclass(frozen=True)
class KeptRun:
    """In the place of ``_papilio.RunResult``."""

    texts: tuple[bytes, bytes, bytes]
    numbers: Arrays
    wavelengths: tuple[Reals, Reals]
    drawn: list[tuple[str, str]]
    shown: str | None
    names: list[str]
    directions: list[tuple[float, float]]
    said: tuple[list[str], list[str]]

    @classmethod
    def of(cls, core: _papilio.RunResult | KeptRun, title: str) -> KeptRun:
        """All that can be asked of a result."""
        if isinstance(core, cls):
            return core
        return cls(
            (core.json(), core.states_csv(), core.spectra_csv()),
            core.arrays(),
            (core.wavelength_nm(), core.radiance_of_white()),
            core.figures(title),
            core.overview(title),
            core.states(),
            core.views(),
            (core.warnings(), core.notes()),
        )

    def json(self) -> bytes:
        return self.texts[0]

    def states_csv(self) -> bytes:
        return self.texts[1]

    def spectra_csv(self) -> bytes:
        return self.texts[2]

    def arrays(self) -> Arrays:
        return self.numbers

    def wavelength_nm(self) -> Reals:
        return self.wavelengths[0]

    def radiance_of_white(self) -> Reals:
        return self.wavelengths[1]

    def figures(self, title: str) -> list[tuple[str, str]]:
        return self.drawn

    def overview(self, title: str) -> str | None:
        return self.shown

    def states(self) -> list[str]:
        return list(self.names)

    def views(self) -> list[tuple[float, float]]:
        return list(self.directions)

    def warnings(self) -> list[str]:
        return list(self.said[0])

    def notes(self) -> list[str]:
        return list(self.said[1])


@dataclass(frozen=True)
class KeptCone:
    """In the place of ``_papilio.Cone``."""

    angles: tuple[Reals, Reals]
    names: list[str]
    numbers: Arrays
    svg: str | None
    said: list[str]

    @classmethod
    def of(cls, core: _papilio.Cone | KeptCone, title: str) -> KeptCone:
        """All that can be asked of a cone."""
        if isinstance(core, cls):
            return core
        angles = core.theta_deg(), core.phi_deg()
        return cls(angles, core.states(), core.arrays(), core.figure(title), core.warnings())

    def theta_deg(self) -> Reals:
        return self.angles[0]

    def phi_deg(self) -> Reals:
        return self.angles[1]

    def states(self) -> list[str]:
        return list(self.names)

    def arrays(self) -> Arrays:
        return self.numbers

    def figure(self, title: str) -> str | None:
        return self.svg

    def warnings(self) -> list[str]:
        return list(self.said)


@dataclass(frozen=True)
class KeptProduction:
    """In the place of ``_papilio.Production``, for all but computing."""

    of: tuple[list[str], list[str]]
    widths: list[int]
    own: list[str]
    said: str
    drawn: list[tuple[str, str]]
    written: list[tuple[str, bytes]]

    @classmethod
    def made(cls, core: _papilio.Production | KeptProduction, numbers: Reals, title: str) -> KeptProduction:
        """All that can be asked of a production whose rows are known."""
        if isinstance(core, cls):
            return core
        rows = range(core.rows)
        return cls(
            core.names(),
            [core.width(row) for row in rows],
            [core.keys(row) for row in rows],
            core.report(numbers),
            core.figures(title, numbers),
            core.tables(numbers),
        )

    @property
    def rows(self) -> int:
        return len(self.widths)

    def names(self) -> tuple[list[str], list[str]]:
        return list(self.of[0]), list(self.of[1])

    def width(self, row: int) -> int:
        return self.widths[row]

    def keys(self, row: int) -> str:
        return self.own[row]

    def report(self, numbers: Reals) -> str:
        return self.said

    def figures(self, title: str, numbers: Reals) -> list[tuple[str, str]]:
        return self.drawn

    def tables(self, numbers: Reals) -> list[tuple[str, bytes]]:
        return self.written
