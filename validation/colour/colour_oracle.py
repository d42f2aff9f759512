"""Colours of some surfaces by colour-science, as reference values for papilio-colour.

    pip install colour-science==0.4.7 scipy==1.17.1
    python colour_oracle.py --write     # makes the tables
    python colour_oracle.py --check     # recomputes and compares with them

surfaces.csv: a surface of reflectance `floor + height exp(-((nm - centre)/width)^2)`
under a CIE illuminant, 380 to 780 nm at 1 nm, 1931 2 degree observer: X, Y, Z
(perfect white Y = 1), u', v', L*, a*, b* and u*, v* against that light; X10, Y10, Z10 of the
1964 10 degree observer.
differences.csv: pairs of L*a*b* and their CIEDE2000 difference.
appearance.csv: CIECAM16 (CIE 248:2022) J, C and CAM16-UCS J', a', b' of colours under viewing conditions.
adapted.csv: colours and whites; the colours adapted to D65 (CAT16, complete), and their Oklab.
gamuts.csv: displays by the X, Y, Z of black, red, green, yellow, blue, magenta, cyan, white: area and coverage of
references in u'v' (the common area by scipy, as an intersection of half-planes), the CIELAB volume of
their 602 surface colours against D65 (the triangles' tetrahedra), that of the colours' convex hull, and area and
coverage in xy.
primaries.csv: the reflectances of red, green and blue of Mallett and Yuksel 2019.
"""

import pathlib
import sys
import warnings

warnings.filterwarnings("ignore")

import colour  # noqa: E402
import numpy as np  # noqa: E402
import scipy.optimize  # noqa: E402
import scipy.spatial  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))

import oracle  # noqa: E402

NM = colour.SpectralShape(380, 780, 1)
OBSERVER = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(NM).values
OBSERVER_10 = colour.MSDS_CMFS["CIE 1964 10 Degree Standard Observer"].copy().align(NM).values
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
    yield ["light", "floor", "height", "centre_nm", "width_nm", "X", "Y", "Z", "u_prime", "v_prime", "L", "a", "b",
           "u_star", "v_star", "X10", "Y10", "Z10"]
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
            luv = colour.XYZ_to_Luv(xyz, colour.XYZ_to_xy(relative_white))[1:]
            xyz_10 = (spd * reflectance) @ OBSERVER_10 / (spd @ OBSERVER_10)[1]
            numbers = (*xyz, *uv, *lab, *luv, *xyz_10)
            yield [name, floor, height, centre, width, *(repr(float(v)) for v in numbers)]


def differences():
    yield ["L1", "a1", "b1", "L2", "a2", "b2", "delta_e_2000"]
    numbers = np.random.default_rng(20120501)
    low, high = np.array([0.0, -80.0, -80.0]), np.array([100.0, 80.0, 80.0])
    for i in range(60):
        one = np.round(numbers.uniform(low, high), 4)
        step = [1.0, 10.0, 60.0][i % 3]
        two = np.round(np.clip(one + numbers.normal(0.0, step, 3), low, high), 4)
        yield [*one.tolist(), *two.tolist(), repr(float(colour.delta_E(one, two, method="CIE 2000")))]


SURROUNDS = {"average": "Average", "dim": "Dim", "dark": "Dark"}


