"""The CIE tables of Papilio, from colour-science.

    pip install colour-science==0.4.7 scipy==1.17.1
    python tables_oracle.py --write     # makes the tables
    python tables_oracle.py --check     # recomputes and compares with them

crates/colour/data/observers.csv: the colour-matching functions of 1931 and 1964 at 1 nm.
crates/spectra/data/daylight.csv: the components S0, S1 and S2 of daylight at 5 nm.
crates/spectra/data/illuminants-5nm.csv: illuminants that the CIE tabulates at 5 nm.
crates/spectra/data/illuminants-1nm.csv: illuminants that the CIE tabulates at 1 nm. A is computed from its definition.
colour-science has the others at 5 nm, with fewer digits. A committed value is accepted if it rounds to that of
colour-science (LED series), or if it agrees within rounding with linear interpolation of the values of colour-science
(D50, D65). Otherwise it is replaced by that of colour-science, so that the tables differ.
lamps.csv (next to this file): x and y of each illuminant, 380 to 780 nm, 1931 observer: by linear interpolation and summation
at 1 nm, and as published (CIE 15:2004, from colour-science; empty where it has none).
"""

import csv
import pathlib
import sys
import warnings

warnings.filterwarnings("ignore")

import colour  # noqa: E402
import numpy as np  # noqa: E402
from colour.colorimetry import SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES as DAYLIGHT  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.append(str(HERE.parent))

import oracle  # noqa: E402

NM_1, NM_5 = np.arange(380, 781), np.arange(380, 781, 5)
LEDS = [f"LED-{name}" for name in ("B1", "B2", "B3", "B4", "B5", "BH1", "RGB1", "V1", "V2")]
AT_1_NM = ["A", "D50", "D65", *LEDS]
AT_5_NM = ["C", "D55", "D60", "D75", *(f"FL{i}" for i in range(1, 13)), *(f"FL3.{i}" for i in range(1, 16)),
           *(f"HP{i}" for i in range(1, 6))]


def values(spectrum, wavelengths):
    """Tabulated values, not interpolated: interpolation would round."""
    table = dict(zip(spectrum.wavelengths, spectrum.values))
    return np.array([table[nm] for nm in wavelengths])


def rows(names, wavelengths, columns):
    yield ["nm", *names]
    for i, nm in enumerate(wavelengths):
        # Ten digits: more than any table has; they remove the rounding noise of D60, which is computed.
        yield [int(nm), *(column[i] if isinstance(column[i], str) else f"{column[i]:.10g}" for column in columns)]


def observers():
    both = [colour.MSDS_CMFS[f"CIE {name} Degree Standard Observer"] for name in ("1931 2", "1964 10")]
    columns = [dict(zip(one.wavelengths, one.values[:, k])) for one in both for k in range(3)]
    yield from rows(["x", "y", "z", "x10", "y10", "z10"], NM_1, [[column[nm] for nm in NM_1] for column in columns])


def daylight():
    yield from rows(["S0", "S1", "S2"], NM_5, [values(DAYLIGHT[name], NM_5) for name in ("S0", "S1", "S2")])


def at_5_nm():
    yield from rows(AT_5_NM, NM_5, [values(colour.SDS_ILLUMINANTS[name], NM_5) for name in AT_5_NM])


def illuminant_a():
    """ISO/CIE 11664-2, to six digits."""
    exponent = lambda nm: np.exp(1.435e7 / (2848.0 * nm)) - 1.0  # noqa: E731
    relative = 100.0 * (560.0 / NM_1) ** 5 * exponent(560.0) / exponent(NM_1)
    return [f"{value:.6g}" for value in relative]


def confirmed(name, committed):
    """The committed column, with values of colour-science where they disagree."""
    theirs = colour.SDS_ILLUMINANTS[name]
    if name.startswith("LED"):
        at_nodes = dict(zip(NM_5, values(theirs, NM_5)))
        agrees = lambda nm, value: nm not in at_nodes or abs(value - at_nodes[nm]) <= 0.005  # noqa: E731
    else:
        # Daylight is known every 10 nm, here with six digits, in colour-science with at least five.
        line = dict(zip(NM_1, np.interp(NM_1, NM_5[::2], values(theirs, NM_5[::2]))))
        agrees = lambda nm, value: abs(value - line[nm]) <= 0.00101  # noqa: E731
    own = np.interp(NM_1, NM_5, values(theirs, NM_5))
    return [text if text and agrees(nm, float(text)) else float(own[i])
            for i, (nm, text) in enumerate(zip(NM_1, committed))]


def at_1_nm():
    path = ROOT / "crates/spectra/data/illuminants-1nm.csv"
    with path.open(newline="") as file:
        committed = {int(row["nm"]): row for row in csv.DictReader(file)} if path.exists() else {}
    columns = [confirmed(name, [committed.get(int(nm), {}).get(name, "") for nm in NM_1]) for name in AT_1_NM[1:]]
    yield from rows(AT_1_NM, NM_1, [illuminant_a(), *columns])


def lamps():
    yield ["light", "x", "y", "x_published", "y_published"]
    observer = np.array([[float(cell) for cell in row[1:4]] for row in list(observers())[1:]])
    published = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]
    for table in (list(at_1_nm()), list(at_5_nm())):
        numbers = np.array([[float(cell) for cell in row] for row in table[1:]])
        for k, name in enumerate(table[0][1:], start=1):
            xyz = np.interp(NM_1, numbers[:, 0], numbers[:, k]) @ observer
            known = published.get(name)
            known = ["", ""] if known is None else [repr(float(v)) for v in known]
            yield [name, *(repr(float(v)) for v in colour.XYZ_to_xy(xyz)), *known]


def tables():
    yield "crates/colour/data/observers.csv", list(observers()), 0.0
    yield "crates/spectra/data/daylight.csv", list(daylight()), 0.0
    yield "crates/spectra/data/illuminants-5nm.csv", list(at_5_nm()), 0.0
    yield "crates/spectra/data/illuminants-1nm.csv", list(at_1_nm()), 0.0
    yield "validation/colour/lamps.csv", list(lamps()), 1e-9


if __name__ == "__main__":
    oracle.main(__doc__, ROOT, tables(), least=1.0)
