"""Units and long names of the quantities of results, from the published schema."""

from __future__ import annotations

import json
import re
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


#: Attributes of coordinates.
WAVELENGTH = {"units": "nm", "long_name": "wavelength in vacuum"}
STATE = {"long_name": "drive state"}
_ANGLES = {"theta_deg": "inclination of the view", "phi_deg": "azimuth of the view"}

#: Names of errors at the end of columns of CSV files.
_SHORT_ERRORS = {"_se": "_standard_error", "_de": "_discretisation_error"}


@cache
def parts(name: str) -> tuple[str, str | None]:
    """Splits a name into its quantity and the kind of error (None for a value)."""
    pieces = name.split(".")
    error = next((piece for piece in pieces if piece in _ERRORS), None)
    return ".".join(piece for piece in pieces if piece != error), error


@cache
def flat(name: str) -> str:
    """Returns the name of a variable or column: ``standard_error.terms.diffuse`` becomes ``terms_diffuse_standard_error``."""
    quantity, error = parts(name)
    return "_".join(quantity.split(".") + ([error] if error else []))


def long_error(column: str) -> str:
    """Returns the name of a column with the error in words: ``Y_se`` becomes ``Y_standard_error``."""
    for end, words in _SHORT_ERRORS.items():
        if column.endswith(end):
            return column.removesuffix(end) + words
    return column


def in_tables(name: str) -> str:
    """Returns the name of a number in the tables of the program: ``terms_diffuse_standard_error`` becomes ``Y_diffuse_se``."""
    for short, end in _SHORT_ERRORS.items():
        if name.endswith(end):
            name = name.removesuffix(end) + short
    begin = next((begin for begin in _IN_TABLES if name.startswith(begin.replace(".", "_"))), None)
    return name if begin is None else _IN_TABLES[begin] + name[len(begin) :]


def description(name: str) -> str | None:
    """Returns the words of a number of ``result.json`` in its schema, or of its error; None if there is no such number."""
    begin, _, component = name.rpartition("_")
    if begin == "interpolation_error" and component in ("X", "Y", "Z"):
        return f"Interpolation error of {component}"
    kind = next((kind for kind in _ERRORS if name.endswith(f"_{kind}")), "")
    words = _descriptions().get(name.removesuffix(f"_{kind}").removeprefix("spectra_").removeprefix("by_light_"))
    return f"{kind.replace('_', ' ').capitalize()} of {words}" if kind and words else words


def inner_dimensions(name: str, count: int) -> tuple[str, ...]:
    """Returns the ``count`` dimensions of a named array in addition to view and state."""
    known = _INNER.get(parts(name)[0], ())
    return known if len(known) == count else tuple(f"{flat(name)}_{i}" for i in range(count))


def attributes(name: str) -> dict[str, str]:
    """Returns the unit and long name of an array."""
    return dict(zip(("units", "long_name"), _unit_and_words(name), strict=True))


def angle(name: str) -> dict[str, str]:
    """Returns the unit and long name of an angle of the view."""
    return {"units": "degree", "long_name": _ANGLES[name]}


def label(about: dict[str, str]) -> str:
    """Returns the label of an axis: the long name with the unit."""
    units = about.get("units", "1")
    return about["long_name"] if units == "1" else f"{about['long_name']} ({units})"


@cache
def _unit_and_words(name: str) -> tuple[str, str]:
    quantity, error = parts(name)
    words = _words(quantity) or _descriptions().get(quantity.rpartition(".")[2]) or quantity.replace(".", " ").replace("_", " ")
    kinds = {"standard_error": "standard error: ", "discretisation_error": "discretisation error: "}
    return unit(quantity), kinds.get(error or "", "") + words


@cache
def unit(name: str) -> str:
    """Returns the unit of a quantity; "1" if it is dimensionless."""
    for end, of in [("_nm", "nm"), ("_cd_m2", "cd m-2"), ("_deg", "degree"), ("_lx", "lx")]:
        if name.endswith(end):
            return of
    if "_percent_" in name:
        return "%"
    return "W m-2 sr-1 nm-1" if name in ("radiance", "radiance_of_white") else "1"


#: Beginnings of names of parts of a result, and of the same in its tables.
_IN_TABLES = {"terms.": "Y_", "ledger.absorbed.": "ledger_", "ledger.": "ledger_", "cam16.": "cam16_"}


def _words(quantity: str) -> str | None:
    """Returns the label of a quantity in tables and figures of the program; None if it has none."""
    begin = next((begin for begin in _IN_TABLES if quantity.startswith(begin)), None)
    name = quantity if begin is None else _IN_TABLES[begin] + quantity.removeprefix(begin)
    words, of = _papilio.label(name)
    if words == name:
        return None
    return f"{words}, {of}" if of.startswith("% of") else words


@cache
def _descriptions() -> dict[str, str]:
    """Returns the first clause of each key's description in the schema, without remarks in parentheses and about the file."""
    found: dict[str, str] = {}

    def gather(node: Any) -> None:
        if isinstance(node, dict):
            for key, of in node.get("properties", {}).items():
                if isinstance(of, dict) and "description" in of:
                    first = re.split(r"\. |; |\n|, if `|, or relative", of["description"])[0].rstrip(".")
                    found.setdefault(key, re.sub(r" \([^)]*$| \((null|0 )[^)]*\)|`", "", first))
            for one in node.values():
                gather(one)
        elif isinstance(node, list):
            for one in node:
                gather(one)

    gather(json.loads(_papilio.schema(True)))
    return found
