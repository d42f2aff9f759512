"""Random thin-film stacks through PyPI `tmm` 0.2.0, as a table for the Rust tests.

    python validation/films/tmm_oracle.py --check    # recompute, compare with the tables
    python validation/films/tmm_oracle.py --write    # write the tables

Needs `pip install tmm==0.2.0 numpy`. The tables are next to this file:
`tmm.csv` has one row for each film with both polarisations, from a
fixed seed; `coatings.csv` has single absorbing films between air and
substrates of many indices, in unpolarised light from both sides.

Limits of tmm 0.2.0 as a reference:

- It limits the imaginary phase of a layer to 35, with a warning: the error of the
  field behind such an opaque layer is below 1e-30. The rows are included (20 um of
  metal is drawn deliberately), and the warning is suppressed.
- If the index of a layer equals beta = n sin(theta) to the last bits, its interface
  matrices are singular and energy is not conserved: for n = 1.5 / 100 nm of n = beta /
  n = 1.5 at 60 deg, R + T = 1.0005 for s and 0.558 for p. Random stacks are never
  close to this case; the Rust tests compare it with R + T = 1 and with a thin limit.
- It stops with an AssertionError if it cannot distinguish a forward wave from a
  backward wave. No row of this seed is such a case; otherwise this script would stop, too.
"""

import argparse
import contextlib
import csv
import importlib.metadata
import io
import math
import pathlib
import sys

import numpy as np
import tmm

TABLE = pathlib.Path(__file__).with_name("tmm.csv")
COATINGS = pathlib.Path(__file__).with_name("coatings.csv")
SEED = 20_120_501
ROWS = 500
MAX_LAYERS = 6
TOLERANCE = 1e-10
COLUMNS = (
    ["kind", "wavelength_nm", "theta_deg", "beta", "incidence", "n_sub", "k_sub", "layers"]
    + ["r_s_re", "r_s_im", "r_p_re", "r_p_im", "t_s_re", "t_s_im", "t_p_re", "t_p_im"]
    + ["R_s", "R_p", "T_s", "T_p", "A_s", "A_p"]
)


# Name, n + ik at 550 nm: Cr (two samples), Al, Ni, Ti, Ag, Ge, ITO.
FILMS = [
    ("Cr", 3.181 + 3.329j), ("Cr:Sytchkova", 3.588 + 4.898j), ("Al", 0.966 + 6.458j), ("Ni", 1.815 + 3.259j),
    ("Ti", 1.791 + 3.003j), ("Ag", 0.134 + 3.172j), ("Ge", 5.194 + 2.117j), ("ITO", 1.864 + 0.003j),
]
# Adhesive, BK7, glasses of high index, sapphire, silicon nitride, titania and others.
SUBSTRATES = [1.30, 1.38, 1.47, 1.519, 1.59, 1.64, 1.72, 1.77, 1.79, 1.80, 1.97, 2.023, 2.4]
THICKNESSES_NM = [2.0, 12.0, 45.0]
# Sines of the angle in air, and beyond its critical angle as parts of what is left up to the substrate.
SINES = [0.0, 0.5, 0.9, 0.999]
BEYOND = [0.01, 0.5, 0.99]
COATING_COLUMNS = ["film", "n", "k", "thickness_nm", "substrate", "beta", "R_from_air", "T", "R_from_substrate"]


def medium(random, kind):
    """Returns a random index of one of four kinds."""
    if kind == "glass":
        return complex(random.uniform(1.2, 3.0), 0.0)
    if kind == "air":
        return complex(1.0, 0.0)
    if kind == "weak":
        return complex(random.uniform(1.2, 3.0), 10.0 ** random.uniform(-9.0, -1.0))
    return complex(random.uniform(0.05, 4.0), random.uniform(1.0, 8.0))


def stack(random, row):
    """Returns layers, substrate, index of incidence, wavelength and angle of a row."""
    kinds = ["glass", "air", "weak", "metal"]
    layers = []
    for _ in range(random.integers(0, MAX_LAYERS + 1)):
        kind = random.choice(kinds, p=[0.45, 0.2, 0.15, 0.2])
        thick = random.choice([60.0, 500.0, 20_000.0], p=[0.6, 0.25, 0.15]) if kind == "metal" else 500.0
        layers.append((medium(random, kind), random.uniform(0.0, float(thick))))
    substrate = medium(random, random.choice(kinds, p=[0.4, 0.2, 0.1, 0.3]))
    incidence = 1.0 if random.random() < 0.4 else random.uniform(1.0, 2.0)
    wavelength = random.uniform(380.0, 780.0)
    # Normal and grazing incidence are drawn deliberately, the other angles uniformly.
    theta = [0.0, 89.9][row % 2] if row % 10 < 2 else random.uniform(0.0, 89.9)
    return layers, substrate, incidence, wavelength, theta


