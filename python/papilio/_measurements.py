"""Measured scattering as arrays: papilio's own format of a measurement (docs/bsdf-files.md), read and written."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arguments import described, one_of, reals, text
from ._snapshots import read_only
from ._storing import optional
from .errors import ArgumentError

if TYPE_CHECKING:
    import xarray

__all__ = ["Part", "dataset", "npz", "prefix", "read"]

_PARTS = ("front reflection", "front transmission", "back transmission", "back reflection")

#: Axes of each grid: the name in tables, the name in the file, the long name.
_AXES = {
    "specular": {
        "rotation_deg": ("rotations_deg", "rotation of the sample about its normal"),
        "incidence_deg": ("incidences_deg", "inclination of the light"),
        "azimuth_deg": ("azimuths_deg", "azimuth about the specular direction"),
        "radial_deg": ("radials_deg", "distance from the specular direction"),
    },
    "spherical": {
        "theta_i_deg": ("theta_i_deg", "inclination of the light"),
        "phi_i_deg": ("phi_i_deg", "azimuth of the light"),
        "theta_o_deg": ("theta_o_deg", "inclination of the viewer"),
        "phi_o_deg": ("phi_o_deg", "azimuth of the viewer"),
    },
}

#: Axes with a single value if they are left out.
_SINGLE = ("rotation_deg", "phi_i_deg")

#: Dimensions of cells that have numbers instead of angles.
_CELLS = {"patches": ("patch_in", "patch_out"), "half_angle": ("theta_h", "theta_d", "phi_d"), "pairs": ("pair",)}

#: Channels in order of preference for luminous values.
_LUMINOUS = ("monochrome", "Y", "green")


class Part(NamedTuple):
    """The values of one mode of scattering."""

    name: str
    geometry: str
    channels: list[str]
    #: Names of the axes, and their angles; indices for cells without a grid.
    axes: dict[str, NDArray[np.float64]]
    #: BSDF, 1/sr, shape [channel, axes...].
    values: NDArray[np.float64]
    #: Coordinates along the first axis, of pairs of directions.
    directions: dict[str, NDArray[np.float64]]

    @property
    def luminous(self) -> int:
        """Index of the luminous channel: monochrome, else Y, else green, else the wavelength nearest to 555 nm."""
        for name in _LUMINOUS:
            if name in self.channels:
                return self.channels.index(name)
        off = [abs(float(name) - 555.0) if name.replace(".", "", 1).isdigit() else np.inf for name in self.channels]
        return int(np.argmin(off))


def prefix(name: str) -> str:
    """Returns the name of a part in files and tables."""
    return name.replace(" ", "_")


def read(content: bytes) -> dict[str, Part]:
    """Reads the parts of a measurement."""
    found = {}
    with np.load(io.BytesIO(content)) as arrays:
        for about in json.loads(str(arrays["about"]))["parts"]:
            begin, kind = prefix(about["way"]), about["geometry"]
            values = np.asarray(arrays[f"{begin}_values"], dtype=np.float64)
            directions: dict[str, NDArray[np.float64]] = {}
            if kind in _AXES:
                axes = {name: np.asarray(arrays[f"{begin}_{stored}"]) for name, (stored, _) in _AXES[kind].items()}
            else:
                names = _CELLS.get(kind, tuple(f"cell_{i}" if i else "cell" for i in range(values.ndim - 1)))
                axes = {name: np.arange(float(length)) for name, length in zip(names, values.shape[1:], strict=True)}
            if kind == "pairs":
                rows = arrays[f"{begin}_pairs_deg"]
                directions = {name: rows[:, at] for at, name in enumerate(_AXES["spherical"])}
            found[about["way"]] = Part(about["way"], kind, list(about["channels"]), axes, read_only(values), directions)
    return found


def dataset(parts: Mapping[str, Part], attributes: Mapping[str, str]) -> xarray.Dataset:
    """Returns the parts as a Dataset."""
    with optional("xarray"):
        import xarray

    data: dict[str, Any] = {}
    coordinates: dict[str, Any] = {}
    for part in parts.values():
        if part.geometry in ("tree", "warped"):
            raise ArgumentError(f"{part.name}: the values have no grid of directions; Diffuser.evaluate interpolates them at any directions")
        own = {"channel": np.array(part.channels), **part.axes}
        dims = {}
        for name, values in own.items():
            known = coordinates.get(name)
            same = known is None or np.array_equal(known[1], values)
            dims[name] = name if same else f"{name}_{prefix(part.name)}"
            coordinates[dims[name]] = (dims[name], values, _about(part.geometry, name))
        for name, values in part.directions.items():
            coordinates[name] = (dims["pair"], values, _about("spherical", name))
        what = {"units": "1/sr", "long_name": f"BSDF of {part.name}, without a cosine", "geometry": part.geometry}
        data[prefix(part.name)] = (tuple(dims.values()), part.values.copy(), what)
    return xarray.Dataset(data, coordinates, attributes)


def _about(geometry: str, name: str) -> dict[str, str]:
    if name in _AXES.get(geometry, {}):
        return {"units": "degree", "long_name": _AXES[geometry][name][1]}
    return {"long_name": "channel: weighting, or wavelength in nm"} if name == "channel" else {"long_name": name.replace("_", " ")}


def npz(
    values: ArrayLike,
    axes: Mapping[str, ArrayLike],
    part: str,
    channels: Sequence[str | float] | None,
    media: tuple[float, float],
    sample: str,
) -> bytes:
    """Returns the file of a measurement on a grid; see `Diffuser.from_arrays`."""
    if not isinstance(axes, Mapping):
        raise ArgumentError(f"axes: expected a dict of names and angles, not {described(axes)}")
    kind = "specular" if "radial_deg" in axes else "spherical"
    known = _AXES[kind]
    unknown = [name for name in axes if name not in known]
    missing = [name for name in known if name not in axes and name not in _SINGLE]
    if unknown or missing:
        wrong = f"there is no axis {unknown[0]!r}" if unknown else f"{missing[0]} is missing"
        raise ArgumentError(f"axes: {wrong}; expected theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg, or rotation_deg, incidence_deg, azimuth_deg, radial_deg")
    angles = {name: _axis(name, axes.get(name, [0.0])) for name in known}
    numbers = reals("values", values, least=0.0, missing=True)
    names = ["monochrome"] if channels is None else _channels(channels)
    given = [len(angles[name]) for name in axes]
    whole = (len(names), *map(len, angles.values()))
    if list(axes) != [name for name in known if name in axes]:
        raise ArgumentError(f"axes: expected them in the order {', '.join(name for name in known if name in axes)}")
    if numbers.shape not in (tuple(given), (len(names), *given), whole[1:], whole) or (channels is not None and numbers.shape[0] != len(names)):
        raise ArgumentError(f"values: expected shape {(len(names), *given) if channels is not None else tuple(given)}, not {numbers.shape}")
    begin = prefix(one_of("part", part, _PARTS))
    geometry: dict[str, Any] = {"geometry": kind}
    if kind == "specular":
        geometry["plane_symmetrical"] = bool(angles["azimuth_deg"][0] >= 0 and angles["azimuth_deg"][-1] <= 180)
    about = {
        "format": "papilio-measurement",
        "version": 1,
        "media": [float(one) for one in reals("media", media, least=1.0)],
        "provenance": {"format": "arrays", "sample": text("sample", sample, "a name"), "source": "", "remarks": []},
        "parts": [{"way": part, "channels": names, **geometry}],
    }
    arrays: dict[str, Any] = {f"{begin}_{known[name][0]}": line for name, line in angles.items()}
    arrays[f"{begin}_values"] = np.ascontiguousarray(numbers.reshape(whole))
    arrays["about"] = np.array(json.dumps(about))
    out = io.BytesIO()
    np.savez(out, **arrays)
    return out.getvalue()


def _axis(name: str, angles: ArrayLike) -> NDArray[np.float64]:
    line = reals(f"axes[{name!r}]", angles)
    if line.ndim != 1 or not line.size or not (np.diff(line) > 0).all():
        raise ArgumentError(f"axes[{name!r}]: expected ascending angles in one dimension, not {described(angles)}")
    return line


def _channels(channels: Sequence[str | float]) -> list[str]:
    if isinstance(channels, str) or not isinstance(channels, (list, tuple, np.ndarray)) or not len(channels):
        raise ArgumentError(f"channels: expected a list of names or wavelengths, not {described(channels)}")
    return [one if isinstance(one, str) else f"{float(reals('channels', one, least=30.0)):g}" for one in channels]
