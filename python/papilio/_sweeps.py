"""Sweeps on this machine: grids of designs in one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import common_shape, described, one_of
from ._batches import Grid, Question
from ._dims import is_labelled
from ._keys import Keys, Names
from .errors import ArgumentError
from .evaluated import Evaluated
from .prepared import AnyKeys, OnError, Prepared, View, columns, named
from .running import Progress, reporting
from .scenario import Scenario

__all__ = ["crossed_axes", "sweep", "swept"]

#: Address of the only part of a sweep in memory.
_ADDRESS = ""


def sweep(
    scenario: Scenario | str | PathLike[str],
    axes: Mapping[AnyKeys, ArrayLike],
    metrics: Sequence[str],
    *,
    view: View = 0,
    set: Mapping[str, Any] | None = None,
    names: Names | None = None,
    threads: int | None = None,
    on_error: OnError = "raise",
    progress: Progress | bool | None = None,
) -> Evaluated:
    """Computes metrics at every combination of values, with labelled axes, on this machine.

    `papilio.cluster.sweep` does the same in batches that can be interrupted and resumed, also on a cluster.

    Args:
        scenario: a `Scenario`, or the path of a scenario file.
        axes: keys, or tuples of keys with a common value, with one-dimensional values: numbers or strings.
        metrics: names of `metric_names`: "gamut_percent_srgb", "white.Y". Spectra instead of numbers: "white.reflectance_factor".
        view: index of one of the scenario's views, from 0; a list of indices, or "all".
        set: values to set in the scenario first, ``{path: value}``.
        names: short names of the axes in tables, ``{key: name}`` or a list; by default the keys.
        threads: number of threads; None: one for each processor. The results do not depend on it.
        on_error: "raise": an invalid design ends the call; "nan": its metrics are NaN, and ``errors`` of the result has its index and
            the reason.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        The metrics: ``found["white.Y"]``, ``to_xarray()`` with units and long names, ``to_pandas()``, ``figures()``.

    Raises:
        ArgumentError, DesignError, ScenarioError, KeyboardInterrupt: as for `Prepared.evaluate`.

    Warns:
        PapilioWarning: each warning about the scenario; ``warnings`` of the result contains it.

    Example:
        >>> axes = {"display.pixel.film.0.thickness_nm": [50, 55.9, 60], "display.diffuser.haze": [0.6, 0.78]}
        >>> found = papilio.sweep("scenarios/indoor.toml", axes, ["gamut_percent_srgb"], names=["matching_nm", "haze"])
        >>> dict(found.to_xarray().sizes)
        {'matching_nm': 3, 'haze': 2}
    """
    return Prepared(scenario, set=set).sweep(
        axes, metrics, view=view, names=names, threads=threads, on_error=on_error, progress=progress
    )


def swept(
    prepared: Prepared,
    axes: Mapping[AnyKeys, ArrayLike],
    metrics: Sequence[str],
    view: View,
    names: Names | None,
    threads: int | None,
    on_error: OnError,
    progress: Progress | bool | None,
) -> Evaluated:
    """Computes metrics at every combination of values; see `sweep`."""
    arrays = crossed_axes(axes)
    shape = common_shape({named(keys): array for keys, array in arrays.items()})
    skips = one_of("on_error", on_error, ("raise", "nan")) == "nan"
    with reporting(progress, "designs") as tell:
        call = prepared._call(arrays, metrics, view, threads)
        if skips:
            values, skipped = call.batch.evaluate(call.designs, call.many, call.threads, tell, skip=True)
        else:
            values, skipped = call.answer(call.batch.evaluate, tell)
    scenario = prepared._scenario
    views = call.labels.get("view")
    first = view if isinstance(view, int) else 0
    question = Question(scenario, tuple(arrays), tuple(call.labels["metric"]), first, scenario.hash)
    flat = values.reshape(call.many, *map(len, call.labels.values()))
    return Evaluated(
        Grid(arrays, shape), question, [_ADDRESS], {_ADDRESS: (flat, skipped)}, None, call.many, 0, names=names, views=views
    )


def crossed_axes(axes: Mapping[AnyKeys, ArrayLike]) -> dict[Keys, Any]:
    """Returns the values of each axis along an axis of its own.

    Raises:
        ArgumentError: if the values of an axis do not have one dimension, or two axes have the same one.
    """
    if not isinstance(axes, Mapping):
        raise ArgumentError(f"axes: expected a dict of keys and values, not {described(axes)}")
    if not axes:
        raise ArgumentError("axes: expected at least one key")
    given: dict[Keys, Any] = {keys: one for keys, one in axes.items()}
    dims = [one.dims for one in given.values() if is_labelled(one)]
    if len({name for own in dims for name in own}) < sum(map(len, dims)):
        raise ArgumentError(
            f"axes: two axes have the same dimension ({', '.join(map(str, dims))}); expected separate dimensions, because a sweep "
            "combines every value with every other. For values that vary together, use papilio.cluster.evaluate_many"
        )
    plain = {keys: np.asarray(one) if is_labelled(one) else one for keys, one in given.items()}
    open_grid: dict[Keys, Any] = {}
    for at, (keys, line) in enumerate(columns(plain)[0].items()):
        if line.ndim != 1:
            raise ArgumentError(f"axes: expected the values of {keys!r} in one dimension, not shape {line.shape}")
        open_grid[keys] = line.reshape([-1 if i == at else 1 for i in range(len(axes))])
    return open_grid
