"""Tolerance analysis: the distribution of metrics and the yield in production, from a scenario's ``[tolerance]``."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterable, KeysView, Mapping, Sequence
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _messages, _metadata, _papilio, _samples, _snapshots
from ._arguments import checked_folder, reals, whole
from ._keys import attributes
from ._mapping import Lookup
from ._snapshots import ProductionSnapshot, read_only
from ._backends import ClusterBackend, check_client
from ._storing import Stored, optional, variable
from .errors import DesignError
from .figure import Figure
from .running import Line, Progress, checked_threads, reporter, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
    import pandas
    import xarray
    from distributed import Client

__all__ = ["Yield", "tolerance"]

#: The percentiles of a report.
_PERCENTILES = (1, 5, 25, 50, 75, 95, 99)


class _Keys(list[str]):
    """The keys that vary; called, the names of all arrays."""

    def __init__(self, varied: Iterable[str], names: Iterable[str]) -> None:
        super().__init__(varied)
        self._names = list(names)

    def __call__(self) -> KeysView[str]:
        return dict.fromkeys(self._names).keys()


class Yield(Stored, Lookup[NDArray[Any]]):
    """Result of a tolerance analysis: distributions of the metrics, yield and sensitivities.

    ``found["white.Y"]`` has a metric, or a key, of every display. `report` is the contents of ``tolerance.json`` of ``papilio
    tolerance``, `sensitivities` its Sobol indices as a table. A notebook shows a table. The result can be copied and
    pickled, and then needs neither its scenario nor its files.
    """

    def __init__(
        self,
        core: _papilio.Production | ProductionSnapshot,
        numbers: NDArray[np.float64],
        title: str = "",
        warned: Sequence[str] = (),
        notes: Sequence[str] = (),
    ) -> None:
        self._core, self._numbers = core, read_only(numbers)
        #: The scenario's title.
        self.title = title
        keys, metrics = core.names()
        #: The names of the keys that vary.
        self.varied: list[str] = keys
        #: The names of the reported metrics.
        self.metrics: list[str] = metrics
        #: Yield, percentiles, sensitivities and the worst displays, each number with its standard error.
        self.report: dict[str, Any] = json.loads(core.report(numbers))
        starts = np.cumsum([0, *(core.width(row) for row in range(core.rows - 1))])
        #: The metrics of every display, shape [display, metric]; NaN where undefined. The array is read-only.
        self.values: NDArray[np.float64] = read_only(numbers[starts[:, None] + np.arange(len(metrics))])
        #: Warnings; each was also raised as a `papilio.PapilioWarning` by the computation.
        self.warnings = list(warned)
        #: Notes on data that were measured, assumed or scaled.
        self.notes = list(notes)

    @property
    def share(self) -> float:
        """The yield: fraction of the displays that meet all limits, 0 to 1; `report` has its standard error."""
        return float(self.report["verdict"]["yield_share"]["value"])

    @property
    def keys(self) -> _Keys:
        """The names of all arrays, as ``keys()``; without a call the list `varied`, which has been the meaning of this name."""
        return _Keys(self.varied, self._names())

    @cached_property
    def _columns(self) -> dict[str, NDArray[Any]]:
        """The keys and metrics of every display."""
        rows = [json.loads(self._core.keys(row)) for row in range(self._core.rows)]
        keys = {key: read_only(np.array([row[at] for row in rows])) for at, key in enumerate(self.varied)}
        return keys | {name: self.values[:, at] for at, name in enumerate(self.metrics)}

    def _names(self) -> Iterable[str]:
        return [*self.varied, *self.metrics]

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Returns a metric or a key of every display.

        Raises:
            KeyError: if the analysis has neither.
        """
        if name not in self._columns:
            raise KeyError(f"{name!r}: there is no such metric or key; expected {', '.join(self._columns)}")
        return self._columns[name]

    def sensitivities(self) -> pandas.DataFrame:
        """Returns the Sobol indices: a row for each metric and group of keys, with their standard errors.

        Returns:
            The columns ``first`` and ``total`` (fractions of the variance) and ``first_standard_error``, ``total_standard_error``; the index
            is metric, group. Empty without a sensitivity sample.

        Raises:
            ImportError: if pandas is not installed.
        """
        with optional("pandas"):
            import pandas

        rows = []
        for metric in self.report["metrics"]:
            for group, index in zip(self.report.get("groups") or [], metric.get("indices") or [], strict=False):
                row = {"metric": metric["name"], "group": " + ".join(group) if isinstance(group, list) else group}
                for which in ("first", "total"):
                    row |= {which: index[which]["value"], f"{which}_standard_error": index[which]["standard_error"]}
                rows.append(row)
        columns = ["metric", "group", "first", "first_standard_error", "total", "total_standard_error"]
        return pandas.DataFrame(rows, columns=columns).set_index(["metric", "group"])

    def to_xarray(self) -> xarray.Dataset:
        """Returns keys and metrics of every display as a Dataset over ``display``, with units and long names; keys are coordinates.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        coordinates: dict[Any, Any] = {variable(key): ("display", self[key].copy(), attributes(key)) for key in self.varied}
        data: dict[Any, Any] = {name: ("display", self[name].copy(), _metadata.attributes(name)) for name in self.metrics}
        about = {"title": self.title, "yield": self.share} | _messages.attributes(self.warnings, self.notes)
        return xarray.Dataset(data, coordinates, about)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each display: its keys and its metrics.

        Raises:
            ImportError: if pandas is not installed.
        """
        with optional("pandas"):
            import pandas

        rows = [json.loads(self._core.keys(row)) for row in range(self._core.rows)]
        keys = pandas.DataFrame(rows, columns=self.varied)
        return pandas.concat([keys, pandas.DataFrame(self.values, columns=self.metrics)], axis=1)

    def figures(self) -> dict[str, Figure]:
        """Returns the figures of ``papilio tolerance``, by name: histograms of the metrics, sensitivities, passing and failing displays."""
        return {name: Figure(name, svg) for name, svg in self._core.figures(self.title, self._numbers)}

    def to_json(self) -> str:
        """Returns the text of ``tolerance.json``, identical byte for byte."""
        return dict(self._core.tables(self._numbers))["tolerance.json"].decode()

    def _files(self) -> dict[str, bytes]:
        return dict(self._core.tables(self._numbers))

    def __reduce__(self) -> tuple[Any, ...]:
        snapshot = _snapshots.pack(ProductionSnapshot.create(self._core, self._numbers, self.title))
        return _restored, (snapshot, self._numbers, self.title, self.warnings, self.notes)

    def __copy__(self) -> Yield:
        return Yield(self._core, self._numbers, self.title, self.warnings, self.notes)

    def __deepcopy__(self, memo: object) -> Yield:
        return self.__copy__()  # the arrays are read-only, and the constructor creates the rest again

    def __repr__(self) -> str:
        return f"<papilio.Yield: {100 * self.share:.4g} % of {self.values.shape[0]} displays{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        """The yield and a table of the percentiles of every metric, as HTML."""
        spreads = [(one["name"], one["spread"]) for one in self.report["metrics"]]
        rows = ""
        for name, spread in spreads:
            cells = [] if spread is None else [spread["mean"], spread["deviation"], *spread["percentiles"]]
            shown = "".join(f"<td>{cell['value']:.5g}</td>" for cell in cells)
            rows += f"<tr><th>{html.escape(name)}</th>{shown}</tr>"
        titles = ["", "mean", "deviation", *(f"{percent} %" for percent in _PERCENTILES)]
        head = "".join(f"<th>{title}</th>" for title in titles)
        verdict = f"{100 * self.share:.4g} % of {self.values.shape[0]} displays meet all limits"
        table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        return f"<p>{verdict}</p>{table}{_messages.as_html(self.warnings, self.notes)}"


def _restored(
    content: bytes, numbers: NDArray[np.float64], title: str, warned: list[str], notes: list[str]
) -> Yield:
    return Yield(_snapshots.unpack(content), numbers, title, warned, notes)


def tolerance(
    scenario: Scenario | str | PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    out: str | PathLike[str] | None = None,
    client: Client | None = None,
    batch_seconds: float = 4.0,
    threads: int | None = None,
    retries: int = 3,
    progress: Progress | bool | None = None,
) -> Yield:
    """Runs the tolerance analysis that a scenario's ``[tolerance]`` describes, as ``papilio tolerance`` does.

    Args:
        scenario: a `Scenario`, or the path of a scenario file, with ``[tolerance]``.
        set: values to set in the scenario first, ``{path: value}``, including those of ``[tolerance]`` (``"tolerance.samples": 1024``).
        out: folder for the journal ``tolerance.jsonl``, which is also that of ``papilio tolerance``: samples in it (and in the journals
            of ``--shard`` in the same folder) are not computed again, and an analysis with more samples computes only the new ones.
        client: a `distributed.Client`, whose workers compute batches. None: this machine. The report is the same to the last bit.
        batch_seconds: with ``client``: approximate computing time of a batch; a lost worker loses one batch.
        threads: without ``client``: number of threads; None: one for each processor. The results do not depend on it.
        retries: how often a batch is submitted again after its worker was lost.
        progress: function that is called with ``done`` and ``of``, the numbers of completed and of all samples; or True for a line on
            the terminal.

    Returns:
        The displays, the yield, and the report of ``papilio tolerance``.

    Raises:
        ScenarioError: if the scenario is invalid; with the position of the error.
        DesignError: if one of the displays is invalid; ``design`` is the index of its sample.
        ArgumentError: if an argument is invalid; the message names it (closed client, folder that cannot be created, ...).
        ClusterError: if the cluster was closed, or lost a batch more often than ``retries`` allows. The contents of ``out`` are kept.
        FileError: if the journal cannot be used, for example because another program is writing it.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> found = papilio.tolerance("scenarios/tolerance.toml", set={"tolerance.samples": 64, "tolerance.sensitivity_samples": 4})
        >>> 0 <= found.share <= 1
        True
    """
    changed = read(scenario, with_solver(set))
    workers = checked_threads(threads) or os.cpu_count() or 1
    whole("retries", retries, 0, 1000)
    seconds = float(reals("batch_seconds", batch_seconds, least=1e-3, most=86400.0))
    tell = reporter(progress, "samples")
    if client is not None:
        check_client(client)
    core = _papilio.Production(*changed._state())
    folder = checked_folder(out)
    try:
        if folder is not None:
            core.open(folder)
        missing = core.missing()
        if client is None:
            try:
                core.compute(missing, workers, tell)
            except DesignError as error:
                at = error.design if isinstance(error.design, int) else error.design[0]
                raise DesignError(str(error.args[0]), missing[at]) from None
        else:
            question = _samples.question(changed, core)
            _samples.compute(question, core, missing, ClusterBackend(client, question, retries), seconds, tell)
        scene = changed._scene()
        found = Yield(core, core.finish(), changed.title, scene.warnings, scene.notes)
    finally:
        core.close()
        if isinstance(tell, Line):
            tell.end()
    _messages.warn(found.warnings)
    return found
