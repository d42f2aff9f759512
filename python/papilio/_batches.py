"""Batches of designs: their addresses, their sizes, and their evaluation by a worker."""

from __future__ import annotations

import hashlib
import json
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import ceil, log2, prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _parts
from ._dims import Dims
from ._papilio import __version__
from .errors import ClusterError, DesignError
from ._keys import Keys, joined
from .prepared import Prepared, Skipped
from .scenario import Scenario

#: The values (numbers or strings) of each variable, one for each design.
Columns = dict[Keys, NDArray[Any]]

#: The largest number of designs in a batch: a few megabytes.
_LARGEST = 2**17


@dataclass(frozen=True)
class Question:
    """The metrics requested of every design: all that a worker needs in addition to the batch."""

    scenario: Scenario
    variables: tuple[Keys, ...]
    metrics: tuple[str, ...]
    view: int
    hash: str
    version: str = field(default=__version__, kw_only=True)

    @cached_property
    def described(self) -> dict[str, Any]:
        """The request as a JSON object. Equal requests to the same version of the program have equal objects."""
        return {
            "papilio": self.version,
            "scenario": self.hash,
            "variables": [[keys] if isinstance(keys, str) else list(keys) for keys in self.variables],
            "metrics": list(self.metrics),
            "view": self.view,
        }

    @cached_property
    def address(self) -> str:
        """SHA-256 of the request."""
        return hashlib.sha256(json.dumps(self.described, sort_keys=True).encode()).hexdigest()

    def address_of(self, columns: Columns) -> str:
        """Returns the SHA-256 of the request and of these designs."""
        digest = hashlib.sha256(self.address.encode())
        for keys in self.variables:
            column = columns[keys]
            if column.dtype.kind == "U":
                content = json.dumps(column.tolist()).encode()
            else:
                content = np.ascontiguousarray(column, dtype="<f8").tobytes()
            digest.update(f"{column.dtype.kind} {len(content)} ".encode() + content)
        return digest.hexdigest()

    def evaluate(self, columns: Columns, threads: int = 1) -> NDArray[np.float64]:
        """Computes the metrics of designs, shape [design, metric]."""
        prepared: Prepared = self.evaluator()
        return prepared.evaluate(columns, list(self.metrics), view=self.view, threads=threads)

    def evaluate_skipping(self, columns: Columns, threads: int = 1) -> tuple[NDArray[np.float64], Skipped]:
        """Computes as `evaluate`, with NaN for invalid designs; also returns their indices in the batch and the reasons."""
        prepared: Prepared = self.evaluator()
        return prepared._skipping(columns, list(self.metrics), self.view, threads)

    def create_evaluator(self) -> tuple[Any, str]:
        """Creates the evaluator of the request, and returns it with the hash of its scenario."""
        return Prepared._silent(self.scenario), self.scenario.hash

    def evaluator(self) -> Any:
        """Returns the evaluator of this thread. Only the latest is cached, so that memory does not grow with the number of requests."""
        if getattr(_cache, "address", None) != self.address:
            if self.version != __version__:
                raise ClusterError(f"a worker has papilio {__version__}, but this program has {self.version}")
            evaluator, scenario_hash = self.create_evaluator()
            if scenario_hash != self.hash:
                raise ClusterError("a worker reads files of the same names as this program, but with different contents")
            _cache.evaluator, _cache.address = evaluator, self.address
        return _cache.evaluator


_cache = threading.local()


