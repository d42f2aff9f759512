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

from . import _messages, _papilio
from ._arguments import ascending, reals
from ._snapshots import read_only
from ._mapping import ByName
from .errors import ArgumentError
from .running import Progress, checked_progress, checked_threads, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
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
    "theta_o_deg": ("degree", "inclination of the viewer"),
    "dphi_deg": ("degree", "azimuth of the viewer minus that of the light; symmetric about 0"),
    "wavelength_nm": ("nm", "wavelength in air"),
}
_SHARES = ("returned", "mirror", "haze", "lambertian", "beyond_2_5_deg")


class Brdf:
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
        #: Inclinations of the viewer, degrees.
        self.theta_o_deg: NDArray[np.float64] = read_in["theta_o_deg"]
        #: Azimuths of the viewer minus those of the light, degrees: 0 is the side of the light, 180 that of the mirror direction.
        self.dphi_deg: NDArray[np.float64] = read_in["dphi_deg"]
        #: Wavelengths in air, nm.
        self.wavelength_nm: NDArray[np.float64] = read_in["wavelength_nm"]
        #: Scattered light, dL_o/dE_i in 1/sr, shape [state, theta_i, theta_o, dphi, wavelength], single precision.
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

    def to_xarray(self) -> xarray.Dataset:
        """Returns all arrays as a Dataset over ``state``, ``theta_i_deg``, ``theta_o_deg``, ``dphi_deg`` and ``wavelength_nm``.

        Raises:
            ImportError: if xarray is not installed.
        """
        import xarray

        inner = {"brdf": tuple(_AXES), "specular": ("theta_i_deg", "wavelength_nm")}
        inner["directional_hemispherical"] = inner["specular"]
        data = {
            name: (("state", *inner[name]), getattr(self, name).copy(), {"units": unit, "long_name": words})
            for name, (unit, words) in _ARRAYS.items()
        }
        coordinates: dict[str, Any] = {
            name: (name, getattr(self, name).copy(), {"units": unit, "long_name": words}) for name, (unit, words) in _AXES.items()
        }
        coordinates["state"] = ("state", self.states, {"long_name": "drive state"})
        about = {key: self.about[key] for key in ("papilio", "title", "hash")}
        messages = _messages.attributes(self.warnings, self.notes)
        return xarray.Dataset(data, coordinates, about | {"missed": self.missed} | messages)

    def save(self, path: str | PathLike[str]) -> None:
        """Writes ``display-bsdf.npz``, identical to the program's file byte for byte."""
        Path(path).write_bytes(self._content)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._content, self.missed, self.warnings, self.notes)

    def __repr__(self) -> str:
        directions = f"{self.theta_i_deg.size} x {self.theta_o_deg.size} x {self.dphi_deg.size} directions"
        size = f"{len(self.states)} states, {directions}, {self.wavelength_nm.size} wavelengths"
        return f"<papilio.Brdf {self.about['title']!r}: {size}{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        """A summary with warnings and notes, as HTML."""
        return f"<p>{html.escape(repr(self))}</p>{_messages.as_html(self.warnings, self.notes)}"


class Reflection(ByName[NDArray[np.float64]]):
    """Mirror, haze and Lambertian parts of the reflection of a display, as luminous fractions; see `reflection`.

    Arrays are read-only.
    """

    def __init__(self, text: str, warned: Sequence[str] = (), notes: Sequence[str] = ()) -> None:
        self._text = text
        rows = [line.split(",") for line in text.splitlines()[1:]]
        #: Inclinations of the beam, degrees.
        self.theta_deg: NDArray[np.float64] = read_only(np.array(list(dict.fromkeys(float(row[0]) for row in rows))))
        #: The names of the drive states.
        self.states = list(dict.fromkeys(row[1] for row in rows))
        numbers = np.array([[float(cell) if cell else np.nan for cell in row[2:]] for row in rows], dtype=np.float64)
        self._shares: NDArray[np.float64] = read_only(numbers.reshape(self.theta_deg.size, len(self.states), len(_SHARES)))
        #: Warnings; each was also raised as a `papilio.PapilioWarning` by the computation.
        self.warnings = list(warned)
        #: Notes on data that were measured, assumed or scaled.
        self.notes = list(notes)

    def _names(self) -> Iterable[str]:
        return _SHARES

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Returns ``returned`` (the fraction of the beam that leaves), its parts ``mirror``, ``haze`` and ``lambertian``, or ``beyond_2_5_deg`` (a
        fraction of the leaving light), shape [theta, state].

        Raises:
            KeyError: if there is no such part.
        """
        if name not in _SHARES:
            raise KeyError(f"{name!r}: there is no such part; expected {', '.join(_SHARES)}")
        return self._shares[..., _SHARES.index(name)]

    def to_xarray(self) -> xarray.Dataset:
        """Returns all parts as a Dataset over ``theta_deg`` and ``state``.

        Raises:
            ImportError: if xarray is not installed.
        """
        import xarray

        data = {name: (("theta_deg", "state"), self[name].copy(), {"units": "1"}) for name in _SHARES}
        theta = ("theta_deg", self.theta_deg.copy(), {"units": "degree", "long_name": "inclination of the beam"})
        messages = _messages.attributes(self.warnings, self.notes)
        return xarray.Dataset(data, {"theta_deg": theta, "state": ("state", self.states)}, messages)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._text, self.warnings, self.notes)

    def __repr__(self) -> str:
        size = f"{self.theta_deg.size} inclinations, states {', '.join(self.states)}"
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
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
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
        dphi_deg: azimuths of the viewer minus those of the light, ascending, 0 to 180 degrees.
        set: values to set in the scenario first, ``{path: value}``.
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second.
        allow_error: rows with a larger relative error are refused; None: the scenario's target.

    Raises:
        ArgumentError: if an argument is invalid; the message names it; or if the table would have more than 1e8 numbers.
        ScenarioError, DisplayError, KeyboardInterrupt: as for `papilio.run`.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.
    """
    changed = read(scenario, with_solver(set))
    request = _TableRequest(
        changed,
        ascending("theta_i_deg", theta_i_deg, below=90.0),
        ascending("theta_o_deg", theta_o_deg, below=90.0),
        ascending("dphi_deg", dphi_deg, most=180.0),
        checked_threads(threads),
        checked_progress(progress),
        allow_error,
    )
    found, finer = request.table(_FIRST_STEP_DEG if step_deg is None else _checked_step(step_deg))
    while step_deg is None and finer is not None:
        found, finer = request.table(finer)
    _messages.warn(found.warnings)
    return found


#: The initial step, which is that of ``papilio brdf``.
_FIRST_STEP_DEG = 5.0


def _checked_step(step_deg: float) -> float:
    step = float(reals("step_deg", step_deg, least=0.01, most=90.0))
    if abs(90.0 / step - round(90.0 / step)) >= 1e-9:
        raise ArgumentError(f"step_deg: expected a divisor of 90 degrees, not {step_deg!r}")
    return step


class _TableRequest(NamedTuple):
    """A display, the specified directions, and the options of the computation."""

    scenario: Scenario
    theta_i_deg: list[float] | None
    theta_o_deg: list[float] | None
    dphi_deg: list[float] | None
    threads: int | None
    progress: Progress | None
    allow_error: float | None

    def table(self, step: float) -> tuple[Brdf, float | None]:
        """Computes the table with all other directions in steps; also returns a finer step if it is required and possible."""
        steps = round(90.0 / step)
        scene = self.scenario._scene()
        # The sum is only meaningful over uniform directions of the viewer.
        is_uniform = self.theta_o_deg is None and self.dphi_deg is None
        content, missed, warned, finer = _papilio.bsdf(
            scene,
            self.scenario.title,
            self.theta_i_deg or [step * i for i in range(steps)],
            self.theta_o_deg or [step * i for i in range(steps)],
            self.dphi_deg or [step * i for i in range(2 * steps + 1)],
            step if is_uniform else None,
            self.threads,
            self.progress,
            self.allow_error,
        )
        return Brdf(content, missed, _messages.merged(scene.warnings, warned), scene.notes), finer


def reflection(
    scenario: Scenario | str | PathLike[str],
    *,
    theta_deg: ArrayLike = (0.0, 8.0, 30.0, 45.0),
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Reflection:
    """Computes the mirror, haze and Lambertian parts (Kelley 1998) of reflected beams of the scene's light, as ``papilio brdf`` does.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        theta_deg: inclinations of the beams, ascending, 0 to less than 87 degrees.
        set: values to set in the scenario first, ``{path: value}``.
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second.

    Raises:
        ArgumentError: if an argument is invalid; the message names it.
        ScenarioError, DisplayError, KeyboardInterrupt: as for `papilio.run`.
    """
    scene = read(scenario, with_solver(set))._scene()
    thetas = ascending("theta_deg", theta_deg, below=87.0) or []
    text = _papilio.beams(scene, thetas, checked_threads(threads), checked_progress(progress))
    _messages.warn(scene.warnings)
    return Reflection(text.decode(), scene.warnings, scene.notes)
