"""Absorptance of each layer of a film pixel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _messages, _papilio, _snapshots
from ._arguments import ascending
from ._mapping import ByName
from ._snapshots import AbsorptionSnapshot, read_only
from ._storing import Stored, optional
from ._tables import long_table
from .figure import Figure
from .scenario import Scenario, read

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Absorption", "absorption"]

_ARRAYS = ("absorptance", "reflectance", "area")

#: Default angles, degrees: those of ``papilio pixel --absorption``.
_THETA_DEG = tuple(15.0 * k for k in range(7))


class Absorption(Stored, ByName[NDArray[np.float64]]):
    """Absorptance of each layer of the film pixel of a display: the output of ``papilio pixel --absorption``.

    All fractions are of the light on one sub-pixel: over ``layer``, ``absorptance`` sums to 1 - ``reflectance``. Arrays are
    read-only. It can be copied and pickled.
    """

    def __init__(
        self, core: _papilio.Absorption | AbsorptionSnapshot, title: str = "", warned: Sequence[str] = (), notes: Sequence[str] = ()
    ) -> None:
        self._core = core
        #: Warnings; each was also raised as a `papilio.PapilioWarning` by the computation.
        self.warnings = list(warned)
        #: Notes on data that were measured, assumed or scaled.
        self.notes = list(notes)
        #: The scenario's title.
        self.title = title

    def _names(self) -> Iterable[str]:
        return _ARRAYS

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Returns ``absorptance``, ``reflectance`` or ``area``; the properties of these names have their shapes.

        Raises:
            KeyError: if there is no such array.
        """
        if name not in _ARRAYS:
            raise KeyError(f"{name!r}: there is no such array; expected {', '.join(_ARRAYS)}")
        return self._arrays[name]

    @cached_property
    def _arrays(self) -> dict[str, NDArray[np.float64]]:
        return {name: read_only(values) for name, values in self._core.arrays().items()}

    @property
    def layers(self) -> list[tuple[str, str]]:
        """Number (in ``display.pixel.film``, or ``"substrate"``) and material of each layer, from the glass down."""
        return self._core.layers()

    @property
    def states(self) -> list[str]:
        """The names of the drive states."""
        return self._core.names()[0]

    @property
    def sub_pixels(self) -> list[str]:
        """The names of the sub-pixels."""
        return self._core.names()[1]

    @property
    def theta_deg(self) -> NDArray[np.float64]:
        """Angles in the medium of the scenario's angles, degrees."""
        return self._arrays["theta_deg"]

    @property
    def wavelength_nm(self) -> NDArray[np.float64]:
        """Wavelengths, nm."""
        return self._arrays["wavelength_nm"]

    @property
    def absorptance(self) -> NDArray[np.float64]:
        """Absorptance, shape [state, sub_pixel, layer, theta_deg, wavelength_nm]."""
        return self._arrays["absorptance"]

    @property
    def reflectance(self) -> NDArray[np.float64]:
        """Reflectance of each sub-pixel, shape [state, sub_pixel, theta_deg, wavelength_nm]."""
        return self._arrays["reflectance"]

    @property
    def area(self) -> NDArray[np.float64]:
        """Fraction of the panel's area that each sub-pixel has, shape [state, sub_pixel]."""
        return self._arrays["area"]

    def to_xarray(self) -> xarray.Dataset:
        """Returns ``absorptance``, ``reflectance`` and ``area`` as a Dataset with units and long names.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        numbers, materials = zip(*self.layers, strict=True)
        about = {
            "absorptance": "fraction of the light on the sub-pixel that the layer absorbs",
            "reflectance": "reflectance of the sub-pixel",
            "area": "fraction of the panel's area",
        }
        place, points = ("state", "sub_pixel"), ("theta_deg", "wavelength_nm")
        dimensions = {"absorptance": (*place, "layer", *points), "reflectance": (*place, *points), "area": place}
        data: dict[str, Any] = {
            name: (dimensions[name], self._arrays[name].copy(), {"units": "1", "long_name": words}) for name, words in about.items()
        }
        coordinates: dict[str, Any] = {
            "state": ("state", self.states, {"long_name": "drive state"}),
            "sub_pixel": ("sub_pixel", self.sub_pixels, {"long_name": "sub-pixel"}),
            "layer": ("layer", list(numbers), {"long_name": "number of the layer in display.pixel.film"}),
            "material": ("layer", list(materials), {"long_name": "material of the layer"}),
            "theta_deg": ("theta_deg", self.theta_deg.copy(), {"units": "degree", "long_name": f"angle in {self._core.medium()}"}),
            "wavelength_nm": ("wavelength_nm", self.wavelength_nm.copy(), {"units": "nm", "long_name": "wavelength in vacuum"}),
        }
        return xarray.Dataset(data, coordinates, {"title": self.title} | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each state, sub-pixel, layer, angle and wavelength.

        Raises:
            ImportError: if pandas is not installed.
        """
        labels: dict[str, Any] = {
            "state": self.states,
            "sub_pixel": self.sub_pixels,
            "layer": [number for number, _ in self.layers],
            "theta_deg": self.theta_deg,
            "wavelength_nm": self.wavelength_nm,
        }
        place, points = ("state", "sub_pixel"), ("theta_deg", "wavelength_nm")
        dimensions = {"absorptance": (*place, "layer", *points), "reflectance": (*place, *points), "area": place}
        return long_table(labels, {name: (dimensions[name], self[name]) for name in _ARRAYS})

    def figures(self) -> dict[str, Figure]:
        """Returns the figure as ``absorption``."""
        return {"absorption": self.figure()}

    def figure(self) -> Figure:
        """Returns the figure: absorptances at the smallest angle as stacked areas."""
        return Figure("absorption", self._core.figure(self.title))

    def _files(self) -> dict[str, bytes]:
        return dict(self._core.tables())

    def __reduce__(self) -> tuple[Any, ...]:
        snapshot = _snapshots.pack(AbsorptionSnapshot.of(self._core, self.title))
        return _restored, (snapshot, self.title, self.warnings, self.notes)

    def __copy__(self) -> Absorption:
        return Absorption(self._core, self.title, self.warnings, self.notes)

    def __deepcopy__(self, memo: object) -> Absorption:
        return self.__copy__()  # its contents are immutable

    def _repr_html_(self) -> str:
        return self.figure().svg + _messages.as_html(self.warnings, self.notes)

    def __repr__(self) -> str:
        return f"<papilio.Absorption {self.title!r}: {len(self.layers)} layers, {self.theta_deg.size} angles>"