def appearance():
    yield ["X", "Y", "Z", "Xw", "Yw", "Zw", "adapting", "background", "surround", "J", "C", "J_prime", "a_prime", "b_prime"]
    numbers = np.random.default_rng(20220101)
    for i in range(60):
        white = np.round([numbers.uniform(0.85, 1.1), 1.0, numbers.uniform(0.3, 1.2)], 4)
        # From near black to four times the luminance of white, which a display with gain can have.
        xyz = np.round(white * numbers.uniform(0.3, 1.0, 3) * [0.003, 0.02, 0.1, 0.4, 1.0, 4.0][i // 3 % 6], 6)
        adapting = round(float(10 ** numbers.uniform(0, 3.5)), 3)
        background = round(float(numbers.uniform(0.1, 0.5)), 3)
        surround = list(SURROUNDS)[i % 3]
        cam = colour.XYZ_to_CIECAM16(100 * xyz, 100 * white, adapting, 100 * background,
                                     colour.VIEWING_CONDITIONS_CIECAM16[SURROUNDS[surround]])
        ucs = colour.JMh_CIECAM02_to_CAM02UCS([cam.J, cam.M, cam.h])  # the same formulae for CAM16-UCS
        yield [*xyz, *white, adapting, background, surround, *(repr(float(v)) for v in (cam.J, cam.C, *ucs))]


def adapted():
    yield ["X", "Y", "Z", "Xw", "Yw", "Zw", "X65", "Y65", "Z65", "L", "a", "b"]
    numbers = np.random.default_rng(20201223)
    for _ in range(40):
        white = np.round([numbers.uniform(0.85, 1.1), 1.0, numbers.uniform(0.3, 1.2)], 4)
        xyz = np.round(white * numbers.uniform(0.3, 1.0, 3) * 10 ** numbers.uniform(-3, 0.2), 6)
        seen = colour.adaptation.chromatic_adaptation_VonKries(xyz, white, WHITE, transform="CAT16")
        yield [*xyz, *white, *(repr(float(v)) for v in (*seen, *colour.XYZ_to_Oklab(seen)))]


REFERENCES = {
    "srgb": [(0.64, 0.33), (0.30, 0.60), (0.15, 0.06)],
    "ebu": [(0.64, 0.33), (0.29, 0.60), (0.15, 0.06)],
    "ntsc": [(0.67, 0.33), (0.21, 0.71), (0.14, 0.08)],
    "dci_p3": [(0.680, 0.320), (0.265, 0.690), (0.150, 0.060)],
}
WHITE = np.array([0.95047, 1.0, 1.08883])
STEPS = 10


def displays():
    """X, Y, Z of the eight corners; bits of the index: red (1), green (2) and blue (4) are on."""
    for name, colourspace in [("srgb", "sRGB"), ("p3", "Display P3"), ("bt2020", "ITU-R BT.2020")]:
        matrix = colour.RGB_COLOURSPACES[colourspace].matrix_RGB_to_XYZ
        corners = np.array([matrix @ [on & 1, on >> 1 & 1, on >> 2 & 1] for on in range(8)])
        yield name, np.round(corners / corners[7] * WHITE, 6)
    numbers = np.random.default_rng(20120502)
    primaries = np.array([[0.06, 0.035, 0.005], [0.05, 0.12, 0.02], [0.03, 0.02, 0.12]])
    for i in range(6):
        black = 0.01 * numbers.uniform(0.3, 2.0, 3)
        lit = primaries * numbers.uniform(0.7, 1.3, (3, 3))
        corners = [black + sum(lit[k] for k in range(3) if on >> k & 1) for on in range(8)]
        yield f"mixed-{i}", np.round(corners * (1 if i % 2 else numbers.uniform(0.9, 1.1, (8, 1))), 6)


def common_area(one, other):
    """Area of the intersection of two convex polygons, by half-planes."""
    def half_planes(corners):
        hull = scipy.spatial.ConvexHull(corners)
        return hull.equations
    planes = np.vstack([half_planes(one), half_planes(other)])
    norm = np.ones((len(planes), 1))
    found = scipy.optimize.linprog([0, 0, -1], A_ub=np.hstack([planes[:, :2], norm]), b_ub=-planes[:, 2],
                                   bounds=[(None, None), (None, None), (0, None)])
    if not found.success or found.x[2] < 1e-12:
        return 0.0
    corners = scipy.spatial.HalfspaceIntersection(planes, found.x[:2]).intersections
    return scipy.spatial.ConvexHull(corners).volume  # of a plane figure: its area


def solid(corners):
    """Volume enclosed by the gamut surface in CIELAB, and volume of its convex hull."""
    steps = np.linspace(0.0, 1.0, STEPS + 1) ** 2.2
    volume, points = 0.0, []
    for axis in range(3):
        for side in (0.0, 1.0):
            drive = np.zeros((STEPS + 1, STEPS + 1, 3))
            drive[..., axis] = side
            drive[..., (axis + 1) % 3] = steps[:, None]
            drive[..., (axis + 2) % 3] = steps[None, :]
            weight = np.ones((STEPS + 1, STEPS + 1, 8))
            for on in range(8):
                for k in range(3):
                    weight[..., on] *= drive[..., k] if on >> k & 1 else 1 - drive[..., k]
            lab = colour.XYZ_to_Lab(weight @ corners, colour.XYZ_to_xy(WHITE))[..., [1, 2, 0]]
            points.append(lab.reshape(-1, 3))
            a, b, c, d = lab[:-1, :-1], lab[1:, :-1], lab[1:, 1:], lab[:-1, 1:]
            triple = lambda p, q, r: np.sum(p * np.cross(q, r))  # noqa: E731
            volume += (1 if side else -1) * (triple(a, b, c) + triple(a, c, d))
    return abs(volume) / 6, scipy.spatial.ConvexHull(np.vstack(points)).volume


def gamuts():
    yield ["display", *(f"{axis}{on}" for on in range(8) for axis in "XYZ"),
           *(f"{what}_{name}" for name in REFERENCES for what in ("area", "coverage")), "volume", "hull",
           *(f"{what}_{name}_xy" for name in REFERENCES for what in ("area", "coverage"))]
    to_uv = lambda xy: np.array([colour.xy_to_Luv_uv(one) for one in xy])  # noqa: E731
    area = lambda corners: scipy.spatial.ConvexHull(corners).volume  # noqa: E731
    for name, corners in displays():
        percent = {}
        for diagram, of_xy in (("uv", to_uv), ("xy", np.array)):
            primaries = of_xy(colour.XYZ_to_xy(corners[[1, 2, 4]]))
            percent[diagram] = []
            for reference in map(of_xy, REFERENCES.values()):
                common = common_area(primaries, reference)
                percent[diagram] += [100 * area(primaries) / area(reference), 100 * common / area(reference)]
        numbers = (*percent["uv"], *solid(corners), *percent["xy"])
        yield [name, *corners.ravel().tolist(), *(repr(float(v)) for v in numbers)]


def primaries():
    yield ["nm", "red", "green", "blue"]
    basis = colour.recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
    for nm, row in zip(basis.wavelengths, basis.values):
        yield [int(nm), *(repr(float(v)) for v in row)]


def tables():
    yield "surfaces.csv", list(surfaces()), 1e-9
    yield "differences.csv", list(differences()), 1e-9
    yield "appearance.csv", list(appearance()), 1e-9
    yield "adapted.csv", list(adapted()), 1e-9
    yield "gamuts.csv", list(gamuts()), 1e-8
    yield "primaries.csv", list(primaries()), 1e-9


if __name__ == "__main__":
    oracle.main(__doc__, HERE, tables(), least=1.0)
