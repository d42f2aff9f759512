"""Random anisotropic stacks through PyPI `pyElli` 0.23.1, as a table for the Rust tests.

    python validation/films/berreman_oracle.py --check    # recompute, compare with the table
    python validation/films/berreman_oracle.py --write    # write the table

Needs `pip install pyElli==0.23.1 packaging numpy==2.4.6`. `berreman.csv`, next to this file, has one row for each
stack, from a fixed seed. Tensors are in the frame of the panel (x, y in the panel, z to the viewer) and are turned
into pyElli's frame (z down, x along the travel of the light) here, by rotation matrices of this script.

Limits of pyElli 0.23.1 as a reference: it multiplies transfer matrices (exponentials by SciPy), which lose digits
where waves decay. The layers drawn here let them decay by a factor of 1e3 at most.
"""

import argparse
import csv
import importlib.metadata
import math
import pathlib
import sys

import elli
import numpy as np

TABLE = pathlib.Path(__file__).with_name("berreman.csv")
SEED = 20_261_127
ROWS = 300
TOLERANCE = 1e-9
COLUMNS = (
    ["kind", "wavelength_nm", "beta", "azimuth_deg", "front", "n_back", "k_back", "layers"]
    + [f"{a}_{b}_{part}" for a in "rt" for b in ("pp", "ps", "sp", "ss") for part in ("re", "im")]
)
# Elements of a symmetric tensor in the table.
ELEMENTS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]


class Fixed(elli.Material):
    """A material with one tensor at all wavelengths."""

    def __init__(self, tensor):
        self.tensor = np.asarray(tensor, dtype=complex)

    def get_tensor(self, lbda):
        return np.broadcast_to(self.tensor, (np.size(lbda), 3, 3)).copy()


class Medium(elli.IsotropicMaterial):
    """An isotropic medium with one index at all wavelengths."""

    def __init__(self, index):
        self.index = complex(index)

    def get_tensor(self, lbda):
        return np.broadcast_to(np.eye(3) * self.index**2, (np.size(lbda), 3, 3)).copy()


def about(axis, angle):
    """Returns the matrix that rotates by an angle about a coordinate axis, right-handed."""
    i, k = [(1, 2), (2, 0), (0, 1)][axis]
    out = np.eye(3)
    out[i, i] = out[k, k] = math.cos(angle)
    out[k, i] = math.sin(angle)
    out[i, k] = -out[k, i]
    return out


def principal(random, kind):
    """Returns three principal indices."""
    n = random.uniform(1.3, 2.2, 3)
    if kind in ("uniaxial", "polariser"):
        n[1] = n[0]
    k = np.zeros(3)
    if kind == "absorbing":
        k = random.uniform(0.0, 0.2, 3)
    if kind == "polariser":
        k = np.array([1e-4, 1e-4, random.uniform(0.01, 0.1)])
    return n + 1j * k


def layers_of(random):
    """Returns the text of the layers, and (thickness, tensor) of each slice from the top down."""
    texts, slices = [], []
    for _ in range(random.integers(1, 5)):
        kind = random.choice(["uniaxial", "biaxial", "absorbing", "polariser", "isotropic", "metal", "helix"])
        thickness = float(random.uniform(5.0, 600.0))
        if kind == "helix":
            o, e = (float(x) for x in np.sort(random.uniform(1.45, 1.85, 2)))
            azimuth, tilt, twist = (float(random.uniform(*ends)) for ends in [(0, 360), (0, 60), (-270, 270)])
            count, thickness = int(random.integers(3, 13)), 5 * thickness
            texts.append(f"helix:{o!r}:{e!r}:{azimuth!r}:{tilt!r}:{twist!r}:{count}:{thickness!r}")
            for k in range(count):
                turn = math.radians(azimuth + twist * (k + 0.5) / count)
                # A positive rotation about y lowers x.
                matrix = about(2, turn) @ about(1, -math.radians(tilt))
                slices.append((thickness / count, matrix @ np.diag([e**2, o**2, o**2]) @ matrix.T))
            continue
        if kind == "isotropic":
            tensor = np.eye(3) * random.uniform(1.0, 2.3) ** 2 + 0j
        elif kind == "metal":
            tensor = np.eye(3) * complex(random.uniform(0.05, 3.0), random.uniform(1.0, 5.0)) ** 2
            thickness /= 20
        else:
            turns = random.uniform(0.0, 2 * math.pi, 3)
            matrix = about(2, turns[0]) @ about(0, turns[1]) @ about(2, turns[2])
            tensor = matrix @ np.diag(principal(random, kind) ** 2) @ matrix.T
        elements = [tensor[at] for at in ELEMENTS]
        texts.append(":".join(["tensor", repr(thickness)] + [f"{float(e.real)!r}:{float(e.imag)!r}" for e in elements]))
        slices.append((thickness, tensor))
    return " ".join(texts), slices


