"""Colours of some surfaces by colour-science, as an oracle for papilio-colour.

    pip install colour-science==0.4.7
    python colour_oracle.py --write     # makes surfaces.csv and differences.csv
    python colour_oracle.py --check     # recomputes and compares with them

surfaces.csv: a surface of reflectance `floor + height exp(-((nm - centre)/width)^2)`
under a CIE illuminant, 380 to 780 nm at 1 nm, 1931 2 degree observer: X, Y, Z
(perfect white Y = 1), u', v' and L*, a*, b* against that light.
differences.csv: pairs of L*a*b* and their CIEDE2000 difference.
"""

import pathlib
import sys
import warnings

warnings.filterwarnings("ignore")

import colour  # noqa: E402
import numpy as np  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))

import oracle  # noqa: E402

NM = colour.SpectralShape(380, 780, 1)
OBSERVER = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(NM).values
LIGHTS = ["E", "D65", "D50", "A", "LED-B1", "LED-B5", "LED-BH1", "LED-V1"]
SURFACES = [  # floor, height, centre nm, width nm
    (1.0, 0.0, 550.0, 50.0),
    (0.02, 0.0, 550.0, 50.0),
    (0.005, 0.35, 450.0, 30.0),
    (0.01, 0.30, 530.0, 45.0),
    (0.02, 0.25, 620.0, 60.0),
    (0.30, -0.25, 500.0, 80.0),
]


def light(name):
    if name == "E":
        return np.ones(len(NM.wavelengths))
    if name.startswith("D"):  # piecewise linear by the CIE's definition
        return colour.SDS_ILLUMINANTS[name].copy().align(NM).values
    return colour.SDS_ILLUMINANTS[name].copy().interpolate(NM, interpolator=colour.SpragueInterpolator).values


def surfaces():
    yield ["light", "floor", "height", "centre_nm", "width_nm", "X", "Y", "Z", "u_prime", "v_prime", "L", "a", "b"]
    nm = NM.wavelengths
    for name in LIGHTS:
        spd = light(name)
        white = spd @ OBSERVER
        for floor, height, centre, width in SURFACES:
            reflectance = floor + height * np.exp(-(((nm - centre) / width) ** 2))
            xyz = (spd * reflectance) @ OBSERVER / white[1]
            relative_white = white / white[1]
            uv = colour.xy_to_Luv_uv(colour.XYZ_to_xy(xyz))
            lab = colour.XYZ_to_Lab(xyz, colour.XYZ_to_xy(relative_white))
            yield [name, floor, height, centre, width, *(repr(float(v)) for v in (*xyz, *uv, *lab))]


def differences():
    yield ["L1", "a1", "b1", "L2", "a2", "b2", "delta_e_2000"]
    numbers = np.random.default_rng(20120501)
    low, high = np.array([0.0, -80.0, -80.0]), np.array([100.0, 80.0, 80.0])
    for i in range(60):
        one = np.round(numbers.uniform(low, high), 4)
        step = [1.0, 10.0, 60.0][i % 3]
        two = np.round(np.clip(one + numbers.normal(0.0, step, 3), low, high), 4)
        yield [*one.tolist(), *two.tolist(), repr(float(colour.delta_E(one, two, method="CIE 2000")))]


def tables():
    yield "surfaces.csv", list(surfaces()), 1e-9
    yield "differences.csv", list(differences()), 1e-9


if __name__ == "__main__":
    oracle.main(__doc__, HERE, tables(), least=1.0)
