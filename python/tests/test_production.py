"""Tolerance analysis from Python: the same results as the program."""

import json
import subprocess

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, Scenario, ScenarioError, _papilio

FEW = {"tolerance.samples": 64, "tolerance.sensitivity_samples": 16, "spectrum.step_nm": 20}


@pytest.fixture(scope="module")
def path():
    from conftest import ROOT

    return ROOT / "scenarios" / "tolerance.toml"


@pytest.fixture(scope="module")
def found(path):
    return papilio.tolerance(path, set=FEW)


def test_yield_equals_program(path, found, program, tmp_path):
    few = [word for key, value in FEW.items() for word in ["--set", f"{key}={value}"]]
    done = subprocess.run([program, "tolerance", path, "--out", tmp_path, *few], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    # The files, including the journal, are identical.
    ours = papilio.tolerance(path, set=FEW, out=tmp_path / "ours")
    names = [file.name for file in ours.save(tmp_path / "ours")]
    assert names[:3] == ["tolerance.csv", "tolerance-metrics.csv", "tolerance.json"]
    assert [f"{name}.svg" for name in ours.figures()] == names[3:]
    for file in tmp_path.iterdir():
        if file.is_file():
            assert (tmp_path / "ours" / file.name).read_bytes() == file.read_bytes(), file.name
    assert found.report == json.loads((tmp_path / "tolerance.json").read_text())
    assert 0 <= found.share <= 1 and "%" in repr(found) and "<table>" in found._repr_html_()


def test_every_display_has_keys_and_metrics(found):
    pytest.importorskip("pandas")
    table = found.to_pandas()
    assert list(table.columns) == [*found.keys, *found.metrics] and len(table) == 64
    means = {one["name"]: one["spread"]["mean"]["value"] for one in found.report["metrics"]}
    for at, name in enumerate(found.metrics):
        np.testing.assert_allclose(np.nanmean(found.values[:, at]), means[name], rtol=1e-9)


def test_result_does_not_depend_on_threads(path, found):
    again = papilio.tolerance(path, set=FEW, threads=3)
    assert again.values.tobytes() == found.values.tobytes() and again.report == found.report


def test_errors_have_positions(path):
    with pytest.raises(ScenarioError) as error:
        papilio.tolerance(path, set={"tolerance.samples": 0})
    assert error.value.file == str(path) and error.value.line is not None
    with pytest.raises(ScenarioError):
        papilio.tolerance(Scenario.new("indoor"))
    for wrong in [{"threads": 0}, {"retries": 1.5}, {"out": "/dev/null/x"}, {"client": 3}, {"batch_seconds": 0}, {"progress": 3}]:
        with pytest.raises(ArgumentError, match=f"^{next(iter(wrong))}"):
            papilio.tolerance(path, **wrong)


def test_more_samples_resume_from_journal(path, found, tmp_path):
    """Samples in the journal are not computed again."""
    papilio.tolerance(path, set=FEW, out=tmp_path)
    larger = {**FEW, "tolerance.samples": 80}
    core = _papilio.Production(*Scenario.load(path).with_values(larger)._state())
    core.open(str(tmp_path))
    assert core.missing() == list(range(64, 80))
    core.close()
    more = papilio.tolerance(path, set=larger, out=tmp_path)
    assert more.values[:64].tobytes() == found.values.tobytes()
