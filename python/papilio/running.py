"""Runs of scenarios, and arguments that several computations share."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from typing import Any, Literal

from . import _messages, _papilio
from ._arguments import described, one_of, whole
from .errors import ArgumentError
from .result import Result
from .scenario import Scenario, read

__all__ = ["Progress", "Solver", "run"]

#: The solver; ``"walk"`` is the old name of ``"monte-carlo"``.
Solver = Literal["adding", "monte-carlo", "auto", "walk"]

#: Function that reports progress. Its argument has fraction (of the whole, which never decreases), views_done, views, relative_error, target and paths for a run
#: (None where there is none); done and of for designs and searches; fraction for a fit.
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
    progress: Progress | bool | None = None,
) -> Result:
    """Computes the display that a scenario, or a scenario file, describes, as ``papilio run`` does.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        solver: ``"adding"``, ``"monte-carlo"`` or ``"auto"`` (the one with less work); None: that of the scenario.
        seed: integer that selects the random numbers of the Monte Carlo solver; None: that of the scenario.
        threads: number of threads; None: one for each processor. The results do not depend on it.
        set: values to set in the scenario first, ``{path: value}``; the `Scenario` itself is not changed. Spectra and materials may
            be arrays, as in `Scenario`.
        progress: function that is called a few times a second with the progress of the run, or True for a line on the terminal.

    Returns:
        The result: arrays over views, states and wavelengths, by name.

    Raises:
        ScenarioError: if the scenario is invalid; with the position of the error.
        DisplayError: if the display cannot be computed.
        KeyboardInterrupt: on Ctrl-C, within about a second.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> result = papilio.run("scenarios/indoor.toml", set={"viewer.theta_deg": 20})
        >>> round(float(result["contrast_ratio"][0]), 1)
        24.5
    """
    changed = read(scenario, with_solver(set, solver, seed))
    scene = changed._scene()
    with reporting(progress, "views") as tell:
        core = _papilio.Prepared(scene).run(scene, checked_threads(threads), tell)
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
        known = "monte-carlo" if isinstance(solver, str) and solver == "walk" else solver
        all_values["solver.method"] = one_of("solver", known, ("adding", "monte-carlo", "auto"))
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
        if "done" in state:
            workers = state.get("workers")
            of_workers = "" if workers is None else f" on {workers} workers"
            line = f"{state['done']:,} of {state['of']:,} {self._noun}{of_workers}"
        elif "views" not in state:
            line = f"{100 * state['fraction']:.0f} % {self._noun}"
        else:
            target = "" if state["target"] is None else f", target {state['target']:.2g}"
            error = "" if state["relative_error"] is None else f", relative error {state['relative_error']:.2g}{target}"
            line = f"{100 * state['fraction']:.0f} %, {state['views_done']:,} of {state['views']:,} {self._noun}{error}"
        sys.stderr.write(f"\r{line:<79}")
        sys.stderr.flush()
        self._is_open = True

    def end(self) -> None:
        """Ends the line."""
        if self._is_open:
            sys.stderr.write("\n")
            self._is_open = False


def reporter(progress: Progress | bool | None, noun: str) -> Progress | None:
    """Returns a function that reports progress; for True, one that prints to the terminal, with ``noun`` as the unit."""
    if isinstance(progress, bool):
        return Line(noun) if progress else None
    return checked_progress(progress)


@contextmanager
def reporting(progress: Progress | bool | None, noun: str) -> Iterator[Progress | None]:
    """Provides the function of `reporter`, and ends its line on the terminal."""
    tell = reporter(progress, noun)
    try:
        yield tell
    finally:
        if isinstance(tell, Line):
            tell.end()


def checked_progress(progress: Progress | None) -> Progress | None:
    """Returns a function that reports progress, or None.

    Raises:
        ArgumentError: if it is not callable.
    """
    if progress is not None and not callable(progress):
        raise ArgumentError(f"progress: expected a function or a bool, not {described(progress)}")
    return progress

