"""Gloss: what ``papilio gloss`` writes."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any

from . import _messages, _metadata, _papilio
from ._storing import optional
from .running import Progress, checked_threads, reporting, with_solver
from .scenario import Scenario, read
from .spatial import _Written

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Gloss", "gloss"]


class Gloss(_Written):
    """Gloss of a display: the output of ``papilio gloss``.

    ``found["gloss_60"]`` and all other numbers have the shape [state]; ``found["error.gloss_60"]`` is the error. Arrays are read-only. It
    can be copied and pickled.
    """

    _FILE = "gloss.json"

    @property
    def states(self) -> list[str]:
        """The names of the states, in the order of all arrays."""
        return list(self.data["states"])

    def to_xarray(self) -> xarray.Dataset:
        """Returns all numbers as a Dataset over ``state``.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        data = {_metadata.flat(name): ("state", values.copy(), _metadata.attributes(name)) for name, values in self._arrays.items()}
        coordinates = {"state": ("state", self.states, _metadata.STATE)}
        return xarray.Dataset(data, coordinates, {"title": self.title} | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each state, and a column for each number.

        Raises:
            ImportError: if pandas is not installed.
        """
        with optional("pandas"):
            import pandas

        return pandas.DataFrame({"state": self.states} | dict(self._arrays))

    def __repr__(self) -> str:
        return f"<papilio.Gloss {self.title!r}: {len(self.states)} states{_messages.summary(self.warnings)}>"


def gloss(
    scenario: Scenario | str | PathLike[str],
    *,
    solver: str | None = None,
    seed: int | None = None,
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Gloss:
    """Computes gloss (ISO 2813) and distinctness of image of each state: the output of ``papilio gloss``.

    Args:
        scenario: a `Scenario`, or the path of a scenario file. Its light and the inclination of its views have no influence.
        solver: "adding", "monte-carlo" or "auto"; None: that of the scenario.
        seed: integer that selects the random numbers of the Monte Carlo solver; None: that of the scenario.
        set: values to set in the scenario first, ``{key: value}`` with keys such as "display.layers.0.alpha".
        threads: number of threads; None: one for each processor. The results do not depend on it.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        Gloss at 20, 60 and 85 deg, the distinctness of image and the haze of the glass, with their errors, by name.

    Raises:
        ScenarioError: for mistakes in the scenario, with their places.
        DisplayError: if the solver does not cover the display.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> read = papilio.gloss("scenarios/epaper.toml")
        >>> read.states, read["gloss_60"].shape
        (['white', 'black'], (2,))
    """
    changed = read(scenario, with_solver(set, solver, seed))
    scene = changed._scene()
    with reporting(progress, "views") as tell:
        core = _papilio.Gloss(scene, checked_threads(threads), tell)
    warned = _messages.merged(scene.warnings, core.warnings())
    found = Gloss(core.json(), core.arrays(), [], changed.title, warned, scene.notes, core.tables())
    _messages.warn(found.warnings)
    return found