def kind_of(layers, substrate, beta):
    """Returns a description of the difficulties of a row, for the messages of failures."""
    words = []
    if any(n.imag > 0.5 for n, _ in layers) or substrate.imag > 0.5:
        words.append("metal")
    if any(n.imag == 0.0 and n.real < beta for n, _ in layers):
        words.append("evanescent")
    if substrate.imag == 0.0 and substrate.real < beta:
        words.append("total")
    return "+".join(words) or "plain"


def solve(layers, substrate, incidence, wavelength, theta):
    """Returns (r, t, R, T, A of each layer) for s and for p."""
    n_list = [incidence] + [n for n, _ in layers] + [substrate]
    d_list = [math.inf] + [d for _, d in layers] + [math.inf]
    found = []
    for polarisation in "sp":
        with contextlib.redirect_stdout(io.StringIO()):
            data = tmm.coh_tmm(polarisation, n_list, d_list, math.radians(theta), wavelength)
            absorbed = tmm.absorp_in_each_layer(data)[1:-1]
        found.append((data["r"], data["t"], data["R"], data["T"], absorbed))
    return found


def number(x):
    return repr(float(x))


def rows():
    random = np.random.default_rng(SEED)
    for row in range(ROWS):
        layers, substrate, incidence, wavelength, theta = stack(random, row)
        beta = incidence * math.sin(math.radians(theta))
        text = " ".join(f"{n.real!r}:{n.imag!r}:{d!r}" for n, d in layers)
        head = [kind_of(layers, substrate, beta), wavelength, theta, beta, incidence]
        head += [substrate.real, substrate.imag]
        line = [head[0]] + [number(x) for x in head[1:]] + [text]
        s, p = solve(layers, substrate, incidence, wavelength, theta)
        amplitudes = [s[0].real, s[0].imag, p[0].real, p[0].imag]
        amplitudes += [s[1].real, s[1].imag, p[1].real, p[1].imag]
        powers = [s[2], p[2], s[3], p[3]]
        absorbed = [" ".join(number(a) for a in x[4]) for x in (s, p)]
        yield line + [number(x) for x in amplitudes + powers] + absorbed


def coating_rows():
    """Yields rows of single films in unpolarised light; what does not exist beyond the critical angle is 0."""

    def mean(indices, thicknesses, theta):
        both = [tmm.coh_tmm(polarisation, indices, thicknesses, theta, 550.0) for polarisation in "sp"]
        return [sum(data[name] for data in both) / 2 for name in ("R", "T")]

    for name, index in FILMS:
        for thickness in THICKNESSES_NM:
            for below in SUBSTRATES:
                for beta in SINES + [1 + part * (below - 1) for part in BEYOND]:
                    # Angles in an absorbing film are complex: tmm takes that of the incident medium.
                    thicknesses = [math.inf, thickness, math.inf]
                    from_air, through = 0.0, 0.0
                    if beta < 1:
                        from_air, through = mean([1.0, index, below], thicknesses, math.asin(beta))
                    from_below, _ = mean([below, index, 1.0], thicknesses, math.asin(beta / below))
                    numbers = [index.real, index.imag, thickness, below, beta, from_air, through, from_below]
                    yield [name, *map(number, numbers)]


def agree(old, new):
    """Returns whether all numbers are equal within the tolerance, which is relative for the inputs."""
    if old[0] != new[0]:
        return False
    old, new = (" ".join(line[1:]).replace(":", " ").split() for line in (old, new))
    if len(old) != len(new):
        return False
    pairs = [(float(a), float(b)) for a, b in zip(old, new)]
    return all(abs(a - b) <= TOLERANCE * max(1.0, abs(a)) for a, b in pairs)


def tmm_version():
    return importlib.metadata.version("tmm")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    action = parser.add_mutually_exclusive_group(required=True)
    action.add_argument("--check", action="store_true", help="recompute and compare with the table")
    action.add_argument("--write", action="store_true", help="write the table")
    arguments = parser.parse_args()

    tables = [(TABLE, COLUMNS, rows()), (COATINGS, COATING_COLUMNS, coating_rows())]
    results = [update(arguments.write, path, list(columns), list(fresh)) for path, columns, fresh in tables]
    return max(results)


def update(write, path, columns, fresh):
    """Writes or compares a table; returns the exit code."""
    if write:
        with path.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([columns, *fresh])
        print(f"{path.name}: {len(fresh)} films written")
        return 0
    with path.open(newline="") as file:
        header, *committed = csv.reader(file)
    differing = [i for i, (a, b) in enumerate(zip(committed, fresh)) if not agree(a, b)]
    if header != columns or len(committed) != len(fresh) or differing:
        print(f"{path.name} differs from tmm: rows {differing[:10]}", file=sys.stderr)
        return 1
    print(f"{path.name}: {len(fresh)} films equal tmm {tmm_version()} within {TOLERANCE:g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
