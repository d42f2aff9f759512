"""Surfaces measured by their geometry: what ``papilio gonio`` writes."""

from __future__ import annotations

import io
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _messages, _papilio, _toml
from ._arguments import described
from ._storing import optional
from ._tables import long_table
from .errors import ArgumentError
from .scenario import _checked_path
from .running import Progress, checked_threads, reporting
from .spatial import _Written

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Surface", "gonio"]


class Surface(_Written):
    """A surface measured by its geometry: the output of ``papilio gonio``.

    By rays: ``found["theta_deg"]``, shape [inclination], are the inclinations of the light, and ``found["reflected"]``,
    ``found["transmitted"]`` and the other columns of ``totals.csv``, with their standard errors ``found["reflected_error"]``, have the shape
    [side, inclination]; sides are above, below. ``found["scattered"]`` and the other arrays of ``face.npz`` are the kernel, shape
    [band of arrival, band of departure, azimuth]. With ``azimuth_deg``, ``found["phi_deg"]`` are the azimuths of the light,
    ``found["reflected_by_azimuth"]`` and so on have the shape [side, inclination, azimuth], and ``found["scattered_by_azimuth"]`` has the shape
    [band of arrival, its azimuth, band of departure, its azimuth]. By waves: ``found["wavelength_nm"]``, ``found["straight"]``, ``found["mirror"]``, ``found["haze"]``
    and the other columns of ``waves.csv`` but ``reflected`` and ``transmitted`` have the shape [wavelength] and are those of light along the normal from above; "haze_closed_form" is NaN
    without one. Those of all inclinations are ``found["waves_haze"]`` and so on, shape [side, inclination, wavelength], with ``found["waves_theta_deg"]``,
    shape [inclination]; NaN, or "" in "waves_holds", where nothing is transmitted. Arrays are read-only. It can be copied and pickled.
    """

    _FILE = "audit.json"

    def __init__(
        self,
        text: str,
        totals: bytes | None,
        by_azimuth: bytes | None,
        face: bytes | None,
        figures: list[tuple[str, str]],
        title: str,
        notes: list[str],
    ) -> None:
        written = {"totals.csv": totals, "totals_by_azimuth.csv": by_azimuth, "face.npz": face}
        tables = [(name, content) for name, content in written.items() if content is not None]
        super().__init__(text, {}, figures, title, [], notes, tables)
        self._face = face
        arrays: dict[str, NDArray[Any]] = {}
        if totals is not None and face is not None:
            arrays |= _by_inclination(totals)
            with np.load(io.BytesIO(face), allow_pickle=False) as kernel:
                # Those of one number or text are in ``data``.
                arrays |= {name: kernel[name] for name in kernel.files if name not in ("format", "hash", "index")}
            if by_azimuth is not None:
                # Names that both have are those of the kernel, as without azimuths.
                arrays = _by_azimuth(by_azimuth, arrays["phi_deg"].size) | arrays
        if self.data["waves"]:
            arrays |= _by_waves(self.data["waves"])
        for one in arrays.values():
            one.flags.writeable = False
        self._arrays = arrays

    def _axes(self) -> dict[str, tuple[str, ...]]:
        """Returns the axes of each array."""
        inclinations = self._arrays.get("theta_deg", np.empty(0)).size
        azimuths = self._arrays.get("phi_deg", np.empty(0)).size
        nm = self._arrays.get("wavelength_nm", np.empty(0)).size
        of_waves = self._arrays.get("waves_theta_deg", np.empty(0)).size
        known: dict[tuple[int, ...], tuple[str, ...]] = {
            (nm,): ("wavelength_nm",),
            (2, of_waves, nm): ("side", "waves_theta_deg", "wavelength_nm"),
            (2, inclinations): ("side", "theta_deg"),
            (2, inclinations, azimuths): ("side", "theta_deg", "phi_deg"),
        }
        own = ("theta_deg", "phi_deg", "wavelength_nm", "waves_theta_deg", "beta_above", "beta_below", "dphi_deg")
        axes: dict[str, tuple[str, ...]] = {}
        for name, values in self._arrays.items():
            if name in own:
                axes[name] = (name,)
            elif name in ("scattered", "error") or name.startswith("scattered_by_azimuth"):
                turned = ("arrival_band", "departure_band", "turn")
                axes[name] = turned if values.ndim == 3 else ("arrival_band", "arrival_azimuth", "departure_band", "departure_azimuth")
            else:
                axes[name] = known.get(values.shape, ("band",) if values.ndim == 1 else tuple(f"{name}_{at}" for at in range(values.ndim)))
        return axes

    def to_xarray(self) -> xarray.Dataset:
        """Returns all numbers as a Dataset over the side of the light, its inclination, azimuth and wavelength, and the bands of the kernel.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        axes = self._axes()
        named = {name: (axes[name], values.copy(), _about(name)) for name, values in self._arrays.items()}
        coordinates: dict[str, Any] = {name: one for name, one in named.items() if axes[name] == (name,)}
        coordinates["side"] = ("side", ["above", "below"], {"long_name": "side of the light"})
        data = {name: one for name, one in named.items() if name not in coordinates}
        return xarray.Dataset(data, coordinates, {"title": self.title} | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the table of ``totals.csv``, or without rays that of ``waves.csv``: a row for each side and inclination of the light (and wavelength).

        Raises:
            ImportError: if pandas is not installed.
        """
        axes = self._axes()
        over = ("side", "theta_deg") if "theta_deg" in self._arrays else ("side", "waves_theta_deg", "wavelength_nm")
        labels: dict[str, Any] = {"side": ["above", "below"]} | {name: self._arrays[name] for name in over[1:]}
        return long_table(labels, {name: (over, one) for name, one in self._arrays.items() if axes[name] == over})

    def face(self) -> bytes | None:
        """Returns the content of ``face.npz``, a layer of a display (key ``file``); None without rays."""
        return self._face

    def __repr__(self) -> str:
        roads = [name for name, there in (("rays", self._face is not None), ("waves", bool(self.data["waves"]))) if there]
        return f"<papilio.Surface {self.title!r}: by {' and '.join(roads)}>"


