"""What a run found."""

from __future__ import annotations

import json
from functools import cached_property
from typing import Any

from . import _papilio

__all__ = ["Result"]


class Result:
    """What a meter would report of a display, with errors; what ``papilio run`` writes as ``result.json``."""

    def __init__(self, core: _papilio.RunResult) -> None:
        self._core = core

    @property
    def states(self) -> list[str]:
        """The names of the drive states, in the scenario's order."""
        return self._core.states()

    @property
    def views(self) -> list[tuple[float, float]]:
        """Inclination and azimuth of every view, degrees."""
        return self._core.views()

    def to_json(self) -> str:
        """The text of ``result.json``, byte for byte."""
        return self._core.json().decode()

    @cached_property
    def data(self) -> dict[str, Any]:
        """Everything, as ``result.json`` has it (`papilio.schema("result")`); None where a number is undefined."""
        return dict(json.loads(self._core.json()))
