"""Results of runs."""

from __future__ import annotations

import csv
import html
import json
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _messages, _metadata, _papilio, _snapshots
from ._arguments import whole
from ._snapshots import RunSnapshot, read_only
from ._mapping import ByName
from ._storing import Stored, optional
from .figure import Figure

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Result"]

_Arrays = Mapping[str, NDArray[np.float64]]

#: Columns that name the rows of ``states.csv``.
_OF_ROWS = ["theta_deg", "phi_deg", "state"]

#: Quantities of each state in the table of a view.
_SHOWN = ("Y", "contrast", "L_star", "a_star", "b_star", "u_prime", "v_prime", "luminance_cd_m2", "peak_nm")


class Result(Stored, ByName[NDArray[np.float64]]):
    """Simulated measurement of a display, with errors: the contents of ``result.json`` of ``papilio run``.

    Quantities are arrays over views (theta fastest), states and wavelengths. Names are those of ``result.json``
    (`papilio.schema("result")`)::

        result["contrast_ratio"]            # shape [view]
        result["white.Y"]                   # shape [view]
        result["Y"]                         # shape [view, state]
        result["reflectance_factor"]        # shape [view, state, wavelength]
        result["standard_error.Y"]          # one sigma; "discretisation_error.Y" of adding

    Undefined values are NaN. Arrays are read-only; ``result[name].copy()`` is writable. ``keys()``, iteration and ``dict(result)`` have
    the names of ``to_xarray()`` and ``to_pandas()``: ``Y_standard_error``, with underscores for dots and the kind of error last; errors that
    the solver does not estimate are not among them. ``[]``, ``in`` and ``get`` accept these, the names of ``result.json`` and of the columns of numbers of ``states.csv`` (``"R_dir_0"``, shape
    [view, state]), and the arrays of one state (``"white.Y"``). A result can be copied
    and pickled, and then needs neither its scenario nor its files. A notebook shows a table, warnings and notes, and the overview figure
    of the first view.
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

    @cached_property
    def _canonical(self) -> dict[str, str]:
        """Names in ``result.json``, by themselves and by the names in tables."""
        names = [*self._arrays[0], *self._arrays[1]]
        return {_metadata.flat(name): name for name in names} | {name: name for name in names}

    def _names(self) -> Iterable[str]:
        return [_metadata.flat(name) for arrays in self._arrays for name, values in arrays.items() if self._is_estimated(name, values)]

    @cached_property
    def _kinds_of_errors(self) -> set[str | None]:
        """The kinds of errors that the solver estimates: those of which a number is above 0."""
        every = (one for arrays in self._arrays for one in arrays.items())
        return {kind for name, values in every if (kind := _metadata.parts(name)[1]) is not None and bool((values > 0).any())}

    def _is_estimated(self, name: str, values: NDArray[np.float64]) -> bool:
        """Tells whether an array has numbers: any quantity, and errors that the solver estimates."""
        kind = _metadata.parts(name)[1]
        return kind is None or (kind in self._kinds_of_errors and not bool(np.isnan(values).all()))

    def _known(self, name: str) -> str | None:
        """Returns the name in ``result.json`` of a quantity; None if there is none."""
        return self._canonical.get(name) or self._canonical.get(_metadata.long_error(name))

    @cached_property
    def _table(self) -> tuple[list[tuple[float, float, str]], dict[str, NDArray[np.float64]]]:
        """Views and states of the rows of ``states.csv``, and its other columns by name."""
        header, *rows = csv.reader(self._core.states_csv().decode().splitlines())
        at = [header.index(name) for name in _OF_ROWS]
        labels = [(float(row[at[0]]), float(row[at[1]]), row[at[2]]) for row in rows]
        numbers = {i: [float(row[i]) if row[i] else np.nan for row in rows] for i in range(len(header)) if i not in at}
        return labels, {header[i]: np.array(column) for i, column in numbers.items()}

    @cached_property
    def _columns(self) -> dict[str, NDArray[np.float64]]:
        """The columns of ``states.csv`` that are no arrays of their own, by their names with short and long errors: shape [view, state]."""
        own = {name: read_only(column.reshape(len(self.views), -1)) for name, column in self._table[1].items() if self._known(name) is None}
        return own | {_metadata.long_error(name): column for name, column in own.items()}

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Returns a quantity by its name; see the class.

        Raises:
            KeyError: if there is no such quantity.
        """
        together, alone = self._arrays
        known = self._known(name) if isinstance(name, str) else None
        if known is not None:
            return together[known] if known in together else alone[known]
        of_state = [(at, name[len(state) + 1 :]) for at, state in enumerate(self.states) if isinstance(name, str) and name.startswith((f"{state}.", f"{state}_"))]
        for at, rest in of_state:
            if (of_states := alone.get(self._known(rest) or "")) is not None:
                return of_states[:, at]
        if isinstance(name, str) and name in self._columns:
            return self._columns[name]
        for at, rest in of_state:
            if rest in self._columns:
                return self._columns[rest][:, at]
        known_names = list(self._names())
        raise KeyError(f"{name!r}: there is no such metric; states are {', '.join(self.states)}, metrics {', '.join(known_names)}")

    def metrics(self, view: int = 0) -> dict[str, float]:
        """Returns every scalar metric of a view by its name, without errors.

        Args:
            view: index of the view, from 0.

        Returns:
            ``{"contrast_ratio": ..., "white.Y": ...}``; NaN where undefined.

        Example:
            >>> result = papilio.run("scenarios/indoor.toml")
            >>> round(result.metrics()["white.Y"], 3)
            0.586
        """
        whole("view", view, 0, len(self.views) - 1)
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

    def to_xarray(self, *, directions: bool = False) -> xarray.Dataset:
        """Returns all quantities as a Dataset over ``view``, ``state`` and ``wavelength_nm``, with units and long names.

        Errors that the solver does not estimate are left out: standard errors of adding, discretisation errors of Monte Carlo. The
        attributes ``warnings`` and ``notes`` have one line for each.

        Args:
            directions: whether the axes ``phi_deg`` and ``theta_deg`` replace ``view``, of which they are coordinates otherwise.

        Returns:
            The Dataset; ``Y_standard_error`` is the error of ``Y``.

        Raises:
            ImportError: if xarray is not installed.

        Example:
            >>> views = {"viewer.theta_deg": [0, 20, 40], "viewer.phi_deg": [0, 90]}
            >>> arrays = papilio.run("scenarios/indoor.toml", set=views).to_xarray(directions=True)
            >>> arrays.Y.sel(state="white", phi_deg=90).shape
            (3,)
        """
        with optional("xarray"):
            import xarray

        together, alone = self._arrays
        angles = np.array(self.views).reshape(-1, 2).T
        thetas, phis = (np.array(list(dict.fromkeys(one.tolist()))) for one in angles)
        views, shape = (("phi_deg", "theta_deg"), (phis.size, thetas.size)) if directions else (("view",), (angles.shape[1],))
        data: dict[str, Any] = {}
        for before, arrays in [(views, together), ((*views, "state"), alone)]:
            for name, values in arrays.items():
                if not self._is_estimated(name, values):
                    continue
                rest = values.shape[1:]
                inner = _metadata.inner_dimensions(name, len(rest) + len(views) - len(before))
                data[_metadata.flat(name)] = ((*before, *inner), values.copy().reshape(*shape, *rest), _metadata.attributes(name))
        white = self._core.radiance_of_white()
        data["radiance_of_white"] = (("wavelength_nm",), white.copy(), _metadata.attributes("radiance_of_white"))
        coordinates: dict[str, Any] = {
            "state": ("state", self.states, _metadata.STATE),
            "wavelength_nm": ("wavelength_nm", self.wavelength_nm.copy(), _metadata.WAVELENGTH),
            "theta_deg": ("theta_deg" if directions else "view", thetas if directions else angles[0], _metadata.angle("theta_deg")),
            "phi_deg": ("phi_deg" if directions else "view", phis if directions else angles[1], _metadata.angle("phi_deg")),
        }
        about = dict(zip(("papilio", "hash", "seed"), self._core.about(), strict=True)) | {"title": self.title}
        return xarray.Dataset(data, coordinates, about | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self, *, short_errors: bool = False) -> pandas.DataFrame:
        """Returns the table of ``states.csv``: a row for each view and state.

        Args:
            short_errors: whether columns of errors have the names of the file, ``Y_se`` and ``Y_de``.

        Returns:
            The table, with the index theta_deg, phi_deg, state. ``Y_standard_error`` and ``Y_discretisation_error`` are errors of ``Y``.

        Raises:
            ImportError: if pandas is not installed.

        Example:
            >>> table = papilio.run("scenarios/indoor.toml").to_pandas()
            >>> round(float(table.xs("white", level="state").Y.iloc[0]), 3)
            0.586
        """
        with optional("pandas"):
            import pandas

        labels, columns = self._table
        index = pandas.MultiIndex.from_tuples(labels, names=_OF_ROWS)
        named = {name if short_errors else _metadata.long_error(name): column for name, column in columns.items()}
        return pandas.DataFrame(named, index=index)

    def figures(self) -> dict[str, Figure]:
        """Returns the figures of ``papilio run``, by name.

        Returns:
            Figures with ``svg``, ``png()`` and ``save(path)``; a notebook shows them.
        """
        return {name: Figure(name, svg) for name, svg in self._core.figures(self.title)}

    def _files(self) -> dict[str, bytes]:
        return {
            "result.json": self._core.json(),
            "states.csv": self._core.states_csv(),
            "spectra.csv": self._core.spectra_csv(),
        }

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


def _digits(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.4g}"
