"""Files of measured scattering: audit, fits of lobes, conversion to other formats."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _measurements, _messages, _papilio
from ._arguments import common_shape, one_of, reals, whole
from ._mapping import Lookup
from ._storing import Stored, optional
from .errors import ArgumentError, FileError
from .figure import Figure
from .scenario import _checked_path

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Diffuser", "lobe_names"]


def __dir__() -> list[str]:
    return __all__

#: Side of incidence, and reflection or transmission.
Part = Literal["front reflection", "front transmission", "back transmission", "back reflection"]

_FORMATS = ("bsdf", "csv", "xml", "npz")


def lobe_names() -> list[str]:
    """Returns the names of the analytic lobes that `Diffuser.fit` fits.

    Returns:
        The names, for its argument ``model``.

    Example:
        >>> "k-correlation (s = 3)" in papilio.diffuser.lobe_names()
        True
    """
    return _papilio.lobe_names()


class Diffuser(Stored, Lookup[NDArray[np.float64]]):
    """Measured scattering, from a file in any format that ``papilio diffuser`` reads (detected from its contents), or from arrays.

    ``foil["front transmission"]`` is the array of a part, BSDF in 1/sr with the channel first; `to_xarray` has its axes, `evaluate`
    interpolates it. In a scenario, a diffuser may stand where a file of measured scattering may: ``scenario["display.diffuser.file"] =
    foil``.

    Args:
        path: path of the file.

    Raises:
        FileError: if the file is invalid; with the position of the error.

    Warns:
        PapilioWarning: each suspicious but readable property of the file; ``warnings`` contains it.

    Example:
        >>> foil = papilio.diffuser.Diffuser("scenarios/data/H78.bsdf")
        >>> foil["front transmission"].shape
        (3, 1, 16, 19, 91)
    """

    def __init__(self, path: str | PathLike[str]) -> None:
        self._path: str | None = _checked_path("path", path)
        self._core: _papilio.Diffuser
        self._core = _papilio.Diffuser(_checked_path("path", path))
        _messages.warn(self.warnings)

    @classmethod
    def from_arrays(
        cls,
        values: ArrayLike,
        axes: Mapping[str, ArrayLike],
        *,
        part: Part = "front transmission",
        channels: Sequence[str | float] | None = None,
        media: tuple[float, float] = (1.0, 1.0),
        sample: str = "",
    ) -> Diffuser:
        """Creates a measurement from arrays.

        Args:
            values: BSDF, 1/sr (radiance over irradiance, not multiplied by a cosine), 0 or more; NaN where nothing was measured. Shape [axes...], or [channel, axes...].
            axes: ascending angles, degrees, in this order. Angles of light and viewer: ``theta_i_deg``, ``phi_i_deg`` (may be omitted:
                a single azimuth of 0), ``theta_o_deg``, ``phi_o_deg``; each theta is 0 along the normal of the side on which its ray
                lies, in transmission too. Or angles about the specular direction: ``rotation_deg`` (may be omitted: 0), ``incidence_deg``, ``azimuth_deg``, ``radial_deg``.
            part: side of incidence, and reflection or transmission.
            channels: name of each channel ("monochrome", "X", "Y", "Z", "red", "green", "blue") or its wavelength, nm; None: one channel.
            media: refractive indices on the front and on the back.
            sample: name of the sample.

        Returns:
            The measurement, as if it were read from a file.

        Raises:
            ArgumentError: if a shape, an axis or a name is wrong.
            FileError: if values are invalid.

        Example:
            >>> theta = np.arange(0.0, 86.0, 5.0)
            >>> lobe = np.exp(-((theta[:, None, None] - theta[:, None]) ** 2) / 200) * np.ones(2)
            >>> foil = papilio.diffuser.Diffuser.from_arrays(lobe, {"theta_i_deg": theta, "theta_o_deg": theta, "phi_o_deg": [0, 180]})
            >>> foil.parts, foil["front transmission"].shape
            (['front transmission'], (1, 18, 1, 18, 2))
        """
        made = cls.__new__(cls)
        made._path = None
        made._core = _papilio.Diffuser.from_bytes(_measurements.npz(values, axes, part, channels, media, sample), sample or "arrays")
        _messages.warn(made.warnings)
        return made

    def to_bytes(self) -> bytes:
        """Returns the measurement in papilio's own format (``.npz``), which holds everything.

        Returns:
            The bytes of the file that ``convert("NAME.npz")`` writes.
        """
        return self._core.npz()

    @cached_property
    def _content(self) -> dict[str, _measurements.Part]:
        return _measurements.read(self.to_bytes())

    def _names(self) -> Iterable[str]:
        return self.parts

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Returns the values of a part, 1/sr, shape [channel, axes...]; NaN where nothing was measured. The array is read-only.

        Raises:
            KeyError: if the file has no such part.
        """
        known = {_measurements.prefix(part): part for part in self.parts} | {part: part for part in self.parts}
        if name not in known:
            raise KeyError(f"{name!r}: there is no such part; the parts are {', '.join(self.parts)}")
        return self._content[known[name]].values

    def evaluate(
        self,
        theta_i_deg: ArrayLike,
        phi_i_deg: ArrayLike,
        theta_o_deg: ArrayLike,
        phi_o_deg: ArrayLike,
        *,
        part: str | None = None,
        channel: int | None = None,
    ) -> NDArray[np.float64]:
        """Interpolates a part between the measured directions, linearly; nothing is extrapolated.

        Args:
            theta_i_deg, phi_i_deg: direction of the light, degrees, from the normal of its side. The arrays broadcast.
            theta_o_deg, phi_o_deg: direction of the viewer; phi is the same on both sides.
            part: name of the part; None: the first.
            channel: index of the channel; None: the luminous one.

        Returns:
            BSDF, 1/sr, in the common shape of the angles; NaN where nothing was measured.

        Example:
            >>> foil = papilio.diffuser.Diffuser("scenarios/data/H78.bsdf")
            >>> bool(foil.evaluate(0, 0, 5, 0) > foil.evaluate(0, 0, 30, 0))
            True
        """
        at = 0 if part is None else self.parts.index(one_of("part", part, self.parts))
        found = self._content[self.parts[at]]
        which = found.luminous if channel is None else whole("channel", channel, 0, len(found.channels) - 1)
        angles = {
            name: reals(name, one)
            for name, one in zip(
                ("theta_i_deg", "phi_i_deg", "theta_o_deg", "phi_o_deg"), (theta_i_deg, phi_i_deg, theta_o_deg, phi_o_deg), strict=True
            )
        }
        shape = common_shape(angles)
        rows = np.stack([np.broadcast_to(one, shape) for one in angles.values()], axis=-1)
        return self._core.evaluate(at, which, np.ascontiguousarray(rows).reshape(-1)).reshape(shape)

    def to_xarray(self) -> xarray.Dataset:
        """Returns the values of all parts, BSDF in 1/sr, over their axes.

        Returns:
            A Dataset with a variable for each part (``front_transmission``) over ``channel`` and the angles of its grid. Axes that differ
            between parts have the part's name at the end.

        Raises:
            ArgumentError: if a part has no grid of directions (tensor trees, warped grids); `evaluate` interpolates these.
            ImportError: if xarray is not installed.

        Example:
            >>> foil = papilio.diffuser.Diffuser("scenarios/data/H78.bsdf")
            >>> foil.to_xarray().front_transmission.sel(incidence_deg=0, azimuth_deg=0).isel(channel=0, rotation_deg=0).dims
            ('radial_deg',)
        """
        return _measurements.dataset(self._content, _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a row for each channel and direction, with a column for each part.

        Raises:
            ArgumentError: if a part has no grid of directions (tensor trees, warped grids).
            ImportError: if xarray or pandas is not installed.
        """
        return self.to_xarray().to_dataframe()

    @property
    def notes(self) -> list[str]:
        """Comments and header lines of the file that are worth keeping."""
        return list(self.audit().get("remarks", []))

    @property
    def warnings(self) -> list[str]:
        """Suspicious but readable properties of the file."""
        return self._core.warnings

    @property
    def parts(self) -> list[str]:
        """The measured sides and modes of scattering: "front transmission", ..."""
        return self._core.parts()

    @cached_property
    def _audit(self) -> tuple[str, str, list[tuple[str, str]]]:
        return self._core.audit()

    def audit(self) -> dict[str, Any]:
        """Returns the audit of the file, as ``papilio diffuser inspect --json`` prints it."""
        return dict(json.loads(self._audit[0]))

    def to_json(self) -> str:
        """Returns the audit of the file, the text of ``papilio diffuser inspect --json``."""
        return self._audit[0]

    def _files(self) -> dict[str, bytes]:
        return {"audit.json": self.to_json().encode(), "measurement.npz": self.to_bytes()}

    def figures(self) -> dict[str, Figure]:
        """Returns the figures of the lobes, by name."""
        return {name: Figure(name, svg) for name, svg in self._audit[2]}

    def fit(self, model: str | None = None, *, part: str | None = None) -> dict[str, Any]:
        """Fits analytic lobes to a part.

        Args:
            model: one of `lobe_names`; None: all.
            part: one of `parts`; None: the first.

        Returns:
            The result of ``papilio diffuser fit --json``; the best fit is the first. `fits` has its parameters as a table.
        """
        kind = None if model is None else one_of("model", model, lobe_names())
        at = 0 if part is None else self.parts.index(one_of("part", part, self.parts))
        return dict(json.loads(self._core.fit(at, kind)))

    def fits(self, model: str | None = None, *, part: str | None = None) -> pandas.DataFrame:
        """Fits analytic lobes to a part, and returns a row for each parameter of each lobe, the best lobe first.

        Args:
            model: one of `lobe_names`; None: all.
            part: one of `parts`; None: the first.

        Returns:
            The parameters of ``fit``, with the columns of its entries; the index is the name of the lobe.

        Raises:
            ImportError: if pandas is not installed.
        """
        with optional("pandas"):
            import pandas

        rows = []
        for one in self.fit(model, part=part)["fits"]:
            scalars = {key: value for key, value in one.items() if not isinstance(value, (list, dict))}
            for parameter in one["parameters"]:
                rows.append({**scalars, **parameter})
        table = pandas.DataFrame(rows)
        return table.set_index("model") if "model" in table.columns else table

    def convert(self, output: str | PathLike[str], format: Literal["bsdf", "csv", "xml", "npz"] | None = None) -> list[str]:
        """Writes the measurement in another format.

        Args:
            output: path of the file.
            format: "bsdf" (Radiant, Zemax), "csv", "xml" (Klems) or "npz" (papilio's own); None: from the suffix of the name.

        Returns:
            Descriptions of the data that this format cannot store.
        """
        where = _checked_path("output", output)
        by_name = Path(where).suffix.removeprefix(".")
        chosen = one_of("format", by_name if format is None else format, _FORMATS)
        if self._path is not None and Path(where).exists() and Path(where).samefile(self._path):
            raise ArgumentError(f"output: expected another file than the input {where}, which would be overwritten")
        if not Path(where).parent.is_dir():
            raise FileError(f"{where}: the file cannot be written: there is no folder {str(Path(where).parent)!r}")
        return self._core.convert(where, chosen)

    def __str__(self) -> str:
        return self._audit[1]

    def __repr__(self) -> str:
        return f"<papilio.diffuser.Diffuser {self._path or 'from arrays'!r}: {', '.join(self.parts)}{_messages.summary(self.warnings)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.to_bytes(), self._path)

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(str(self))}</pre>" + "".join(figure.svg for figure in self.figures().values())


def _restored(content: bytes, path: str | None) -> Diffuser:
    made = Diffuser.__new__(Diffuser)
    made._path, made._core = path, _papilio.Diffuser.from_bytes(content, path or "arrays")
    return made
