#!/usr/bin/env python3
"""Writes synthetic palettes of colour electronic paper: four-inks.csv, six-inks.csv and seven-inks.csv, and the one of scenarios/.

The spectra are invented. Edges and bands are those of common pigments, levels those of panels seen through their own surface: a white of
0.38, a black of 0.03. Nobody measured them: they show what a file looks like, and what a palette does in different light.
"""

import math
from pathlib import Path


def edge(nm: float, at: float, width: float) -> float:
    """Rises from 0 to 1 at a wavelength."""
    return 1 / (1 + math.exp(-(nm - at) / width))


def band(nm: float, peak: float, width: float) -> float:
    return math.exp(-0.5 * ((nm - peak) / width) ** 2)


INKS = {
    "black": lambda nm: 0.028 + 0.004 * edge(nm, 650, 30),
    "white": lambda nm: 0.385 * (0.55 + 0.45 * edge(nm, 415, 9)) - 0.012 * edge(nm, 620, 40),
    "yellow": lambda nm: 0.032 + 0.33 * edge(nm, 508, 12),
    "red": lambda nm: 0.030 + 0.20 * edge(nm, 602, 11) + 0.008 * band(nm, 430, 30),
    "blue": lambda nm: 0.028 + 0.105 * band(nm, 458, 34) + 0.03 * edge(nm, 690, 15),
    "green": lambda nm: 0.030 + 0.10 * band(nm, 532, 32) + 0.02 * edge(nm, 700, 15),
    "orange": lambda nm: 0.031 + 0.25 * edge(nm, 566, 12),
}

SETS = {"four": ["black", "white", "yellow", "red"], "six": ["black", "white", "yellow", "red", "blue", "green"], "seven": list(INKS)}

for count, states in SETS.items():
    rows = ["# synthetic: invented spectra of pigments, not measured", "state,wavelength_nm,reflectance_factor"]
    rows += [f"{state},{nm},{INKS[state](nm):.4f}" for state in states for nm in range(380, 781, 10)]
    here = Path(__file__).resolve()
    paths = [here.with_name(f"{count}-inks.csv")]
    if count == "six":
        paths.append(here.parents[4] / "scenarios" / "data" / "synthetic-inks-6.csv")
    for path in paths:
        path.write_text("\n".join(rows) + "\n", encoding="utf-8", newline="\n")
