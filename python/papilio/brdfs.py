"""BSDF of a display, and the parts of its reflection."""

from __future__ import annotations

import html
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _messages, _papilio, plot
from ._arguments import ascending, reals
from ._snapshots import read_only
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

__all__ = ["Brdf", "Reflection", "brdf", "reflection"]

#: Names of arrays, with units and long names.
_ARRAYS = {
    "brdf": ("1/sr", "scattered light: dL_o/dE_i, without a cosine"),
    "specular": ("1", "fraction of a beam that leaves in the mirror direction"),
    "directional_hemispherical": ("1", "fraction of a beam that leaves in any direction, scattered and mirrored"),
}
_AXES = {
    "theta_i_deg": ("degree", "inclination of the light"),
    "phi_i_deg": ("degree", "azimuth of the light; the same at opposite azimuths"),
    "theta_o_deg": ("degree", "inclination of the viewer"),
    "dphi_deg": ("degree", "azimuth of the viewer minus that of the light; symmetric about 0 without azimuths of the light"),
    "wavelength_nm": ("nm", "wavelength in air"),
}
_WORDS = {
    "returned": "fraction of the beam that leaves",
    "mirror": "mirror part of the reflection, fraction of the beam",
    "haze": "haze part of the reflection, fraction of the beam",
    "lambertian": "Lambertian part of the reflection, fraction of the beam",
    "beyond_2_5_deg": "fraction of the leaving light beyond 2.5 deg from the mirror direction",
}
_SHARES = tuple(_WORDS)


