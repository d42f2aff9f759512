"""Evaluation of millions of designs in batches, on this machine or on a Dask cluster; it can be interrupted and resumed.

`evaluate_many` is `Prepared.evaluate` for more designs than fit one call; `sweep` evaluates a grid. The results are the same, to
the last bit, on every machine and in any order of the batches. (`papilio.optimize` and `papilio.tolerance` have their own
argument ``client``.)
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _batches, _messages, _parts
from ._arguments import common_shape, described, one_of, reals, whole
from ._batches import Batch, Grid, Question
from ._backends import INSTALL, ClusterBackend, Failed, LocalBackend, check_client, seconds_each
from .errors import ArgumentError, DesignError
from .evaluated import Evaluated
from ._keys import Keys, Names, short_names
from ._sweeps import crossed_axes
from .prepared import SPECTRUM, AnyKeys, OnError, Skipped, Table, checked_metrics, columns, named
from .running import checked_threads
from .scenario import Scenario, read

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["Evaluated", "Progress", "evaluate_many", "print_progress", "sweep"]


def __dir__() -> list[str]:
    return __all__

#: Function that reports progress. Its argument has ``done`` and ``of`` (designs), ``reused``, ``workers``, ``seconds``.
Progress = Callable[[dict[str, Any]], object]


def evaluate_many(
    scenario: Scenario | str | PathLike[str],
    variables: Mapping[AnyKeys, ArrayLike] | Table,
    metrics: Sequence[str],
    *,
    view: int = 0,
    set: Mapping[str, Any] | None = None,
    out: str | PathLike[str] | None = None,
    client: Client | None = None,
    batch_seconds: float = 4.0,
    threads: int | None = None,
    retries: int = 3,
    on_error: OnError = "raise",
    names: Names | None = None,
    progress: Progress | bool | None = None,
) -> Evaluated:
    """Computes metrics of very many designs, shape [designs..., metric]: the same numbers as `Prepared.evaluate`.

    Designs are computed in batches of about ``batch_seconds``: a trial of 0.25 s determines how many
    designs that is. With ``out``, each batch is a Parquet file that is named by the SHA-256 of the request and of the designs'
    values, and is written completely or not at all. Call again to resume an interrupted computation; a call with more designs
    computes only the new ones.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        variables: keys, or tuples of keys with a common value, with arrays that broadcast to ``designs...``.
        metrics: names of `metric_names`.
        view: index of one of the scenario's views, from 0.
        set: values to set in the scenario first, ``{path: value}``.
        out: folder for results; with a cluster of several machines, on a disk that all machines share.
        client: a `distributed.Client`, whose workers compute one batch per thread. None: this machine.
        batch_seconds: approximate computing time of a batch. Longer batches have less overhead; a lost worker loses one
            batch.
        threads: without ``client``: number of threads; None: one for each processor.
        retries: how often a batch is submitted again after its worker was lost.
        on_error: "raise": an invalid design ends the call; "nan": its metrics are NaN, and ``errors`` of the result has its index
            and the reason.
        names: short names of the variables in tables, ``{key: name}`` or a list; by default the keys.
        progress: function that is called after every batch, or True for a line on the terminal.

    Returns:
        The metrics: ``found["white.Y"]``, ``to_xarray()``, ``to_pandas()``; with ``out``, they are read from there when needed.

    Raises:
        ArgumentError: if an argument is invalid; the message names it (closed client, shapes, NaN, ...).
        DesignError: for the first invalid design that is found (unless ``on_error="nan"``).
        ScenarioError: if a key does not exist.
        ClusterError: if the cluster was closed, or lost a batch more often than ``retries`` allows. The contents of ``out`` are kept.

    Warns:
        PapilioWarning: each warning about the scenario; ``warnings`` of the result contains it.

    Example:
        >>> rng = np.random.default_rng(0)
        >>> designs = {"display.pixel.film.0.thickness_nm": rng.uniform(50, 60, 100), "display.pixel.gap_nm.red": rng.uniform(270, 280, 100)}
        >>> papilio.cluster.evaluate_many("scenarios/indoor.toml", designs, ["white.Y"])["white.Y"].shape
        (100,)
    """
    found = _found(scenario, variables, metrics, view, set, out, client, batch_seconds, threads, retries, on_error, names, progress)
    _messages.warn(found.warnings)
    return found


def sweep(
    scenario: Scenario | str | PathLike[str],
    axes: Mapping[AnyKeys, ArrayLike],
    metrics: Sequence[str],
    *,
    view: int = 0,
    set: Mapping[str, Any] | None = None,
    out: str | PathLike[str] | None = None,
    client: Client | None = None,
    batch_seconds: float = 4.0,
    threads: int | None = None,
    retries: int = 3,
    on_error: OnError = "raise",
    names: Names | None = None,
    progress: Progress | bool | None = None,
) -> Evaluated:
    """Computes metrics at every combination of values, in batches that can be interrupted and resumed.

    `papilio.sweep` is the same in one call on this machine, also for several views and for spectra.

    Args:
        axes: keys, or tuples of keys with a common value, with one-dimensional values.

    The other arguments, the errors and the warnings are those of `evaluate_many`.

    Returns:
        The metrics, shape [axes..., metric], with a coordinate for each axis in ``to_xarray()``.

    Example:
        >>> axes = {"display.pixel.gap_nm.red": [265.0, 275.9], "display.pixel.film.2.material": ["SiO2", "MgF2"]}
        >>> papilio.cluster.sweep("scenarios/indoor.toml", axes, ["red.Y"])["red.Y"].shape
        (2, 2)
    """
    found = _found(scenario, crossed_axes(axes), metrics, view, set, out, client, batch_seconds, threads, retries, on_error, names, progress)
    _messages.warn(found.warnings)
    return found


def print_progress(state: Mapping[str, Any]) -> None:
    """Prints the progress in one line on the terminal (stderr).

    Args:
        state: what a ``progress`` function is called with.
    """
    new = state["done"] - state["reused"]
    rate = new / state["seconds"] if state["seconds"] > 0 else 0.0
    left = f", {(state['of'] - state['done']) / rate:.0f} s to go" if rate > 0 else ""
    of_workers = f" on {state['workers']} workers" if state["workers"] is not None else ""
    end = "\n" if state["done"] == state["of"] else ""
    line = f"{state['done']:,} of {state['of']:,} designs, {rate:,.0f}/s{of_workers}{left}"
    sys.stderr.write(f"\r{line:<79}{end}")
    sys.stderr.flush()


def _found(
    scenario: Scenario | str | PathLike[str],
    variables: Mapping[AnyKeys, ArrayLike] | Table,
    metrics: Sequence[str],
    view: int,
    set: Mapping[str, Any] | None,
    out: str | PathLike[str] | None,
    client: Client | None,
    batch_seconds: float,
    threads: int | None,
    retries: int,
    on_error: OnError,
    names: Names | None,
    progress: Progress | bool | None,
) -> Evaluated:
    """Evaluates designs without raising warnings."""
    grid = _grid(variables)
    question = _question(read(scenario, set), tuple(grid.columns), metrics, view)
    skips = one_of("on_error", on_error, ("raise", "nan")) == "nan"
    return _evaluated(question, grid, out, client, batch_seconds, threads, retries, skips, names, progress)


def _evaluated(
    question: Question,
    grid: Grid,
    out: str | PathLike[str] | None,
    client: Client | None,
    batch_seconds: float,
    threads: int | None,
    retries: int,
    skips: bool,
    names: Names | None,
    progress: Progress | bool | None,
) -> Evaluated:
    """Evaluates all designs of a grid."""
    short_names(names, list(grid.columns))
    seconds = float(reals("batch_seconds", batch_seconds, least=1e-3, most=86400.0))
    whole("retries", retries, 0, 1000)
    if client is not None:
        check_client(client)
    backend = LocalBackend(checked_threads(threads)) if client is None else ClusterBackend(client, question, retries)
    folder, size = _opened(out, question, grid, backend, seconds, skips)
    report = _ProgressReporter(progress, grid.size, backend)
    found: dict[str, tuple[NDArray[np.float64], Skipped]] = {}
    order: list[str] = []

    def missing() -> Iterator[Batch]:
        for batch in _batches.cut(question, grid, size, skips):
            order.append(batch.address)
            if folder is None or not _parts.whole(folder, batch.address, batch.size):
                yield batch
                continue
            known = [] if skips else _parts.skipped(folder, batch.address)
            if known:
                raise Failed(DesignError(known[0][1], known[0][0]), batch)
            report(batch, reused=True)

    try:
        with closing(backend.each(question, missing(), None if folder is None else str(folder))) as answers:
            for batch, answer in answers:
                if answer is not None:
                    found[batch.address] = answer
                report(batch)
    except Failed as failed:
        raise _batches.placed(failed.error, failed.batch, grid) from None
    finally:
        report.end()
    return Evaluated(grid, question, order, found, folder, size, report.reused, names=names)


def _grid(variables: Mapping[AnyKeys, ArrayLike] | Table) -> Grid:
    arrays, dims = columns(variables)
    if not arrays:
        raise ArgumentError("variables: expected at least one key")
    return Grid(arrays, common_shape({named(keys): array for keys, array in arrays.items()}), dims)


def _question(scenario: Scenario, variables: tuple[Keys, ...], metrics: Sequence[str], view: int) -> Question:
    asked = tuple(checked_metrics(metrics))
    spectra = [name for name in asked if name.endswith(SPECTRUM)]
    if spectra:
        raise ArgumentError(f"metrics: {spectra[0]} is a spectrum; papilio.sweep and Prepared.evaluate compute spectra")
    if len(dict.fromkeys(asked)) < len(asked):
        raise ArgumentError(f"metrics: expected each name once; given {', '.join(asked)}")
    return Question(scenario, variables, asked, whole("view", view, 0, 4999), scenario.hash)


def _opened(
    out: str | PathLike[str] | None,
    question: Question,
    grid: Grid,
    backend: LocalBackend | ClusterBackend,
    batch_seconds: float,
    skips: bool,
) -> tuple[Path | None, int]:
    """Returns the folder for parts, or None, and the number of designs in a batch."""
    where = None if out is None else Path(os.path.abspath(out))
    if where is not None:
        try:
            import pyarrow  # noqa: F401
        except ImportError:
            raise ArgumentError(f"out: writing results requires pyarrow, which is not installed: {INSTALL}") from None
    size = None if where is None else _parts.known_size(where, question.address)
    if size is None and grid.size:
        each = seconds_each(question, grid, backend, skips)
        size = _batches.batch_size(each, batch_seconds, grid.size, backend.workers() or 1)
    if where is None:
        return None, size or 1
    return _parts.open_folder(where, question.address, question.described, size or 1)


class _ProgressReporter:
    """Calls a ``progress`` function."""

    def __init__(self, progress: Progress | bool | None, of: int, backend: LocalBackend | ClusterBackend) -> None:
        if progress is not None and not isinstance(progress, bool) and not callable(progress):
            raise ArgumentError(f"progress: expected a function or a bool, not {described(progress)}")
        self._tell = print_progress if progress is True else (progress or None)
        self._of, self._backend, self._started = of, backend, time.monotonic()
        self._done = self.reused = 0

    def __call__(self, batch: Batch, reused: bool = False) -> None:
        self._done += batch.size
        self.reused += batch.size if reused else 0
        if self._tell is not None:
            seconds = time.monotonic() - self._started
            state = {"done": self._done, "of": self._of, "reused": self.reused, "seconds": seconds}
            self._tell({**state, "workers": self._backend.workers()})

    def end(self) -> None:
        """Ends the terminal's line if the computation is not complete."""
        if self._tell is print_progress and self._done < self._of:
            sys.stderr.write("\n")
