"""Metrics of many designs."""

from __future__ import annotations

import html
from collections.abc import Iterable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _messages, _metadata, _parts
from ._batches import Grid, Question, as_names
from ._dims import Dims
from ._snapshots import read_only
from ._mapping import Lookup
from .prepared import Skipped

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Evaluated"]


class Evaluated(Lookup[NDArray[np.float64]]):
    """Metrics of designs, from `papilio.cluster`. Its arrays are read-only; ``found["white.Y"].copy()`` is writable."""

    def __init__(
        self,
        grid: Grid,
        question: Question,
        order: list[str],
        found: dict[str, tuple[NDArray[np.float64], Skipped]],
        folder: Path | None,
        batch: int,
        reused: int,
    ) -> None:
        self._grid, self._question, self._order, self._found = grid, question, order, found
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
        """The shape of ``values``: designs..., metric."""
        return (*self._grid.shape, len(self.metrics))

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
        """The metrics, shape [designs..., metric]; NaN where one is not defined."""
        flat = np.empty((self._grid.size, len(self.metrics)))
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
        """Returns one metric, shape [designs...].

        Raises:
            KeyError: if it was not requested.
        """
        if metric not in self.metrics:
            raise KeyError(f"{metric!r} was not requested; the metrics are {', '.join(self.metrics)}")
        return self.values[..., self.metrics.index(metric)]

    def _variables(self) -> dict[str, NDArray[Any]]:
        return as_names(self._grid.columns)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each design: its variables and metrics."""
        import pandas

        shape = self._grid.shape
        table = {name: np.broadcast_to(column, shape).reshape(-1) for name, column in self._variables().items()}
        flat = self.values.reshape(-1, len(self.metrics))
        return pandas.DataFrame({**table, **{name: flat[:, at] for at, name in enumerate(self.metrics)}})

    def to_xarray(self) -> xarray.Dataset:
        """Returns the metrics over the variables.

        An axis has the name of a variable if only this one varies along it, otherwise ``design``. Axes of xarray arrays keep their
        names.
        """
        import xarray

        if self._grid.dims is not None:
            return self._labelled(self._grid.dims)

        dimensions = [f"design_{at}" for at in range(len(self._grid.shape))]
        if len(dimensions) == 1:
            dimensions = ["design"]
        padded = {
            name: column.reshape((1,) * (len(dimensions) - column.ndim) + column.shape)
            for name, column in self._variables().items()
        }
        along = {
            name: [at for at, length in enumerate(column.shape) if length > 1 or self._grid.shape[at] == 1]
            for name, column in padded.items()
        }
        for name, axes in along.items():
            alone = [at for at in axes if sum(at in others for others in along.values()) == 1]
            if len(axes) == 1 and alone:
                dimensions[axes[0]] = name
        coordinates = {
            name: ([dimensions[at] for at in along[name]], np.squeeze(column, axis=tuple(at for at in range(column.ndim) if at not in along[name])))
            for name, column in padded.items()
        }
        data = {_metadata.flat(name): (dimensions, self[name].copy(), _metadata.attributes(name)) for name in self.metrics}
        return xarray.Dataset(data, coordinates, self._about())

    def _labelled(self, dims: Dims) -> xarray.Dataset:
        """Returns the metrics over the dimensions of variables that are xarray arrays."""
        import xarray

        names, coordinates = dims.names, dict(dims.coordinates)
        for name, column in self._variables().items():
            at = [axis for axis in range(column.ndim) if column.shape[axis] > 1 or self._grid.shape[axis] == 1]
            coordinates[name] = ([names[axis] for axis in at], column.reshape([column.shape[axis] for axis in at]))
        data = {_metadata.flat(name): (names, self[name].copy(), _metadata.attributes(name)) for name in self.metrics}
        return xarray.Dataset(data, coordinates, self._about())

    def _about(self) -> dict[str, Any]:
        about = {"papilio": self._question.version, "hash": self._question.hash, "view": self._question.view}
        return about | _messages.attributes(self.warnings, self.notes)

    def __repr__(self) -> str:
        where = "in memory" if self.folder is None else f"in {self.folder}"
        return f"<papilio.Evaluated: {self._grid.size:,} designs, {', '.join(self.metrics)}; {where}{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        """A summary with warnings and notes, as HTML."""
        return f"<p>{html.escape(repr(self))}</p>{_messages.as_html(self.warnings, self.notes)}"
