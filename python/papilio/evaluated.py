"""Metrics of many designs."""

from __future__ import annotations

import html
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _messages, _metadata, _parts, plot
from ._batches import Grid, Question, as_names
from ._keys import Names, attributes, short_names
from ._snapshots import read_only
from ._mapping import Lookup
from ._storing import Stored, optional, variable
from .errors import ArgumentError
from .figure import Figure
from .prepared import SPECTRUM, Skipped

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Evaluated"]


class Evaluated(Stored, Lookup[NDArray[np.float64]]):
    """Metrics of many designs, from `papilio.sweep` and `papilio.cluster`.

    ``found["white.Y"]`` has the shape of the designs; after it, the views if several were requested, and the wavelengths of a spectrum.
    Arrays are read-only; ``found["white.Y"].copy()`` is writable. Names are those of the request, or those of ``to_xarray()``.
    """

    def __init__(
        self,
        grid: Grid,
        question: Question,
        order: list[str],
        found: dict[str, tuple[NDArray[np.float64], Skipped]],
        folder: Path | None,
        batch: int,
        reused: int,
        *,
        names: Names | None = None,
        views: list[int] | None = None,
    ) -> None:
        self._grid, self._question, self._order, self._found = grid, question, order, found
        self._short = short_names(names, list(grid.columns))
        self._views = views
        #: Folder of the Parquet parts (`pandas.read_parquet(folder)`); None: the values are in memory.
        self.folder = folder
        #: Number of designs in a part.
        self.designs_per_part = batch
        #: Number of designs that were already computed.
        self.reused = reused
        scene = question.scenario._scene()
        #: Warnings about the scenario; the designs that change it are not checked.
        self.warnings: list[str] = list(scene.warnings)
        #: Notes on data that were measured, assumed or scaled.
        self.notes: list[str] = list(scene.notes)

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of ``values``: designs..., view if several were requested, metric, wavelength of spectra."""
        return (*self._grid.shape, *map(len, self._inner.values()))

    @cached_property
    def _inner(self) -> dict[str, Any]:
        """Names and labels of the axes after those of the designs."""
        inner: dict[str, Any] = {} if self._views is None else {"view": self._views}
        inner["metric"] = self.metrics
        if self.metrics[0].endswith(SPECTRUM):
            inner["wavelength_nm"] = self._question.scenario._scene().wavelength_nm
        return inner

    @property
    def metrics(self) -> list[str]:
        """The names of the metrics along the last axis."""
        return list(self._question.metrics)

    @property
    def parts(self) -> list[Path]:
        """The files, in the order of designs (the last axis is the fastest)."""
        return [] if self.folder is None else [_parts.path(self.folder, address) for address in self._order]

    @cached_property
    def values(self) -> NDArray[np.float64]:
        """The metrics, of shape ``shape``; NaN where one is not defined."""
        flat = np.empty((self._grid.size, *map(len, self._inner.values())))
        start = 0
        for address in self._order:
            known, _ = self._found.get(address, (None, []))
            if known is None and self.folder is not None:
                known = _parts.read(self.folder, address, self.metrics)
            if known is not None:
                flat[start : start + len(known)] = known
                start += len(known)
        return read_only(flat.reshape(self.shape))

    def __getstate__(self) -> dict[str, Any]:
        # Unpickled arrays are writable, so the read-only values are created again.
        return {name: one for name, one in self.__dict__.items() if name != "values"}

    def _names(self) -> Iterable[str]:
        return self.metrics

    @cached_property
    def errors(self) -> list[tuple[tuple[int, ...], str]]:
        """The invalid designs that ``on_error="nan"`` skipped: the index of each, as in ``DesignError.design``, and the reason."""
        errors = []
        for part, address in enumerate(self._order):
            _, skipped = self._found.get(address, (None, []))
            if address not in self._found and self.folder is not None:
                skipped = _parts.skipped(self.folder, address)
            start = part * self.designs_per_part
            errors += [(self._grid.place(start + at), why) for at, why in skipped]
        return errors

    def __getitem__(self, metric: str) -> NDArray[np.float64]:
        """Returns one metric, shape [designs...], with axes for several views and for the wavelengths of a spectrum.

        Raises:
            KeyError: if it was not requested.
        """
        known = {_metadata.flat(name): name for name in self.metrics} | {name: name for name in self.metrics}
        if metric not in known:
            raise KeyError(f"{metric!r} was not requested; the metrics are {', '.join(self.metrics)}")
        axis = len(self._grid.shape) + list(self._inner).index("metric")
        return self.values[(slice(None),) * axis + (self.metrics.index(known[metric]),)]

    def _variables(self, names: Names | None = None) -> dict[str, NDArray[Any]]:
        """Returns the columns of the variables by their names in tables."""
        short = self._short if names is None else short_names(names, list(self._grid.columns))
        return {short[name]: column for name, column in as_names(self._grid.columns).items()}

    def _attributes(self, names: Names | None = None) -> dict[str, dict[str, str]]:
        """Returns the attributes of the variables by their names in tables."""
        return dict(zip(self._variables(names), map(attributes, self._grid.columns), strict=True))

    def to_pandas(self, names: Names | None = None) -> pandas.DataFrame:
        """Returns a table with a row for each design: its variables and metrics.

        Args:
            names: short names of the variables, ``{key: name}`` or a list; by default those of the call that made the result.

        Returns:
            The table. With several views, it has a row for each view of a design; with spectra, for each wavelength.

        Raises:
            ImportError: if pandas is not installed.
        """
        with optional("pandas"):
            import pandas

        shape = (*self._grid.shape, *(len(labels) for axis, labels in self._inner.items() if axis != "metric"))
        others = [axis for axis in self._inner if axis != "metric"]
        table = {
            name: np.broadcast_to(column.reshape(column.shape + (1,) * len(others)), shape).reshape(-1)
            for name, column in self._variables(names).items()
        }
        for at, axis in enumerate(others):
            labels = np.asarray(self._inner[axis]).reshape((-1,) + (1,) * (len(others) - at - 1))
            table[axis] = np.broadcast_to(labels, shape).reshape(-1)
        return pandas.DataFrame({**table, **{name: self[name].reshape(-1) for name in self.metrics}})

    def to_xarray(self, names: Names | None = None, *, by_state: bool = True) -> xarray.Dataset:
        """Returns the metrics over the variables, with units and long names.

        An axis has the name of a variable if only this one varies along it, otherwise ``design``. Axes of xarray arrays keep their names.
        The attribute ``key`` of a coordinate is the key of the scenario. Variables and dimensions are those of `Result.to_xarray`
        (``Y`` over ``state``), so that the two can be joined.

        Args:
            names: short names of the variables, ``{key: name}`` or a list; by default those of the call that made the result.
            by_state: whether metrics of states are arrays over ``state``; False: an array for each metric and state, ``white_Y``.

        Returns:
            A Dataset; metrics that were not requested for a state are NaN.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        dimensions, coordinates = self._axes(names)
        scene = self._question.scenario._scene()
        inner = [axis for axis in self._inner if axis != "metric"]
        if "view" in inner:
            angles = np.array([scene.views[view] for view in self._inner["view"]]).T
            coordinates |= {name: ("view", values, _metadata.angle(name)) for name, values in zip(("theta_deg", "phi_deg"), angles, strict=True)}
        if "wavelength_nm" in inner:
            coordinates["wavelength_nm"] = ("wavelength_nm", np.array(self._inner["wavelength_nm"]), _metadata.WAVELENGTH)
        data: dict[str, Any] = {}
        of_states: dict[str, dict[str, NDArray[np.float64]]] = {}
        for name in self.metrics:
            state, _, metric = name.rpartition(".")
            if by_state and state:
                of_states.setdefault(metric, {})[state] = self[name]
            else:
                data[_metadata.flat(name)] = ((*dimensions, *inner), self[name].copy(), _metadata.attributes(name))
        if of_states:
            states = list(dict.fromkeys(state for each in of_states.values() for state in each))
            coordinates["state"] = ("state", states, _metadata.STATE)
            at = len(dimensions) + ("view" in inner)
            for metric, each in of_states.items():
                missing = np.full_like(next(iter(each.values())), np.nan)
                stacked = np.stack([each.get(state, missing) for state in states], axis=at)
                over = [axis for axis in ("view", "state", "wavelength_nm") if axis == "state" or axis in inner]
                data[_metadata.flat(metric)] = ((*dimensions, *over), stacked, _metadata.attributes(metric))
        clash = [str(name) for name in {*dimensions, *coordinates} & data.keys()]
        if clash:
            raise ArgumentError(f"names: {clash[0]!r} is the name of a metric; expected other names of variables")
        return xarray.Dataset(data, coordinates, self._about())

    def _axes(self, names: Names | None) -> tuple[list[Any], dict[Any, Any]]:
        """Returns the dimensions of the designs, and the coordinates of the variables."""
        variables, about = self._variables(names), self._attributes(names)
        shape = self._grid.shape
        padded = {name: column.reshape((1,) * (len(shape) - column.ndim) + column.shape) for name, column in variables.items()}
        along = {name: [at for at, length in enumerate(column.shape) if length > 1 or shape[at] == 1] for name, column in padded.items()}
        if self._grid.dims is not None:
            dimensions: list[Any] = list(self._grid.dims.names)
            coordinates: dict[Any, Any] = dict(self._grid.dims.coordinates)
        else:
            dimensions, coordinates = [f"design_{at}" for at in range(len(shape))] if len(shape) != 1 else ["design"], {}
            for name, axes in along.items():
                alone = [at for at in axes if sum(at in others for others in along.values()) == 1]
                if len(axes) == 1 and alone:
                    dimensions[axes[0]] = name
        for name, column in padded.items():
            values = column.reshape([column.shape[at] for at in along[name]])
            coordinates[name] = ([dimensions[at] for at in along[name]], values, about[name])
        return dimensions, coordinates

    def figures(self) -> dict[str, Figure]:
        """Returns a figure of each metric, by its name: a curve over one axis, or a map over two; none for other shapes and spectra."""
        dimensions, coordinates = self._axes(None)
        axes = [coordinates.get(name) for name in dimensions]
        is_map = len(axes) == 2 and self._grid.size <= plot.MOST_CELLS
        if list(self._inner) != ["metric"] or not (len(axes) == 1 or is_map) or not all(isinstance(axis, tuple) for axis in axes):
            return {}
        figures = {}
        for name in self.metrics:
            labels = [_metadata.label(axis[2]) for axis in axes if axis is not None]
            lines = [axis[1] for axis in axes if axis is not None]
            what = _metadata.label(_metadata.attributes(name))
            if not np.isfinite(self[name]).any() or (len(lines) == 1 and lines[0].dtype.kind == "U"):
                continue
            if len(lines) == 1:
                svg = plot.curves(lines[0], {name: self[name]}, x_label=labels[0], y_label=what).svg
            else:
                svg = plot.map(lines[1], lines[0], self[name], x_label=labels[1], y_label=labels[0], name=what).svg
            figures[name] = Figure(_metadata.flat(name), svg)
        return figures

    def _files(self) -> dict[str, bytes]:
        return {"designs.csv": self.to_pandas().to_csv(index=False).encode()}

    def _about(self) -> dict[str, Any]:
        about = {"papilio": self._question.version, "hash": self._question.hash, "view": self._question.view}
        return about | _messages.attributes(self.warnings, self.notes)

    def __repr__(self) -> str:
        where = "in memory" if self.folder is None else f"in {self.folder}"
        return f"<papilio.Evaluated: {self._grid.size:,} designs, {', '.join(self.metrics)}; {where}{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        """A summary with warnings and notes, as HTML."""
        return f"<p>{html.escape(repr(self))}</p>{_messages.as_html(self.warnings, self.notes)}"
