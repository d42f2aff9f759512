"""Conoscopic maps: quantities over all viewing directions."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _messages, _metadata, _papilio, _snapshots
from ._arguments import ascending, reals
from ._snapshots import ConeSnapshot, read_only
from ._mapping import ByName
from ._storing import Stored, optional
from ._tables import long_table
from .errors import ArgumentError
from .figure import Figure
from .running import Progress, checked_threads, reporting, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Cone", "cone"]


class Cone(Stored, ByName[NDArray[np.float64]]):
    """A conoscopic map: photometric and colorimetric quantities (no spectra) over all directions.

    ``cone["contrast_ratio"]`` has the shape [phi, theta], ``cone["Y"]`` the shape [phi, theta, state]; NaN where
    a quantity is undefined. Arrays are read-only; ``cone[name].copy()`` is writable. It can be copied and pickled. A notebook shows
    the maps.
    """

    def __init__(
        self, core: _papilio.Cone | ConeSnapshot, title: str = "", warned: Sequence[str] = (), notes: Sequence[str] = ()
    ) -> None:
        self._core = core
        self._warnings_and_notes = _messages.merged(warned, core.warnings()), list(notes)
        #: The scenario's title.
        self.title = title

    @cached_property
    def theta_deg(self) -> NDArray[np.float64]:
        """Inclinations, degrees."""
        return read_only(self._core.theta_deg())

    @cached_property
    def phi_deg(self) -> NDArray[np.float64]:
        """Azimuths, degrees."""
        return read_only(self._core.phi_deg())

    @property
    def states(self) -> list[str]:
        """The names of the drive states."""
        return self._core.states()

    @property
    def warnings(self) -> list[str]:
        """Warnings; each was also raised as a `papilio.PapilioWarning` by the computation."""
        return list(self._warnings_and_notes[0])

    @property
    def notes(self) -> list[str]:
        """Notes on data that were measured, assumed or scaled."""
        return list(self._warnings_and_notes[1])

    @cached_property
    def _arrays(self) -> tuple[dict[str, NDArray[np.float64]], dict[str, NDArray[np.float64]]]:
        return _snapshots.read_only_arrays(self._core.arrays())

    def _names(self) -> Iterable[str]:
        together, alone = self._arrays
        return [*together, *alone]

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Returns a quantity by its name; see the class."""
        together, alone = self._arrays
        both = {**together, **alone}
        if name not in both:
            raise KeyError(f"{name!r}: there is no such quantity; expected {', '.join(both)}")
        return both[name]

    def to_xarray(self) -> xarray.Dataset:
        """Returns all quantities as a Dataset over ``phi_deg``, ``theta_deg`` and ``state``, with units and long names."""
        with optional("xarray"):
            import xarray

        together, alone = self._arrays
        data: dict[str, Any] = {}
        for dimensions, arrays in [(("phi_deg", "theta_deg"), together), (("phi_deg", "theta_deg", "state"), alone)]:
            for name, values in arrays.items():
                data[name] = (dimensions, values.copy(), _metadata.attributes(name))
        coordinates: dict[str, Any] = {
            "theta_deg": ("theta_deg", self.theta_deg.copy(), {"units": "degree", "long_name": "inclination of the view"}),
            "phi_deg": ("phi_deg", self.phi_deg.copy(), {"units": "degree", "long_name": "azimuth of the view"}),
            "state": ("state", self.states, {"long_name": "drive state"}),
        }
        return xarray.Dataset(data, coordinates, {"title": self.title} | _messages.attributes(*self._warnings_and_notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each direction and state; quantities of all states together are repeated.

        Raises:
            ImportError: if pandas is not installed.
        """
        together, alone = self._arrays
        labels: dict[str, Any] = {"phi_deg": self.phi_deg, "theta_deg": self.theta_deg, "state": self.states}
        views, states = ("phi_deg", "theta_deg"), ("phi_deg", "theta_deg", "state")
        return long_table(labels, {**{name: (views, one) for name, one in together.items()}, **{name: (states, one) for name, one in alone.items()}})

    def _files(self) -> dict[str, bytes]:
        return dict(self._core.files())

    def figures(self) -> dict[str, Figure]:
        """Returns the maps as ``cone``, and those of colour differences as ``cone_differences``; none if the directions do not span an area."""
        return {name: Figure(name, svg) for name, svg in self._core.figures(self.title)}

    def figure(self) -> Figure | None:
        """Returns the figure of the maps; None if the directions do not span an area."""
        return self.figures().get("cone")

    def _repr_html_(self) -> str:
        figure = self.figure()
        shown = html.escape(repr(self)) if figure is None else figure.svg
        return shown + _messages.as_html(*self._warnings_and_notes)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (_snapshots.pack(ConeSnapshot.of(self._core, self.title)), self.title, *self._warnings_and_notes)

    def __copy__(self) -> Cone:
        return Cone(self._core, self.title, *self._warnings_and_notes)

    def __deepcopy__(self, memo: object) -> Cone:
        return self.__copy__()  # its contents are immutable

    def __repr__(self) -> str:
        size = f"{self.theta_deg.size} x {self.phi_deg.size} directions"
        return f"<papilio.Cone {self.title!r}: {size}{_messages.summary(self._warnings_and_notes[0])}>"


def _restored(content: bytes, title: str, warned: list[str], notes: list[str]) -> Cone:
    return Cone(_snapshots.unpack(content), title, warned, notes)


def cone(
    scenario: Scenario | str | PathLike[str],
    *,
    theta_deg: ArrayLike | None = None,
    phi_deg: ArrayLike | None = None,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
    allow_error: float | None = None,
    reference_deg: tuple[float, float] = (0.0, 0.0),
) -> Cone:
    """Computes a conoscopic map: the output of ``papilio run --cone``.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        theta_deg: inclinations, ascending, 0 to less than 90 degrees; by default every degree.
        phi_deg: azimuths, ascending, 0 to less than 360 degrees; by default every 5 degrees.
        set: values to set in the scenario first, ``{key: value}`` with keys such as "viewer.field_deg".
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second, or True for a line on the terminal.
        allow_error: the largest accepted relative error of the radiance in a direction; None: the scenario's
            ``solver.relative_error``.
        reference_deg: inclination and azimuth of the direction with which the colour of each state is compared
            (``uv_shift``, ``delta_E_2000_with_angle``, ``delta_E_1976_with_angle``); by default the normal.

    Returns:
        The quantities by name, of shape [azimuth, inclination], or [azimuth, inclination, state] where they are of a state.

    Raises:
        ScenarioError: for mistakes in the scenario, with their places.
        ArgumentError: if an argument is invalid; the message names it.
        DisplayError: if a direction has a larger error than ``allow_error``, or the display cannot be computed.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> cone = papilio.cone("scenarios/indoor.toml", theta_deg=[0, 20, 40], phi_deg=[0, 90, 180, 270])
        >>> cone["contrast_ratio"].shape, cone["Y"].shape
        ((4, 3), (4, 3, 8))
    """
    changed = read(scenario, with_solver(set))
    scene = changed._scene()
    thetas = ascending("theta_deg", theta_deg, below=90.0)
    phis = ascending("phi_deg", phi_deg, below=360.0)
    reference = reals("reference_deg", reference_deg, least=-360.0, most=360.0)
    if reference.shape != (2,) or not 0 <= reference[0] < 90:
        raise ArgumentError(f"reference_deg: expected an inclination from 0 to below 90 and an azimuth, not {reference_deg!r}")
    direction = [float(angle) for angle in reference]
    with reporting(progress, "views") as tell:
        core = _papilio.Cone(scene, thetas, phis, checked_threads(threads), tell, allow_error, direction)
    found = Cone(core, changed.title, scene.warnings, scene.notes)
    _messages.warn(found.warnings)
    return found
