"""Work items of a search, on a cluster."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, field
from typing import Any

from . import _papilio
from ._batches import Question
from ._backends import ClusterBackend
from .running import Progress
from .scenario import Scenario


@dataclass(frozen=True)
class SearchRequest(Question):
    """The search that a scenario's ``[optimize]`` describes, as separate work items."""

    def create_evaluator(self) -> tuple[Any, str]:
        """Creates the search, and returns it with its hash."""
        search = _papilio.Search(*self.scenario._state())
        return search, search.hash


@dataclass
class WorkItem:
    """A descent, or some designs of a population's generation, as JSON."""

    start: int
    text: str = field(repr=False)
    tries: int = 0

    def __str__(self) -> str:
        return f"work item {self.start} of the search"

    def compute(self, question: Question, folder: str | None, threads: int = 1) -> str:
        """Computes the work item, and returns its result as JSON."""
        search: _papilio.Search = question.evaluator()
        return search.work(self.text)


class _AvailableItems:
    """Iterates over the work items that can be computed now; may yield more after its end, when others are complete."""

    def __init__(self, search: _papilio.Search) -> None:
        self._search, self._count = search, 0

    def __iter__(self) -> _AvailableItems:
        return self

    def __next__(self) -> WorkItem:
        text = self._search.piece()
        if text is None:
            raise StopIteration
        self._count += 1
        return WorkItem(self._count, text)


def question(scenario: Scenario, search: _papilio.Search) -> SearchRequest:
    """Creates the request for the search of a scenario's ``[optimize]``."""
    return SearchRequest(scenario, (), (), 0, search.hash)


def compute(question: SearchRequest, search: _papilio.Search, backend: ClusterBackend, tell: Progress | None) -> None:
    """Computes a search, which has begun, on a cluster.

    Raises:
        ClusterError: if the cluster was closed, or lost a work item more often than ``retries`` allows.
    """
    with closing(backend.each(question, _AvailableItems(search), None)) as answers:
        for _, answer in answers:
            search.take(answer)
            if tell is not None:
                done, of = search.progress()
                tell({"done": done, "of": of, "workers": backend.workers()})
