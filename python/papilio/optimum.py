"""The search for better designs that a scenario's ``[optimize]`` describes."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _messages, _papilio, _work_items
from ._arguments import checked_folder, whole
from ._backends import ClusterBackend, check_client
from .errors import ArgumentError
from .figure import Figure
from .running import Line, Progress, checked_threads, told, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
    import pandas
    from distributed import Client

__all__ = ["Design", "Optimum", "optimize"]


class Design(NamedTuple):
    """A design, and what it is worth."""

    #: The value of every key that it sets.
    values: dict[str, Any]
    #: What was asked of it, by name; NaN where it is not defined.
    metrics: dict[str, float]
    #: Whether it meets all limits.
    meets_limits: bool = True


class Optimum:
    """What a search found: the best design, or the front of several objectives. A notebook shows a table."""

    def __init__(self, scenario: Scenario, said: Mapping[str, Any]) -> None:
        self._scenario = scenario
        self._quantities: list[str] = list(said["quantities"])
        #: The scenario's own design.
        self.own = self._design(said["own"])
        #: The designs that are handed on: one, or those of the front from one end to the other.
        self.designs = [self._design(one) for one in said["chosen"]]
        #: How many designs were evaluated.
        self.evaluations = int(said["evaluations"])
        self._table: str = said["table"]
        self._figures: list[tuple[str, str]] = said["figures"]
        scene = scenario._scene()
        #: What the reader should know; each was raised as a `papilio.PapilioWarning` when it was found.
        self.warnings: list[str] = [*scene.warnings, *self._missed()]
        #: What the reader may like to know: what was measured, assumed, or scaled.
        self.notes: list[str] = list(scene.notes)

    def _missed(self) -> list[str]:
        """The program's words about what a search did not find."""
        if not self.designs:
            return ["no design could be evaluated: what is asked is not defined anywhere"]
        if not self.designs[0].meets_limits:
            return ["no design was found that meets all limits; this one misses them least"]
        return []

    def _design(self, said: Mapping[str, Any]) -> Design:
        values = [float("nan") if value is None else float(value) for value in said["values"]]
        return Design(dict(said["set"]), dict(zip(self._quantities, values, strict=True)), said.get("meets_limits", True))

    @property
    def best(self) -> Design:
        """The best design; of a front its first end.

        Raises:
            ValueError: if no design could be evaluated.
        """
        if not self.designs:
            raise ArgumentError("scenario: no design could be evaluated: what is asked is not defined anywhere")
        return self.designs[0]

    def scenario(self, design: int = 0) -> Scenario:
        """The scenario with one of the `designs`."""
        if isinstance(design, bool) or not isinstance(design, int) or not 0 <= design < len(self.designs):
            raise ArgumentError(f"design: expected 0 to {len(self.designs) - 1}, not {design!r}")
        return self._scenario.with_values(self.designs[design].values)

    def front(self) -> NDArray[np.float64]:
        """What was asked, of all `designs`, shape [design, quantity]; the names are those of ``best.metrics``."""
        rows = [list(design.metrics.values()) for design in self.designs]
        return np.array(rows, dtype=np.float64).reshape(len(rows), len(self._quantities))

    def to_pandas(self) -> pandas.DataFrame:
        """The scenario's own design and the `designs`, a row each: keys, what was asked, ``meets_limits``.

        Raises:
            ImportError: without pandas.
        """
        import pandas

        rows = [{**one.values, **one.metrics, "meets_limits": one.meets_limits} for one in (self.own, *self.designs)]
        return pandas.DataFrame(rows, index=pandas.Index(["scenario", *range(len(self.designs))], name="design"))

    def figures(self) -> dict[str, Figure]:
        """What ``papilio optimize`` draws, by name: ``trace``, and of several objectives ``front``."""
        return {name: Figure(name, svg) for name, svg in self._figures}

    def save(self, folder: str | PathLike[str]) -> list[Path]:
        """Writes into a folder, which is made, what ``papilio optimize`` writes but for the journal (see ``out`` of `optimize`).

        ``best.toml``, or ``front-01.toml`` and so on: the scenario with each design (``closest.toml`` where a single design does not
        meet all limits; a ``best.toml`` of an earlier search is removed then, and the other way round); ``optimize.csv``: what
        each task found; figures.
        Scenarios find files on the disk from there; those that a `Scenario` has in memory are not written.
        """
        where = Path(folder)
        where.mkdir(parents=True, exist_ok=True)
        texts = {"optimize.csv": self._table}
        for at in range(len(self.designs)):
            name = self._single() if len(self.designs) == 1 else f"front-{at + 1:02}.toml"
            design = self.scenario(at)
            texts[name] = _papilio.moved_text(design.to_toml(), design._folder, str(where))
        texts |= {f"{figure.name}.svg": figure.svg for figure in self.figures().values()}
        for other in {"best.toml", "closest.toml"} - texts.keys():
            (where / other).unlink(missing_ok=True)
        for name, content in texts.items():
            (where / name).write_bytes(content.encode())
        return [where / name for name in texts]

    def _single(self) -> str:
        """The file of a single design, as the program names it."""
        return "best.toml" if self.designs[0].meets_limits else "closest.toml"

    def __repr__(self) -> str:
        return f"<papilio.Optimum: {len(self.designs)} designs of {self.evaluations} evaluated{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        titles = ["", *self.own.values, *self._quantities]
        head = "".join(f"<th>{html.escape(title)}</th>" for title in titles)
        named = [("scenario", self.own), *((str(i), design) for i, design in enumerate(self.designs))]
        rows = ""
        for name, design in named:
            cells = [*design.values.values(), *design.metrics.values()]
            shown = "".join(f"<td>{html.escape(_shown(cell))}</td>" for cell in cells)
            rows += f"<tr><th>{name}</th>{shown}</tr>"
        table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        return table + _messages.as_html(self.warnings, self.notes)


