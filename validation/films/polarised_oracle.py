"""Flat layers that keep s and p apart, by the program `tmm`, as reference values for bare displays at oblique angles.

    pip install tmm==0.2.0 numpy==2.4.6
    python validation/films/polarised_oracle.py --write     # makes polarised.csv
    python validation/films/polarised_oracle.py --check     # recomputes and compares with it

`inc_tmm` sums intensities between thick layers and amplitudes within thin ones, for one polarisation. polarised.csv: the
reflectance of s and of p of each display, angle in air and wavelength. polarised_paper.csv: paper of reflectance 0.8 below the same
layers in diffuse light, R(theta) + T(theta)/n^2 0.8 t/(1 - 0.8 r) with t the integral of T over the square of the sine,
r = 1 - t/n^2, and T and R the means over s and p of the whole layers. polarised_diffused.csv: the mean of R_s and R_p over
the square of the sine, what a Lambertian diffuser in the air above each display shows in diffuse light. The pixel is an absorber of 12 nm (n 3.18, k
3.33), a spacer of 38.6 nm (1.46), an air gap of 192.3 nm and a mirror (0.97, 6.46); glass has 1.5.
"""

import pathlib
import sys

import numpy as np
import tmm

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))

import oracle  # noqa: E402

PIXEL = [(3.18 + 3.33j, 12.0), (1.46, 38.6), (1.0, 192.3), (0.97 + 6.46j, np.inf)]
THICK = 1e6
FACE = [(1.5, THICK)]
COVER = [(1.5, THICK), (1.0, THICK), (1.5, THICK)]
PANES = [(1.5, THICK), (1.0, THICK), *COVER]
DISPLAYS = {"face": FACE, "cover": COVER, "panes": PANES, "coated": [(1.38, 99.6), *COVER]}


def reflectance(polarisation, layers, theta_deg, nm):
    stack = [(1.0, np.inf), *layers, *PIXEL]
    kinds = ["i"] + ["i" if d == THICK else "c" for _, d in stack[1:-1]] + ["i"]
    indices, lengths = zip(*stack)
    return tmm.inc_tmm(polarisation, indices, lengths, kinds, np.radians(theta_deg), nm)["R"]


def rows():
    yield ["display", "theta_deg", "wavelength_nm", "R_s", "R_p"]
    for name, layers in DISPLAYS.items():
        for theta_deg in (8, 45, 60, 75):
            for nm in (450.0, 550.0, 650.0):
                yield [name, theta_deg, nm] + [repr(float(reflectance(p, layers, theta_deg, nm))) for p in "sp"]


def glass(theta, layers):
    """Transmittance of the layers above the last medium, which is that of the paper; mean of s and p."""
    indices, lengths = zip((1.0, np.inf), *layers[:-1], (layers[-1][0], np.inf))
    kinds = ["i"] + ["i" if d == THICK else "c" for _, d in layers[:-1]] + ["i"]
    return np.mean([tmm.inc_tmm(p, indices, lengths, kinds, theta, 550.0)["T"] for p in "sp"])


def paper_rows():
    yield ["display", "theta_deg", "rho"]
    x, weights = np.polynomial.legendre.leggauss(120)
    x, weights = np.pi / 4 * (x + 1), np.pi / 4 * weights
    for name, layers in DISPLAYS.items():
        n, rho = layers[-1][0], 0.8
        t = float(np.sum(weights * np.sin(2 * x) * [glass(theta, layers) for theta in x]))
        up = rho * t / (1 - rho * (1 - t / n**2))
        for theta_deg in (8, 45, 60, 75):
            through = glass(np.radians(theta_deg), layers)
            yield [name, theta_deg, repr(float(1 - through + through / n**2 * up))]


def diffused_rows():
    yield ["display", "wavelength_nm", "rho"]
    x, weights = np.polynomial.legendre.leggauss(200)
    x, weights = np.pi / 4 * (x + 1), np.pi / 4 * weights
    for name, layers in DISPLAYS.items():
        for nm in (450.0, 550.0, 650.0):
            both = [[reflectance(p, layers, np.degrees(theta), nm) for theta in x] for p in "sp"]
            yield [name, nm, repr(float(np.sum(weights * np.sin(2 * x) * np.mean(both, axis=0))))]


if __name__ == "__main__":
    TABLES = [("polarised.csv", rows()), ("polarised_paper.csv", paper_rows()), ("polarised_diffused.csv", diffused_rows())]
    oracle.main(__doc__, HERE, [(name, list(table), 1e-10) for name, table in TABLES], 1e-6)
