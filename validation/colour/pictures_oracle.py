"""Compares differences of pictures with programs of others; `--write` writes the committed table again.

    pip install flip-evaluator==1.7 colour-science==0.4.7 numpy==2.4.6 scipy==1.17.1
    python pictures_oracle.py --check

pictures.csv: mean difference, and those of three pixels, of two pictures of 24 rows and 40 columns: waves of colour that become finer
downwards, w(k) = 0.5 + 0.5 sin(0.37 (k + 1) i + 0.11 (k + 2) j (1 + 0.05 i)) in row i and column j.

- flip: by the authors' program. Linear red, green and blue are w(0), w(1), w(2) and the squares of w(1), w(2), w(3).
- scielab-1976, scielab-2000: X, Y, Z are the white times these numbers. The filters of `scielab.m` (1996) by scipy's cosine transform, so that
  the picture continues as its mirror image; colour differences by colour-science. X, Y, Z are scaled from the white to D65 before the filters.
"""

import pathlib
import sys
import warnings

warnings.filterwarnings("ignore")

import colour  # noqa: E402
import flip_evaluator  # noqa: E402
import numpy as np  # noqa: E402
import scipy.fft  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))

import oracle  # noqa: E402

ROWS, COLUMNS = 24, 40
PIXELS = [(0, 0), (3, 5), (10, 20)]
DISTANCES = [67.0206, 30.0, 120.0]
D65 = np.array([0.95047, 1.0, 1.08883])
WARM = np.array([1.0985, 1.0, 0.3558])
OPPONENT = np.array(
    [[0.2787336, 0.7218031, -0.1065520], [-0.4487736, 0.2898056, 0.0771569], [0.0859513, -0.5899859, 0.5011089]]
)
FILTERS = [  # full width at half maximum in degrees, weight
    [(0.05, 1.00327), (0.225, 0.114416), (7.0, -0.117686)],
    [(0.0685, 0.616725), (0.826, 0.383275)],
    [(0.092, 0.567885), (0.6451, 0.432115)],
]


def waves():
    i, j = np.meshgrid(np.arange(ROWS), np.arange(COLUMNS), indexing="ij")
    w = [0.5 + 0.5 * np.sin(0.37 * (k + 1) * i + 0.11 * (k + 2) * j * (1 + 0.05 * i)) for k in range(4)]
    return np.stack(w[:3], axis=-1), np.stack(w[1:], axis=-1) ** 2


def flip(pixels_per_degree):
    pictures = [colour.cctf_encoding(one, "sRGB").astype(np.float32) for one in waves()]
    return flip_evaluator.evaluate(*pictures, "LDR", applyMagma=False, parameters={"ppd": pixels_per_degree})[0][..., 0]


def blurred_lab(linear, white, pixels_per_degree):
    opponents = linear * D65 @ OPPONENT.T
    x, y = [np.arange(count) / (2 * count) * pixels_per_degree for count in (COLUMNS, ROWS)]
    squared = y[:, None] ** 2 + x[None, :] ** 2  # (cycles per degree) squared
    for k, gaussians in enumerate(FILTERS):
        transfer = sum(w * np.exp(-((np.pi * fwhm) ** 2) * squared / (4 * np.log(2))) for fwhm, w in gaussians)
        transfer /= sum(w for _, w in gaussians)
        opponents[..., k] = scipy.fft.idctn(scipy.fft.dctn(opponents[..., k]) * transfer)
    xyz = opponents @ np.linalg.inv(OPPONENT).T / D65 * white
    return colour.XYZ_to_Lab(xyz, colour.XYZ_to_xy(white))


def scielab(white, pixels_per_degree, method):
    return colour.delta_E(*(blurred_lab(one, white, pixels_per_degree) for one in waves()), method=method)


def comparisons():
    yield ["measure", "Xw", "Yw", "Zw", "pixels_per_degree", "mean", *(f"row {i} column {j}" for i, j in PIXELS)]
    for distance in DISTANCES:
        yield row("flip", D65, distance, flip(distance))
    for distance in DISTANCES:
        for year in ("1976", "2000"):
            yield row(f"scielab-{year}", WARM, distance, scielab(WARM, distance, f"CIE {year}"))


def row(name, white, distance, found):
    numbers = [found.mean(), *(found[at] for at in PIXELS)]
    return [name, *white.tolist(), distance, *(f"{float(value):.7f}" for value in numbers)]


def tables():
    # The authors' program has single precision.
    yield "pictures.csv", list(comparisons()), 1e-5


if __name__ == "__main__":
    oracle.main(__doc__, HERE, tables(), least=1.0)
