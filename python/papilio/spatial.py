"""Sharpness, crosstalk and sparkle: what ``papilio mtf``, ``papilio crosstalk`` and ``papilio sparkle`` write."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from . import _messages, _metadata, _papilio
from ._arguments import one_of, whole
from ._mapping import ByName
from ._snapshots import read_only
from ._storing import Stored, optional
from ._tables import long_table
from .figure import Figure
from .running import Progress, checked_threads, reporting, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Crosstalk", "Mtf", "Sparkle", "crosstalk", "mtf", "sparkle"]

_Arrays = Mapping[str, NDArray[Any]]


class _Written(Stored, ByName[NDArray[Any]]):
    """Contents of a file, arrays by name, and figures. Arrays are read-only."""

    #: Name of the program's file.
    _FILE: ClassVar[str]

    def __init__(
        self,
        text: str,
        arrays: _Arrays,
        figures: Iterable[tuple[str, str]],
        title: str,
        warned: Sequence[str],
        notes: Sequence[str],
        tables: Iterable[tuple[str, bytes]] = (),
    ) -> None:
        self._text, self._arrays = text, {name: read_only(one) for name, one in arrays.items()}
        self._figures, self._tables = list(figures), dict(tables)
        #: The scenario's title.
        self.title = title
        #: Warnings; each was also raised as a `papilio.PapilioWarning` by the computation.
        self.warnings = list(warned)
        #: Notes on data that were measured, assumed or scaled.
        self.notes = list(notes)

    def _names(self) -> Iterable[str]:
        return self._arrays

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Returns a number by its name; see the class.

        Raises:
            KeyError: if there is no such number.
        """
        if name not in self._arrays:
            raise KeyError(f"{name!r}: there is no such number; expected {', '.join(self._arrays)}")
        return self._arrays[name]

    def to_json(self) -> str:
        """Returns the text of the program's file, identical byte for byte."""
        return self._text

    def _files(self) -> dict[str, bytes]:
        return {self._FILE: self._text.encode(), **self._tables}

    @cached_property
    def data(self) -> dict[str, Any]:
        """The contents of the program's file; None where a number is undefined."""
        return dict(json.loads(self._text))

    def figures(self) -> dict[str, Figure]:
        """Returns the program's figures, by name.

        Returns:
            Figures with ``svg``, ``png()`` and ``save(path)``; a notebook shows them.
        """
        return {name: Figure(name, svg) for name, svg in self._figures}

    def _repr_html_(self) -> str:
        return "".join(svg for _, svg in self._figures[:1]) + _messages.as_html(self.warnings, self.notes)


class _OfViews(_Written):
    """Contents of a file with numbers of each view."""

    @cached_property
    def views(self) -> list[tuple[float, float]]:
        """Inclination and azimuth of every view, degrees."""
        return [(view["theta_deg"], view["phi_deg"]) for view in self.data["views"]]

    def _angles(self) -> dict[str, Any]:
        """Coordinates of the views of a Dataset."""
        angles = zip(("theta_deg", "phi_deg"), np.array(self.views).reshape(-1, 2).T, strict=True)
        return {name: ("view", values, _metadata.angle(name)) for name, values in angles}

    def _size(self) -> str:
        return f"{len(self.views)} view{'s' if len(self.views) > 1 else ''}"


