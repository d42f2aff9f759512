"""The search for better designs that a scenario's ``[optimize]`` describes."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _messages, _metadata, _papilio, _work_items
from ._arguments import checked_folder, whole
from ._backends import ClusterBackend, check_client
from ._keys import attributes
from ._mapping import Lookup
from ._storing import Stored, optional, single, variable, written
from .errors import ArgumentError
from .figure import Figure
from .running import Line, Progress, checked_threads, reporter, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
    import pandas
    import xarray
    from distributed import Client

__all__ = ["Design", "Optimum", "optimize"]


class Design(NamedTuple):
    """A design and its metrics."""

    #: Values of the keys that the design sets.
    values: dict[str, Any]
    #: Values of the requested quantities, by name; NaN where undefined.
    metrics: dict[str, float]
    #: Whether the design meets all limits.
    meets_limits: bool = True


class Optimum(Stored, Lookup[NDArray[np.float64]]):
    """Result of a search: the best design, or the Pareto front of several objectives. A notebook shows a table.

    ``found["white.Y"]`` has a requested quantity, or a key, of each of the `designs`.
    """

    def __init__(self, scenario: Scenario, content: Mapping[str, Any]) -> None:
        self._scenario = scenario
        self._quantities: list[str] = list(content["quantities"])
        #: The scenario's own design.
        self.own = self._design(content["own"])
        #: The resulting designs: one, or those of the Pareto front from one end to the other.
        self.designs = [self._design(one) for one in content["chosen"]]
        #: Number of evaluated designs.
        self.evaluations = int(content["evaluations"])
        self._table: str = content["table"]
        self._figures: list[tuple[str, str]] = content["figures"]
        scene = scenario._scene()
        #: Warnings; each was also raised as a `papilio.PapilioWarning` by the computation.
        self.warnings: list[str] = [*scene.warnings, *self._missed()]
        #: Notes on data that were measured, assumed or scaled.
        self.notes: list[str] = list(scene.notes)

    def _missed(self) -> list[str]:
        """Returns a warning if the search found no feasible design."""
        if not self.designs:
            return ["no design could be evaluated, because its metrics are undefined"]
        if not self.designs[0].meets_limits:
            return ["no feasible design was found; the returned design has the smallest violation of the constraints"]
        return []

    def _design(self, content: Mapping[str, Any]) -> Design:
        values = [float("nan") if value is None else float(value) for value in content["values"]]
        return Design(dict(content["set"]), dict(zip(self._quantities, values, strict=True)), content.get("meets_limits", True))

    @property
    def best(self) -> Design:
        """The best design; for a Pareto front, its first design.

        Raises:
            ValueError: if no design could be evaluated.
        """
        if not self.designs:
            raise ArgumentError("scenario: no design could be evaluated, because its metrics are undefined")
        return self.designs[0]

    def scenario(self, design: int = 0) -> Scenario:
        """Returns the scenario with one of the `designs`."""
        return self._scenario.with_values(self.designs[whole("design", design, 0, len(self.designs) - 1)].values)

    def front(self) -> NDArray[np.float64]:
        """Returns the requested quantities of all `designs`, shape [design, quantity]; ``best.metrics`` has their names."""
        rows = [list(design.metrics.values()) for design in self.designs]
        return np.array(rows, dtype=np.float64).reshape(len(rows), len(self._quantities))

    def _names(self) -> Iterable[str]:
        return [*self.own.values, *self._quantities]

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Returns a quantity or a key of each of the `designs`.

        Raises:
            KeyError: if the search has neither.
        """
        if name not in (*self.own.values, *self._quantities):
            raise KeyError(f"{name!r}: there is no such quantity or key; expected {', '.join(self._names())}")
        column = np.array([{**one.values, **one.metrics}[name] for one in self.designs])
        column.flags.writeable = False
        return column

    def to_xarray(self) -> xarray.Dataset:
        """Returns keys and requested quantities of the `designs` as a Dataset over ``design``, with units and long names.

        Keys are coordinates with the names of `to_pandas`; ``meets_limits`` tells whether a design meets all limits.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        coordinates: dict[Any, Any] = {variable(key): ("design", self[key].copy(), attributes(key)) for key in self.own.values}
        coordinates["design"] = np.arange(len(self.designs))
        data: dict[Any, Any] = {name: ("design", self[name].copy(), _metadata.attributes(name)) for name in self._quantities}
        data["meets_limits"] = ("design", np.array([one.meets_limits for one in self.designs]), {"long_name": "whether all limits are met"})
        about = {"evaluations": self.evaluations} | _messages.attributes(self.warnings, self.notes)
        return xarray.Dataset(data, coordinates, about)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table of the scenario's own design and the `designs`: keys, requested quantities, ``meets_limits``.

        The index ``design`` has ``"scenario"``, then the numbers of the designs as texts: ``"0"``, ``"1"`` and so on.

        Raises:
            ImportError: if pandas is not installed.
        """
        with optional("pandas"):
            import pandas

        rows = [{**one.values, **one.metrics, "meets_limits": one.meets_limits} for one in (self.own, *self.designs)]
        return pandas.DataFrame(rows, index=pandas.Index(["scenario", *map(str, range(len(self.designs)))], name="design"))

    def figures(self) -> dict[str, Figure]:
        """Returns the figures of ``papilio optimize``, by name: ``trace``, and ``front`` if there are several objectives."""
        return {name: Figure(name, svg) for name, svg in self._figures}

    def save(self, folder: str | PathLike[str]) -> list[Path]:
        """Writes the files of ``papilio optimize`` except the journal (see ``out`` of `optimize`) into a folder, which is created.

        The files are ``best.toml``, or ``front-01.toml`` and so on, with the scenario of each design (``closest.toml`` if a single
        design does not meet all limits; then a ``best.toml`` of an earlier search is removed, and vice versa), ``optimize.csv`` with
        the result of each task, and the figures. Relative paths in the scenarios are adapted to the folder; files that a `Scenario`
        has in memory are not written.
        """
        one = len(self.designs) == 1
        designs = [self._single()] if one else [f"front-{at + 1:02}.toml" for at in range(len(self.designs))]
        figures = {f"{figure.name}.svg": figure.svg for figure in self.figures().values()}
        name = single(folder, ["optimize.csv", *designs, *figures])
        where = Path(folder) if name is None else Path(folder).parent
        texts = {"optimize.csv": self._table}
        for at, of_design in enumerate(designs):
            design = self.scenario(at)
            texts[of_design] = _papilio.moved_text(design.to_toml(), design._folder, str(where))
        if name is None:
            for other in {"best.toml", "closest.toml"} - texts.keys():
                (where / other).unlink(missing_ok=True)
        return written(folder, {file: text.encode() for file, text in (texts | figures).items()})

    def _single(self) -> str:
        """Returns the program's file name for a single design."""
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
    """Searches for the designs that a scenario's ``[optimize]`` describes, as ``papilio optimize`` does.

    The search consists of work items, which are independent within a round: descents from one starting point each, and designs of
    a population's generation. Threads or the workers of a cluster compute them; the result is the same, to the last bit.

    Args:
        scenario: a `Scenario`, or the path of a scenario file, with ``[optimize]``.
        set: values to set in the scenario first, ``{path: value}``, including those of ``[optimize]`` (``"optimize.seed": 1``).
        out: folder for the journal ``optimize.jsonl``, which is also that of ``papilio optimize``: either of them can resume an
            interrupted search from it. None: an interrupted search starts again.
        client: a `distributed.Client`, whose workers compute one work item per thread. None: this machine.
        threads: without ``client``: number of threads; None: one for each processor. The results do not depend on it.
        retries: how often a work item is submitted again after its worker was lost.
        progress: function that is called with ``done`` and ``of``, the numbers of completed searches and of those that are known so
            far (a front adds more); or True for a line on the terminal.

    Returns:
        The best design, or the designs of a Pareto front.

    Raises:
        ScenarioError: if the scenario is invalid; with the position of the error.
        ArgumentError: if an argument is invalid; the message names it (closed client, folder that cannot be created, ...).
        ClusterError: if the cluster was closed, or lost a work item more often than ``retries`` allows. The contents of ``out`` are kept.
        FileError: if the journal cannot be used, for example because another program is writing it.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> few = {"optimize.evaluations": 20, "optimize.starts": 1}
        >>> found = papilio.optimize("scenarios/optimize.toml", set=few)
        >>> len(found.designs) >= 1
        True
    """
    changed = read(scenario, with_solver(set))
    workers = checked_threads(threads) or os.cpu_count() or 1
    whole("retries", retries, 0, 1000)
    tell = reporter(progress, "searches")
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
