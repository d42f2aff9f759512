"""Papilio: spectral light transport for reflective displays.

A scenario goes in; spectra, colours and metrics with their errors come out::

    import papilio

    result = papilio.run("scenarios/indoor.toml")
    result

Limits, units and sources of the models are in the documentation of the program ``papilio``; the numbers here are
its own, to the last bit.
"""

from ._papilio import __version__
from .errors import ArgumentError, DisplayError, FileError, Mistake, PapilioError, ScenarioError
from .result import Result
from .running import run
from .scenario import Scenario, preset_names, schema

__all__ = [
    "ArgumentError",
    "DisplayError",
    "FileError",
    "Mistake",
    "PapilioError",
    "Result",
    "Scenario",
    "ScenarioError",
    "__version__",
    "preset_names",
    "run",
    "schema",
]