def solve(front, back, slices, wavelength, theta, azimuth):
    """Returns the Jones matrices of reflection and transmission, rows and columns p, s."""
    # Columns: the axes of the wave in the frame of the panel.
    frame = about(2, azimuth) @ np.diag([1.0, -1.0, -1.0])
    turned = [elli.Layer(Fixed(frame.T @ tensor @ frame), d) for d, tensor in slices]
    ends = [Medium(front), Medium(back)]
    result = elli.Structure(ends[0], turned, ends[1]).evaluate(wavelength, theta)
    return [np.reshape(m, (2, 2)) for m in (result.jones_matrix_r, result.jones_matrix_t)]


def rows():
    random = np.random.default_rng(SEED)
    for row in range(ROWS):
        text, slices = layers_of(random)
        front = 1.0 if row % 3 == 0 else float(random.uniform(1.0, 1.6))
        back = complex(random.uniform(1.0, 2.2), 0.0)
        if row % 2 == 0:
            back = complex(random.uniform(0.1, 3.0), random.uniform(1.0, 7.0))
        wavelength = float(random.uniform(380.0, 780.0))
        theta = [0.0, 89.0][row // 10 % 2] if row % 10 == 0 else float(random.uniform(0.0, 89.0))
        azimuth = float(random.uniform(0.0, 360.0))
        kind = "metal" if back.imag > 0 else "total" if front * math.sin(math.radians(theta)) > back.real else "plain"
        r, t = solve(front, back, slices, wavelength, theta, math.radians(azimuth))
        beta = front * math.sin(math.radians(theta))
        numbers = [x for m in (r, t) for value in m.ravel() for x in (value.real, value.imag)]
        head = [wavelength, beta, azimuth, front, back.real, back.imag]
        yield [kind, *(repr(float(x)) for x in head), text, *(repr(round(float(x), 12)) for x in numbers)]


def agree(old, new):
    """Returns whether all numbers are equal within the tolerance, which is relative for the inputs."""
    split = lambda line: " ".join(line).replace(":", " ").split()  # noqa: E731
    old, new = split(old), split(new)
    if len(old) != len(new):
        return False
    for a, b in zip(old, new):
        try:
            if abs(float(a) - float(b)) > TOLERANCE * max(1.0, abs(float(a))):
                return False
        except ValueError:
            if a != b:
                return False
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    action = parser.add_mutually_exclusive_group(required=True)
    action.add_argument("--check", action="store_true", help="recompute and compare with the table")
    action.add_argument("--write", action="store_true", help="write the table")
    fresh = list(rows())
    if parser.parse_args().write:
        with TABLE.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *fresh])
        print(f"{TABLE.name}: {len(fresh)} stacks written")
        return 0
    with TABLE.open(newline="") as file:
        header, *committed = csv.reader(file)
    differing = [i for i, (a, b) in enumerate(zip(committed, fresh)) if not agree(a, b)]
    if header != COLUMNS or len(committed) != len(fresh) or differing:
        print(f"{TABLE.name} differs from pyElli: rows {differing[:10]}", file=sys.stderr)
        return 1
    print(f"{TABLE.name}: {len(fresh)} stacks equal pyElli {importlib.metadata.version('pyElli')} within {TOLERANCE:g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
