"""Batches of designs: what they are called, how large they are, and what a worker does with one."""

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
from .prepared import Keys, Prepared, Skipped
from .scenario import Scenario

#: The numbers (or words) of each variable, one for each design.
Columns = dict[Keys, NDArray[Any]]

#: More designs than this are never one batch: a few megabytes.
_LARGEST = 2**17


@dataclass(frozen=True)
class Question:
    """What is asked of every design: all that a worker has to know besides the batch."""

    scenario: Scenario
    variables: tuple[Keys, ...]
    metrics: tuple[str, ...]
    view: int
    hash: str
    version: str = field(default=__version__, kw_only=True)

    @cached_property
    def described(self) -> dict[str, Any]:
        """It in JSON's words; equal questions of equal programs have equal ones."""
        return {
            "papilio": self.version,
            "scenario": self.hash,
            "variables": [[keys] if isinstance(keys, str) else list(keys) for keys in self.variables],
            "metrics": list(self.metrics),
            "view": self.view,
        }

    @cached_property
    def address(self) -> str:
        """SHA-256 of what is asked."""
        return hashlib.sha256(json.dumps(self.described, sort_keys=True).encode()).hexdigest()

    def address_of(self, columns: Columns) -> str:
        """SHA-256 of what is asked of these designs."""
        digest = hashlib.sha256(self.address.encode())
        for keys in self.variables:
            column = columns[keys]
            if column.dtype.kind == "U":
                content = json.dumps(column.tolist()).encode()
            else:
                content = np.ascontiguousarray(column, dtype="<f8").tobytes()
            digest.update(f"{column.dtype.kind} {len(content)} ".encode() + content)
        return digest.hexdigest()

    def answered(self, columns: Columns, threads: int = 1) -> NDArray[np.float64]:
        """The metrics of designs, shape [design, metric]."""
        prepared: Prepared = self.kept()
        return prepared.evaluate(columns, list(self.metrics), view=self.view, threads=threads)

    def skipping(self, columns: Columns, threads: int = 1) -> tuple[NDArray[np.float64], Skipped]:
        """As `answered`; but designs that cannot be are NaN, and stand beside: their number in the batch and why."""
        prepared: Prepared = self.kept()
        return prepared._skipping(columns, list(self.metrics), self.view, threads)

    def made(self) -> tuple[Any, str]:
        """What answers it, and the hash of what that was made of."""
        return Prepared._silent(self.scenario), self.scenario.hash

    def kept(self) -> Any:
        """What answers it in this thread. The last one is kept, so memory does not grow with questions."""
        if getattr(_kept, "address", None) != self.address:
            if self.version != __version__:
                raise ClusterError(f"a worker has papilio {__version__}, this program {self.version}")
            made, of = self.made()
            if of != self.hash:
                raise ClusterError("a worker reads other files than this program, by the same names")
            _kept.made, _kept.address = made, self.address
        return _kept.made


_kept = threading.local()


@dataclass(frozen=True)
class Grid:
    """Variables that broadcast together; nothing of the size of all designs is made."""

    columns: Columns
    shape: tuple[int, ...]
    #: Of arrays of xarray's.
    dims: Dims | None = None

    @property
    def size(self) -> int:
        """How many designs there are."""
        return prod(self.shape)

    def take(self, which: NDArray[np.int64]) -> Columns:
        """The designs of these flat indices."""
        at = np.unravel_index(which, self.shape) if self.shape else ()
        whole = {keys: np.broadcast_to(column, self.shape) for keys, column in self.columns.items()}
        return {keys: np.atleast_1d(column[at]) for keys, column in whole.items()}

    def sample(self, count: int) -> Columns:
        """So many designs from all over."""
        return self.take(np.linspace(0, self.size - 1, min(count, self.size)).astype(np.int64))

    def place(self, flat: int) -> tuple[int, ...]:
        """The index of a design in the arrays."""
        return tuple(int(i) for i in np.unravel_index(flat, self.shape)) if self.shape else ()


@dataclass
class Batch:
    """Designs that are computed at once."""

    start: int
    columns: Columns = field(repr=False)
    address: str
    #: Whether designs that cannot be are left out, and end nothing.
    skips: bool = False
    #: How often it was given to a worker.
    tries: int = 0

    @property
    def size(self) -> int:
        """How many designs it holds."""
        return len(next(iter(self.columns.values())))

    def __str__(self) -> str:
        return f"{self.size} designs from number {self.start} on"

    def computed(
        self, question: Question, folder: str | None, threads: int = 1
    ) -> tuple[NDArray[np.float64], Skipped] | None:
        """Its answers, and what was skipped: written into ``folder``, or given back."""
        skipped: Skipped = []
        if self.skips:
            values, skipped = question.skipping(self.columns, threads)
        else:
            values = question.answered(self.columns, threads)
        if folder is None:
            return values, skipped
        if not Path(folder).is_dir():
            raise ClusterError(f"out: a worker does not see the folder {folder}; it has to be on a disk that all share")
        _parts.write(Path(folder), self.address, self.columns, question.metrics, values, question.described, skipped)
        return None


def cut(question: Question, grid: Grid, size: int, skips: bool = False) -> Iterator[Batch]:
    """All designs, in order."""
    for start in range(0, grid.size, size):
        columns = grid.take(np.arange(start, min(start + size, grid.size)))
        yield Batch(start, columns, question.address_of(columns), skips)


def seconds_each(question: Question, columns: Columns, skips: bool = False) -> float | None:
    """What a design costs here, from a trial of a quarter of a second or all of `columns`; None if one of them cannot be.

    With ``skips`` such designs are left out, as they will be. (Nothing is raised: a cluster would log it as a failure.)
    """
    count = len(next(iter(columns.values())))
    answered = question.skipping if skips else question.answered
    many, took = 0, 0.0
    try:
        answered({keys: column[:1] for keys, column in columns.items()})
        while took < 0.25 and many < count:
            many = min(max(1, 2 * many), count)
            before = time.perf_counter()
            answered({keys: column[:many] for keys, column in columns.items()})
            took = time.perf_counter() - before
    except DesignError:
        return None
    return took / many


def batch_size(seconds_per_design: float, batch_seconds: float, designs: int, workers: int) -> int:
    """Designs in a batch: a power of two, of about this many seconds, and enough batches that nobody waits for the last."""
    wanted = batch_seconds / max(seconds_per_design, 1e-9)
    fair = ceil(designs / (8 * max(workers, 1)))
    return int(min(_LARGEST, 2 ** max(0, round(log2(max(wanted, 1.0)))), 2 ** max(0, round(log2(max(fair, 1))))))


def placed(error: DesignError, batch: Batch, grid: Grid) -> DesignError:
    """The error, with the design's place among all."""
    within = error.design[0] if isinstance(error.design, tuple) else error.design
    return DesignError(str(error.args[0]), grid.place(batch.start + within))


def as_names(columns: Mapping[Keys, Any]) -> dict[str, Any]:
    """Columns under the names that tables give them: keys that move alike, with commas."""
    return {keys if isinstance(keys, str) else ", ".join(keys): column for keys, column in columns.items()}