@dataclass(frozen=True)
class Grid:
    """Variables that broadcast together. No array of the size of all designs is allocated."""

    columns: Columns
    shape: tuple[int, ...]
    #: The dimensions, if the variables are xarray arrays.
    dims: Dims | None = None

    @property
    def size(self) -> int:
        """The number of designs."""
        return prod(self.shape)

    def take(self, which: NDArray[np.int64]) -> Columns:
        """Returns the designs at flat indices."""
        at = np.unravel_index(which, self.shape) if self.shape else ()
        whole = {keys: np.broadcast_to(column, self.shape) for keys, column in self.columns.items()}
        return {keys: np.atleast_1d(column[at]) for keys, column in whole.items()}

    def sample(self, count: int) -> Columns:
        """Returns ``count`` designs at uniform intervals of the flat index, or all if there are fewer."""
        return self.take(np.linspace(0, self.size - 1, min(count, self.size)).astype(np.int64))

    def place(self, flat: int) -> tuple[int, ...]:
        """Returns the index of a design in the arrays from its flat index."""
        return tuple(int(i) for i in np.unravel_index(flat, self.shape)) if self.shape else ()


@dataclass
class Batch:
    """Designs that are computed together."""

    start: int
    columns: Columns = field(repr=False)
    address: str
    #: Whether invalid designs are skipped instead of ending the computation.
    skips: bool = False
    #: The number of times the batch was submitted to a worker.
    tries: int = 0

    @property
    def size(self) -> int:
        """The number of designs."""
        return len(next(iter(self.columns.values())))

    def __str__(self) -> str:
        return f"batch of {self.size} designs starting at design {self.start}"

    def compute(
        self, question: Question, folder: str | None, threads: int = 1
    ) -> tuple[NDArray[np.float64], Skipped] | None:
        """Computes the batch; writes metrics and skipped designs into ``folder``, or returns them."""
        skipped: Skipped = []
        if self.skips:
            values, skipped = question.evaluate_skipping(self.columns, threads)
        else:
            values = question.evaluate(self.columns, threads)
        if folder is None:
            return values, skipped
        if not Path(folder).is_dir():
            raise ClusterError(f"out: the folder {folder} does not exist for a worker; expected a folder on a disk that all machines share")
        _parts.write(Path(folder), self.address, self.columns, question.metrics, values, question.described, skipped)
        return None


def cut(question: Question, grid: Grid, size: int, skips: bool = False) -> Iterator[Batch]:
    """Yields all designs in order, in batches of ``size``."""
    for start in range(0, grid.size, size):
        columns = grid.take(np.arange(start, min(start + size, grid.size)))
        yield Batch(start, columns, question.address_of(columns), skips)


def seconds_each(question: Question, columns: Columns, skips: bool = False) -> float | None:
    """Measures the seconds per design in a trial of 0.25 s or of all `columns`; None if one of the designs is invalid.

    With ``skips``, such designs are skipped, as in the computation. No exception is raised, because a cluster would log it as a
    failure.
    """
    count = len(next(iter(columns.values())))
    evaluate = question.evaluate_skipping if skips else question.evaluate
    many, took = 0, 0.0
    try:
        evaluate({keys: column[:1] for keys, column in columns.items()})
        while took < 0.25 and many < count:
            many = min(max(1, 2 * many), count)
            before = time.perf_counter()
            evaluate({keys: column[:many] for keys, column in columns.items()})
            took = time.perf_counter() - before
    except DesignError:
        return None
    return took / many


def batch_size(seconds_per_design: float, batch_seconds: float, designs: int, workers: int) -> int:
    """Returns the designs in a batch: a power of two that takes about ``batch_seconds``, with several batches for each worker."""
    wanted = batch_seconds / max(seconds_per_design, 1e-9)
    fair = ceil(designs / (8 * max(workers, 1)))
    return int(min(_LARGEST, 2 ** max(0, round(log2(max(wanted, 1.0)))), 2 ** max(0, round(log2(max(fair, 1))))))


def placed(error: DesignError, batch: Batch, grid: Grid) -> DesignError:
    """Returns the error with the index of the design among all designs."""
    within = error.design[0] if isinstance(error.design, tuple) else error.design
    return DesignError(str(error.args[0]), grid.place(batch.start + within))


def as_names(columns: Mapping[Keys, Any]) -> dict[str, Any]:
    """Returns columns by their names in tables: keys with a common value are joined by commas."""
    return {joined(keys): column for keys, column in columns.items()}
