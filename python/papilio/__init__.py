"""Papilio: spectral light transport for reflective displays.

A scenario goes in; spectra, colours and metrics with their errors come out::

    import papilio

    result = papilio.run("scenarios/indoor.toml")
    result["gamut_percent_srgb"]

- `run` computes a scenario, `cone` what is seen from every direction, `brdf` what the display makes of light from any,
  `Prepared` thousands of designs;
- `optimize` searches for better designs, `tolerance` tells what production makes of one;
- `Scenario` reads, builds and edits scenarios;
- `cluster` computes designs by the million, on many machines;
- `films`, `colour` and `diffuser` are the parts by themselves, on arrays.

Units, limits and sources of the models are in the documentation of the program ``papilio``; the numbers here are its
own, to the last bit.
"""

from . import cluster, colour, diffuser, films, plot
from ._papilio import __version__
from .brdfs import Brdf, Reflection, brdf, reflection
from .cones import Cone, cone
from .errors import (
    ArgumentError,
    ClusterError,
    DesignError,
    DisplayError,
    FileError,
    Mistake,
    PapilioError,
    PapilioWarning,
    ScenarioError,
)
from .figure import Figure
from .optimum import Optimum, optimize
from .prepared import Prepared, metric_names
from .production import Yield, tolerance
from .result import Result
from .running import run
from .scenario import Scenario, preset_names, schema

__all__ = [
    "ArgumentError",
    "Brdf",
    "ClusterError",
    "Cone",
    "DesignError",
    "DisplayError",
    "Figure",
    "FileError",
    "Mistake",
    "Optimum",
    "PapilioError",
    "PapilioWarning",
    "Prepared",
    "Reflection",
    "Result",
    "Scenario",
    "ScenarioError",
    "Yield",
    "__version__",
    "brdf",
    "cluster",
    "colour",
    "cone",
    "diffuser",
    "films",
    "metric_names",
    "optimize",
    "plot",
    "preset_names",
    "reflection",
    "run",
    "schema",
    "tolerance",
]
