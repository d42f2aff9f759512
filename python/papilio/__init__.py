"""Papilio: spectral light transport for reflective displays.

Computes spectra, colours and metrics, with their errors, from a scenario::

    import papilio

    result = papilio.run("scenarios/indoor.toml")
    result["gamut_percent_srgb"]

- `run` computes a scenario, `cone` a conoscopic map, `brdf` the BSDF of the display.
- `mtf` computes how sharp a display is, `crosstalk` which sub-pixel lights which, `sparkle` how much an antiglare face glitters,
  `gloss` what a glossmeter reads.
- `gonio` measures a surface that is described by its geometry.
- `image` shows a picture on the display, and `palette` computes the colours of all states in this and other rooms.
- `sweep` computes thousands of designs with labelled axes, `Prepared` any designs, with derivatives.
- `optimize` searches for better designs; `tolerance` analyses the tolerances of a design; `fit` determines keys from measured data.
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
from . import absorbed, brdfs, cones, errors, evaluated, figure, fits, glosses, images, labels, palettes, production, result, scenario, spatial, surfaces
from ._papilio import __version__
from ._sweeps import sweep
from ._tables import AnyResult
from .optimum import Optimum, optimize
from .prepared import Prepared, metric_names
from .running import run

# Of these, all that they name public: a new function is named in its own module only.
from .absorbed import *
from .brdfs import *
from .cones import *
from .errors import *
from .evaluated import *
from .figure import *
from .fits import *
from .glosses import *
from .images import *
from .labels import *
from .palettes import *
from .production import *
from .result import *
from .scenario import *
from .spatial import *
from .surfaces import *

__all__ = [
    "AnyResult",
    "Optimum",
    "Prepared",
    "__version__",
    "cluster",
    "colour",
    "diffuser",
    "films",
    "metric_names",
    "optimize",
    "plot",
    "run",
    "sweep",
]
__all__ += absorbed.__all__
__all__ += brdfs.__all__
__all__ += cones.__all__
__all__ += errors.__all__
__all__ += evaluated.__all__
__all__ += figure.__all__
__all__ += fits.__all__
__all__ += glosses.__all__
__all__ += images.__all__
__all__ += labels.__all__
__all__ += palettes.__all__
__all__ += production.__all__
__all__ += result.__all__
__all__ += scenario.__all__
__all__ += spatial.__all__
__all__ += surfaces.__all__


def __dir__() -> list[str]:
    return __all__
