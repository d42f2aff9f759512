"""Colours of arrays: published values, and arguments that are wrong."""

import numpy as np
import pytest

from papilio import ArgumentError, colour

NM = np.arange(380, 781, 5)


def test_a_perfect_white_in_d65_lies_at_its_chromaticity():
    white = colour.xyz(np.ones((2, 3, 81)), NM)
    assert white.shape == (2, 3, 3)
    np.testing.assert_allclose(white[1, 2], [0.9504, 1.0, 1.0888], atol=1e-3)  # CIE 15:2018
    np.testing.assert_allclose(colour.uv_prime(white)[0, 0], [0.1978, 0.4683], atol=1e-4)
    np.testing.assert_allclose(colour.lab(white, white)[..., 0], 100.0)
    assert abs(colour.lab(0.1842 * white, white)[0, 0, 0] - 50) < 0.01


def test_ciede2000_of_the_papers_pairs():
    """Sharma, Wu, Dalal 2005, table 1: pairs 1, 7, 13, 25."""
    one = [[50, 2.6772, -79.7751], [50, 0, 0], [50, -0.001, 2.49], [60.2574, -34.0099, 36.2677]]
    other = [[50, 0, -82.7485], [50, -1, 2], [50, 0.0009, -2.49], [60.4626, -34.1751, 39.4387]]
    np.testing.assert_allclose(colour.delta_e_2000(one, other), [2.0425, 2.3669, 4.8045, 1.2644], atol=1e-4)


def test_srgbs_own_primaries_are_its_gamut():
    xy = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])
    uv = np.stack([4 * xy[:, 0], 9 * xy[:, 1]], -1) / (-2 * xy[:, :1] + 12 * xy[:, 1:] + 3)
    np.testing.assert_allclose(colour.gamut_percent(uv), 100.0)
    np.testing.assert_allclose(colour.coverage_percent(np.stack([uv, uv])), [100.0, 100.0])
    assert colour.gamut_percent(uv, "ntsc") < 100


def test_no_light_has_no_chromaticity():
    assert np.isnan(colour.uv_prime([0.0, 0.0, 0.0])).all()


@pytest.mark.parametrize(
    ("call", "names"),
    [
        (lambda: colour.xyz(np.ones(80), NM), "spectra"),
        (lambda: colour.xyz(["a"] * 81, NM), "spectra"),
        (lambda: colour.xyz(np.full(81, np.nan), NM), "spectra"),
        (lambda: colour.xyz(np.ones(3), [400, 500, 550]), "wavelength_nm"),
        (lambda: colour.xyz(np.ones(2), [500, 400]), "wavelength_nm"),
        (lambda: colour.xyz(np.ones(3), [1000, 1100, 1200], None), "wavelength|observer|grid|380"),
        (lambda: colour.xyz(np.ones(81), NM, "D66"), "illuminant"),
        (lambda: colour.xyz(np.ones(81), NM, np.zeros(81)), "light"),
        (lambda: colour.xyz(np.ones(81), NM, np.ones(5)), "light"),
        (lambda: colour.xyz(np.ones(81), NM, observer="1950"), "observer"),
        (lambda: colour.lab([1.0, 2.0]), "colours"),
        (lambda: colour.lab(1.0), "colours"),
        (lambda: colour.lab(np.ones((2, 3)), np.ones((3, 3))), "shapes"),
        (lambda: colour.gamut_percent(np.ones((3, 3))), "primaries"),
        (lambda: colour.gamut_percent(np.ones((3, 2)), "adobe"), "reference"),
        (lambda: colour.delta_e_2000([1, 2, 3], "abc"), "other"),
        (lambda: colour.illuminant(65, NM), "name"),
    ],
)
def test_wrong_arguments_are_named(call, names):
    with pytest.raises(ArgumentError, match=names):
        call()