class Mtf(_OfViews):
    """Sharpness of a display: the output of ``papilio mtf``.

    ``found["f50_x_per_mm"]`` and all other numbers of a state have the shape [view, state], or [view, state, frequency];
    ``found["white.f50_x_per_mm"]`` is that of one state. ``found["line_contrast.white_1_x"]`` and all other numbers of all states
    together have the shape [view]. ``error.f50_x_per_mm`` is the error of ``f50_x_per_mm``. NaN where a number is undefined. Arrays are
    read-only. It can be copied and pickled.
    """

    _FILE = "mtf.json"

    def __init__(
        self,
        text: str,
        arrays: tuple[_Arrays, _Arrays],
        kernels: _Arrays,
        figures: Iterable[tuple[str, str]],
        title: str,
        warned: Sequence[str],
        notes: Sequence[str],
        tables: Iterable[tuple[str, bytes]],
    ) -> None:
        together, alone = arrays
        super().__init__(text, {**together, **alone}, figures, title, warned, notes, tables)
        self._of_states = frozenset(alone)
        self._kernels = {state: read_only(one) for state, one in kernels.items()}

    @property
    def states(self) -> list[str]:
        """The names of the drive states."""
        return list(self._kernels)

    @cached_property
    def frequency_per_mm(self) -> NDArray[np.float64]:
        """Spatial frequencies in the plane of the panel, cycles per mm."""
        return read_only(np.array(self.data["frequency_per_mm"]))

    @cached_property
    def cycles_per_degree(self) -> NDArray[np.float64]:
        """The same for the eye at ``viewer.distance_mm``, cycles per degree."""
        return read_only(np.array(self.data["cycles_per_degree"]))

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Returns a number by its name; see the class.

        Raises:
            KeyError: if there is no such number.
        """
        for at, state in enumerate(self.states if isinstance(name, str) else ()):
            rest = name.removeprefix(f"{state}.")
            if rest != name and rest in self._of_states:
                return self._arrays[rest][:, at]
        return super().__getitem__(name)

    def otf(self, state: str, *, axis: str = "x", light: str = "all", view: int = 0) -> NDArray[np.complex128]:
        """Returns the optical transfer function of a state: its modulus is the MTF, its phase that about the view's own ray.

        Args:
            state: name of a drive state.
            axis: ``"x"`` (azimuth 0 deg) or ``"y"`` (90 deg).
            light: ``"all"``, ``"diffuse"``, ``"directed.0"``, ``"environment.0"``, ...
            view: index of the view, from 0.

        Returns:
            Complex array over ``frequency_per_mm``; 1 at frequency 0.

        Raises:
            ArgumentError: if there is no such state, axis, light or view.
        """
        one_of("axis", axis, ("x", "y"))
        states = self.data["views"][whole("view", view, 0, len(self.views) - 1)]["states"]
        one_of("state", state, list(states))
        lights = {"all": states[state]["otf"], **states[state]["by_light"]}
        one_of("light", light, list(lights))
        re, im = np.array(lights[light][f"otf_{axis}"]).T
        return np.asarray(re + 1j * im)

    def kernel(self, state: str) -> NDArray[np.float64]:
        """Returns the point spread of a state as a picture.

        Args:
            state: name of a drive state.

        Returns:
            Fraction of the light of the state in each cell, shape [view, y, x], y upwards; ``data`` has the side of a cell
            (``kernel.cell_um`` of the state) and the fraction outside.

        Raises:
            ArgumentError: if there is no such state.
        """
        return self._kernels[one_of("state", state, list(self._kernels))]

    def to_xarray(self) -> xarray.Dataset:
        """Returns all numbers but those of single lights as a Dataset over ``view``, ``state`` and ``frequency_per_mm``.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        of_states, data = ("view", "state", "frequency_per_mm", "part"), dict[str, Any]()
        for name, values in self._arrays.items():
            axes = of_states if name in self._of_states else ("view", "of_strokes")
            if not name.startswith("by_light."):
                data[_metadata.flat(name)] = (axes[: values.ndim], values.copy(), _metadata.attributes(name))
        coordinates: dict[str, Any] = {
            "state": ("state", self.states, _metadata.STATE),
            "frequency_per_mm": ("frequency_per_mm", self.frequency_per_mm.copy(), {"units": "mm-1", "long_name": "spatial frequency"}),
            "part": ("part", ["real", "imaginary"], {"long_name": "part of a complex number"}),
            "of_strokes": ("of_strokes", ["min", "median"], {"long_name": "smallest or median contrast of the strokes of text"}),
            **self._angles(),
        }
        return xarray.Dataset(data, coordinates, {"title": self.title} | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each view and state, and a column for each number; those of all states together are repeated.

        Raises:
            ImportError: if pandas is not installed.
        """
        labels: dict[str, Any] = {"view": range(len(self.views)), "state": self.states}
        axes = {name: ("view", "state") if name in self._of_states else ("view",) for name in self._arrays}
        return long_table(labels, {name: (axes[name], one) for name, one in self._arrays.items() if one.ndim == len(axes[name])})

    def __repr__(self) -> str:
        size = f"{self._size()}, {len(self.states)} states"
        return f"<papilio.Mtf {self.title!r}: {size}{_messages.summary(self.warnings)}>"


class Crosstalk(_OfViews):
    """Who lights whom: the output of ``papilio crosstalk``.

    ``found["out"]`` has the shape [view, window, subpixel], ``found["in"]`` (with a colour filter) [view, subpixel, window], and
    ``found["patterns.line_1.contrast_ratio"]`` and other numbers [view]. NaN where a number is undefined. Arrays are read-only. It can
    be copied and pickled.
    """

    _FILE = "crosstalk.json"

    @property
    def subpixels(self) -> list[str]:
        """The names of the sub-pixels, in the order of all shares."""
        return list(self.data["subpixels"])

    def to_xarray(self) -> xarray.Dataset:
        """Returns all numbers but those of single lights as a Dataset over ``view``, ``window`` and ``subpixel``.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        axes = {"in": ("view", "subpixel", "window"), "between_in": ("view", "subpixel")}
        data: dict[str, Any] = {}
        for name, values in self._arrays.items():
            if not name.startswith("by_light."):
                dims = axes.get(name, ("view", "window", "subpixel"))[: values.ndim]
                data[_metadata.flat(name)] = (dims, values.copy(), _metadata.attributes(name))
        coordinates: dict[str, Any] = {
            "window": ("window", self.subpixels, {"long_name": "window through which light is seen"}),
            "subpixel": ("subpixel", self.subpixels, {"long_name": "sub-pixel that light left"}),
            **self._angles(),
        }
        return xarray.Dataset(data, coordinates, {"title": self.title} | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each view, window and sub-pixel, and a column for each number; numbers of a view are repeated.

        Raises:
            ImportError: if pandas is not installed.
        """
        labels: dict[str, Any] = {"view": range(len(self.views)), "window": self.subpixels, "subpixel": self.subpixels}
        axes = ("view", "window", "subpixel")
        kept = {name: one for name, one in self._arrays.items() if name == "out" or one.ndim == 1}
        return long_table(labels, {name: (axes[: one.ndim], one) for name, one in kept.items()})

    def __repr__(self) -> str:
        size = f"{self._size()}, {len(self.subpixels)} sub-pixels"
        return f"<papilio.Crosstalk {self.title!r}: {size}{_messages.summary(self.warnings)}>"


class Sparkle(_Written):
    """Sparkle of a display: the output of ``papilio sparkle``.

    ``found["ppd"]`` and all other numbers have the shape [row]: one row for each view, gap and correlation length of the face. Arrays are
    read-only. It can be copied and pickled.
    """

    _FILE = "sparkle.json"

    def to_xarray(self) -> xarray.Dataset:
        """Returns all numbers as a Dataset over ``row``.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        data = {name: ("row", values.copy(), _metadata.attributes(name)) for name, values in self._arrays.items()}
        return xarray.Dataset(data, attrs={"title": self.title} | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the table of ``sparkle.csv``.

        Raises:
            ImportError: if pandas is not installed.
        """
        with optional("pandas"):
            import pandas

        return pandas.DataFrame(dict(self._arrays))

    def __repr__(self) -> str:
        return f"<papilio.Sparkle {self.title!r}: {len(self.data['rows'])} rows{_messages.summary(self.warnings)}>"


def mtf(
    scenario: Scenario | str | PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Mtf:
    """Computes how sharp a display is: the output of ``papilio mtf``.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        set: values to set in the scenario first, ``{key: value}`` with keys such as "display.glass.thickness_mm".
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        Modulation transfer, spreads and contrasts of lines and text, by name.

    Raises:
        ScenarioError: for mistakes in the scenario, and lengths that are missing, with their places.
        DisplayError: if the display cannot be computed.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> sharp = papilio.mtf("scenarios/matrix.toml", set={"spectrum.step_nm": 20})
        >>> sharp["f50_x_per_mm"].shape, sharp["white.f50_x_per_mm"].shape
        ((1, 8), (1,))
        >>> complex(sharp.otf("white")[0])
        (1+0j)
    """
    changed = read(scenario, with_solver(set))
    scene = changed._scene()
    with reporting(progress, "views") as tell:
        core = _papilio.Mtf(scene, checked_threads(threads), tell)
    text = core.json()
    states = list(json.loads(text)["views"][0]["states"])
    kernels = {state: core.kernel(state) for state in states}
    warned = _messages.merged(scene.warnings, core.warnings())
    found = Mtf(text, core.arrays(), kernels, core.figures(changed.title), changed.title, warned, scene.notes, core.tables())
    _messages.warn(found.warnings)
    return found


def crosstalk(
    scenario: Scenario | str | PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Crosstalk:
    """Computes which sub-pixel lights which: the output of ``papilio crosstalk``.

    Args:
        scenario: a `Scenario`, or the path of a scenario file, with ``[display.matrix]``.
        set: values to set in the scenario first, ``{key: value}`` with keys such as "display.glass.thickness_mm".
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        Shares of light, and the gamut and contrast of patterns, by name.

    Raises:
        ScenarioError: for mistakes in the scenario, and lengths that are missing, with their places.
        DisplayError: if the display cannot be computed.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> shares = papilio.crosstalk("scenarios/matrix.toml", set={"spectrum.step_nm": 20})
        >>> shares["out"].shape, shares.subpixels
        ((1, 3, 3), ['red', 'green', 'blue'])
        >>> bool((abs(shares["out"].sum(axis=2) - 1) < 1e-9).all())
        True
    """
    changed = read(scenario, with_solver(set))
    scene = changed._scene()
    with reporting(progress, "views") as tell:
        core = _papilio.Crosstalk(scene, checked_threads(threads), tell)
    warned = _messages.merged(scene.warnings, core.warnings())
    found = Crosstalk(core.json(), core.arrays(), core.figures(changed.title), changed.title, warned, scene.notes, core.tables())
    _messages.warn(found.warnings)
    return found


def sparkle(
    scenario: Scenario | str | PathLike[str],
    *,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Sparkle:
    """Computes the sparkle of a display below an antiglare face: the output of ``papilio sparkle``.

    Args:
        scenario: a `Scenario`, or the path of a scenario file, with the table ``[sparkle]``.
        seed: integer that selects the random faces; None: that of the scenario.
        set: values to set in the scenario first, ``{key: value}`` with keys such as "sparkle.correlation_um".
        threads: number of threads; None: one for each processor. The results do not depend on it.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        The pixel power deviation and its terms, with standard errors, by name: one row for each view, gap and correlation length.

    Raises:
        ScenarioError: for mistakes in the scenario, and lengths that are missing, with their places.
        ArgumentError: if the scenario describes no antiglare face.
        DisplayError: if sparkle cannot be estimated.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> glitter = papilio.sparkle("scenarios/antiglare.toml", set={"sparkle.replicates": 4, "sparkle.correlation_um": [40, 60]})
        >>> glitter["ppd"].shape, bool((glitter["ppd"] > 0.001).all())
        ((2,), True)
    """
    changed = read(scenario, with_solver(set, None, seed))
    scene = changed._scene()
    with reporting(progress, "views") as tell:
        core = _papilio.Sparkle(scene, changed.title, checked_threads(threads), tell)
    found = Sparkle(core.json(), core.arrays(), core.figures(changed.title), changed.title, scene.warnings, scene.notes, core.tables())
    _messages.warn(found.warnings)
    return found
