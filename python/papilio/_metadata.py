"""Units and long names of the quantities of results, from the published schema."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from . import _papilio

#: Dimensions of arrays in addition to view and state, by the quantity.
_INNER = {
    "radiance": ("wavelength_nm",),
    "reflectance_factor": ("wavelength_nm",),
    "hue_rgb": ("rgb",),
    "R_dir": ("directed",),
    "R_environment": ("environment",),
    "specular": ("directed",),
    "terms.directed": ("directed",),
    "terms.environment": ("environment",),
    "by_light.R_hemi": ("wavelength_nm",),
    "by_light.R_dir": ("directed", "wavelength_nm"),
    "by_light.R_environment": ("environment", "wavelength_nm"),
    "spectra_by_light.R_hemi": ("wavelength_nm",),
    "spectra_by_light.R_dir": ("directed", "wavelength_nm"),
    "spectra_by_light.R_environment": ("environment", "wavelength_nm"),
}

_ERRORS = ("standard_error", "discretisation_error")


def parts(name: str) -> tuple[str, str | None]:
    """Splits a name into its quantity and the kind of error (None for a value)."""
    pieces = name.split(".")
    error = next((piece for piece in pieces if piece in _ERRORS), None)
    return ".".join(piece for piece in pieces if piece != error), error


def flat(name: str) -> str:
    """Returns the name of a Dataset's variable: ``standard_error.terms.diffuse`` becomes ``terms_diffuse_standard_error``."""
    quantity, error = parts(name)
    return "_".join(quantity.split(".") + ([error] if error else []))


def inner_dimensions(name: str, count: int) -> tuple[str, ...]:
    """Returns the ``count`` dimensions of a named array in addition to view and state."""
    known = _INNER.get(parts(name)[0], ())
    return known if len(known) == count else tuple(f"{flat(name)}_{i}" for i in range(count))


def attributes(name: str) -> dict[str, str]:
    """Returns the unit and long name of an array."""
    quantity, error = parts(name)
    words = _descriptions().get(quantity.rpartition(".")[2], quantity.replace(".", " ").replace("_", " "))
    kinds = {"standard_error": "standard error: ", "discretisation_error": "discretisation error: "}
    return {"units": unit(quantity), "long_name": kinds.get(error or "", "") + words}


def unit(name: str) -> str:
    """Returns the unit of a quantity; "1" if it is dimensionless."""
    for end, of in [("_nm", "nm"), ("_cd_m2", "cd m-2"), ("_deg", "degree"), ("_lx", "lx")]:
        if name.endswith(end):
            return of
    if "_percent_" in name:
        return "%"
    return "W m-2 sr-1 nm-1" if name in ("radiance", "radiance_of_white") else "1"


@cache
def _descriptions() -> dict[str, str]:
    """Returns the first sentence of each key's description in the schema."""
    found: dict[str, str] = {}

    def gather(node: Any) -> None:
        if isinstance(node, dict):
            for key, of in node.get("properties", {}).items():
                if isinstance(of, dict) and "description" in of:
                    found.setdefault(key, of["description"].split(". ")[0].split("; ")[0].split("\n")[0].rstrip("."))
            for one in node.values():
                gather(one)
        elif isinstance(node, list):
            for one in node:
                gather(one)

    gather(json.loads(_papilio.schema(True)))
    return found
