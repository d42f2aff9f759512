"""Files of `papilio brdf --format rgl` in Mitsuba: radiances between their nodes, the density of the samples, the colours of a panel in a
uniform sky, and a map of light with a spectrum in each pixel.

The variant is `scalar_spectral`, which needs no other software; the chi-square test of Mitsuba's own package needs LLVM or a graphics
processor.
"""

import importlib.util
import json
import os
import subprocess
import sys
from array import array
from statistics import NormalDist

import numpy as np
import pytest
from conftest import ROOT

mi = pytest.importorskip("mitsuba")

#: They take half a minute: `cargo xtask full` and `cargo xtask python` run them.
pytestmark = pytest.mark.skipif(os.environ.get("PAPILIO_NOTEBOOKS") != "all", reason="cargo xtask full runs it")

INCLINATIONS_DEG = [0.0, 30.0, 62.0]
#: Cells of the hemisphere, equal in projected solid angle: rings, and cells of each ring.
RINGS, CELLS = 12, 24
SAMPLES = 100_000
#: Chance of a false alarm in any of the tests.
SIGNIFICANCE = 0.01


def export(folder, *options):
    """Runs `papilio brdf` of the indoor panel; returns its messages."""
    command = [os.environ["PAPILIO"], "brdf", ROOT / "scenarios" / "indoor.toml", "--out", folder, *options]
    return subprocess.run(command, check=True, capture_output=True, text=True).stderr


@pytest.fixture(scope="module")
def indoor(tmp_path_factory):
    """The scene script of an exported display, and its materials."""
    mi.set_variant("scalar_spectral")
    folder = tmp_path_factory.mktemp("export")
    export(folder, "--format", "rgl", "--states", "white,red", "--set", "spectrum.step_nm=10")
    place = importlib.util.spec_from_file_location("scene", folder / "scene.py")
    script = importlib.util.module_from_spec(place)
    place.loader.exec_module(script)
    mirror = json.loads((folder / script.MIRROR).read_text())
    return script, script.Display(mirror, tmp_path_factory.mktemp("scaled"))


def lit(theta_deg):
    """A point of the surface, seen from this inclination."""
    point = mi.SurfaceInteraction3f()
    theta = np.radians(theta_deg)
    point.wi = [np.sin(theta), 0.0, np.cos(theta)]
    point.wavelengths = [450.0, 500.0, 550.0, 600.0]
    return point


def scattering(display_of):
    """The scattered light of white."""
    script, display = display_of
    return mi.load_dict({"type": "measured", "filename": str(script.HERE / display.mirror["states"]["white"]["file"])})


