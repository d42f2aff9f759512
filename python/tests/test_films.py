"""Films: closed forms, a program of others, and numpy's shapes."""

import numpy as np
import pytest

from papilio import ArgumentError, FileError, films

NM = np.arange(380, 781, 5)


def test_a_quarter_wave_leaves_nothing():
    n = np.sqrt(1.5)
    assert films.reflectance([(n, 550 / (4 * n))], 550.0, substrate=1.5) < 1e-30


def test_bare_glass_as_fresnel_has_it():
    theta = np.array([0.0, 30.0, 56.30993247402021, 80.0])
    inside = np.arcsin(np.sin(np.radians(theta)) / 1.5)
    c, t = np.cos(np.radians(theta)), np.cos(inside)
    s, p = ((c - 1.5 * t) / (c + 1.5 * t)) ** 2, ((1.5 * c - t) / (1.5 * c + t)) ** 2
    np.testing.assert_allclose(films.reflectance([], 550, theta, substrate=1.5, polarisation="s"), s, atol=1e-15)
    np.testing.assert_allclose(films.reflectance([], 550, theta, substrate=1.5, polarisation="p"), p, atol=1e-15)
    np.testing.assert_allclose(films.reflectance([], 550, theta, substrate=1.5), (s + p) / 2, atol=1e-15)


def test_arrays_broadcast_over_designs_wavelengths_and_angles():
    d, theta = np.linspace(0, 200, 7)[:, None, None], np.array([0.0, 20.0, 60.0])
    stack = [("Si3N4", 55.9), ("Cr:Johnson", 12.15), ("SiO2", d)]
    together = films.power(stack, NM[:, None], theta, incidence=1.5, substrate="Al")
    assert together.reflectance.shape == (7, 81, 3)
    for i, j, k in [(0, 0, 0), (3, 40, 2), (6, 80, 1)]:
        alone = films.power([*stack[:2], ("SiO2", d[i, 0, 0])], float(NM[j]), theta[k], incidence=1.5, substrate="Al")
        assert together.reflectance[i, j, k] == alone.reflectance
        assert together.transmittance[i, j, k] == alone.transmittance
    assert (together.absorptance > -1e-12).all()


def test_indices_as_arrays_and_materials_agree():
    silica = films.index("SiO2", NM)
    assert abs(films.index("SiO2", 587.5618).real - 1.458464) < 1e-6  # Malitson 1965
    by_name = films.reflectance([("SiO2", 100.0)], NM)
    assert (films.reflectance([(silica, 100.0)], NM) == by_name).all()


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        ({"layers": [("SiO2", -1.0)]}, r"layers\[0\] thickness"),
        ({"layers": [("SiO2", "10 nm")]}, r"layers\[0\] thickness"),
        ({"layers": [("SiO2", np.nan)]}, r"layers\[0\] thickness"),
        ({"layers": [("Si02", 1.0)]}, r"layers\[0\]"),
        ({"layers": [("SiO2",)]}, r"layers\[0\]"),
        ({"layers": "SiO2"}, "layers"),
        ({"layers": 3}, "layers"),
        ({"layers": [(1.5 - 0.1j, 1.0)]}, "-0.1"),
        ({"layers": [(np.nan, 1.0)]}, r"layers\[0\]"),
        ({"layers": [(None, 1.0)]}, r"layers\[0\]"),
        ({"wavelength_nm": 0.0}, "wavelength_nm"),
        ({"wavelength_nm": "550"}, "wavelength_nm"),
        ({"wavelength_nm": 100.0}, r"layers\[0\]"),
        ({"theta_deg": 90.0}, "theta_deg"),
        ({"theta_deg": -1.0}, "theta_deg"),
        ({"theta_deg": np.zeros(4)}, "shapes do not broadcast"),
        ({"incidence": 0.0}, "incidence"),
        ({"substrate": "Unobtainium"}, "substrate"),
        ({"polarisation": "x"}, "polarisation"),
    ],
)
def test_wrong_arguments_are_named(arguments, names):
    good = {"layers": [("SiO2", 100.0)], "wavelength_nm": NM}
    with pytest.raises(ArgumentError, match=names):
        films.power(**{**good, **arguments})


def test_a_file_of_n_and_k(tmp_path, scenarios):
    path = tmp_path / "glass.csv"
    path.write_text("wavelength_nm,n,k\n300,1.5,0\n900,1.6,0\n")
    np.testing.assert_allclose(films.index(path, 600.0), 1.55)
    path.write_text("wavelength_nm,n,k\n300,x,0\n")
    with pytest.raises(FileError) as error:
        films.index(path, 600.0)
    assert error.value.line == 2
    with pytest.raises(FileError):
        films.index(tmp_path / "absent.csv", 600.0)
