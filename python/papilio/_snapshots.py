"""Contents of pickled results, without objects of the extension module.

Everything that a result offers is computed before pickling, so that the unpickled result needs no file, scenario or
computation. A snapshot replaces the object of `_papilio` and has its methods.
"""

from __future__ import annotations

import json
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

__all__ = ["AbsorptionSnapshot", "Arrays", "ConeSnapshot", "ProductionSnapshot", "RunSnapshot", "pack", "read_only", "read_only_arrays", "unpack"]


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Makes an array read-only, and returns it."""
    array.flags.writeable = False
    return array


def read_only_arrays(arrays: tuple[Mapping[str, Reals], Mapping[str, Reals]]) -> Arrays:
    """Makes named arrays read-only, and returns them."""
    one, other = ({name: read_only(array) for name, array in some.items()} for some in arrays)
    return one, other


def pack(snapshot: object) -> bytes:
    """Pickles and compresses a snapshot; figures are most of its size."""
    return zlib.compress(pickle.dumps(snapshot, protocol=5), 1)


def unpack(content: bytes) -> Any:
    """Restores the snapshot from the bytes of `pack`."""
    return pickle.loads(zlib.decompress(content))


@dataclass(frozen=True)
class RunSnapshot:
    """Replacement of ``_papilio.RunResult``."""

    texts: tuple[bytes, bytes, bytes]
    numbers: Arrays
    wavelengths: tuple[Reals, Reals]
    drawn: list[tuple[str, str]]
    shown: str | None
    names: list[str]
    directions: list[tuple[float, float]]
    messages: tuple[list[str], list[str]]

    @classmethod
    def of(cls, core: _papilio.RunResult | RunSnapshot, title: str) -> RunSnapshot:
        """Creates the snapshot of a result."""
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

    def about(self) -> tuple[str, str, int]:
        content = json.loads(self.texts[0])
        return content["papilio"], content["hash"], content["seed"]

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
        return list(self.messages[0])

    def notes(self) -> list[str]:
        return list(self.messages[1])


@dataclass(frozen=True)
class ConeSnapshot:
    """Replacement of ``_papilio.Cone``."""

    angles: tuple[Reals, Reals]
    names: list[str]
    numbers: Arrays
    drawn: list[tuple[str, str]]
    messages: list[str]
    written: list[tuple[str, bytes]]

    @classmethod
    def of(cls, core: _papilio.Cone | ConeSnapshot, title: str) -> ConeSnapshot:
        """Creates the snapshot of a conoscopic map."""
        if isinstance(core, cls):
            return core
        angles = core.theta_deg(), core.phi_deg()
        return cls(angles, core.states(), core.arrays(), core.figures(title), core.warnings(), core.files())

    def theta_deg(self) -> Reals:
        return self.angles[0]

    def phi_deg(self) -> Reals:
        return self.angles[1]

    def states(self) -> list[str]:
        return list(self.names)

    def arrays(self) -> Arrays:
        return self.numbers

    def figures(self, title: str) -> list[tuple[str, str]]:
        return self.drawn

    def warnings(self) -> list[str]:
        return list(self.messages)

    def files(self) -> list[tuple[str, bytes]]:
        return self.written


@dataclass(frozen=True)
class AbsorptionSnapshot:
    """Replacement of ``_papilio.Absorption``."""

    of_layers: list[tuple[str, str]]
    named: tuple[list[str], list[str]]
    numbers: dict[str, Reals]
    angles_in: str
    svg: str
    written: list[tuple[str, bytes]]

    @classmethod
    def of(cls, core: _papilio.Absorption | AbsorptionSnapshot, title: str) -> AbsorptionSnapshot:
        """Creates the snapshot of absorptances."""
        if isinstance(core, cls):
            return core
        return cls(core.layers(), core.names(), core.arrays(), core.medium(), core.figure(title), core.tables())

    def layers(self) -> list[tuple[str, str]]:
        return list(self.of_layers)

    def names(self) -> tuple[list[str], list[str]]:
        return list(self.named[0]), list(self.named[1])

    def arrays(self) -> dict[str, Reals]:
        return self.numbers

    def medium(self) -> str:
        return self.angles_in

    def figure(self, title: str) -> str:
        return self.svg

    def tables(self) -> list[tuple[str, bytes]]:
        return self.written


@dataclass(frozen=True)
class ProductionSnapshot:
    """Replacement of ``_papilio.Production``, except for computing."""

    of: tuple[list[str], list[str]]
    widths: list[int]
    own: list[str]
    report_text: str
    drawn: list[tuple[str, str]]
    written: list[tuple[str, bytes]]

    @classmethod
    def create(cls, core: _papilio.Production | ProductionSnapshot, numbers: Reals, title: str) -> ProductionSnapshot:
        """Creates the snapshot of a tolerance analysis whose rows are all computed."""
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
        return self.report_text

    def figures(self, title: str, numbers: Reals) -> list[tuple[str, str]]:
        return self.drawn

    def tables(self, numbers: Reals) -> list[tuple[str, bytes]]:
        return self.written