@pytest.mark.parametrize(("haze", "grid", "most"), [(0.78, 64, 0.025), (0.2, 64, 0.04), (0.05, 128, 0.03)])
def test_radiances_between_nodes_are_those_of_the_display(tmp_path, haze, grid, most):
    """The solver's own values at directions that are no nodes of the file: a table in steps of 4.5 deg; and the light
    that leaves in all directions. The largest error is stated by a warning if it is above 2 %."""
    mi.set_variant("scalar_spectral")
    few = ["--states", "white", "--set", "spectrum.step_nm=50", "--set", f"display.diffuser.haze={haze}"]
    message = export(tmp_path, "--format", "rgl", "--grid", str(grid), *few)
    export(tmp_path, "--step", "4.5", *few)
    exact = np.load(tmp_path / "display-bsdf.npz")
    bsdf = mi.load_dict({"type": "measured", "filename": str(tmp_path / "display-white.bsdf")})
    bins = [list(exact["wavelength_nm"]).index(nm) for nm in (430.0, 480.0, 530.0, 630.0)]
    context, largest = mi.BSDFContext(), 0.0
    for i, theta_i in enumerate(exact["theta_i_deg"]):
        if theta_i not in (4.5, 13.5, 36.0, 49.5, 58.5):
            continue
        point = lit(theta_i)
        point.wavelengths = [float(exact["wavelength_nm"][bin]) for bin in bins]
        # At single wavelengths, where a film hardly reflects, relative errors between directions of the light are larger.
        values = exact["brdf"][0, i][..., bins].mean(axis=-1)
        for o, theta_o in enumerate(np.radians(exact["theta_o_deg"])):
            for p, dphi in enumerate(np.radians(exact["dphi_deg"])):
                to = [np.sin(theta_o) * np.cos(dphi), np.sin(theta_o) * np.sin(dphi), np.cos(theta_o)]
                found = np.mean(list(bsdf.eval(context, point, to))) / np.cos(theta_o)
                if theta_o < np.radians(80.0):
                    largest = max(largest, abs(found - values[o, p]) / max(values[o, p], 0.01 * values.max()))
        # The mean of f cos over the density with which Mitsuba samples is the albedo.
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(3)
        weights = [bsdf.sample(context, point, sampler.next_1d(), sampler.next_2d())[1] for _ in range(SAMPLES // 5)]
        albedo = np.mean([list(weight) for weight in weights], axis=0)
        scattered = (exact["directional_hemispherical"] - exact["specular"])[0, i, bins]
        np.testing.assert_allclose(albedo, scattered, rtol=most)
    assert largest < most
    assert largest < 0.025 or "between the directions of the file" in message


def test_map_with_a_spectrum_in_each_pixel_becomes_one_of_colours(indoor, tmp_path):
    """A pixel of constant radiance 1 per nm is white of luminance 1; one of a line is of its X, Y and Z."""
    mi.set_variant("scalar_spectral")
    script, _ = indoor
    names = [f"S0.{nm},000000nm" for nm in range(380, 781, 40)]
    pixels = np.zeros((2, 4, len(names)), np.float16)
    pixels[0] = 1.0
    pixels[1, 2, names.index("S0.540,000000nm")] = 1.0
    path = tmp_path / "spectra.exr"
    mi.Bitmap(pixels, mi.Bitmap.PixelFormat.MultiChannel, channel_names=names).write(str(path))
    found = np.array(script.light_map(mi, path))
    assert found.shape == (2, 4, 3)
    # Equal energy has x = y = 1/3.
    np.testing.assert_allclose(found[0, 0], [1.2048, 0.9484, 0.9087], atol=0.01)
    assert found[1, 2, 1] > 5.0 * found[1, 2, 0] and found[1, 0].max() == 0.0
    command = [sys.executable, script.HERE / "scene.py", "--light", path, "--width", "24", "--samples", "4", "--out"]
    subprocess.run([*command, tmp_path / "lit.png"], check=True, capture_output=True)
    assert (tmp_path / "lit.png").exists()
    mi.Bitmap(np.ones((2, 4, 5), np.float32), mi.Bitmap.PixelFormat.MultiChannel, channel_names=list("abcde")).write(str(path))
    told = subprocess.run([*command, tmp_path / "none.png"], capture_output=True, text=True)
    assert told.returncode != 0 and "expected channels R, G and B" in told.stderr and "Traceback" not in told.stderr


def fractions_of(bsdf, point, count):
    """Integrals of the density over the cells, by the midpoint rule with count x count points in each."""
    context = mi.BSDFContext()
    cells = np.zeros(RINGS * CELLS)
    for ring in range(RINGS * count):
        across = (ring + 0.5) / (RINGS * count)
        sin, cos = np.sqrt(across), np.sqrt(1.0 - across)
        for cell in range(CELLS * count):
            around = 2 * np.pi * (cell + 0.5) / (CELLS * count)
            density = bsdf.pdf(context, point, [sin * np.cos(around), sin * np.sin(around), cos])
            # The projected solid angle of the hemisphere is pi.
            cells[ring // count * CELLS + cell // count] += density / cos
    return cells * np.pi / (RINGS * CELLS * count**2)


def expected_fractions(bsdf, point):
    """The error of the midpoint rule is of second order."""
    coarser, finer = (fractions_of(bsdf, point, count) for count in (12, 24))
    return np.maximum((4.0 * finer - coarser) / 3.0, 0.0)


def counted(bsdf, point):
    """Numbers of samples in the cells."""
    context = mi.BSDFContext()
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(1)
    counts = np.zeros(RINGS * CELLS)
    for _ in range(SAMPLES):
        sample, _ = bsdf.sample(context, point, sampler.next_1d(), sampler.next_2d())
        x, y, z = sample.wo
        # A half vector may lead below the horizon: then there is no sample.
        if sample.pdf > 0.0 and z > 0.0:
            ring = min(int(RINGS * (x * x + y * y)), RINGS - 1)
            counts[ring * CELLS + int(CELLS * (np.arctan2(y, x) / (2 * np.pi) % 1.0)) % CELLS] += 1
    return counts


def probability(counts, expected, least=5.0):
    """Probability of a larger statistic of the chi-square test; cells with few samples are pooled."""
    many = expected >= least
    pooled = [np.append(values[many], values[~many].sum()) for values in (counts, expected)]
    counts, expected = (values if pooled[1][-1] >= least else values[:-1] for values in pooled)
    statistic, degrees = np.sum((counts - expected) ** 2 / expected), len(expected) - 1
    # The cube root of chi-square is nearly normal (Wilson & Hilferty 1931).
    scale = 2.0 / (9.0 * degrees)
    return 1.0 - NormalDist().cdf(((statistic / degrees) ** (1 / 3) - (1.0 - scale)) / scale**0.5)


@pytest.mark.parametrize("theta_deg", INCLINATIONS_DEG)
def test_samples_have_the_density_of_their_pdf(indoor, theta_deg):
    bsdf, point = scattering(indoor), lit(theta_deg)
    expected = expected_fractions(bsdf, point)
    # Samples below the horizon are missing, and their density is not tested.
    assert 0.995 < expected.sum() < 1.003
    # Sidak's correction for the number of tests.
    assert probability(counted(bsdf, point), SAMPLES * expected) > 1.0 - (1.0 - SIGNIFICANCE) ** (1 / len(INCLINATIONS_DEG))


def test_samples_of_another_density_are_found(indoor):
    bsdf = scattering(indoor)
    expected = expected_fractions(bsdf, lit(30.5))
    assert probability(counted(bsdf, lit(30.0)), SAMPLES * expected) < 1e-6


def rendered(bsdf, theta_deg):
    """X, Y, Z of a surface in a uniform sky of D65, seen from this inclination; relative to Y of the sky."""
    theta = np.radians(theta_deg)
    eye = mi.ScalarTransform4f().look_at(
        origin=[50 * np.sin(theta), 0.0, 50 * np.cos(theta)], target=[0, 0, 0], up=[0, 1, 0]
    )
    film = {"type": "hdrfilm", "width": 1, "height": 1, "pixel_format": "xyz", "rfilter": {"type": "box"}}
    sensor = {"type": "radiancemeter", "to_world": eye, "film": film, "sampler": {"type": "independent"}}
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 3},
        "sensor": sensor,
        "sky": {"type": "constant", "radiance": {"type": "d65"}},
        "panel": {"type": "rectangle", "bsdf": bsdf},
    }
    return np.array(mi.render(mi.load_dict(scene), spp=4 * SAMPLES, seed=2)).ravel()[:3].astype(float)


@pytest.mark.parametrize("state", ["white", "red"])
@pytest.mark.parametrize("theta_deg", [0.0, 40.0])
def test_panel_in_uniform_sky_has_the_colours_of_a_run(indoor, scenarios, program, state, theta_deg):
    _, display = indoor
    white = rendered({"type": "diffuse", "reflectance": {"type": "uniform", "value": 1.0}}, 0.0)
    found = rendered(display.material(state), theta_deg) / white
    sky = ["lighting.diffuse=1", "lighting.directed=[]", f"viewer.theta_deg={theta_deg}", "spectrum.step_nm=10"]
    options = [word for key in sky for word in ("--set", key)]
    told = subprocess.run([program, "run", scenarios / "indoor.toml", "--json", *options], check=True, capture_output=True)
    seen = json.loads(told.stdout)["views"][0]["states"][state]
    expected = np.array([seen[name] for name in "XYZ"]) / [0.95047, 1.0, 1.08883]
    np.testing.assert_allclose(found, expected, rtol=0.01)


def test_mixture_of_states_has_the_mean_of_their_colours(indoor):
    script, display = indoor
    of_states = [rendered(display.material(state), 20.0) for state in ("white", "red")]
    coverages = {"white": array("f", [0.25]), "red": array("f", [0.75])}
    found = rendered(script.mixture(display, coverages, 1), 20.0)
    np.testing.assert_allclose(found, 0.25 * of_states[0] + 0.75 * of_states[1], rtol=0.005)
