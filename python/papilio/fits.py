"""Fits: keys of a scenario from measured data, as ``papilio fit`` determines them."""

from __future__ import annotations

import csv
import html
import io
import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _messages, _papilio
from ._arguments import described, text
from ._keys import attributes
from ._snapshots import read_only
from ._storing import optional, single, written
from .errors import ArgumentError
from .running import Progress, checked_threads, reporting, with_solver
from .scenario import Scenario, read
from .spatial import _Written

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Fitted", "FittedVariable", "fit"]

_NONE = (math.nan, math.nan)

#: Long names of the arrays.
_WORDS = {
    "value": "fitted value",
    "best": "value of the best fit, even if others fit as well",
    "standard_error": "standard error",
    "interval_68": "interval of 68.3 % confidence",
    "interval_95": "interval of 95 % confidence",
    "at_bound": "whether the value is at one of its bounds",
    "bounds": "bounds",
    "start": "value of the scenario",
    "correlations": "correlation",
}


class FittedVariable(NamedTuple):
    """A fitted variable. Its numbers are NaN if the data do not determine it."""

    #: Its first key.
    key: str
    #: All keys that get the value.
    keys: tuple[str, ...]
    #: Fitted value.
    value: float
    #: Standard error, from the curvature of chi-square.
    standard_error: float
    #: Interval of 68.3 % confidence, by profile likelihood.
    interval_68: tuple[float, float]
    #: Interval of 95 % confidence, by profile likelihood.
    interval_95: tuple[float, float]
    #: Whether the value is at one of its bounds.
    at_bound: bool
    #: Smallest and largest value.
    bounds: tuple[float, float]
    #: Value of the scenario; NaN if it is not a number.
    start: float
    #: Value of the best fit, even if others fit as well.
    best: float
    #: First keys of the variables, this one among them, at whose bounds the intervals end; the data alone give wider ones.
    cut_by: tuple[str, ...]


