"""Colours of arrays: published values and invalid arguments."""

import re

import numpy as np
import pytest

from papilio import ArgumentError, PapilioWarning, colour

NM = np.arange(380, 781, 5)


def test_perfect_white_in_d65_has_its_chromaticity():
    white = colour.xyz(np.ones((2, 3, 81)), NM)
    assert white.shape == (2, 3, 3)
    np.testing.assert_allclose(white[1, 2], [0.9504, 1.0, 1.0888], atol=1e-3)  # CIE 15:2018
    np.testing.assert_allclose(colour.uv_prime(white)[0, 0], [0.1978, 0.4683], atol=1e-4)
    np.testing.assert_allclose(colour.lab(white, white)[..., 0], 100.0)
    assert abs(colour.lab(0.1842 * white, white)[0, 0, 0] - 50) < 0.01


def test_perfect_white_has_lab_of_white():
    """L*, a*, b* are those of white to the last digit, because all functions use the same D65."""
    assert colour.lab(colour.xyz(np.ones(81), NM)).tolist() == [100.0, 0.0, 0.0]
    for step in (1, 2, 10):
        nm = np.arange(380, 781, step)
        np.testing.assert_allclose(colour.lab(colour.xyz(np.ones(nm.size), nm)), [100, 0, 0], atol=5e-5)
    nm = np.arange(400, 701, 10)
    with pytest.warns(PapilioWarning):
        white = colour.xyz(np.ones(nm.size), nm)
    assert colour.lab(white, white=white).tolist() == [100.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("first", "last", "light", "says"),
    [
        (500, 510, "D65", "500 to 510 nm omit .* of D65"),
        (400, 700, "D65", r"400 to 700 nm omit 0\.1\d % of X, 0\.0\d+ % of Y, 0\.\d+ % of Z"),
        (400, 700, None, "equal-energy"),
        (400, 700, [1.0] * 31, "equal-energy"),
        (380, 780, "D65", None),
        (360, 830, None, None),
        (380, 740, "D65", None),  # omits less than 0.1 % of X, Y and Z
    ],
)
def test_wavelengths_that_omit_light_cause_warning(first, last, light, says, recwarn):
    nm = np.arange(first, last + 1, 5 if last - first < 50 else 10)
    found = colour.xyz(np.ones(nm.size), nm, light)
    said = [str(one.message) for one in recwarn if one.category is PapilioWarning]
    if says is None:
        assert not said
    else:
        assert len(said) == 1 and re.search(says, said[0]) and recwarn[0].filename == __file__
    assert np.isfinite(found).all()


def test_xyz_interpolates_product_of_spectrum_and_light():
    """The product of spectrum and light at the specified wavelengths is interpolated linearly to 1 nm."""
    nm, fine = np.arange(380, 781, 10), np.arange(380, 781.0)
    spectrum = 0.5 + 0.4 * np.sin(nm / 15)
    product = np.interp(fine, nm, spectrum * colour.illuminant("LED-RGB1", nm))
    white = np.interp(fine, nm, colour.illuminant("LED-RGB1", nm))
    by_hand = colour.xyz(product, fine, None) / colour.xyz(white, fine, None)[1]
    np.testing.assert_allclose(colour.xyz(spectrum, nm, "LED-RGB1"), by_hand, rtol=1e-13)


def test_ciede2000_equals_published_pairs():
    """Sharma, Wu, Dalal 2005, table 1: pairs 1, 7, 13, 25."""
    one = [[50, 2.6772, -79.7751], [50, 0, 0], [50, -0.001, 2.49], [60.2574, -34.0099, 36.2677]]
    other = [[50, 0, -82.7485], [50, -1, 2], [50, 0.0009, -2.49], [60.4626, -34.1751, 39.4387]]
    np.testing.assert_allclose(colour.delta_e_2000(one, other), [2.0425, 2.3669, 4.8045, 1.2644], atol=1e-4)


def test_gamut_of_srgb_primaries_is_100_percent():
    xy = np.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])
    uv = np.stack([4 * xy[:, 0], 9 * xy[:, 1]], -1) / (-2 * xy[:, :1] + 12 * xy[:, 1:] + 3)
    np.testing.assert_allclose(colour.gamut_percent(uv), 100.0)
    np.testing.assert_allclose(colour.coverage_percent(np.stack([uv, uv])), [100.0, 100.0])
    assert colour.gamut_percent(uv, "ntsc") < 100


def test_chromaticity_of_black_is_nan():
    assert np.isnan(colour.uv_prime([0.0, 0.0, 0.0])).all()


@pytest.mark.parametrize(
    ("call", "names"),
    [
        (lambda: colour.xyz(np.ones(80), NM), "spectra"),
        (lambda: colour.xyz(["a"] * 81, NM), "spectra"),
        (lambda: colour.xyz(np.full(81, np.nan), NM), "spectra"),
        (lambda: colour.xyz(np.ones(3), [400, 500, 550]), "wavelength_nm"),
        (lambda: colour.xyz(np.ones(2), [500, 400]), "wavelength_nm"),
        (lambda: colour.xyz(np.ones(3), [1000, 1100, 1200], None), "wavelength_nm: .*380"),
        (lambda: colour.xyz(np.ones(3), [1000, 1100, 1200]), "wavelength_nm: .*380"),
        (lambda: colour.xyz(np.ones(81), NM, "D66"), "light: there is no illuminant"),
        (lambda: colour.illuminant("D66", NM), "name: there is no illuminant"),
        (lambda: colour.illuminant_info("D66"), "name: there is no illuminant"),
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
def test_invalid_arguments_are_named(call, names):
    with pytest.raises(ArgumentError, match=f"^.*{names}" if names == "shapes" else f"^{names}"):
        call()


def test_illuminant_is_described_under_any_usual_name():
    described = colour.illuminant_info("TL84")
    assert (described["name"], round(described["cct_K"]), round(described["Ra"])) == ("FL11", 4001, 83)
    np.testing.assert_array_equal(colour.illuminant("F11", np.arange(380.0, 781.0, 5.0)), described["relative_power"])
