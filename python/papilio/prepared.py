"""Displays that are prepared for the evaluation of thousands of designs."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _messages, _papilio
from ._arguments import described, text, whole
from ._dims import Dims, crossed
from ._toml import plain
from .errors import ArgumentError, DesignError
from .result import Result
from .running import Progress, checked_progress, checked_threads, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
    import xarray

__all__ = ["AnyKeys", "Keys", "Prepared", "metric_names"]

_Answer = TypeVar("_Answer")

#: One key of a scenario, or several keys with a common value.
Keys = str | tuple[str, ...]

#: The key type of a mapping. A type variable is necessary because mappings are invariant in their keys.
AnyKeys = TypeVar("AnyKeys", bound=Keys)

#: Invalid designs: the index of each, and the reason.
Skipped = list[tuple[int, str]]


def metric_names() -> list[str]:
    """Returns the names of the metrics of designs; metrics of states are listed for the state ``white``."""
    return _papilio.metric_names()


class Prepared:
    """A display, its light and its views, prepared for many designs.

    Computations that do not change between designs are done once: angular kernels are reused while layers, views and lights are
    the same, films while their layers and gaps are the same. The results of `run` equal those of `papilio.run` to the last bit,
    those of `evaluate` within the scenario's error::

        prepared = papilio.Prepared("scenarios/indoor.toml")
        d = np.linspace(40, 70, 31)
        y = prepared.evaluate({"display.pixel.film.0.thickness_nm": d}, metrics=["gamut_percent_srgb", "white.Y"])
        y.shape                                       # (31, 2)

    The constructor raises each warning about the scenario as a `papilio.PapilioWarning`; `run` raises those that only a run detects
    (such as a target that was not reached). A prepared display can be pickled: the pickle contains the scenario, and the kernels
    are computed again.
    """

    def __init__(self, scenario: Scenario | str | PathLike[str], *, set: Mapping[str, Any] | None = None) -> None:
        self._prepare(read(scenario, with_solver(set)).copy())
        _messages.warn(self.warnings)

    def _prepare(self, scenario: Scenario) -> None:
        self._scenario = scenario
        self._core = _papilio.Prepared(scenario._scene())
        self._batches: dict[Any, _papilio.Batch] = {}

    @classmethod
    def _silent(cls, scenario: Scenario) -> Prepared:
        """Prepares a scenario without raising its warnings."""
        made = cls.__new__(cls)
        made._prepare(scenario)
        return made

    @property
    def warnings(self) -> list[str]:
        """Warnings about the scenario; the designs that change it are not checked."""
        return self._scenario._scene().warnings

    @property
    def notes(self) -> list[str]:
        """Notes on data that were measured, assumed or scaled."""
        return self._scenario._scene().notes

    @property
    def scenario(self) -> Scenario:
        """A copy of the scenario."""
        return self._scenario.copy()

    def run(
        self,
        values: Mapping[str, Any] | None = None,
        *,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Result:
        """Computes the full result of one design: the scenario with ``{path: value}`` set; see `papilio.run`."""
        changed = self._scenario.with_values(with_solver(values)) if values else self._scenario
        core = self._core.run(changed._scene(), checked_threads(threads), checked_progress(progress))
        _messages.warn(core.warnings())
        return Result(core, changed.title)

    @overload
    def evaluate(
        self,
        variables: Mapping[AnyKeys, xarray.DataArray],
        metrics: Sequence[str],
        *,
        view: int = 0,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> xarray.DataArray: ...
    @overload
    def evaluate(
        self,
        variables: Mapping[AnyKeys, ArrayLike],
        metrics: Sequence[str],
        *,
        view: int = 0,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> NDArray[np.float64]: ...
    def evaluate(
        self,
        variables: Mapping[AnyKeys, ArrayLike],
        metrics: Sequence[str],
        *,
        view: int = 0,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Any:
        """Computes metrics of many designs in one call, shape [designs..., metric]; NaN where undefined.

        xarray arrays broadcast by their dimensions, and the result is a DataArray over these and ``metric``.

        Args:
            variables: keys (``display.pixel.gap_nm.red``), or tuples of keys with a common value, with arrays of
                values that broadcast to ``designs...`` by numpy's rules. Values are numbers in the key's own unit, or
                strings (the names of materials).
            metrics: names of `metric_names`: "gamut_percent_srgb", "white.Y".
            view: index of one of the scenario's views, from 0.
            threads: number of threads; None: one for each processor. The results do not depend on it.
            progress: function that is called a few times a second.

        Raises:
            ArgumentError: if an argument is invalid; the message names it.
            DesignError: for the first invalid design, with the reason.
            KeyboardInterrupt: on Ctrl-C, within about a second.
        """
        call = self._call(variables, metrics, view, threads, progress)
        found = call.array(call.answer(call.batch.evaluate)[0])
        return found if call.dims is None else call.dims.labelled(found, metric=list(metrics))

    def _skipping(
        self, variables: Mapping[AnyKeys, ArrayLike], metrics: Sequence[str], view: int, threads: int | None
    ) -> tuple[NDArray[np.float64], Skipped]:
        """Computes as `evaluate`, with NaN for invalid designs; also returns their indices and the reasons."""
        call = self._call(variables, metrics, view, threads, None)
        values, skipped = call.batch.evaluate(call.designs, call.many, call.threads, None, skip=True)
        return call.array(values), skipped

    @overload
    def derivatives(
        self,
        variables: Mapping[AnyKeys, xarray.DataArray],
        metrics: Sequence[str],
        *,
        view: int = 0,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> tuple[xarray.DataArray, xarray.DataArray]: ...
    @overload
    def derivatives(
        self,
        variables: Mapping[AnyKeys, ArrayLike],
        metrics: Sequence[str],
        *,
        view: int = 0,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def derivatives(
        self,
        variables: Mapping[AnyKeys, ArrayLike],
        metrics: Sequence[str],
        *,
        view: int = 0,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Any:
        """Computes metrics of many designs and their derivatives: shapes [designs..., metric] and [designs..., metric, variable].

        The derivative is that of the metric with respect to the variable (for several keys: their common value), per unit of the
        variable; NaN where undefined, 0 for variables with strings. Derivatives with respect to numbers of a film pixel are exact;
        the others are central differences.

        Arguments and errors are those of `evaluate`.
        """
        call = self._call(variables, metrics, view, threads, progress)
        values, slopes = call.answer(call.batch.derivatives)
        found, steep = call.array(values), call.array(slopes, len(variables))
        if call.dims is None:
            return found, steep
        names = [", ".join(_keys(keys)) for keys in variables]
        return call.dims.labelled(found, metric=list(metrics)), call.dims.labelled(steep, metric=list(metrics), variable=names)

    def _call(
        self,
        variables: Mapping[AnyKeys, ArrayLike],
        metrics: Sequence[str],
        view: int,
        threads: int | None,
        progress: Progress | None,
    ) -> _Call:
        """Checks the arguments of a call."""
        asked = checked_metrics(metrics)
        arrays, choices, dims = _split(variables)
        shape = _arguments.common_shape(arrays) if arrays else ()
        at = whole("view", view, 0, 4999)
        designs = np.stack([np.broadcast_to(array, shape) for array in arrays.values()], axis=-1) if arrays else np.zeros((1, 0))
        return _Call(
            self._batch([_keys(keys) for keys in variables], choices, asked, at),
            np.ascontiguousarray(designs).reshape(-1),
            shape,
            len(asked),
            checked_threads(threads) or os.cpu_count() or 1,
            checked_progress(progress),
            dims,
        )

    def _batch(
        self, keys: list[tuple[str, ...]], choices: list[list[Any] | None], metrics: list[str], view: int
    ) -> _papilio.Batch:
        """Returns the batch evaluator for this request; it reuses its kernels in later calls."""
        written = [None if some is None else json.dumps(some) for some in choices]
        question = (tuple(keys), tuple(written), tuple(metrics), view)
        if question not in self._batches:
            text, name, folder, files = self._scenario._state()
            self._batches = {
                question: _papilio.Batch(
                    self._scenario._scene(), text, name, folder, files, list(zip(keys, written, strict=True)), metrics, [view]
                )
            }
        return self._batches[question]

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._scenario,)

    def __repr__(self) -> str:
        return f"<papilio.Prepared {self._scenario.name!r}{_messages.summary(self.warnings)}>"


def _restored(scenario: Scenario) -> Prepared:
    return Prepared._silent(scenario)


class _Call(NamedTuple):
    """The checked arguments of a call."""

    batch: _papilio.Batch
    designs: NDArray[np.float64]
    shape: tuple[int, ...]
    metrics: int
    threads: int
    progress: Progress | None
    #: The dimensions, if the variables are xarray arrays.
    dims: Dims | None

    @property
    def many(self) -> int:
        """The number of designs."""
        return int(np.prod(self.shape, dtype=np.int64))

    def answer(self, of: Callable[[NDArray[np.float64], int, int, Progress | None], _Answer]) -> _Answer:
        """Calls the batch; a `DesignError` gets the index of the design in the arrays."""
        try:
            return of(self.designs, self.many, self.threads, self.progress)
        except DesignError as error:
            flat = error.design if isinstance(error.design, int) else 0
            at = tuple(int(i) for i in np.unravel_index(flat, self.shape)) if self.shape else ()
            raise DesignError(error.args[0], at) from None

    def array(self, flat: NDArray[np.float64], *inner: int) -> NDArray[np.float64]:
        """Returns flat numbers with the axes of designs and metrics."""
        return flat.reshape(*self.shape, self.metrics, *inner)


def checked_metrics(metrics: Sequence[str]) -> list[str]:
    """Returns a list of names of metrics.

    Raises:
        ArgumentError: if ``metrics`` is not a list of strings.
    """
    names = metrics.tolist() if isinstance(metrics, np.ndarray) and metrics.ndim == 1 else metrics
    if not isinstance(names, (list, tuple)) or not names:
        raise ArgumentError(f"metrics: expected a list of names such as gamut_percent_srgb or white.Y, not {described(metrics)}")
    return [text("metrics", name, "names such as gamut_percent_srgb or white.Y") for name in names]


def _keys(keys: Keys) -> tuple[str, ...]:
    return (keys,) if isinstance(keys, str) else tuple(keys)


def columns(variables: Mapping[AnyKeys, ArrayLike]) -> tuple[dict[Keys, NDArray[Any]], Dims | None]:
    """Returns the numbers or strings of each variable so that they broadcast, and the dimensions of xarray arrays."""
    if not isinstance(variables, Mapping):
        raise ArgumentError(f"variables: expected a dict of keys and arrays, not {described(variables)}")
    varied: set[str] = set()
    for keys in variables:
        if not isinstance(keys, (str, tuple)) or not keys:
            raise ArgumentError(f"variables: expected a key such as display.pixel.gap_nm.red, or a tuple of keys, not {described(keys)}")
        for path in _keys(keys):
            text("variables", path, "a key such as display.pixel.gap_nm.red")
            if path in varied:
                raise ArgumentError(f"variables: expected each key once; {path} is given twice")
            varied.add(path)
    by_keys: dict[Keys, Any] = {keys: values for keys, values in variables.items()}
    plain_ones, dims = crossed(by_keys, {keys: named(keys) for keys in by_keys})
    arrays: dict[Keys, NDArray[Any]] = {}
    for each, values in plain_ones.items():
        strings = _strings(values)
        arrays[each] = _arguments.reals(named(each), values) if strings is None else strings
    return arrays, dims


def named(keys: Keys) -> str:
    """Returns the name of a variable for errors."""
    return f"variables[{', '.join(_keys(keys))!r}]"


def _split(variables: Mapping[AnyKeys, ArrayLike]) -> tuple[dict[str, NDArray[np.float64]], list[list[Any] | None], Dims | None]:
    """Returns the numbers of each variable, its choices if its values are strings, and the dimensions of xarray arrays."""
    arrays: dict[str, NDArray[np.float64]] = {}
    choices: list[list[Any] | None] = []
    found, dims = columns(variables)
    for keys, values in found.items():
        if values.dtype.kind == "U":
            known, which = np.unique(values, return_inverse=True)
            choices.append(plain(known, named(keys)))
            arrays[named(keys)] = which.reshape(values.shape).astype(np.float64)
        else:
            choices.append(None)
            arrays[named(keys)] = values
    return arrays, choices, dims


def _strings(values: ArrayLike) -> NDArray[np.str_] | None:
    """Returns an array of strings; None for other values."""
    if not isinstance(values, (str, list, tuple, np.ndarray)):
        return None
    try:
        words = np.asarray(values)
    except ValueError:
        return None
    return words if words.dtype.kind == "U" else None
