"""Yield: what production makes of a design, as a scenario's ``[tolerance]`` describes it."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _messages, _papilio, _samples, _snapshots
from ._arguments import checked_folder, reals, whole
from ._snapshots import ProductionSnapshot, read_only
from ._backends import ClusterBackend, check_client
from .errors import DesignError
from .figure import Figure
from .running import Line, Progress, checked_threads, told, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
    import pandas
    from distributed import Client

__all__ = ["Yield", "tolerance"]

#: Those of a report.
_PERCENTILES = (1, 5, 25, 50, 75, 95, 99)


class Yield:
    """How the metrics of a production scatter, how much of it meets its limits, and what is to blame.

    `report` is what ``papilio tolerance`` writes as ``tolerance.json``; a notebook shows a table. It can be copied and pickled, and
    then needs neither its scenario nor its files.
    """

    def __init__(
        self,
        core: _papilio.Production | ProductionSnapshot,
        numbers: NDArray[np.float64],
        title: str = "",
        warned: Sequence[str] = (),
        notes: Sequence[str] = (),
    ) -> None:
        self._core, self._numbers = core, read_only(numbers)
        #: The scenario's title.
        self.title = title
        keys, metrics = core.names()
        #: The names of what scatters.
        self.keys: list[str] = keys
        #: The names of what is reported.
        self.metrics: list[str] = metrics
        #: Yield, percentiles, sensitivities and the worst displays, each number with its standard error.
        self.report: dict[str, Any] = json.loads(core.report(numbers))
        starts = np.cumsum([0, *(core.width(row) for row in range(core.rows - 1))])
        #: The metrics of every display, shape [display, metric]; NaN where one is not defined. It cannot be written to.
        self.values: NDArray[np.float64] = read_only(numbers[starts[:, None] + np.arange(len(metrics))])
        #: What the reader should know; each was raised as a `papilio.PapilioWarning` when it was found.
        self.warnings = list(warned)
        #: What the reader may like to know: what was measured, assumed, or scaled.
        self.notes = list(notes)

    @property
    def share(self) -> float:
        """The share of displays that meet all limits, 0 to 1; its standard error is in `report`."""
        return float(self.report["verdict"]["yield_share"]["value"])

    def to_pandas(self) -> pandas.DataFrame:
        """Every display: what its keys are, and its metrics.

        Raises:
            ImportError: without pandas.
        """
        import pandas

        rows = [json.loads(self._core.keys(row)) for row in range(self._core.rows)]
        keys = pandas.DataFrame(rows, columns=self.keys)
        return pandas.concat([keys, pandas.DataFrame(self.values, columns=self.metrics)], axis=1)

    def figures(self) -> dict[str, Figure]:
        """What ``papilio tolerance`` draws, by name: a histogram of every metric, sensitivities, good and bad displays."""
        return {name: Figure(name, svg) for name, svg in self._core.figures(self.title, self._numbers)}

    def save(self, folder: str | PathLike[str]) -> list[Path]:
        """Writes into a folder, which is made, what ``papilio tolerance`` writes but for the journal (see ``out`` of `tolerance`):
        ``tolerance.csv``, ``tolerance-metrics.csv``, ``tolerance.json`` and the figures."""
        where = Path(folder)
        where.mkdir(parents=True, exist_ok=True)
        contents = dict(self._core.tables(self._numbers))
        contents |= {f"{figure.name}.svg": figure.svg.encode() for figure in self.figures().values()}
        for name, content in contents.items():
            (where / name).write_bytes(content)
        return [where / name for name in contents]

    def __reduce__(self) -> tuple[Any, ...]:
        kept = _snapshots.pack(ProductionSnapshot.made(self._core, self._numbers, self.title))
        return _restored, (kept, self._numbers, self.title, self.warnings, self.notes)

    def __copy__(self) -> Yield:
        return Yield(self._core, self._numbers, self.title, self.warnings, self.notes)

    def __deepcopy__(self, memo: object) -> Yield:
        return self.__copy__()  # what it has is fixed, or made anew

    def __repr__(self) -> str:
        return f"<papilio.Yield: {100 * self.share:.4g} % of {self.values.shape[0]} displays{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        """The percentiles of every metric."""
        spreads = [(one["name"], one["spread"]) for one in self.report["metrics"]]
        rows = ""
        for name, spread in spreads:
            cells = [] if spread is None else [spread["mean"], spread["deviation"], *spread["percentiles"]]
            shown = "".join(f"<td>{cell['value']:.5g}</td>" for cell in cells)
            rows += f"<tr><th>{html.escape(name)}</th>{shown}</tr>"
        titles = ["", "mean", "deviation", *(f"{percent} %" for percent in _PERCENTILES)]
        head = "".join(f"<th>{title}</th>" for title in titles)
        said = f"{100 * self.share:.4g} % of {self.values.shape[0]} displays meet all limits"
        table = f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        return f"<p>{said}</p>{table}{_messages.as_html(self.warnings, self.notes)}"


def _restored(
    content: bytes, numbers: NDArray[np.float64], title: str, warned: list[str], notes: list[str]
) -> Yield:
    return Yield(_snapshots.unpack(content), numbers, title, warned, notes)


def tolerance(
    scenario: Scenario | str | PathLike[str],
    *,
    set: Mapping[str, Any] | None = None,
    out: str | PathLike[str] | None = None,
    client: Client | None = None,
    batch_seconds: float = 4.0,
    threads: int | None = None,
    retries: int = 3,
    progress: Progress | bool | None = None,
) -> Yield:
    """What production makes of a design, as a scenario's ``[tolerance]`` describes it: what ``papilio tolerance`` finds.

    Args:
        scenario: a `Scenario`, or the path of one, with ``[tolerance]``.
        set: values put in before, ``{path: value}``, those of ``[tolerance]`` included (``"tolerance.samples": 1024``).
        out: a folder for the journal, ``tolerance.jsonl``, that ``papilio tolerance`` keeps there, too: what is in it (and in those
            of ``--shard`` beside it) is not computed again, and a production of more samples goes on from a smaller one's.
        client: a `distributed.Client`: its workers compute, in batches. None: this machine. The report is the same to the
            last bit.
        batch_seconds: with ``client``: how long a batch takes, about; what is lost with a worker is its batch.
        threads: without ``client``: how many; None: one for each processor. They change no number.
        retries: how often a batch is given out anew after the worker that had it was lost.
        progress: a function, called with ``done`` and ``of``, samples, as they go on; or True for a line on the terminal.

    Raises:
        ScenarioError: with the place of what is wrong.
        DesignError: if one of the displays cannot be; ``design`` is its sample.
        ArgumentError: names the argument that is wrong (a client that is closed, a folder that cannot be, ...).
        ClusterError: the cluster was closed, or lost a batch too often. What is in ``out`` stays.
        FileError: the journal cannot be used: another program has it, ...
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: what the program prints as a warning; the result has it as ``warnings``, too.
    """
    changed = read(scenario, with_solver(set))
    workers = checked_threads(threads) or os.cpu_count() or 1
    whole("retries", retries, 0, 1000)
    seconds = float(reals("batch_seconds", batch_seconds, least=1e-3, most=86400.0))
    tell = told(progress, "samples")
    if client is not None:
        check_client(client)
    core = _papilio.Production(*changed._state())
    folder = checked_folder(out)
    try:
        if folder is not None:
            core.open(folder)
        missing = core.missing()
        if client is None:
            try:
                core.compute(missing, workers, tell)
            except DesignError as error:
                at = error.design if isinstance(error.design, int) else error.design[0]
                raise DesignError(str(error.args[0]), missing[at]) from None
        else:
            question = _samples.question(changed, core)
            _samples.compute(question, core, missing, ClusterBackend(client, question, retries), seconds, tell)
        scene = changed._scene()
        found = Yield(core, core.finish(), changed.title, scene.warnings, scene.notes)
    finally:
        core.close()
        if isinstance(tell, Line):
            tell.end()
    _messages.warn(found.warnings)
    return found