def _restored(content: bytes, title: str, warned: list[str], notes: list[str]) -> Absorption:
    return Absorption(_snapshots.unpack(content), title, warned, notes)


def absorption(
    scenario: Scenario | str | PathLike[str],
    *,
    theta_deg: ArrayLike | None = None,
    set: Mapping[str, Any] | None = None,
) -> Absorption:
    """Computes which layer of a film pixel absorbs the light: the output of ``papilio pixel --absorption``.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        theta_deg: angles, ascending, 0 to 90 degrees; by default every 15 degrees.
        set: values to set in the scenario first, ``{path: value}``.

    Returns:
        An `Absorption`, with arrays over states, sub-pixels, layers, angles and wavelengths.

    Raises:
        ScenarioError: if the pixel is not a film.

    Warns:
        PapilioWarning: each warning about the scenario; ``warnings`` of the result contains it.

    Example:
        >>> absorbed = papilio.absorption("scenarios/indoor.toml")
        >>> absorbed.to_xarray().absorptance.sel(state="white", sub_pixel="green", layer="1", theta_deg=0).dims
        ('wavelength_nm',)
    """
    changed = read(scenario, set)
    angles = ascending("theta_deg", _THETA_DEG if theta_deg is None else theta_deg, 90.0)
    scene = changed._scene()
    core = _papilio.Absorption(scene, angles or [])
    _messages.warn(scene.warnings)
    return Absorption(core, changed.title, scene.warnings, scene.notes)
