"""Sparkle of a lamp below Gaussian faces of several millimetres, by rays at random places.

    pip install numpy==2.4.6
    python sparkle_oracle.py --write     # makes sparkle.csv
    python sparkle_oracle.py --check     # computes it with other random numbers and compares

sparkle.csv: the pixel power deviation of a uniform pixel plane in diffuse light and that of a round lamp (`ppd_lamp` of Papilio), and
the mean light of a pixel, each with its standard error.

Each row takes a processor about a minute.

A face is 5.04 mm wide, far wider than what light meets of it on its way in and out, so that nothing of it is met again. Rays start at
random places of each pixel and in random directions of the pupil. Two independent sets of rays give the light of each pixel twice:
the covariance of both over the pixels is the variance without the noise of rays. Nothing here is averaged over cells.

Angles in degrees, lengths in mm. The face deflects light by Snell's law to first order in the slope, as Papilio does.
"""

import csv
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
PITCH, INDEX, CORRELATION, SHARE = 0.084, 1.5, 0.015, 0.3
PIXELS, PER_PIXEL = 60, 56
CELLS, SIDE = PIXELS * PER_PIXEL, PIXELS * PITCH
COLUMNS = ["pixel", "gap_mm", "slope_rms", "view_deg", "azimuth_deg", "lamp_deg", "radius_deg", "pupil_mm", "distance_mm"]
RESULTS = ["ppd", "ppd_error", "mean", "mean_error"]

# The way along the face from where light enters to where it leaves is 0.2 to 1.2 mm, or none.
CASES = [
    ("mirror", 0.5, 0.036, 17, 0, 20, 2, 0, 400),
    ("mirror", 1.0, 0.036, 17, 0, 20, 2, 0, 400),
    ("mirror", 1.268, 0.036, 17, 0, 20, 2, 0, 400),
    ("mirror", 1.5, 0.036, 17, 0, 20, 2, 0, 400),
    ("mirror", 1.2, 0.036, 17, 45, 20, 2, 0, 400),
    ("mirror", 3.0, 0.02, 17, 0, 20, 2, 8, 400),
    ("mirror", 0.3, 0.02, 0, 0, 1, 2, 0, 400),
    ("lambertian", 1.0, 0.036, 17, 0, 17, 3, 0, 400),
    ("lambertian", 0.8, 0.036, 0, 0, 40, 5, 0, 400),
    # A large lamp: its light has other mean direction cosines than its middle.
    ("mirror", 0.3, 0.05, 50, 0, 45, 10, 0, 400),
]


def face(slope, random):
    """Slopes along x and y at the middles of cells."""
    f = np.fft.fftfreq(CELLS, SIDE / CELLS)
    x, y = f[:, None], f[None, :]
    height = slope * CORRELATION / np.sqrt(2)
    spectrum = np.pi * (CORRELATION * height) ** 2 * np.exp(-((np.pi * CORRELATION) ** 2) * (x * x + y * y))
    waves = np.fft.fft2(random.standard_normal((CELLS, CELLS))) * np.sqrt(spectrum) * CELLS / SIDE
    return [np.fft.ifft2(2j * np.pi * axis * waves).real for axis in (x, y)]


def at(values, x, y):
    """Linear interpolation between the middles of cells."""
    x, y = x * (CELLS / SIDE) - 0.5, y * (CELLS / SIDE) - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    u, v = x - i, y - j
    i, j, k, m = i % CELLS, j % CELLS, (i + 1) % CELLS, (j + 1) % CELLS
    return (1 - u) * ((1 - v) * values[i, j] + v * values[i, m]) + u * ((1 - v) * values[k, j] + v * values[k, m])


class Beam:
    """Light of one direction outside of the panel."""

    def __init__(self, beta, gap):
        self.beta = np.array(beta, float)
        square = self.beta @ self.beta
        self.inside, self.outside = np.sqrt(INDEX**2 - square), np.sqrt(1 - square)
        self.bend = self.inside - self.outside
        outer = np.outer(self.beta, self.beta)
        self.place_per_beta = gap / self.inside * (np.eye(2) + outer / self.inside**2)
        self.place = gap * self.beta / self.inside

    def moved(self, slopes):
        """Displacement on the pixel plane by slopes."""
        m = self.bend * self.place_per_beta
        return m[0, 0] * slopes[0] + m[0, 1] * slopes[1], m[1, 0] * slopes[0] + m[1, 1] * slopes[1]


def disc(count, random):
    """Random points of the unit disc."""
    radius, turn = np.sqrt(random.random(count)), 2 * np.pi * random.random(count)
    return radius * np.cos(turn), radius * np.sin(turn)


def around(beta, radius, count, random):
    """Random directions of a round source or pupil, relative to its middle."""
    u, v = disc(count, random)
    b = np.hypot(*beta)
    along = np.array(beta) / b if b > 0 else np.array([1.0, 0.0])
    u, v = radius * np.sqrt(1 - b * b) * u, radius * v
    return u * along[0] - v * along[1], u * along[1] + v * along[0]


def in_cone(axis, radius, count, random):
    """Random directions of a cone, in proportion to the irradiance of a plane, as direction cosines relative to its axis's."""
    cosine = 1 - random.random(count) * (1 - np.cos(radius))
    turn = 2 * np.pi * random.random(count)
    local = np.stack([np.sqrt(1 - cosine**2) * np.cos(turn), np.sqrt(1 - cosine**2) * np.sin(turn), cosine])
    b = np.hypot(*axis)
    along = np.array(axis) / b if b > 0 else np.array([1.0, 0.0])
    up = np.sqrt(1 - b * b)
    # The axis, the direction across it in the plane of incidence, and the one across that plane.
    frame = np.array([[up * along[0], -along[1], axis[0]], [up * along[1], along[0], axis[1]], [-b, 0, up]])
    x, y, z = frame @ local
    kept = random.random(count) * min(1, np.cos(max(0, np.arccos(up) - radius))) < z
    return x[kept] - axis[0], y[kept] - axis[1]


