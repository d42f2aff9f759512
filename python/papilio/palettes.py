"""Colours of the states of a display in one light and view: what ``papilio palette`` writes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _messages, _papilio
from ._arguments import one_of
from ._storing import optional
from ._tables import long_table
from .errors import ArgumentError
from .running import Progress, checked_threads, reporting
from .scenario import Scenario, preset_names, read
from .spatial import _Written

if TYPE_CHECKING:
    import pandas
    import xarray

__all__ = ["Palette", "palette"]

_NUMBERS = ("X", "Y", "Z", "L_star", "a_star", "b_star")

#: Axes of three numbers, with the labels of the numbers.
_COMPONENTS = {
    "xyz": ["X", "Y", "Z"],
    "cielab": ["L*", "a*", "b*"],
    "oklab_axis": ["L", "a", "b"],
    "rgb": ["red", "green", "blue"],
}

#: Long name and inner axis of each array.
_WORDS: dict[str, tuple[str, tuple[str, ...]]] = {name: (name, ()) for name in _NUMBERS} | {
    "XYZ": ("tristimulus values; Y is 1 for a perfect white in the light", ("xyz",)),
    "Lab": ("CIELAB coordinates", ("cielab",)),
    "oklab": ("Oklab coordinates", ("oklab_axis",)),
    "srgb": ("sRGB, 0 to 1; a perfect white in the light is 1", ("rgb",)),
    "srgb_relative": ("sRGB, 0 to 1; the white of the display is 1", ("rgb",)),
}


class Palette(_Written):
    """Colours of all states in one light and view: the output of ``papilio palette``.

    ``found["Y"]`` and the other tristimulus values and CIELAB coordinates have the shape [state]; ``found["XYZ"]``, ``found["Lab"]``,
    ``found["oklab"]``, ``found["srgb"]`` and ``found["srgb_relative"]`` have the shape [state, 3]. NaN where a number is undefined. Arrays are
    read-only. It can be copied and pickled.
    """

    _FILE = "palette.json"

    def __init__(
        self,
        text: str,
        figures: Iterable[tuple[str, str]],
        title: str,
        warned: list[str],
        notes: list[str],
        tables: Iterable[tuple[str, bytes]],
    ) -> None:
        super().__init__(text, {}, figures, title, warned, notes, tables)
        colours = self.data["colours"]
        undefined = [float("nan")] * 3
        arrays = {name: np.array([colour[name] for colour in colours], float) for name in _NUMBERS}
        arrays |= {"XYZ": np.stack([arrays[name] for name in "XYZ"], 1)}
        arrays |= {"Lab": np.stack([arrays[name] for name in ("L_star", "a_star", "b_star")], 1)}
        for name in ("oklab", "srgb", "srgb_relative"):
            arrays[name] = np.array([colour[name] or undefined for colour in colours], float)
        for one in arrays.values():
            one.flags.writeable = False
        self._arrays = arrays

    @property
    def states(self) -> list[str]:
        """Names of the states."""
        return [colour["state"] for colour in self.data["colours"]]

    @property
    def rooms(self) -> list[str]:
        """Names of the other rooms."""
        return list(self.data["rooms"])

    def delta_e_2000(self, room: str) -> NDArray[np.float64]:
        """Returns the CIEDE2000 difference of each state between a room and the scenario's light, shape [state].

        Raises:
            KeyError: if there is no such room.
        """
        if room not in self.data["rooms"]:
            raise KeyError(f"{room!r}: there is no such room; expected {', '.join(self.rooms) or 'none'}")
        there = self.data["rooms"][room]
        return np.array([there[state]["delta_e_2000"] for state in self.states], float)

    def to_xarray(self) -> xarray.Dataset:
        """Returns all numbers as a Dataset over ``state``, and ``delta_e_2000`` over ``room`` and ``state``, with units and long names.

        Raises:
            ImportError: if xarray is not installed.
        """
        with optional("xarray"):
            import xarray

        data: dict[str, Any] = {}
        for name, values in self._arrays.items():
            words, axis = _WORDS[name]
            data[name] = (("state", *axis), values.copy(), {"units": "1", "long_name": words})
        rooms = np.array([self.delta_e_2000(room) for room in self.rooms]).reshape(len(self.rooms), len(self.states))
        data["delta_e_2000"] = (("room", "state"), rooms, {"units": "1", "long_name": "CIEDE2000 difference from the scenario's light"})
        axes = {"xyz": "tristimulus value", "cielab": "coordinate of CIELAB", "oklab_axis": "coordinate of Oklab", "rgb": "channel of sRGB"}
        coordinates: dict[str, Any] = {name: (name, _COMPONENTS[name], {"long_name": words}) for name, words in axes.items()}
        coordinates |= {"state": ("state", self.states, {"long_name": "drive state"}), "room": ("room", self.rooms, {"long_name": "light of the room"})}
        return xarray.Dataset(data, coordinates, {"title": self.title} | _messages.attributes(self.warnings, self.notes))

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a table with a row for each state: tristimulus values and CIELAB coordinates, and the difference in each room.

        Raises:
            ImportError: if pandas is not installed.
        """
        arrays = {name: self[name] for name in _NUMBERS} | {f"delta_e_2000_{room}": self.delta_e_2000(room) for room in self.rooms}
        return long_table({"state": self.states}, {name: (("state",), one) for name, one in arrays.items()})

    def __repr__(self) -> str:
        return f"<papilio.Palette {self.title!r}: {len(self.states)} states{_messages.summary(self.warnings)}>"


