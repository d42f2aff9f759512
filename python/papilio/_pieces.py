"""Pieces of a search, on a cluster."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass, field
from typing import Any

from . import _papilio
from ._batches import Question
from ._roads import OnCluster
from .running import Progress
from .scenario import Scenario


@dataclass(frozen=True)
class Pieces(Question):
    """What a scenario's ``[optimize]`` asks, piece by piece."""

    def made(self) -> tuple[Any, str]:
        """The search."""
        search = _papilio.Search(*self.scenario._state())
        return search, search.hash


@dataclass
class Piece:
    """A descent, or some designs of a population's generation; as JSON."""

    start: int
    text: str = field(repr=False)
    tries: int = 0

    def __str__(self) -> str:
        return f"piece {self.start} of the search"

    def computed(self, question: Question, folder: str | None, threads: int = 1) -> str:
        """What became of it, as JSON."""
        search: _papilio.Search = question.kept()
        return search.work(self.text)


class _Open:
    """The pieces that can be done now: it goes on after its end, when others are done."""

    def __init__(self, search: _papilio.Search) -> None:
        self._search, self._given = search, 0

    def __iter__(self) -> _Open:
        return self

    def __next__(self) -> Piece:
        text = self._search.piece()
        if text is None:
            raise StopIteration
        self._given += 1
        return Piece(self._given, text)


def question(scenario: Scenario, search: _papilio.Search) -> Pieces:
    """What is asked by a scenario's ``[optimize]``."""
    return Pieces(scenario, (), (), 0, search.hash)


def compute(question: Pieces, search: _papilio.Search, road: OnCluster, tell: Progress | None) -> None:
    """Has a search that was begun done on a cluster.

    Raises:
        ClusterError: the cluster was closed, or lost a piece too often.
    """
    with closing(road.each(question, _Open(search), None)) as answers:
        for _, answer in answers:
            search.take(answer)
            if tell is not None:
                done, of = search.progress()
                tell({"done": done, "of": of, "workers": road.workers()})
