"""Files of measured scattering: the same results as the program."""

import json
import pickle
import subprocess
import warnings

import numpy as np
import pytest
from conftest import ROOT

import papilio
from papilio import ArgumentError, FileError
from papilio.diffuser import Diffuser, lobe_names


@pytest.fixture(scope="module")
def h78():
    """One measurement for all tests: its audit takes a second."""
    return Diffuser(ROOT / "scenarios" / "data" / "H78.bsdf")


def printed(program, *arguments):
    return subprocess.run([program, "diffuser", *arguments], capture_output=True, check=True, text=True).stdout


def test_audit_equals_program(h78, program, scenarios):
    path = scenarios / "data" / "H78.bsdf"
    assert h78.audit() == json.loads(printed(program, "inspect", path, "--json"))
    assert str(h78) == printed(program, "inspect", path)
    assert "<svg" in h78._repr_html_() and len(h78.figures()) == len(h78.parts)


def test_fit_equals_program(h78, program, scenarios):
    fits = h78.fit("k-correlation (s = 3)")
    assert fits == json.loads(printed(program, "fit", scenarios / "data" / "H78.bsdf", "--json", "--model", "k-correlation-3"))


def test_converted_file_can_be_read(h78, tmp_path):
    out = tmp_path / "h78.npz"
    assert h78.convert(out) == []
    assert Diffuser(out).parts == h78.parts
    assert pickle.loads(pickle.dumps(Diffuser(out))).parts == h78.parts


def test_invalid_arguments_and_files_are_named(h78, tmp_path, scenarios):
    with pytest.raises(FileError):
        Diffuser(tmp_path / "absent.bsdf")
    with pytest.raises(FileError):
        Diffuser(tmp_path)
    wrong = tmp_path / "wrong.bsdf"
    wrong.write_bytes(bytes(range(256)))
    with pytest.raises(FileError):
        Diffuser(wrong)
    for path in [5, None, "a\0b"]:
        with pytest.raises(ArgumentError, match="^path:"):
            Diffuser(path)
    with pytest.raises(ArgumentError, match="^model:"):
        h78.fit("Phong")
    with pytest.raises(ArgumentError, match="^part:"):
        h78.fit(part="side")
    with pytest.raises(ArgumentError, match="^format:"):
        h78.convert(tmp_path / "a.docx")
    with pytest.raises(ArgumentError, match="^output:"):
        h78.convert(scenarios / "data" / "H78.bsdf")
    with pytest.raises(FileError):
        h78.convert(tmp_path / "no" / "folder.npz")
    assert "GGX" in lobe_names()


def test_measurement_as_arrays(h78, tmp_path):
    pytest.importorskip("xarray")
    foil = h78
    arrays = foil.to_xarray().front_transmission
    assert arrays.attrs["units"] == "1/sr" and arrays.incidence_deg.attrs["units"] == "degree"
    np.testing.assert_array_equal(arrays.values, foil["front transmission"])
    # Interpolation at a cell of the grid gives its value: light along the normal, viewer 10 deg from it.
    cell = arrays.isel(rotation_deg=0).sel(incidence_deg=0, azimuth_deg=0, radial_deg=10, channel="Y")
    assert foil.evaluate(0, 180, 10, 180) == pytest.approx(float(cell), rel=1e-12)
    foil.convert(tmp_path / "a.npz")
    assert foil.to_bytes() == (tmp_path / "a.npz").read_bytes()
    copy = pickle.loads(pickle.dumps(foil))
    assert copy.to_bytes() == foil.to_bytes() and copy.audit() == foil.audit()


def test_arrays_make_the_same_measurement(h78, scenarios):
    """A file's own arrays give a measurement with the same audit, and the same display."""
    pytest.importorskip("xarray")
    foil = h78
    arrays = foil.to_xarray().front_transmission
    axes = {name: arrays[name].values for name in ("rotation_deg", "incidence_deg", "azimuth_deg", "radial_deg")}
    made = Diffuser.from_arrays(arrays.values, axes, channels=list(arrays.channel.values))
    np.testing.assert_array_equal(made["front transmission"], foil["front transmission"])
    assert made.audit()["parts"] == foil.audit()["parts"] or made.parts == foil.parts
    measured = papilio.Scenario.load(scenarios / "measured-diffused.toml")
    kind = {"spectrum.step_nm": 50, "display.diffuser.normalise": "none"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        files = [papilio.run(measured, set={**kind, "display.diffuser.file": one})["Y"] for one in (made, foil)]
    assert np.array_equal(*files)


def test_lobe_from_arrays_is_fitted():
    """A Gaussian about the straight direction, on a grid of light and viewer, keeps its level and its width."""
    theta = np.arange(0.0, 81.0, 4.0)
    phi = np.arange(0.0, 181.0, 10.0)
    i, o, p = np.radians(theta)[:, None, None], np.radians(theta)[None, :, None], np.radians(phi)[None, None, :]
    squared = np.sin(i) ** 2 + np.sin(o) ** 2 - 2 * np.sin(i) * np.sin(o) * np.cos(np.pi - p)
    foil = Diffuser.from_arrays(np.exp(-squared / 0.08), {"theta_i_deg": theta, "theta_o_deg": theta, "phi_o_deg": phi}, sample="lobe")
    assert foil["front transmission"].shape == (1, 21, 1, 21, 19)
    assert foil.evaluate(0, 0, 0, 0) == pytest.approx(1.0) and np.isnan(foil.evaluate(0, 0, 85, 0))
    np.testing.assert_allclose(foil.evaluate(20, 0, theta, 180), np.exp(-((np.sin(np.radians(20)) - np.sin(np.radians(theta))) ** 2) / 0.08), rtol=1e-12)


@pytest.mark.parametrize(
    ("axes", "shape", "says"),
    [
        ({"theta_i_deg": [0.0]}, (1,), "axes: theta_o_deg is missing"),
        ({"theta": [0.0]}, (1,), "axes: there is no axis 'theta'"),
        ({"theta_i_deg": [0, 5], "theta_o_deg": [5, 0], "phi_o_deg": [0]}, (2, 2, 1), r"axes\['theta_o_deg'\]: expected ascending"),
        ({"theta_i_deg": [0, 5], "theta_o_deg": [0, 5], "phi_o_deg": [0, 180]}, (2, 2, 3), r"values: expected shape \(2, 2, 2\)"),
    ],
)
def test_wrong_arrays_are_named(axes, shape, says):
    with pytest.raises(papilio.ArgumentError, match=f"^{says}"):
        Diffuser.from_arrays(np.ones(shape), axes)