class Brdf(Stored, ByName[NDArray[Any]]):
    """Spectral BSDF of a display in each of its states: the contents of ``display-bsdf.npz`` of ``papilio brdf``.

    ``about`` has the conventions. The page on BRDFs in the documentation of the program describes every array. Arrays are
    read-only; ``found.brdf.copy()`` is writable.
    """

    def __init__(self, content: bytes, missed: float, warned: Sequence[str] = (), notes: Sequence[str] = ()) -> None:
        self._content = content
        with np.load(io.BytesIO(content)) as arrays:
            read_in = {name: read_only(arrays[name]) for name in arrays.files}
        #: The names of the drive states.
        self.states = [str(name) for name in read_in["state"]]
        #: Inclinations of the light, degrees.
        self.theta_i_deg: NDArray[np.float64] = read_in["theta_i_deg"]
        #: Azimuths of the light, degrees from 0 to below 180: the values repeat after half a turn. None of a display that is isotropic
        #: in azimuth, whose arrays have no such axis.
        self.phi_i_deg: NDArray[np.float64] | None = read_in.get("phi_i_deg")
        #: Inclinations of the viewer, degrees.
        self.theta_o_deg: NDArray[np.float64] = read_in["theta_o_deg"]
        #: Azimuths of the viewer minus those of the light, degrees: 0 is the side of the light, 180 that of the mirror direction; over a
        #: whole turn with azimuths of the light.
        self.dphi_deg: NDArray[np.float64] = read_in["dphi_deg"]
        #: Wavelengths in air, nm.
        self.wavelength_nm: NDArray[np.float64] = read_in["wavelength_nm"]
        #: Scattered light, dL_o/dE_i in 1/sr, shape [state, theta_i, theta_o, dphi, wavelength], with phi_i after theta_i where there are
        #: azimuths of the light, here and in the next two; single precision.
        self.brdf: NDArray[np.float32] = read_in["brdf"]
        #: Fraction of a beam that leaves in the mirror direction, shape [state, theta_i, wavelength].
        self.specular: NDArray[np.float64] = read_in["specular"]
        #: Fraction of a beam that leaves in any direction, shape [state, theta_i, wavelength].
        self.directional_hemispherical: NDArray[np.float64] = read_in["directional_hemispherical"]
        #: Format, program, scenario, conventions and solver.
        self.about: dict[str, Any] = json.loads(str(read_in["about"]))
        #: Relative deviation of the sum over the directions from the light that leaves. Above 0.02, the directions are too few, and
        #: ``warnings`` reports it. If all directions were specified, it shows whether the table can be summed.
        self.missed = missed
        #: Warnings; each was also raised as a `papilio.PapilioWarning` by the computation.
        self.warnings = list(warned)
        #: Notes on data that were measured, assumed or scaled.
        self.notes = list(notes)

    def _axes(self) -> list[str]:
        """The names of the axes of ``brdf`` after the state."""
        return [name for name in _AXES if name != "phi_i_deg" or self.phi_i_deg is not None]

    def _of_beam(self) -> list[str]:
        """The names of the axes of numbers of a beam after the state."""
        return [name for name in self._axes() if name in ("theta_i_deg", "phi_i_deg", "wavelength_nm")]

    def _names(self) -> Iterable[str]:
        return _ARRAYS

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Returns ``brdf``, ``specular`` or ``directional_hemispherical``; the attributes of these names have their shapes.

        Raises:
            KeyError: if there is no such array.
        """
        if name not in _ARRAYS:
            raise KeyError(f"{name!r}: there is no such array; expected {', '.join(_ARRAYS)}")
        return np.asarray(getattr(self, name))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each state, pair of directions and wavelength; numbers of a beam are repeated.

        Raises:
            ImportError: if pandas is not installed.
        """
        labels: dict[str, Any] = {"state": self.states} | {name: getattr(self, name) for name in self._axes()}
        beam = ("state", *self._of_beam())
        return long_table(labels, {name: (tuple(labels) if name == "brdf" else beam, self[name]) for name in _ARRAYS})

    def figures(self) -> dict[str, Figure]:
        """Returns the BSDF of each state in the plane of incidence, at the wavelength nearest to 555 nm, for up to four beams (of the first
        azimuth of the light)."""
        nm = int(np.abs(self.wavelength_nm - 555.0).argmin())
        sides = [(at, sign) for at, dphi in enumerate(self.dphi_deg) for wanted, sign in ((0.0, -1.0), (180.0, 1.0)) if dphi == wanted]
        beams = np.unique(np.linspace(0, self.theta_i_deg.size - 1, 4).astype(int))
        brdf = self.brdf if self.phi_i_deg is None else self.brdf[:, :, 0]
        figures = {}
        files = _papilio.file_names(self.states, "brdf_", "")
        for s, state in enumerate(self.states if sides else ()):
            x: dict[str, Any] = {}
            y: dict[str, Any] = {}
            for beam in beams:
                name = f"light from {self.theta_i_deg[beam]:g} deg"
                theta = np.concatenate([sign * self.theta_o_deg for _, sign in sides])
                values = np.concatenate([brdf[s, beam, :, at, nm] for at, _ in sides])
                order = np.argsort(theta, kind="stable")
                x[name], y[name] = theta[order], values[order]
            title = f"{self.about['title']}: {state}, {self.wavelength_nm[nm]:g} nm"
            words: dict[str, Any] = {"x_label": "Viewing angle, mirror direction positive (deg)", "y_label": "BSDF (1/sr)", "title": title}
            drawn = plot.curves(x, y, logarithmic=all((one > 0).any() for one in y.values()), **words)
            figures[f"brdf_{state}"] = Figure(files[s], drawn.svg)
        return figures

    def to_xarray(self) -> xarray.Dataset:
        """Returns all arrays as a Dataset over ``state``, ``theta_i_deg``, ``phi_i_deg`` (if there are any), ``theta_o_deg``, ``dphi_deg``
        and ``wavelength_nm``.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        inner = {"brdf": tuple(self._axes()), "specular": tuple(self._of_beam())}
        inner["directional_hemispherical"] = inner["specular"]
        data = {
            name: (("state", *inner[name]), getattr(self, name).copy(), {"units": unit, "long_name": words})
            for name, (unit, words) in _ARRAYS.items()
        }
        coordinates: dict[str, Any] = {
            name: (name, getattr(self, name).copy(), {"units": unit, "long_name": words})
            for name, (unit, words) in _AXES.items()
            if name in self._axes()
        }
        coordinates["state"] = ("state", self.states, {"long_name": "drive state"})
        about = {key: self.about[key] for key in ("papilio", "title", "hash")}
        messages = _messages.attributes(self.warnings, self.notes)
        return xarray.Dataset(data, coordinates, about | {"missed": self.missed} | messages)

    def _files(self) -> dict[str, bytes]:
        return {"display-bsdf.npz": self._readable()}

    def _readable(self) -> bytes:
        """Returns the content of the file, if its azimuths cover the half circle that readers need; one azimuth stands for all."""
        azimuths = self.dphi_deg
        if self.phi_i_deg is not None:
            step = 360.0 / azimuths.size
            is_whole = azimuths.size % 2 == 0 and np.allclose(azimuths, step * np.arange(azimuths.size), atol=1e-6)
            if not is_whole or not np.allclose(self.phi_i_deg / step, np.round(self.phi_i_deg / step), atol=1e-6):
                raise ArgumentError(
                    "dphi_deg: a file needs an even number of azimuths in equal steps from 0 to below 360 deg, of which those of phi_i_deg "
                    "are multiples"
                )
            return self._content
        if azimuths.size > 1:
            # The azimuths may be the middles of cells.
            reach = [azimuths[0] - 0.5 * (azimuths[1] - azimuths[0]), azimuths[-1] + 0.5 * (azimuths[-1] - azimuths[-2])]
            if reach[0] > 0.03 or reach[1] < 179.97:
                raise ArgumentError(
                    f"dphi_deg: a file needs the azimuths of half a circle, 0 to 180 deg, or a single one; these are {azimuths[0]:g} to "
                    f"{azimuths[-1]:g} deg"
                )
        return self._content

    def save(self, folder: str | PathLike[str]) -> list[Path]:
        """Writes ``display-bsdf.npz``, identical to the program's file byte for byte, and the figures.

        Args:
            folder: a folder, which is created; or a path that ends with ``.npz``, where the file alone is written.

        Returns:
            The paths of the files.

        Raises:
            ArgumentError: if ``dphi_deg`` is part of a half circle, which no reader accepts.
        """
        return super().save(folder)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._content, self.missed, self.warnings, self.notes)

    def __repr__(self) -> str:
        axes = (self.theta_i_deg, self.phi_i_deg, self.theta_o_deg, self.dphi_deg)
        directions = " x ".join(str(axis.size) for axis in axes if axis is not None) + " directions"
        size = f"{len(self.states)} states, {directions}, {self.wavelength_nm.size} wavelengths"
        return f"<papilio.Brdf {self.about['title']!r}: {size}{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        """A summary with warnings and notes, as HTML."""
        return f"<p>{html.escape(repr(self))}</p>{_messages.as_html(self.warnings, self.notes)}"


class Reflection(Stored, ByName[NDArray[np.float64]]):
    """Mirror, haze and Lambertian parts of the reflection of a display, as luminous fractions; see `reflection`.

    Arrays are read-only.
    """

    def __init__(self, text: str, warned: Sequence[str] = (), notes: Sequence[str] = ()) -> None:
        self._text = text
        titles, *rows = [line.split(",") for line in text.splitlines()]
        at = titles.index("state")
        #: Inclinations of the beam, degrees.
        self.theta_deg: NDArray[np.float64] = read_only(np.array(list(dict.fromkeys(float(row[0]) for row in rows))))
        #: Azimuths of the beam, degrees; None of a display that is isotropic in azimuth, whose arrays have no such axis.
        self.phi_deg: NDArray[np.float64] | None = None
        if at == 2:
            self.phi_deg = read_only(np.array(list(dict.fromkeys(float(row[1]) for row in rows))))
        #: The names of the drive states.
        self.states = list(dict.fromkeys(row[at] for row in rows))
        numbers = np.array([[float(cell) if cell else np.nan for cell in row[at + 1 :]] for row in rows], dtype=np.float64)
        turned = () if self.phi_deg is None else (self.phi_deg.size,)
        self._shares: NDArray[np.float64] = read_only(numbers.reshape(self.theta_deg.size, *turned, len(self.states), len(_SHARES)))
        #: Warnings; each was also raised as a `papilio.PapilioWarning` by the computation.
        self.warnings = list(warned)
        #: Notes on data that were measured, assumed or scaled.
        self.notes = list(notes)

    def _names(self) -> Iterable[str]:
        return _SHARES

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Returns ``returned`` (the fraction of the beam that leaves), its parts ``mirror``, ``haze`` and ``lambertian``, or ``beyond_2_5_deg`` (a
        fraction of the leaving light), shape [theta, state], or [theta, phi, state] with azimuths of the beam.

        Raises:
            KeyError: if there is no such part.
        """
        if name not in _SHARES:
            raise KeyError(f"{name!r}: there is no such part; expected {', '.join(_SHARES)}")
        return self._shares[..., _SHARES.index(name)]

    def to_xarray(self) -> xarray.Dataset:
        """Returns all parts as a Dataset over ``theta_deg``, ``phi_deg`` (if there are any) and ``state``.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        axes = tuple(self._labels())
        data = {name: (axes, self[name].copy(), {"units": "1", "long_name": words}) for name, words in _WORDS.items()}
        coordinates: dict[str, Any] = {
            "theta_deg": ("theta_deg", self.theta_deg.copy(), {"units": "degree", "long_name": "inclination of the beam"}),
            "state": ("state", self.states, {"long_name": "drive state"}),
        }
        if self.phi_deg is not None:
            coordinates["phi_deg"] = ("phi_deg", self.phi_deg.copy(), {"units": "degree", "long_name": "azimuth of the beam"})
        messages = _messages.attributes(self.warnings, self.notes)
        return xarray.Dataset(data, coordinates, messages)

    def _labels(self) -> dict[str, Any]:
        """The axes of the arrays, by name."""
        turned: dict[str, Any] = {} if self.phi_deg is None else {"phi_deg": self.phi_deg}
        return {"theta_deg": self.theta_deg} | turned | {"state": self.states}

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each direction of the beam and state.

        Raises:
            ImportError: if pandas is not installed.
        """
        labels = self._labels()
        return long_table(labels, {name: (tuple(labels), self[name]) for name in _SHARES})

    def _files(self) -> dict[str, bytes]:
        return {"reflection.csv": self._text.encode()}

    def figures(self) -> dict[str, Figure]:
        """Returns the parts of each state over the inclination of the beam (of its first azimuth), by name; none for a single inclination."""
        figures = {}
        files = _papilio.file_names(self.states, "reflection_", "")
        for s, state in enumerate(self.states if self.theta_deg.size > 1 else ()):
            own = (slice(None), s) if self.phi_deg is None else (slice(None), 0, s)
            curves = {name: self[name][own] for name in ("returned", "mirror", "haze", "lambertian")}
            drawn = plot.curves(self.theta_deg, curves, x_label="Inclination of the beam (deg)", y_label="Fraction of the beam", title=state)
            figures[f"reflection_{state}"] = Figure(files[s], drawn.svg)
        return figures

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._text, self.warnings, self.notes)

    def __repr__(self) -> str:
        turned = "" if self.phi_deg is None else f"{self.phi_deg.size} azimuths, "
        size = f"{self.theta_deg.size} inclinations, {turned}states {', '.join(self.states)}"
        return f"<papilio.Reflection: {size}{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        """A summary with warnings and notes, as HTML."""
        return f"<p>{html.escape(repr(self))}</p>{_messages.as_html(self.warnings, self.notes)}"


def brdf(
    scenario: Scenario | str | PathLike[str],
    *,
    step_deg: float | None = None,
    theta_i_deg: ArrayLike | None = None,
    theta_o_deg: ArrayLike | None = None,
    dphi_deg: ArrayLike | None = None,
    phi_i_deg: ArrayLike | None = None,
    phi_step_deg: float | None = None,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
    allow_error: float | None = None,
) -> Brdf:
    """Computes the spectral BSDF of the display, without its environment, by adding: as ``papilio brdf`` does.

    Without ``step_deg``, the step is reduced from 5 degrees until the sum over the table's directions deviates by at most 0.02
    from the light that leaves (``missed``), or a finer table would have more than 1e8 numbers. This may take minutes and hundreds
    of megabytes; a larger ``spectrum.step_nm`` keeps the table small. A step that is too coarse causes a warning.

    Args:
        scenario: a `Scenario`, or the path of a scenario file; its light and viewer are ignored.
        step_deg: step of all directions that are not specified, a divisor of 90 degrees; None: as fine as necessary (5 if directions
            of the viewer are specified).
        theta_i_deg: inclinations of the light, ascending, 0 to less than 90 degrees.
        theta_o_deg: inclinations of the viewer, ascending, 0 to less than 90 degrees.
        dphi_deg: azimuths of the viewer minus those of the light, ascending, 0 to 180 degrees; 0 to below 360 where the display depends on
            azimuth, as above liquid crystals.
        phi_i_deg: azimuths of the light where the display depends on azimuth, ascending, 0 to below 180 degrees.
        phi_step_deg: step of those that are not specified, a divisor of 180 degrees; None: 15.
        set: values to set in the scenario first, ``{path: value}``.
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second, or True for a line on the terminal.
        allow_error: rows with a larger relative error are refused; None: the scenario's target.

    Returns:
        The BSDF of each state: arrays over state, directions and wavelengths, by name.

    Raises:
        ArgumentError: if an argument is invalid; the message names it; if azimuths of the light are given for a display that is isotropic in
            azimuth; or if the table would have more than 1e8 numbers.
        ScenarioError, DisplayError, KeyboardInterrupt: as for `papilio.run`.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> found = papilio.brdf("scenarios/indoor.toml", step_deg=30, set={"spectrum.step_nm": 50})
        >>> found["brdf"].shape
        (8, 3, 3, 7, 9)
    """
    changed = read(scenario, with_solver(set))
    inclinations = [ascending(name, angles, below=90.0) for name, angles in (("theta_i_deg", theta_i_deg), ("theta_o_deg", theta_o_deg))]
    azimuths = ascending("phi_i_deg", phi_i_deg, below=180.0)
    between = ascending("dphi_deg", dphi_deg, below=360.0)
    phi_step = None if phi_step_deg is None else _checked_phi_step(phi_step_deg)
    with reporting(progress, "views") as tell:
        depends = _papilio.bsdf_depends_on_azimuth(changed._scene(), checked_threads(threads), tell)
        if not depends:
            for name, given in (("phi_i_deg", azimuths), ("phi_step_deg", phi_step)):
                if given is not None:
                    raise ArgumentError(f"{name}: this display is the same at all azimuths of the light")
            between = ascending("dphi_deg", dphi_deg, most=180.0)
            around = None
        else:
            step = _PHI_STEP_DEG if phi_step is None else phi_step
            around = azimuths or [step * i for i in range(round(180.0 / step))]
        request = _TableRequest(changed, inclinations[0], around, inclinations[1], between, checked_threads(threads), allow_error)
        found, finer = request.table(_FIRST_STEP_DEG if step_deg is None else _checked_step(step_deg), tell)
        while step_deg is None and finer is not None:
            found, finer = request.table(finer, tell)
    _messages.warn(found.warnings)
    return found


#: The initial step, and that of the azimuths of the light, which are those of ``papilio brdf``.
_FIRST_STEP_DEG = 5.0
_PHI_STEP_DEG = 15.0


def _checked_phi_step(step_deg: float) -> float:
    step = float(reals("phi_step_deg", step_deg, least=0.5, most=90.0))
    if abs(180.0 / step - round(180.0 / step)) >= 1e-9:
        raise ArgumentError(f"phi_step_deg: expected a divisor of 180 degrees, not {step_deg!r}")
    return step


def _checked_step(step_deg: float) -> float:
    step = float(reals("step_deg", step_deg, least=0.01, most=90.0))
    if abs(90.0 / step - round(90.0 / step)) >= 1e-9:
        raise ArgumentError(f"step_deg: expected a divisor of 90 degrees, not {step_deg!r}")
    return step


class _TableRequest(NamedTuple):
    """A display, the specified directions, and the options of the computation."""

    scenario: Scenario
    theta_i_deg: list[float] | None
    #: None for a display that is isotropic in azimuth.
    phi_i_deg: list[float] | None
    theta_o_deg: list[float] | None
    dphi_deg: list[float] | None
    threads: int | None
    allow_error: float | None

    def table(self, step: float, tell: Progress | None) -> tuple[Brdf, float | None]:
        """Computes the table with all other directions in steps; also returns a finer step if it is required and possible."""
        steps = round(90.0 / step)
        scene = self.scenario._scene()
        # The sum is only meaningful over uniform directions of the viewer.
        is_uniform = self.theta_o_deg is None and self.dphi_deg is None
        content, missed, warned, finer = _papilio.bsdf(
            scene,
            self.scenario.title,
            self.theta_i_deg or [step * i for i in range(steps)],
            self.phi_i_deg or [],
            self.theta_o_deg or [step * i for i in range(steps)],
            self.dphi_deg or [step * i for i in range(2 * steps + 1 if self.phi_i_deg is None else 4 * steps)],
            step if is_uniform else None,
            self.threads,
            tell,
            self.allow_error,
        )
        return Brdf(content, missed, _messages.merged(scene.warnings, warned), scene.notes), finer


def reflection(
    scenario: Scenario | str | PathLike[str],
    *,
    theta_deg: ArrayLike = (0.0, 8.0, 30.0, 45.0),
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Reflection:
    """Computes the mirror, haze and Lambertian parts (Kelley 1998) of reflected beams of the scene's light, as ``papilio brdf`` does; where the
    display depends on azimuth, of beams from 0, 45, 90 and 135 deg.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        theta_deg: inclinations of the beams, ascending, 0 to less than 87 degrees.
        set: values to set in the scenario first, ``{path: value}``.
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        Fractions of each beam over inclination and state, by name.

    Raises:
        ArgumentError: if an argument is invalid; the message names it.
        ScenarioError, DisplayError, KeyboardInterrupt: as for `papilio.run`.

    Example:
        >>> papilio.reflection("scenarios/indoor.toml", theta_deg=[8, 30])["haze"].shape
        (2, 8)
    """
    scene = read(scenario, with_solver(set))._scene()
    thetas = ascending("theta_deg", theta_deg, below=87.0) or []
    with reporting(progress, "beams") as tell:
        text = _papilio.beams(scene, thetas, checked_threads(threads), tell)
    _messages.warn(scene.warnings)
    return Reflection(text.decode(), scene.warnings, scene.notes)
