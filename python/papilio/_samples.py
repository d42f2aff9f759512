"""Samples of a production in batches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _papilio
from ._batches import Columns, Question
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


def question(scenario: Scenario) -> tuple[Samples, _papilio.Production]:
    """What is asked by a scenario's ``[tolerance]``."""
    production = _papilio.Production(*scenario._state())
    metrics = production.names()[1]
    draws = production.width(0) // len(metrics)
    names = [*metrics, *(f"{metric} [{draw}]" for draw in range(1, draws) for metric in metrics)]
    asked = Samples(scenario, (SAMPLE,), tuple(names), 0, production.hash, production.sensitivity_rows)
    return asked, production


def flat(production: _papilio.Production, found: NDArray[np.float64]) -> NDArray[np.float64]:
    """The numbers as a report takes them, one sample after the other."""
    return np.concatenate([row[: production.width(at)] for at, row in enumerate(found)])