class Fitted(_Written):
    """Result of a fit: the output of ``papilio fit``.

    ``found["value"]``, ``["best"]``, ``["standard_error"]``, ``["at_bound"]`` and ``["start"]`` have the shape [variable],
    ``["interval_68"]``, ``["interval_95"]`` and ``["bounds"]`` [variable, end], ``["correlations"]`` [variable, variable]. NaN where the
    data do not determine a variable. Arrays are read-only. A notebook shows a table. The result can be copied and pickled.
    """

    _FILE = "fit.json"

    def __init__(
        self,
        content: Mapping[str, str],
        residuals: Mapping[str, NDArray[Any]],
        figures: Sequence[tuple[str, str]],
        scenario: Scenario,
        warned: Sequence[str],
        notes: Sequence[str],
    ) -> None:
        super().__init__(content["fit.json"], {}, figures, scenario.title, warned, notes)
        self._table, self._scenario = content["fit.csv"], scenario
        self._arrays = {name: read_only(one) for name, one in _arrays(self.data).items()}
        #: Every measured number with its fit: the columns of ``fit.csv`` by name; ``wavelength_nm`` is NaN where there is none.
        self.residuals: dict[str, NDArray[Any]] = {name: read_only(one) for name, one in residuals.items()}

    @cached_property
    def variables(self) -> dict[str, FittedVariable]:
        """The variables by their keys, in the order of the scenario."""
        return {one["key"]: _variable(one) for one in self.data["variables"]}

    @property
    def correlations(self) -> NDArray[np.float64]:
        """Correlations of the variables, shape [variable, variable]; NaN for those that the data do not determine."""
        return self["correlations"]

    @property
    def undetermined(self) -> list[list[str]]:
        """Groups of variables that the data cannot tell apart, by their keys; of a group of one, all values fit."""
        return [list(group) for group in self.data["undetermined"]]

    @property
    def chi_square(self) -> float:
        """Sum of the squares of residuals over standard deviations, those of priors included."""
        return float(self.data["chi_square"])

    @property
    def degrees_of_freedom(self) -> int:
        """Number of residuals minus that of the variables: about `chi_square` if model and standard deviations are right."""
        return int(self.data["degrees_of_freedom"])

    @property
    def bic(self) -> float:
        """Bayesian information criterion, to compare variants of a scenario: the smaller the better."""
        return float(self.data["bic"])

    @property
    def scenario(self) -> Scenario:
        """The scenario with the fitted values."""
        return self._scenario.copy()

    def to_toml(self) -> str:
        """Returns the text of the fitted scenario, with the intervals in comments at its beginning."""
        return self._scenario.to_toml()

    def save(self, folder: str | PathLike[str]) -> list[Path]:
        """Writes the files and figures of ``papilio fit`` into a folder, which is created.

        Args:
            folder: the folder; or a path that ends as one of the files, where this file alone is written. Relative paths in
                ``fitted.toml`` are adapted to it; files that were made from arrays are written beside it.

        Returns:
            The paths of the files.

        Raises:
            ArgumentError: if the path ends as a file that a fit does not have.
        """
        figures = {f"{figure.name}.svg": figure.svg.encode() for figure in self.figures().values()}
        tables = {"fit.json": self.to_json().encode(), "fit.csv": self._table.encode()}
        name = single(folder, ["fitted.toml", *tables, *figures])
        if name is None:
            return [*self._scenario.save(Path(folder) / "fitted.toml"), *written(folder, tables | figures)]
        return self._scenario.save(folder) if name == "fitted.toml" else written(folder, tables | figures)

    def to_xarray(self) -> xarray.Dataset:
        """Returns all numbers as a Dataset over ``variable``, ``end`` (of intervals) and ``other`` (of correlations).

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        keys = list(self.variables)
        dims = {"interval_68": ("variable", "end"), "interval_95": ("variable", "end"), "bounds": ("variable", "end"), "correlations": ("variable", "other")}
        data = {name: (dims.get(name, ("variable",)), one.copy(), {"long_name": _WORDS[name]}) for name, one in self._arrays.items()}
        about = [attributes(key) for key in keys]
        coordinates = {
            "variable": ("variable", keys, {"long_name": "key of the variable"}),
            "other": ("other", keys, {"long_name": "key of another variable"}),
            "end": ("end", ["from", "to"], {"long_name": "end of an interval"}),
            "label": ("variable", [one["long_name"] for one in about], {"long_name": "the variable in words"}),
            "unit": ("variable", [one["units"] for one in about], {"long_name": "unit of the variable"}),
        }
        numbers = {"chi_square": self.chi_square, "degrees_of_freedom": self.degrees_of_freedom, "bic": self.bic}
        return xarray.Dataset(data, coordinates, {"title": self.title} | numbers | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each variable: value, standard error, intervals, and what the scenario has.

        ``pandas.DataFrame(found.residuals)`` is that of the measured numbers.

        Raises:
            ImportError: if pandas is not installed.
        """
        with optional("pandas"):
            import pandas

        columns: dict[str, Any] = {name: self[name].copy() for name in ("start", "value", "standard_error")}
        for name in ("interval_68", "interval_95"):
            columns |= {f"{name}_{end}": self[name][:, at].copy() for at, end in enumerate(("from", "to"))}
        columns |= {"at_bound": self["at_bound"].copy()}
        return pandas.DataFrame(columns, index=pandas.Index(list(self.variables), name="variable"))

    def __repr__(self) -> str:
        size = f"{len(self.variables)} variables, chi-square {self.chi_square:.4g} of {self.degrees_of_freedom} degrees of freedom"
        return f"<papilio.Fitted {self.title!r}: {size}{_messages.summary(self.warnings)}>"

    def _repr_html_(self) -> str:
        """A table of the variables, and what the data cannot tell apart, as HTML."""
        head = "".join(f"<th>{title}</th>" for title in ("", "scenario", "fitted", "standard error", "68.3 %", "95 %"))
        rows = "".join(_row(one) for one in self.variables.values())
        apart = "".join(f"<p>The data cannot tell apart: {html.escape(', '.join(group))}</p>" for group in self.undetermined if len(group) > 1)
        fitness = f"<p>chi-square {self.chi_square:.4g}, {self.degrees_of_freedom} degrees of freedom, BIC {self.bic:.5g}</p>"
        return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{apart}{fitness}{_messages.as_html(self.warnings, self.notes)}"