def gonio(
    surface: str | PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    preview: bool = False,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Surface:
    """Measures a surface by its geometry: the output of ``papilio gonio``.

    Args:
        surface: path of a file with the table ``[microgeometry]``.
        set: values to set first, ``{key: value}`` with keys such as "microgeometry.rms_nm".
        preview: whether to follow a ninth of the rays.
        threads: number of threads; None: one for each processor. The results do not depend on it.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        Reflected and transmitted light, the kernel, and what waves do, by name.

    Raises:
        ScenarioError: for mistakes in the file, with their places.
        ArgumentError: if the surface cannot be measured, or its rays contradict reciprocity or the conservation of energy.
        KeyboardInterrupt: on Ctrl-C.

    Example:
        >>> found = papilio.gonio("surfaces/hemispheres.toml", set={"microgeometry.rays": 640})
        >>> found["transmitted"].shape == (2, found["theta_deg"].size)
        True
        >>> bool((found["reflected"] + found["transmitted"] < 1 + 1e-9).all())
        True
    """
    path = _checked_path("surface", surface)
    if set is not None and not isinstance(set, Mapping):
        raise ArgumentError(f"set: expected a dict of paths and values, not {described(set)}")
    if not isinstance(preview, bool):
        raise ArgumentError(f"preview: expected True or False, not {described(preview)}")
    overrides = [f"{key}={_toml.inline(_toml.plain(value, str(key)))}" for key, value in (set or {}).items()]
    with reporting(progress, "parts") as tell:
        core = _papilio.Surface(path, overrides, preview, Path(path).name, checked_threads(threads), tell)
    return Surface(core.json(), core.totals(), core.totals_by_azimuth(), core.face(), core.figures(), core.title, core.notes())


def _about(name: str) -> dict[str, str]:
    """Returns the unit and long name of an array."""
    ends = {"_deg": "degree", "_nm": "nm"}
    units = next((unit for end, unit in ends.items() if name.endswith(end)), "1")
    kind = "standard error: " if name.endswith("_error") and name != "error" else ""
    quantity = name.removesuffix("_error") if kind else name
    return {"units": units, "long_name": kind + next((quantity.removesuffix(end) for end in ends if quantity.endswith(end)), quantity).replace("_", " ")}


def _by_inclination(totals: bytes) -> dict[str, NDArray[Any]]:
    """Returns the columns of ``totals.csv``, shape [side, inclination]."""
    columns = _columns(totals)
    return columns | {"theta_deg": columns["theta_deg"][0].copy()}


def _by_azimuth(totals: bytes, azimuths: int) -> dict[str, NDArray[Any]]:
    """Returns the columns of ``totals_by_azimuth.csv``, shape [side, inclination, azimuth]."""
    columns = {name: column for name, column in _columns(totals).items() if name not in ("theta_deg", "phi_deg")}
    named = {name.replace("_error", "") + "_by_azimuth" + "_error" * name.endswith("_error"): column for name, column in columns.items()}
    return {name: column.reshape(2, -1, azimuths) for name, column in named.items()}


def _columns(totals: bytes) -> dict[str, NDArray[Any]]:
    """Returns the columns of a file of totals but the first, shape [side, line]."""
    head, *lines = totals.decode().splitlines()
    names = head.split(",")[1:]
    # Its lines are those of light from above, then those of light from below.
    values = np.array([line.split(",")[1:] for line in lines], float).reshape(2, -1, len(names))
    return {name: values[:, :, column].copy() for column, name in enumerate(names)}


def _by_waves(rows: list[dict[str, Any]]) -> dict[str, NDArray[Any]]:
    """Returns the columns of ``waves.csv``: along the normal, shape [wavelength], and of all inclinations, shape [side, inclination, wavelength]."""

    def column(name: str, of: list[dict[str, Any]]) -> NDArray[Any]:
        values = [row[name] for row in of]
        if any(isinstance(value, str) for value in values):
            return np.array([value or "" for value in values])
        return np.array(values, float)

    along = [row for row in rows if row["from"] == "above" and row["theta_deg"] == 0]
    names = [name for name in rows[0] if name not in ("from", "theta_deg")]
    # Those of rays have the names `reflected` and `transmitted`; along the normal, both are Fresnel's.
    arrays = {name: column(name, along) for name in names if name not in ("reflected", "transmitted")}
    # The normal from above stands first, whether or not it is one of the inclinations.
    known = {(row["from"], row["theta_deg"], row["wavelength_nm"]): row for row in rows}
    theta_deg = list(dict.fromkeys(row["theta_deg"] for row in rows if row["from"] == "below"))
    every = [known[side, theta, row["wavelength_nm"]] for side in ("above", "below") for theta in theta_deg for row in along]
    shape = (2, len(theta_deg), len(along))
    arrays |= {f"waves_{name}": column(name, every).reshape(shape) for name in names if name != "wavelength_nm"}
    return arrays | {"waves_theta_deg": np.array(theta_deg, float)}
