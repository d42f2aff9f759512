"""Searches from Python: the same results as the program."""

import pickle
import re
import subprocess

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, FileError, Scenario, ScenarioError, _papilio

SEARCH = """
[optimize]
starts = 2
evaluations = 60

[[optimize.variables]]
key = "display.pixel.film.2.thickness_nm"
bounds = [20, 60]
[[optimize.variables]]
key = "display.pixel.film.3.thickness_nm"
bounds = [5, 20]

[[optimize.objectives]]
metric = "gamut_percent_srgb"
aim = "maximise"

[[optimize.constraints]]
metric = "white.Y"
at_least = 0.55
"""


@pytest.fixture(scope="module")
def scenario():
    from conftest import ROOT

    text = (ROOT / "scenarios" / "indoor.toml").read_text() + SEARCH
    return Scenario(text, name="search.toml", folder=ROOT / "scenarios")


@pytest.fixture(scope="module")
def found(scenario):
    return papilio.optimize(scenario)


def test_best_design_improves_objective_and_meets_limit(scenario, found):
    best = found.best
    assert best.meets_limits and best.metrics["white.Y"] >= 0.55 - 1e-6
    assert best.metrics["gamut_percent_srgb"] > found.own.metrics["gamut_percent_srgb"]
    assert list(best.values) == ["display.pixel.film.2.thickness_nm", "display.pixel.film.3.thickness_nm"]
    result = papilio.run(found.scenario())
    assert result["gamut_percent_srgb"][0] == best.metrics["gamut_percent_srgb"]
    assert found.front().shape == (1, 2)
    assert "<table>" in found._repr_html_()


def test_optimum_equals_program(scenario, found, program, tmp_path):
    path = tmp_path / "search.toml"
    path.write_text(scenario.to_toml())
    done = subprocess.run([program, "optimize", path, "--out", tmp_path / "out", "--no-check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    best = papilio.Scenario.load(tmp_path / "out" / "best.toml")
    for key, value in found.best.values.items():
        assert best[key] == value
    # The files are identical.
    again = papilio.optimize(papilio.Scenario.load(path), out=tmp_path / "ours")
    names = [file.name for file in again.save(tmp_path / "ours")]
    assert names == ["optimize.csv", "best.toml", "trace.svg"] and list(again.figures()) == ["trace"]
    for file in (tmp_path / "out").iterdir():
        assert (tmp_path / "ours" / file.name).read_bytes() == file.read_bytes(), file.name


def test_infeasible_design_is_saved_as_closest(scenario, tmp_path):
    (tmp_path / "best.toml").write_text("of an earlier search")
    with pytest.warns(papilio.PapilioWarning, match="no feasible design was found"):
        missed = papilio.optimize(scenario, set={"optimize.constraints.0.at_least": 1000})
    assert not missed.best.meets_limits
    assert [file.name for file in missed.save(tmp_path)] == ["optimize.csv", "closest.toml", "trace.svg"]
    assert not (tmp_path / "best.toml").exists()


def test_tables_and_pickles_equal_original(found):
    assert pickle.loads(pickle.dumps(found)).designs == found.designs
    pytest.importorskip("pandas")
    table = found.to_pandas()
    assert list(table.index) == ["scenario", "0"]
    assert list(table.columns) == [*found.best.values, "gamut_percent_srgb", "white.Y", "meets_limits"]
    assert table.loc["0", "white.Y"] == found.best.metrics["white.Y"]


def test_result_does_not_depend_on_threads(scenario, found):
    again = papilio.optimize(scenario, threads=3)
    assert again.best == found.best and np.array_equal(again.front(), found.front())


def test_errors_have_positions(scenario, found):
    with pytest.raises(ScenarioError) as error:
        papilio.optimize(scenario, set={"optimize.variables.0.bounds": [60, 20]})
    assert error.value.file == "search.toml" and error.value.line is not None
    with pytest.raises(ScenarioError):
        papilio.optimize(Scenario.new("indoor"))
    with pytest.raises(ArgumentError, match="^design:"):
        found.scenario(1)
    for wrong in [{"threads": 0}, {"retries": -1}, {"out": "/dev/null/x"}, {"client": 3}, {"progress": 3}]:
        with pytest.raises(ArgumentError, match=f"^{next(iter(wrong))}"):
            papilio.optimize(scenario, **wrong)


def test_second_writer_of_journal_is_refused(scenario, found, tmp_path, capfd):
    other = _papilio.Search(*scenario._state())
    other.begin(str(tmp_path), 1)
    with pytest.raises(FileError, match="another program is writing this journal"):
        papilio.optimize(scenario, out=tmp_path)
    other.close()
    assert papilio.optimize(scenario, out=tmp_path, progress=True).designs == found.designs
    assert re.search(r"\d of 2 searches +\n$", capfd.readouterr().err)
