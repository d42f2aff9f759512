"""Samples of a production in batches."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _batches, _papilio
from ._batches import Columns, Grid, Question
from ._roads import Failed, OnCluster, seconds_each
from .errors import DesignError
from .running import Progress
from .scenario import Scenario

#: The one variable: which sample.
SAMPLE = "sample"


@dataclass(frozen=True)
class Samples(Question):
    """The displays of a production, each with those that go with it; their numbers are the `metrics`."""

    sensitivity_rows: int

    @cached_property
    def described(self) -> dict[str, Any]:
        """As of any question; what goes with a sample is asked, too."""
        return {**super().described, "sensitivity_samples": self.sensitivity_rows}

    def made(self) -> tuple[Any, str]:
        """The production."""
        production = _papilio.Production(*self.scenario._state())
        return production, production.hash

    def answered(self, columns: Columns, threads: int = 1) -> NDArray[np.float64]:
        """The numbers of samples, shape [sample, number]; NaN behind those of a sample that nothing goes with."""
        production: _papilio.Production = self.kept()
        rows = columns[SAMPLE].astype(np.int64)
        found = np.full((rows.size, len(self.metrics)), np.nan)
        for at in np.split(np.arange(rows.size), np.flatnonzero(np.diff(rows) != 1) + 1):
            numbers = production.evaluate(int(rows[at[0]]), int(rows[at[-1]]) + 1, threads)
            ends = np.cumsum([production.width(int(rows[i])) for i in at])
            for i, row in zip(at, np.split(numbers, ends[:-1]), strict=True):
                found[i, : row.size] = row
        return found


def question(scenario: Scenario, production: _papilio.Production) -> Samples:
    """What is asked by a scenario's ``[tolerance]``."""
    metrics = production.names()[1]
    draws = production.width(0) // len(metrics)
    names = [*metrics, *(f"{metric} [{draw}]" for draw in range(1, draws) for metric in metrics)]
    return Samples(scenario, (SAMPLE,), tuple(names), 0, production.hash, production.sensitivity_rows)


def compute(
    question: Samples,
    production: _papilio.Production,
    rows: list[int],
    road: OnCluster,
    batch_seconds: float,
    tell: Progress | None,
) -> None:
    """Has rows computed on a cluster, and hands them to the production as they come.

    Raises:
        DesignError: if one of the displays cannot be.
        ClusterError: the cluster was closed, or lost a batch too often.
    """
    if not rows:
        return
    grid = Grid({SAMPLE: np.array(rows, dtype=np.float64)}, (len(rows),))
    each = seconds_each(question, grid, road)
    size = _batches.batch_size(each, batch_seconds, len(rows), road.workers() or 1)
    done = 0
    try:
        with closing(road.each(question, _batches.cut(question, grid, size), None)) as answers:
            for batch, (values, _) in answers:
                for row, numbers in zip(batch.columns[SAMPLE], values, strict=True):
                    production.take(int(row), np.array(numbers))  # what came by wire need not be aligned
                done += batch.size
                if tell is not None:
                    tell({"done": done, "of": len(rows), "workers": road.workers()})
    except Failed as failed:
        at = failed.error.design
        first = at if isinstance(at, int) else at[0]
        raise DesignError(str(failed.error.args[0]), rows[failed.batch.start + first]) from None