def fit(
    scenario: Scenario | str | PathLike[str],
    *measured: str | PathLike[str] | Mapping[str, Any] | pandas.DataFrame,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Fitted:
    """Determines keys of a scenario from measured data, as ``papilio fit`` does.

    Args:
        scenario: a `Scenario`, or the path of a scenario file, with ``[fit]``.
        measured: paths of measured files; or tables with the same columns: a dict of columns, or a DataFrame.
        set: values to set in the scenario first, ``{path: value}``, including those of ``[fit]`` (``"fit.starts": 16``).
        threads: number of threads; None: one for each processor. The results do not depend on it.
        progress: function that is called a few times a second with ``fraction``, or True for a line on the terminal.

    Returns:
        The variables with their intervals, correlations, residuals, and the scenario with the fitted values.

    Raises:
        ScenarioError: if the scenario is invalid; with the position of the error.
        FileError: if a measured file cannot be read; with the position of the error.
        ArgumentError: if nothing that was measured has a counterpart in the scenario, a file is given twice, or no start led to a minimum.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> found = papilio.fit("scenarios/fit.toml", "scenarios/data/synthetic-film.csv", set={"fit.starts": 1})
        >>> gap = found.variables["display.pixel.gap_nm.red"]
        >>> low, high = gap.interval_95
        >>> low < 271.5 < high, abs(found.scenario["display.pixel.gap_nm.red"] - gap.value) < 1e-6
        (True, True)
    """
    changed = read(scenario, with_solver(set))
    if not measured:
        raise ArgumentError("measured: expected at least one measured file or table")
    given = [_measured(one, at) for at, one in enumerate(measured, 1)]
    _refuse_twice([name for name, content in given if content is None])
    scene = changed._scene()
    with reporting(progress, "fitted") as tell:
        core = _papilio.Fit(*changed._state(), given, checked_threads(threads), tell)
    fitted = changed.copy()
    fitted._put(core.scenario(), changed._arrays)
    words, numbers = core.residuals()
    columns = ("name", "theta_deg", "phi_deg", "quantity", "wavelength_nm", "measured", "standard_deviation", "fitted", "residual", "z")
    known = {name: np.array(column) for name, column in words} | numbers
    residuals = {name: known[name] for name in columns}
    content = {"fit.json": core.json(), "fit.csv": core.table()}
    found = Fitted(content, residuals, core.figures(changed.title), fitted, _messages.merged(scene.warnings, core.warnings()), [*scene.notes, *core.notes()])
    _messages.warn(found.warnings)
    return found


def _measured(one: object, at: int) -> tuple[str, bytes | None]:
    """Returns the path of a measured file, or the name and the bytes of a table."""
    if isinstance(one, PathLike):
        one = fspath(one)
    if isinstance(one, str):
        return text("measured", one, "a path or a table"), None
    if not isinstance(one, Mapping) and not hasattr(one, "columns"):
        raise ArgumentError(f"measured: expected the path of a file, a dict of columns or a DataFrame, not {described(one)}")
    items = one.items() if hasattr(one, "items") else ((name, one[name]) for name in one.columns)  # type: ignore[index]
    columns = {str(name): _column(name, values) for name, values in items}
    lengths = {len(column) for column in columns.values()}
    if len(lengths) != 1:
        raise ArgumentError(f"measured: expected columns of the same length, not {', '.join(map(str, sorted(lengths))) or 'none'}")
    table = io.StringIO()
    csv.writer(table, lineterminator="\n").writerows([list(columns), *zip(*(map(_cell, one) for one in columns.values()), strict=True)])
    return f"measured table {at}", table.getvalue().encode()


def _column(name: object, values: Any) -> list[Any]:
    """Returns the values of a column of a table."""
    if not isinstance(values, str | bytes):
        try:
            return list(values)
        except TypeError:
            pass
    raise ArgumentError(f"measured: expected a list of values in the column {name!r}, not {described(values)}")


def _cell(value: object) -> object:
    """Returns a value as a cell of a table: a number with all its digits, nothing for one that is missing."""
    if isinstance(value, float | np.floating):
        return "" if math.isnan(value) else repr(float(value))
    return "" if value is None else value


def _refuse_twice(paths: Sequence[str]) -> None:
    known = {}
    for path in paths:
        whole = Path(path).resolve()
        if whole in known:
            raise ArgumentError(f"measured: {path} is given twice; every measured number counts once")
        known[whole] = path


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _interval(ends: Sequence[float] | None) -> tuple[float, float]:
    return _NONE if ends is None else (float(ends[0]), float(ends[1]))


def _variable(one: Mapping[str, Any]) -> FittedVariable:
    return FittedVariable(
        one["key"],
        tuple(one["keys"]),
        _number(one["value"]),
        _number(one["standard_error"]),
        _interval(one["interval_68"]),
        _interval(one["interval_95"]),
        one["at_bound"],
        _interval(one["bounds"]),
        _number(one["start"]),
        float(one["best"]),
        tuple(one["cut_by"]),
    )


def _arrays(data: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    all_variables = [_variable(one) for one in data["variables"]]
    names = ("value", "best", "standard_error", "interval_68", "interval_95", "at_bound", "bounds", "start")
    arrays = {name: np.array([getattr(one, name) for one in all_variables]) for name in names}
    rows = [[_number(one) for one in row] for row in data["correlations"]]
    return arrays | {"correlations": np.array(rows, dtype=np.float64)}


def _row(one: FittedVariable) -> str:
    def shown(value: float) -> str:
        return "" if math.isnan(value) else f"{value:.6g}"

    ends = [" to ".join(map(shown, interval)) if interval[0] == interval[0] else "" for interval in (one.interval_68, one.interval_95)]
    value = "not determined" if math.isnan(one.value) else shown(one.value) + (" (at its bound)" if one.at_bound else "")
    cells = [shown(one.start), value, shown(one.standard_error), *ends]
    title = html.escape(", ".join(attributes(key)["long_name"] for key in one.keys))
    return f"<tr><th>{title}</th>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
