"""Papilio: spectral light transport for reflective displays.

Computes spectra, colours and metrics, with their errors, from a scenario::

    import papilio

    result = papilio.run("scenarios/indoor.toml")
    result["gamut_percent_srgb"]

- `run` computes a scenario, `cone` a conoscopic map, `brdf` the BSDF of the display, `Prepared` thousands of designs.
- `optimize` searches for better designs; `tolerance` analyses the tolerances of a design.
- `Scenario` reads, builds and edits scenarios.
- `cluster` computes millions of designs, on many machines.
- `films`, `colour` and `diffuser` are the models for separate use, on arrays.

Units, limits and sources of the models are in the documentation of the program ``papilio``. The numbers are those of the
program, to the last bit.
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
from .labels import Label, label
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
    "Label",
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
    "label",
    "metric_names",
    "optimize",
    "plot",
    "preset_names",
    "reflection",
    "run",
    "schema",
    "tolerance",
]
