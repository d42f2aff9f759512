"""Runs of scenarios, and arguments that several computations share."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any, Literal

from . import _messages, _papilio
from ._arguments import described, one_of, whole
from .errors import ArgumentError
from .result import Result
from .scenario import Scenario, read

__all__ = ["Progress", "Solver", "run"]

#: The solver; ``"walk"`` is the old name of ``"monte-carlo"``.
Solver = Literal["adding", "monte-carlo", "walk"]

#: Function that reports progress. Its argument has views_done, views, relative_error, target and paths for a run; done and of
#: for designs and searches.
Progress = Callable[[dict[str, Any]], object]

_MOST_THREADS = 65535
_LARGEST_SEED = 2**63 - 1


def run(
    scenario: Scenario | str | PathLike[str],
    *,
    solver: Solver | None = None,
    seed: int | None = None,
    threads: int | None = None,
    set: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> Result:
    """Computes the display that a scenario, or a scenario file, describes, as ``papilio run`` does.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        solver: ``"adding"`` or ``"monte-carlo"``; None: that of the scenario.
        seed: integer that selects the random numbers of the Monte Carlo solver; None: that of the scenario.
        threads: number of threads; None: one for each processor. The results do not depend on it.
        set: values to set in the scenario first, ``{path: value}``; the `Scenario` itself is not changed.
        progress: function that is called a few times a second with the progress of the run.

    Raises:
        ScenarioError: if the scenario is invalid; with the position of the error.
        DisplayError: if the display cannot be computed.
        KeyboardInterrupt: on Ctrl-C, within about a second.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.
    """
    changed = read(scenario, with_solver(set, solver, seed))
    scene = changed._scene()
    core = _papilio.Prepared(scene).run(scene, checked_threads(threads), checked_progress(progress))
    _messages.warn(core.warnings())
    return Result(core, changed.title)


def with_solver(
    values: Mapping[str, Any] | None, solver: str | None = None, seed: int | None = None
) -> dict[str, Any]:
    """Returns the values to set, including those of the solver."""
    if values is not None and not isinstance(values, Mapping):
        raise ArgumentError(f"set: expected a dict of paths and values, not {described(values)}")
    all_values = dict(values or {})
    if solver is not None:
        all_values["solver.method"] = one_of("solver", solver, ("adding", "monte-carlo", "walk"))
    if seed is not None:
        all_values["solver.seed"] = whole("seed", seed, 0, _LARGEST_SEED)
    return all_values


def checked_threads(threads: int | None) -> int | None:
    """Returns a number of threads, or None.

    Raises:
        ArgumentError: if it is not an integer from 1 to 65535.
    """
    return None if threads is None else whole("threads", threads, 1, _MOST_THREADS)


class Line:
    """Progress in one line on the terminal (stderr)."""

    def __init__(self, noun: str) -> None:
        self._noun, self._is_open = noun, False

    def __call__(self, state: Mapping[str, Any]) -> None:
        workers = state.get("workers")
        of_workers = "" if workers is None else f" on {workers} workers"
        line = f"{state['done']:,} of {state['of']:,} {self._noun}{of_workers}"
        sys.stderr.write(f"\r{line:<79}")
        sys.stderr.flush()
        self._is_open = True

    def end(self) -> None:
        """Ends the line."""
        if self._is_open:
            sys.stderr.write("\n")


def reporter(progress: Progress | bool | None, noun: str) -> Progress | None:
    """Returns a function that reports progress; for True, one that prints to the terminal, with ``noun`` as the unit."""
    if isinstance(progress, bool):
        return Line(noun) if progress else None
    return checked_progress(progress)


def checked_progress(progress: Progress | None) -> Progress | None:
    """Returns a function that reports progress, or None.

    Raises:
        ArgumentError: if it is not callable.
    """
    if progress is not None and not callable(progress):
        raise ArgumentError(f"progress: expected a function, not {described(progress)}")
    return progress

