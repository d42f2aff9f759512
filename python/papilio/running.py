"""Runs."""

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

#: How a display is computed.
Solver = Literal["adding", "monte-carlo", "walk"]

#: What a ``progress`` function is given: of a run views_done, views, relative_error, target and paths; of designs and
#: searches done and of.
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
    """Computes the display that a scenario, or a scenario file, describes: what ``papilio run`` does.

    Args:
        scenario: a `Scenario`, or the path of one.
        solver: ``"adding"`` or ``"monte-carlo"``; None: the scenario's own.
        seed: of the walk; None: the scenario's own.
        threads: how many; None: one for each processor. They change no number.
        set: values put in before, ``{path: value}``; the scenario itself stays as it is.
        progress: called a few times a second with how far the run has come.

    Raises:
        ScenarioError: with the place of what is wrong.
        DisplayError: if the display cannot be computed.
        KeyboardInterrupt: on Ctrl-C, within about a second.

    Warns:
        PapilioWarning: what the program prints as a warning; the result has it as ``warnings``, too.
    """
    changed = read(scenario, with_solver(set, solver, seed))
    scene = changed._scene()
    core = _papilio.Prepared(scene).run(scene, checked_threads(threads), checked_progress(progress))
    _messages.warn(core.warnings())
    return Result(core, changed.title)


def with_solver(
    values: Mapping[str, Any] | None, solver: str | None = None, seed: int | None = None
) -> dict[str, Any]:
    """The values to set, with those of the solver."""
    if values is not None and not isinstance(values, Mapping):
        raise ArgumentError(f"set: expected a dict of paths and values, not {described(values)}")
    all_values = dict(values or {})
    if solver is not None:
        all_values["solver.method"] = one_of("solver", solver, ("adding", "monte-carlo", "walk"))
    if seed is not None:
        all_values["solver.seed"] = whole("seed", seed, 0, _LARGEST_SEED)
    return all_values


def checked_threads(threads: int | None) -> int | None:
    """The number of threads, if it is one."""
    return None if threads is None else whole("threads", threads, 1, _MOST_THREADS)


class Line:
    """Tells on the terminal (stderr), in one line, how many of so many things are done."""

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
        """Leaves the line."""
        if self._is_open:
            sys.stderr.write("\n")


def told(progress: Progress | bool | None, noun: str) -> Progress | None:
    """The function; of True one that tells on the terminal how many of these there are."""
    if isinstance(progress, bool):
        return Line(noun) if progress else None
    return checked_progress(progress)


def checked_progress(progress: Progress | None) -> Progress | None:
    """The function, if it is one."""
    if progress is not None and not callable(progress):
        raise ArgumentError(f"progress: expected a function, not {described(progress)}")
    return progress

