"""Samples of a tolerance analysis, in batches."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _batches, _papilio
from ._batches import Columns, Grid, Question
from ._backends import ClusterBackend, Failed, seconds_each
from .errors import DesignError
from .running import Progress
from .scenario import Scenario

#: The only variable: the index of the sample.
SAMPLE = "sample"


@dataclass(frozen=True)
class SampleRequest(Question):
    """The displays of a tolerance analysis, each with the displays of its sensitivity sample; their numbers are the `metrics`."""

    sensitivity_rows: int

    @cached_property
    def described(self) -> dict[str, Any]:
        """The request as a JSON object, with the number of sensitivity samples."""
        return {**super().described, "sensitivity_samples": self.sensitivity_rows}

    def create_evaluator(self) -> tuple[Any, str]:
        """Creates the tolerance analysis, and returns it with its hash."""
        production = _papilio.Production(*self.scenario._state())
        return production, production.hash

    def evaluate(self, columns: Columns, threads: int = 1) -> NDArray[np.float64]:
        """Computes the numbers of samples, shape [sample, number]; NaN after those of a row without a sensitivity sample."""
        production: _papilio.Production = self.evaluator()
        rows = columns[SAMPLE].astype(np.int64)
        found = np.full((rows.size, len(self.metrics)), np.nan)
        for at in np.split(np.arange(rows.size), np.flatnonzero(np.diff(rows) != 1) + 1):
            numbers = production.evaluate(int(rows[at[0]]), int(rows[at[-1]]) + 1, threads)
            ends = np.cumsum([production.width(int(rows[i])) for i in at])
            for i, row in zip(at, np.split(numbers, ends[:-1]), strict=True):
                found[i, : row.size] = row
        return found


def question(scenario: Scenario, production: _papilio.Production) -> SampleRequest:
    """Creates the request for the samples of a scenario's ``[tolerance]``."""
    metrics = production.names()[1]
    draws = production.width(0) // len(metrics)
    names = [*metrics, *(f"{metric} [{draw}]" for draw in range(1, draws) for metric in metrics)]
    return SampleRequest(scenario, (SAMPLE,), tuple(names), 0, production.hash, production.sensitivity_rows)


def compute(
    question: SampleRequest,
    production: _papilio.Production,
    rows: list[int],
    backend: ClusterBackend,
    batch_seconds: float,
    tell: Progress | None,
) -> None:
    """Computes rows on a cluster, and passes each to the tolerance analysis when it is complete.

    Raises:
        DesignError: if one of the displays is invalid.
        ClusterError: if the cluster was closed, or lost a batch more often than ``retries`` allows.
    """
    if not rows:
        return
    grid = Grid({SAMPLE: np.array(rows, dtype=np.float64)}, (len(rows),))
    each = seconds_each(question, grid, backend)
    size = _batches.batch_size(each, batch_seconds, len(rows), backend.workers() or 1)
    done = 0
    try:
        with closing(backend.each(question, _batches.cut(question, grid, size), None)) as answers:
            for batch, (values, _) in answers:
                for row, numbers in zip(batch.columns[SAMPLE], values, strict=True):
                    production.take(int(row), np.array(numbers))  # received arrays may be unaligned
                done += batch.size
                if tell is not None:
                    tell({"done": done, "of": len(rows), "workers": backend.workers()})
    except Failed as failed:
        at = failed.error.design
        first = at if isinstance(at, int) else at[0]
        raise DesignError(str(failed.error.args[0]), rows[failed.batch.start + first]) from None
