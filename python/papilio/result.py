"""Results of runs."""

from __future__ import annotations

import html
import json
from collections.abc import Iterable, Mapping
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _messages, _metadata, _papilio, _snapshots
from ._snapshots import RunSnapshot, read_only
from ._mapping import ByName
from .errors import ArgumentError
from .figure import Figure

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Result"]

_Arrays = Mapping[str, NDArray[np.float64]]

#: Quantities of each state in the table of a view.
_SHOWN = ("Y", "contrast", "L_star", "a_star", "b_star", "u_prime", "v_prime", "luminance_cd_m2", "peak_nm")


class Result(ByName[NDArray[np.float64]]):
    """Simulated measurement of a display, with errors: the contents of ``result.json`` of ``papilio run``.

    Quantities are arrays over views (theta fastest), states and wavelengths. Names are those of ``result.json``
    (`papilio.schema("result")`)::

        result["contrast_ratio"]            # shape [view]
        result["white.Y"]                   # shape [view]
        result["Y"]                         # shape [view, state]
        result["reflectance_factor"]        # shape [view, state, wavelength]
        result["standard_error.Y"]          # one sigma; "discretisation_error.Y" of adding

    Undefined values are NaN. Arrays are read-only; ``result[name].copy()`` is writable. ``keys()``, iteration and ``dict(result)``
    cover the arrays of all states; ``in`` and ``get`` also accept those of one state (``"white.Y"``). A result can be copied and
    pickled, and then needs neither its scenario nor its files. A notebook shows a table, warnings and notes, and the overview
    figure of the first view.
    """

    def __init__(self, core: _papilio.RunResult | RunSnapshot, title: str = "") -> None:
        self._core = core
        #: The scenario's title.
        self.title = title

    @property
    def states(self) -> list[str]:
        """The names of the drive states, in the scenario's order."""
        return self._core.states()

    @property
    def views(self) -> list[tuple[float, float]]:
        """Inclination and azimuth of every view, degrees."""
        return self._core.views()

    @cached_property
    def wavelength_nm(self) -> NDArray[np.float64]:
        """The wavelengths of spectra, nm."""
        return read_only(self._core.wavelength_nm())

    @property
    def warnings(self) -> list[str]:
        """Warnings; each was also raised as a `papilio.PapilioWarning` by the computation."""
        return self._core.warnings()

    @property
    def notes(self) -> list[str]:
        """Notes on data that were measured, assumed or scaled."""
        return self._core.notes()

    @cached_property
    def _arrays(self) -> tuple[_Arrays, _Arrays]:
        return _snapshots.read_only_arrays(self._core.arrays())

    def _names(self) -> Iterable[str]:
        together, alone = self._arrays
        return [*together, *alone]

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Returns a quantity by its name; see the class.

        Raises:
            KeyError: if there is no such quantity.
        """
        together, alone = self._arrays
        if name in together:
            return together[name]
        if name in alone:
            return alone[name]
        state, _, rest = name.partition(".") if isinstance(name, str) else ("", "", "")
        if state in self.states and rest in alone:
            return alone[rest][:, self.states.index(state)]
        known = [*together, *alone]
        raise KeyError(f"{name!r}: there is no such metric; states are {', '.join(self.states)}, metrics {', '.join(known)}")

    def metrics(self, view: int = 0) -> dict[str, float]:
        """Returns every scalar metric of a view by its name: ``{"contrast_ratio": ..., "white.Y": ...}``, without errors."""
        if not -len(self.views) <= view < len(self.views):
            raise ArgumentError(f"view: expected 0 to {len(self.views) - 1}, not {view!r}")
        together, alone = self._arrays
        found = {name: float(values[view]) for name, values in together.items() if _metadata.parts(name)[1] is None}
        for s, state in enumerate(self.states):
            for name, values in alone.items():
                if values.ndim == 2 and _metadata.parts(name)[1] is None:
                    found[f"{state}.{name}"] = float(values[view, s])
        return found

    def to_json(self) -> str:
        """Returns the text of ``result.json``, identical byte for byte."""
        return self._core.json().decode()

    @cached_property
    def data(self) -> dict[str, Any]:
        """The contents of ``result.json``; None where a number is undefined."""
        return dict(json.loads(self._core.json()))

    def to_xarray(self) -> xarray.Dataset:
        """Returns all quantities as a Dataset over ``view``, ``state`` and ``wavelength_nm``, with units and long names.

        ``theta_deg`` and ``phi_deg`` are coordinates of ``view``; ``Y_standard_error`` is the error of ``Y``. The attributes
        ``warnings`` and ``notes`` have one line for each.

        Raises:
            ImportError: if xarray is not installed.
        """
        import xarray

        together, alone = self._arrays
        data: dict[str, Any] = {}
        for before, arrays in [(("view",), together), (("view", "state"), alone)]:
            for name, values in arrays.items():
                inner = _metadata.inner_dimensions(name, values.ndim - len(before))
                data[_metadata.flat(name)] = ((*before, *inner), values.copy(), _metadata.attributes(name))
        white = self._core.radiance_of_white()
        data["radiance_of_white"] = (("wavelength_nm",), white.copy(), _metadata.attributes("radiance_of_white"))
        angles = np.array(self.views).reshape(-1, 2).T
        degrees = {"units": "degree"}
        coordinates: dict[str, Any] = {
            "state": ("state", self.states, {"long_name": "drive state"}),
            "wavelength_nm": ("wavelength_nm", self.wavelength_nm.copy(), {"units": "nm", "long_name": "wavelength in vacuum"}),
            "theta_deg": ("view", angles[0], degrees | {"long_name": "inclination of the view"}),
            "phi_deg": ("view", angles[1], degrees | {"long_name": "azimuth of the view"}),
        }
        about = {key: self.data[key] for key in ("papilio", "hash", "seed")} | {"title": self.title}
        return xarray.Dataset(data, coordinates, about | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the table of ``states.csv``: a row for each view and state; ``Y_se`` and ``Y_de`` are the errors of ``Y``.

        Raises:
            ImportError: if pandas is not installed.
        """
        import csv

        import pandas

        header, *rows = csv.reader(self._core.states_csv().decode().splitlines())
        table = pandas.DataFrame({name: _column(name, cells) for name, cells in zip(header, zip(*rows, strict=True), strict=True)})
        return table.set_index(["theta_deg", "phi_deg", "state"])

    def figures(self) -> dict[str, Figure]:
        """Returns the figures of ``papilio run``, by name."""
        return {name: Figure(name, svg) for name, svg in self._core.figures(self.title)}

    def save(self, folder: str | PathLike[str]) -> list[Path]:
        """Writes ``result.json``, ``states.csv``, ``spectra.csv`` and the figures into a folder, which is created."""
        where = Path(folder)
        where.mkdir(parents=True, exist_ok=True)
        texts = {
            "result.json": self._core.json(),
            "states.csv": self._core.states_csv(),
            "spectra.csv": self._core.spectra_csv(),
        }
        texts |= {f"{figure.name}.svg": figure.svg.encode() for figure in self.figures().values()}
        for name, content in texts.items():
            (where / name).write_bytes(content)
        return [where / name for name in texts]

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (_snapshots.pack(RunSnapshot.of(self._core, self.title)), self.title)

    def __copy__(self) -> Result:
        return Result(self._core, self.title)

    def __deepcopy__(self, memo: object) -> Result:
        return self.__copy__()  # its contents are immutable

    def __repr__(self) -> str:
        return (
            f"<papilio.Result {self.title!r}: {len(self.views)} views, states {', '.join(self.states)}{_messages.summary(self.warnings)}>"
        )

    def _repr_html_(self) -> str:
        """A table of the first view, warnings and notes, and the overview figure, as HTML."""
        alone = self._arrays[1]
        shown = [name for name in _SHOWN if name in alone]
        head = "".join(f"<th>{html.escape(name)}</th>" for name in ("state", *shown))
        rows = ""
        primaries = self.data["primaries"]
        for s, state in enumerate(self.states):
            # The peak of a mixture of sub-pixels is that of one of its parts.
            values = [np.nan if name == "peak_nm" and state not in primaries else float(alone[name][0, s]) for name in shown]
            cells = "".join(f"<td>{_digits(value)}</td>" for value in values)
            rows += f"<tr><th>{html.escape(state)}</th>{cells}</tr>"
        together = [(name, values[0]) for name, values in self._arrays[0].items() if "." not in name]
        scalars = ", ".join(f"{name} {_digits(value)}" for name, value in together if np.isfinite(value))
        table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        messages = _messages.as_html(self.warnings, self.notes)
        return f"<h4>{html.escape(self.title)}</h4>{table}<p>{html.escape(scalars)}</p>{messages}{self._core.overview(self.title) or ''}"


def _restored(content: bytes, title: str) -> Result:
    return Result(_snapshots.unpack(content), title)


def _column(name: str, cells: tuple[str, ...]) -> list[str] | list[float]:
    return list(cells) if name == "state" else [float(cell) if cell else float("nan") for cell in cells]


def _digits(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.4g}"
