"""Papilio: spectral light transport for reflective displays.

Computes spectra, colours and metrics, with their errors, from a scenario::

    import papilio

    result = papilio.run("scenarios/indoor.toml")
    result["gamut_percent_srgb"]

- `run` computes a scenario, `cone` a conoscopic map, `brdf` the BSDF of the display.
- `mtf` computes how sharp a display is, `crosstalk` which sub-pixel lights which, `sparkle` how much an antiglare face glitters.
- `gonio` measures a surface that is described by its geometry.
- `image` shows a picture on the display, and `palette` computes the colours of all states in this and other rooms.
- `sweep` computes thousands of designs with labelled axes, `Prepared` any designs, with derivatives.
- `optimize` searches for better designs; `tolerance` analyses the tolerances of a design.
- `Scenario` reads, builds and edits scenarios.
- `cluster` computes millions of designs, on many machines.
- `films`, `colour` and `diffuser` are the models for separate use, on arrays.

Units, limits and sources of the models are in the documentation of the program ``papilio``. The numbers are those of the
program, to the last bit.
"""

from pathlib import Path as _Path

try:
    from . import _papilio
except ImportError as _error:
    if any(_Path(__file__).parent.glob("_papilio*.*[od]")):
        raise
    raise ImportError(
        f"papilio: {_Path(__file__).parent} has the sources of the package without its compiled part; install it with "
        "'pip install ./python' at the top of the repository, and start Python in another folder than 'python'"
    ) from None

from . import _guard

# Before other modules take functions and classes from it.
_guard.guard_module(_papilio)

from . import cluster, colour, diffuser, films, plot
from ._papilio import __version__
from ._sweeps import sweep
from ._tables import AnyResult
from .absorbed import Absorption, absorption
from .brdfs import Brdf, Reflection, brdf, reflection
from .cones import Cone, cone
from .evaluated import Evaluated
from .errors import (
    ArgumentError,
    ClusterError,
    DesignError,
    DisplayError,
    FileError,
    InternalError,
    Mistake,
    PapilioError,
    PapilioWarning,
    ScenarioError,
)
from .figure import Figure
from .images import Image, image
from .labels import Label, label
from .optimum import Optimum, optimize
from .palettes import Palette, palette
from .prepared import Prepared, metric_names
from .production import Yield, tolerance
from .result import Result
from .running import run
from .scenario import Scenario, preset_names, schema
from .spatial import Crosstalk, Mtf, Sparkle, crosstalk, mtf, sparkle
from .surfaces import Surface, gonio

__all__ = [
    "AnyResult",
    "Absorption",
    "ArgumentError",
    "Brdf",
    "ClusterError",
    "Cone",
    "Crosstalk",
    "DesignError",
    "DisplayError",
    "Evaluated",
    "Figure",
    "FileError",
    "InternalError",
    "Image",
    "Label",
    "Mtf",
    "Mistake",
    "Optimum",
    "Palette",
    "PapilioError",
    "PapilioWarning",
    "Prepared",
    "Reflection",
    "Result",
    "Scenario",
    "ScenarioError",
    "Sparkle",
    "Surface",
    "Yield",
    "__version__",
    "absorption",
    "brdf",
    "cluster",
    "colour",
    "cone",
    "crosstalk",
    "diffuser",
    "films",
    "gonio",
    "image",
    "label",
    "metric_names",
    "mtf",
    "optimize",
    "palette",
    "plot",
    "preset_names",
    "reflection",
    "run",
    "schema",
    "sparkle",
    "sweep",
    "tolerance",
]


def __dir__() -> list[str]:
    return __all__
