"""Displays that are prepared for the evaluation of thousands of designs."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Protocol, TypeVar, cast, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _arguments, _messages, _papilio
from ._arguments import described, text, whole
from ._dims import Dims, crossed
from ._keys import Keys, Names, joined
from ._toml import plain
from .errors import ArgumentError, DesignError
from .result import Result
from .running import Progress, checked_threads, reporting, with_solver
from .scenario import Scenario, read

if TYPE_CHECKING:
    import xarray

    from .evaluated import Evaluated

__all__ = ["AnyKeys", "Keys", "OnError", "Prepared", "Table", "View", "metric_names"]

_Answer = TypeVar("_Answer")

#: The key type of a mapping. A type variable is necessary because mappings are invariant in their keys.
AnyKeys = TypeVar("AnyKeys", bound=Keys)

#: Index of a view, several of them, or all.
View = int | Sequence[int] | Literal["all"]

#: Treatment of invalid designs.
OnError = Literal["raise", "nan"]

#: Accuracy of an answer.
Accuracy = Literal["exact", "first"]

#: End of the names of spectra.
SPECTRUM = ".reflectance_factor"

#: Invalid designs: the index of each, and the reason.
Skipped = list[tuple[int, str]]


class Table(Protocol):
    """A pandas DataFrame."""

    @property
    def columns(self) -> Any: ...
    def items(self) -> Iterable[tuple[Hashable, Any]]: ...


def metric_names() -> list[str]:
    """Returns the names of the metrics of designs.

    Returns:
        Names of metrics of a view (``"contrast_ratio"``), and of metrics of states, which are listed for the state ``white``
        (``"white.Y"``). `Prepared.evaluate` also accepts the spectra ``"white.reflectance_factor"``.

    Example:
        >>> "white.Y" in papilio.metric_names()
        True
    """
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
        progress: Progress | bool | None = None,
        accuracy: Accuracy = "exact",
    ) -> Result:
        """Computes the full result of one design.

        Args:
            values: values to set in the scenario, ``{path: value}``; None: the scenario as it is.
            threads: number of threads; None: one for each processor. The results do not depend on it.
            progress: function that is called a few times a second, or True for a line on the terminal.
            accuracy: "exact": to the target of the scenario; "first": a coarse answer of adding as soon as possible, whose
                ``discretisation_error`` states its error (``data["solver"]["is_final"]`` is False).

        Returns:
            The result of `papilio.run`, to the last bit, unless it is a first answer.

        Raises:
            ArgumentError: if an argument is invalid; the message names it.

        Example:
            >>> prepared = papilio.Prepared("scenarios/indoor.toml")
            >>> bool(prepared.run({"display.diffuser.haze": 0.6})["white.Y"][0] > 0.3)
            True
        """
        _arguments.one_of("accuracy", accuracy, ("exact", "first"))
        changed = self._scenario.with_values(with_solver(values)) if values else self._scenario
        with reporting(progress, "views") as tell:
            core = self._core.run(changed._scene(), checked_threads(threads), tell, accuracy == "first")
        _messages.warn(core.warnings())
        return Result(core, changed.title)

    @overload
    def evaluate(
        self,
        variables: Mapping[AnyKeys, xarray.DataArray],
        metrics: Sequence[str],
        *,
        view: View = 0,
        threads: int | None = None,
        progress: Progress | bool | None = None,
    ) -> xarray.DataArray: ...
    @overload
    def evaluate(
        self,
        variables: Mapping[AnyKeys, ArrayLike] | Table,
        metrics: Sequence[str],
        *,
        view: View = 0,
        threads: int | None = None,
        progress: Progress | bool | None = None,
    ) -> NDArray[np.float64]: ...
    def evaluate(
        self,
        variables: Mapping[AnyKeys, ArrayLike] | Table,
        metrics: Sequence[str],
        *,
        view: View = 0,
        threads: int | None = None,
        progress: Progress | bool | None = None,
    ) -> Any:
        """Computes metrics of many designs in one call; `sweep` returns them with labelled axes.

        Args:
            variables: keys (``display.pixel.gap_nm.red``), or tuples of keys with a common value, with arrays of values that broadcast
                to ``designs...`` by numpy's rules; or a DataFrame with keys as columns. Values are numbers in the key's own unit, or
                strings (the names of materials). xarray arrays broadcast by their dimensions.
            metrics: names of `metric_names`: "gamut_percent_srgb", "white.Y". Spectra instead of numbers: "white.reflectance_factor".
            view: index of one of the scenario's views, from 0; a list of indices, or "all".
            threads: number of threads; None: one for each processor. The results do not depend on it.
            progress: function that is called a few times a second, or True for a line on the terminal.

        Returns:
            Shape [designs..., metric]; with a list of views or "all" [designs..., view, metric]; spectra have the wavelengths of the
            scenario as a further, last axis. NaN where undefined. A DataArray if the variables are xarray arrays.

        Raises:
            ArgumentError: if an argument is invalid; the message names it.
            DesignError: for the first invalid design, with the reason.
            KeyboardInterrupt: on Ctrl-C, within about a second.

        Example:
            >>> prepared = papilio.Prepared("scenarios/indoor.toml", set={"viewer.theta_deg": [0, 30]})
            >>> gaps = {"display.pixel.gap_nm.red": [265.0, 275.9, 285.0]}
            >>> prepared.evaluate(gaps, ["red.Y", "gamut_percent_srgb"], view="all").shape
            (3, 2, 2)
            >>> prepared.evaluate(gaps, ["red.reflectance_factor"]).shape
            (3, 1, 81)
        """
        call = self._call(variables, metrics, view, threads)
        with reporting(progress, "designs") as tell:
            found = call.array(call.answer(call.batch.evaluate, tell)[0])
        return found if call.dims is None else call.dims.labelled(found, **call.labels)

    def _skipping(
        self, variables: Mapping[AnyKeys, ArrayLike], metrics: Sequence[str], view: View, threads: int | None, tell: Progress | None = None
    ) -> tuple[NDArray[np.float64], Skipped]:
        """Computes as `evaluate`, with NaN for invalid designs; also returns their indices and the reasons."""
        call = self._call(variables, metrics, view, threads)
        values, skipped = call.batch.evaluate(call.designs, call.many, call.threads, tell, skip=True)
        return call.array(values), skipped

    def sweep(
        self,
        axes: Mapping[AnyKeys, ArrayLike],
        metrics: Sequence[str],
        *,
        view: View = 0,
        names: Names | None = None,
        threads: int | None = None,
        on_error: OnError = "raise",
        progress: Progress | bool | None = None,
    ) -> Evaluated:
        """Computes metrics at every combination of values, with labelled axes.

        Args:
            axes: keys, or tuples of keys with a common value, with one-dimensional values: numbers or strings.
            metrics: names of `metric_names`: "gamut_percent_srgb", "white.Y". Spectra instead of numbers: "white.reflectance_factor".
            view: index of one of the scenario's views, from 0; a list of indices, or "all".
            names: short names of the axes in tables, ``{key: name}`` or a list; by default the keys.
            threads: number of threads; None: one for each processor. The results do not depend on it.
            on_error: "raise": an invalid design ends the call; "nan": its metrics are NaN, and ``errors`` of the result has its index
                and the reason.
            progress: function that is called a few times a second, or True for a line on the terminal.

        Returns:
            The metrics: ``found["white.Y"]``, ``to_xarray()`` with units and long names, ``to_pandas()``, ``figures()``.

        Raises:
            ArgumentError, DesignError, KeyboardInterrupt: as for `evaluate`.

        Example:
            >>> prepared = papilio.Prepared("scenarios/indoor.toml")
            >>> found = prepared.sweep({"display.pixel.gap_nm.red": [265.0, 275.9]}, ["red.Y"], names=["red_gap"])
            >>> found.to_xarray().Y.sel(state="red").dims
            ('red_gap',)
        """
        from ._sweeps import swept

        return swept(self, axes, metrics, view, names, threads, on_error, progress)

    @overload
    def derivatives(
        self,
        variables: Mapping[AnyKeys, xarray.DataArray],
        metrics: Sequence[str],
        *,
        view: View = 0,
        threads: int | None = None,
        progress: Progress | bool | None = None,
    ) -> tuple[xarray.DataArray, xarray.DataArray]: ...
    @overload
    def derivatives(
        self,
        variables: Mapping[AnyKeys, ArrayLike] | Table,
        metrics: Sequence[str],
        *,
        view: View = 0,
        threads: int | None = None,
        progress: Progress | bool | None = None,
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def derivatives(
        self,
        variables: Mapping[AnyKeys, ArrayLike] | Table,
        metrics: Sequence[str],
        *,
        view: View = 0,
        threads: int | None = None,
        progress: Progress | bool | None = None,
    ) -> Any:
        """Computes metrics of many designs and their derivatives with respect to the variables.

        Derivatives with respect to numbers of a film pixel are exact; the others are central differences.

        Args:
            variables: keys, or tuples of keys with a common value, with arrays of values, as for `evaluate`.
            metrics: names of metrics, or of spectra, as for `evaluate`.
            view: index of a view; a list of indices, or "all".
            threads: number of threads; None: one for each processor. The results do not depend on it.
            progress: function that is called a few times a second, or True for a line on the terminal.

        Returns:
            The metrics, as `evaluate` returns them, and their derivatives per unit of each variable, which are along one more, last
            axis; NaN where undefined, 0 for variables with strings. DataArrays if the variables are xarray arrays.

        Raises:
            ArgumentError, DesignError, KeyboardInterrupt: as for `evaluate`.

        Example:
            >>> prepared = papilio.Prepared("scenarios/indoor.toml")
            >>> values, slopes = prepared.derivatives({"display.pixel.gap_nm.red": [265.0, 275.9]}, ["red.Y"])
            >>> values.shape, slopes.shape
            ((2, 1), (2, 1, 1))
        """
        call = self._call(variables, metrics, view, threads)
        with reporting(progress, "designs") as tell:
            values, slopes = call.answer(call.batch.derivatives, tell)
        found, steep = call.array(values), call.array(slopes, len(call.variables))
        if call.dims is None:
            return found, steep
        return call.dims.labelled(found, **call.labels), call.dims.labelled(steep, **call.labels, variable=call.variables)

    def _call(
        self, variables: Mapping[AnyKeys, ArrayLike] | Table, metrics: Sequence[str], view: View, threads: int | None
    ) -> _Call:
        """Checks the arguments of a call."""
        asked = checked_metrics(metrics)
        arrays, choices, keys, dims = _split(variables)
        shape = _arguments.common_shape(arrays) if arrays else ()
        views, is_list = self._views(view)
        scene = self._scenario._scene()
        inner: dict[str, Any] = {"view": views} if is_list else {}
        inner["metric"] = asked
        if _are_spectra(asked):
            inner["wavelength_nm"] = scene.wavelength_nm
        designs = np.stack([np.broadcast_to(array, shape) for array in arrays.values()], axis=-1) if arrays else np.zeros((1, 0))
        return _Call(
            self._batch([_parts(one) for one in keys], choices, asked, views),
            np.ascontiguousarray(designs).reshape(-1),
            shape,
            inner,
            [joined(one) for one in keys],
            checked_threads(threads) or os.cpu_count() or 1,
            dims,
        )

    def _views(self, view: View) -> tuple[list[int], bool]:
        """Returns the indices of views, and whether they are an axis of the result."""
        count = len(self._scenario._scene().views)
        if isinstance(view, str):
            _arguments.one_of("view", view, ("all",))
            return list(range(count)), True
        is_list = isinstance(view, (list, tuple, range)) or (isinstance(view, np.ndarray) and view.ndim == 1)
        if is_list:
            found = [whole("view", one, 0, 4999) for one in cast(Sequence[int], view)]
            if not found or len(set(found)) < len(found):
                raise ArgumentError(f"view: expected different indices of views, at least one, not {described(view)}")
        else:
            found = [whole("view", view, 0, 4999)]
        for one in found:
            if one >= count:
                raise ArgumentError(f"view: expected 0 to {count - 1}, not {one}")
        return found, is_list

    def _batch(
        self, keys: list[tuple[str, ...]], choices: list[list[Any] | None], metrics: list[str], views: list[int]
    ) -> _papilio.Batch:
        """Returns the batch evaluator for this request; it reuses its kernels in later calls."""
        written = [None if some is None else json.dumps(some) for some in choices]
        question = (tuple(keys), tuple(written), tuple(metrics), tuple(views))
        if question not in self._batches:
            self._batches = {
                question: _papilio.Batch(
                    self._scenario._scene(), *self._scenario._state(), list(zip(keys, written, strict=True)), metrics, views
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
    #: Names and labels of the axes after those of the designs.
    labels: dict[str, Any]
    #: Names of the variables.
    variables: list[str]
    threads: int
    #: The dimensions, if the variables are xarray arrays.
    dims: Dims | None

    @property
    def many(self) -> int:
        """The number of designs."""
        return int(np.prod(self.shape, dtype=np.int64))

    def answer(self, of: Callable[[NDArray[np.float64], int, int, Progress | None], _Answer], tell: Progress | None) -> _Answer:
        """Calls the batch; a `DesignError` gets the index of the design in the arrays."""
        try:
            return of(self.designs, self.many, self.threads, tell)
        except DesignError as error:
            flat = error.design if isinstance(error.design, int) else 0
            at = tuple(int(i) for i in np.unravel_index(flat, self.shape)) if self.shape else ()
            raise DesignError(error.args[0], at) from None

    def array(self, flat: NDArray[np.float64], *inner: int) -> NDArray[np.float64]:
        """Returns flat numbers with the axes of designs, views, metrics and wavelengths."""
        return flat.reshape(*self.shape, *map(len, self.labels.values()), *inner)


def checked_metrics(metrics: Sequence[str]) -> list[str]:
    """Returns a list of names of metrics.

    Raises:
        ArgumentError: if ``metrics`` is not a list of strings.
    """
    names = metrics.tolist() if isinstance(metrics, np.ndarray) and metrics.ndim == 1 else metrics
    if not isinstance(names, (list, tuple)) or not names:
        raise ArgumentError(f"metrics: expected a list of names such as gamut_percent_srgb or white.Y, not {described(metrics)}")
    return [text("metrics", name, "names such as gamut_percent_srgb or white.Y") for name in names]


def _are_spectra(metrics: Sequence[str]) -> bool:
    """Returns whether metrics are spectra.

    Raises:
        ArgumentError: if only some of them are.
    """
    spectra = [name for name in metrics if name.endswith(SPECTRUM)]
    numbers = [name for name in metrics if not name.endswith(SPECTRUM)]
    if spectra and numbers:
        raise ArgumentError(f"metrics: {spectra[0]} is a spectrum, {numbers[0]} a number; expected either spectra or numbers in one call")
    return bool(spectra)


def _parts(keys: Keys) -> tuple[str, ...]:
    return (keys,) if isinstance(keys, str) else tuple(keys)


def columns(variables: Mapping[AnyKeys, ArrayLike] | Table) -> tuple[dict[Keys, NDArray[Any]], Dims | None]:
    """Returns the numbers or strings of each variable so that they broadcast, and the dimensions of xarray arrays."""
    if not isinstance(variables, Mapping) and hasattr(variables, "columns") and hasattr(variables, "items"):
        return columns({str(name): column.to_numpy() for name, column in variables.items()})  # a DataFrame
    if not isinstance(variables, Mapping):
        raise ArgumentError(f"variables: expected a dict of keys and arrays, or a DataFrame with keys as columns, not {described(variables)}")
    varied: set[str] = set()
    for keys in variables:
        if not isinstance(keys, (str, tuple)) or not keys:
            raise ArgumentError(f"variables: expected a key such as display.pixel.gap_nm.red, or a tuple of keys, not {described(keys)}")
        for path in _parts(keys):
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
    return f"variables[{joined(keys)!r}]"


def _split(
    variables: Mapping[AnyKeys, ArrayLike] | Table,
) -> tuple[dict[str, NDArray[np.float64]], list[list[Any] | None], list[Keys], Dims | None]:
    """Returns the numbers of each variable, its choices if its values are strings, its keys, and the dimensions of xarray arrays."""
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
    return arrays, choices, list(found), dims


def _strings(values: ArrayLike) -> NDArray[np.str_] | None:
    """Returns an array of strings; None for other values."""
    if not isinstance(values, (str, list, tuple, np.ndarray)):
        return None
    try:
        words = np.asarray(values)
    except ValueError:
        return None
    if words.dtype.kind == "O" and words.size and all(isinstance(word, str) for word in words.flat):  # a DataFrame's column
        words = words.astype(np.str_)
    return words if words.dtype.kind == "U" else None