def optimize(
    scenario: Scenario | str | PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    out: str | PathLike[str] | None = None,
    client: Client | None = None,
    threads: int | None = None,
    retries: int = 3,
    progress: Progress | bool | None = None,
) -> Optimum:
    """Searches for the designs that a scenario's ``[optimize]`` asks for: what ``papilio optimize`` does.

    The search is made of pieces that need no other of their round: descents from a place each, and designs of a population's
    generation. They are done by threads, or by the workers of a cluster; what is found is the same, to the last bit.

    Args:
        scenario: a `Scenario`, or the path of one, with ``[optimize]``.
        set: values put in before, ``{path: value}``, those of ``[optimize]`` included (``"optimize.seed": 1``).
        out: a folder for the journal, ``optimize.jsonl``, that ``papilio optimize`` keeps there, too: a search that was
            stopped or killed goes on from it, here or there. None: a stopped search begins anew.
        client: a `distributed.Client`: its workers compute, one piece for each of their threads. None: this machine.
        threads: without ``client``: how many; None: one for each processor. They change no number.
        retries: how often a piece is given out anew after the worker that had it was lost.
        progress: a function, called with ``done`` and ``of``, the searches of a round, as they go on; or True for a line on the
            terminal.

    Raises:
        ScenarioError: with the place of what is wrong.
        ArgumentError: names the argument that is wrong (a client that is closed, a folder that cannot be, ...).
        ClusterError: the cluster was closed, or lost a piece too often. What is in ``out`` stays.
        FileError: the journal cannot be used: another program has it, ...
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: what the program prints as a warning; the result has it as ``warnings``, too.
    """
    changed = read(scenario, with_solver(set))
    workers = checked_threads(threads) or os.cpu_count() or 1
    whole("retries", retries, 0, 1000)
    tell = told(progress, "searches")
    if client is not None:
        check_client(client)
    search = _papilio.Search(*changed._state())
    folder = checked_folder(out)
    try:
        if client is None:
            search.begin(folder, workers)
            search.run(workers, tell)
        else:
            question = _work_items.question(changed, search)
            backend = ClusterBackend(client, question, retries)
            search.begin(folder, max(1, backend.workers() or 1))
            _work_items.compute(question, search, backend, tell)
        found = Optimum(changed, json.loads(search.result(changed.title)))
    finally:
        search.close()
        if isinstance(tell, Line):
            tell.end()
    _messages.warn(found.warnings)
    return found


def _shown(cell: object) -> str:
    if isinstance(cell, float):
        return "" if np.isnan(cell) else f"{cell:.5g}"
    return str(cell)