def palette(
    scenario: Scenario | str | PathLike[str],
    *,
    rooms: Iterable[str] = (),
    relative_to: Literal["white", "display"] = "white",
    set: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress | bool | None = None,
) -> Palette:
    """Computes the colours of all states in one light and view: the output of ``papilio palette``.

    Args:
        scenario: a `Scenario`, or the path of a scenario file, with one view.
        rooms: presets of the light, or CIE illuminants that replace ``lighting.spectrum``, in which the colours are computed, too.
        relative_to: what is white in the files for other programs that ``save`` writes: a perfect white in the light, or the white of the ``"display"``.
        set: values to set in the scenario first, ``{key: value}`` with keys such as "display.pixel.file".
        threads: number of threads; None: one for each processor.
        progress: function that is called a few times a second, or True for a line on the terminal.

    Returns:
        The colours, by name.

    Raises:
        ScenarioError: for mistakes in the scenario, and more than one view, with their places.
        ArgumentError: if ``rooms`` is one text or has a room twice.
        KeyboardInterrupt: on Ctrl-C.

    Warns:
        PapilioWarning: each warning that the program prints; ``warnings`` of the result contains it.

    Example:
        >>> inks = papilio.palette("scenarios/six-ink.toml", rooms=["D65"])
        >>> inks.states[:2], inks["srgb"].shape, bool((inks.delta_e_2000("D65") < 10).all())
        (['black', 'white'], (6, 3), True)
    """
    one_of("relative_to", relative_to, ("white", "display"))
    if isinstance(rooms, str):
        raise ArgumentError(f"rooms: it is the text {rooms!r} (expected a list of texts)")
    names = list(rooms)
    twice = [name for at, name in enumerate(names) if name in names[:at]]
    if twice:
        raise ArgumentError(f"rooms: {twice[0]!r} is given twice (expected each room once)")
    changed = read(scenario, set)
    scene = changed._scene()
    presets = preset_names()
    view = {key: value for key, value in changed.to_dict().get("viewer", {}).items() if key in ("theta_deg", "phi_deg")}

    def room(name: str) -> _papilio.Resolved:
        light: Any = {"lighting": {"preset": name}} if name in presets else {"lighting.spectrum": name}
        return changed.with_values(light | {f"viewer.{key}": value for key, value in view.items()})._scene()

    there = [(name, room(name)) for name in names]
    with reporting(progress, "views") as tell:
        core = _papilio.Palette(scene, there, changed.title, checked_threads(threads), tell)
    warned = _messages.merged(scene.warnings, core.warnings())
    tables = core.tables(changed.title, relative_to == "display")
    found = Palette(core.json(), core.figures(changed.title), changed.title, warned, scene.notes, tables)
    _messages.warn(found.warnings)
    return found