def irradiance(case, slopes, view, random, rays):
    """Light of the lamp on cells of the pixel plane, in the coordinate of the view's undeflected rays."""
    _, gap, _, _, azimuth, lamp, radius, _, _ = case
    turn = np.radians(azimuth)
    # Propagation of the light of a lamp at this inclination, on the view's side if positive.
    beam = Beam(np.sin(np.radians(-lamp)) * np.array([np.cos(turn), np.sin(turn)]), gap)
    cells = np.zeros(CELLS * CELLS)
    block = 4_000_000
    for _ in range(rays // block):
        bx, by = in_cone(beam.beta, np.radians(radius), block, random)
        x, y = SIDE * random.random(bx.size), SIDE * random.random(bx.size)
        u, v = beam.moved([at(values, x, y) for values in slopes])
        p = beam.place_per_beta
        x = x + u + beam.place[0] + view.place[0] + p[0, 0] * bx + p[0, 1] * by
        y = y + v + beam.place[1] + view.place[1] + p[1, 0] * bx + p[1, 1] * by
        i = (np.floor(x * CELLS / SIDE).astype(int) % CELLS) * CELLS + np.floor(y * CELLS / SIDE).astype(int) % CELLS
        cells += np.bincount(i, minlength=CELLS * CELLS)
    return (cells / cells.mean()).reshape(CELLS, CELLS)


def light(case, slopes, random, rays):
    """Mean light of each pixel over random rays."""
    pixel, gap, _, theta, azimuth, lamp, radius, pupil, distance = case
    turn = np.radians(azimuth)
    axis = np.array([np.cos(turn), np.sin(turn)])
    view = Beam(np.sin(np.radians(theta)) * axis, gap)
    if pixel == "lambertian":
        cells = irradiance(case, slopes, view, random, 24_000_000)
    total = np.zeros((PIXELS, PIXELS))
    corner = PITCH * np.arange(PIXELS)
    for _ in range(rays):
        x = (corner[:, None] + PITCH * random.random((PIXELS, PIXELS))).ravel()
        y = (corner[None, :] + PITCH * random.random((PIXELS, PIXELS))).ravel()
        m = [at(values, x, y) for values in slopes]
        u, v = view.moved(m)
        bx, by = around(view.beta, 0.5 * pupil / np.hypot(0.5 * pupil, distance), x.size, random)
        if pixel == "lambertian":
            i = (np.floor((x + u) * CELLS / SIDE).astype(int) % CELLS, np.floor((y + v) * CELLS / SIDE).astype(int) % CELLS)
            found = cells[i]
        else:
            p = view.place_per_beta
            back = [2 * (view.place[k] + p[k, 0] * bx + p[k, 1] * by) for k in (0, 1)]
            other = [at(values, x - back[0] + 2 * u, y - back[1] + 2 * v) for values in slopes]
            seen = [view.beta[k] + (bx, by)[k] - view.bend * (m[k] + other[k]) for k in (0, 1)]
            lamp_rad, radius_rad = np.radians(lamp), np.radians(radius)
            up = np.sqrt(np.maximum(0, 1 - seen[0] ** 2 - seen[1] ** 2))
            cosine = np.sin(lamp_rad) * (seen[0] * axis[0] + seen[1] * axis[1]) + np.cos(lamp_rad) * up
            found = (cosine > np.cos(radius_rad)) / (np.sin(radius_rad) ** 2 * np.cos(lamp_rad))
        total += (1 - SHARE + SHARE * found).reshape(PIXELS, PIXELS)
    return total / rays


def deviation(case, faces, seed):
    """PPD and mean light, with standard errors over faces."""
    covariances, means = [], []
    for number in range(faces):
        random = np.random.default_rng([seed, number])
        slopes = face(case[2], random)
        one, other = (light(case, slopes, random, 300) for _ in range(2))
        covariances.append(np.mean(one * other) - one.mean() * other.mean())
        means.append(0.5 * (one + other).mean())
    count = np.sqrt(faces)
    covariance, mean = np.mean(covariances), np.mean(means)
    ppd = np.sqrt(covariance) / mean
    return ppd, 0.5 * ppd * np.std(covariances, ddof=1) / covariance / count, mean, np.std(means, ddof=1) / count


def main():
    path = HERE / "sparkle.csv"
    if sys.argv[1:] == ["--write"]:
        with path.open("w", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(COLUMNS + RESULTS)
            for case in CASES:
                row = list(case) + [f"{value:.5g}" for value in deviation(case, 10, 1)]
                rows.writerow(row)
                print(*row, flush=True)
    elif sys.argv[1:] == ["--check"]:
        for row in csv.DictReader(path.open()):
            case = (row["pixel"], *(float(row[name]) for name in COLUMNS[1:]))
            ppd, error, mean, mean_error = deviation(case, 4, 2)
            z = [(ppd - float(row["ppd"])) / np.hypot(error, float(row["ppd_error"])),
                 (mean - float(row["mean"])) / np.hypot(mean_error, float(row["mean_error"]))]
            print(*case, *(f"{value:.2f}" for value in z), flush=True)
            assert max(map(abs, z)) < 6, "differs by more than six standard errors"
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
