"""Scenarios as objects: values, edits, and errors with their positions."""

import copy
import pickle
import subprocess

import pytest

import papilio
from papilio import Scenario, ScenarioError

GAPS = "display.pixel.gap_nm"


@pytest.fixture
def indoor(scenarios):
    return Scenario.load(scenarios / "indoor.toml")


def test_values_include_defaults(indoor):
    assert indoor["display.pixel.film.0.thickness_nm"] == 55.9
    assert indoor["solver.seed"] == 0
    assert indoor["lighting.directed.0.theta_deg"] == -20


def test_name_with_points_is_one_key_in_quotes(indoor):
    key = 'display.pixel.states."a.b".blue.gap_nm'
    indoor[key] = 150
    assert indoor[key] == indoor["display.pixel.states. 'a.b' .blue.gap_nm"] == 150
    assert indoor.to_dict()["display"]["pixel"]["states"]["a.b"]["blue"] == {"gap_nm": 150}
    moved = papilio.Prepared(indoor).evaluate({key: [150, 160]}, ["a.b.Y"])[:, 0]
    assert moved[1] == pytest.approx(papilio.run(indoor.with_values({key: 160}))["a.b.Y"].item(), rel=1e-6)
    assert abs(moved[1] - moved[0]) > 1e-3
    del indoor['display.pixel.states."a.b"']
    with pytest.raises(KeyError, match="states has"):
        indoor["display.pixel.states.a.b.blue.gap_nm"]


@pytest.mark.parametrize("path", ["display.pixels", "display.pixel.film.9", "display.pixel.film.x", "display.pixel.film.-1", "title.x", "", "..", "a" * 10000])
def test_unknown_path_raises_key_error_with_path(indoor, path):
    with pytest.raises(KeyError) as error:
        indoor[path]
    assert path in str(error.value)


def test_path_instead_of_text_is_refused(scenarios):
    for path in (scenarios / "indoor.toml", str(scenarios / "indoor.toml")):
        with pytest.raises(papilio.errors.ArgumentError, match="Scenario.load"):
            Scenario(path)


def test_edit_preserves_rest_of_text(indoor):
    before = indoor.to_toml().splitlines()
    indoor["display.pixel.film.0.thickness_nm"] = 50.25
    after = indoor.to_toml().splitlines()
    changed = [(old, new) for old, new in zip(before, after, strict=True) if old != new]
    assert len(changed) == 1 and "50.25" in changed[0][1]
    assert indoor["display.pixel.film.0.thickness_nm"] == 50.25


def test_invalid_edit_is_refused_with_position(indoor):
    before = indoor.to_toml()
    with pytest.raises(ScenarioError) as error:
        indoor["display.pixel.film.0.thickness_nm"] = -5
    assert indoor.to_toml() == before
    assert error.value.path == "display.pixel.film.0.thickness_nm"
    assert error.value.file == indoor.name and error.value.line > 1 and error.value.column >= 1
    assert isinstance(error.value, ValueError) and isinstance(error.value, papilio.PapilioError)


def test_invalid_file_has_message_of_program(tmp_path, program):
    wrong = tmp_path / "wrong.toml"
    wrong.write_text('[display.pixel]\nmodel = "uniform"\nkind = "lambertian"\nreflectence = { white = 0.5 }\n')
    said = subprocess.run([program, "run", wrong], capture_output=True, text=True)
    assert said.returncode == 2
    with pytest.raises(ScenarioError) as error:
        papilio.run(wrong)
    assert str(error.value) == said.stderr.rstrip("\n")
    assert (str(wrong), 4, 1) in [(one.file, one.line, one.column) for one in error.value.mistakes]
    assert pickle.loads(pickle.dumps(error.value)).mistakes == error.value.mistakes


def test_scenario_from_tables_equals_text():
    tables = {
        "title": 'Paper, "white"',
        "display": {"pixel": {"model": "uniform", "kind": "lambertian", "reflectance": {"white": 0.45, "black": 0.03}}},
        "lighting": {"preset": "indoor"},
    }
    paper = Scenario.from_dict(tables)
    assert paper["title"] == tables["title"]
    assert paper["display.pixel.reflectance"] == {"white": 0.45, "black": 0.03}
    assert Scenario(paper.to_toml()).to_dict() == paper.to_dict()


def test_scenarios_survive_conversion_to_tables(scenarios):
    """Reading with defaults, writing as TOML and reading again is the identity."""
    for path in sorted(scenarios.glob("*.toml")):
        scenario = Scenario.load(path)
        again = Scenario.from_dict(without_null(scenario.to_dict()), folder=scenarios)
        assert again.to_dict() == scenario.to_dict(), path


def without_null(value):
    if isinstance(value, dict):
        return {key: without_null(one) for key, one in value.items() if one is not None}
    return [without_null(one) for one in value] if isinstance(value, list) else value


def test_files_in_memory_replace_files_on_disk():
    text = '[display.pixel]\nmodel = "uniform"\nkind = "lambertian"\nreflectance = { white = "w.csv", black = 0.1 }\n'
    text += '[lighting]\npreset = "indoor"\n'
    good = Scenario(text, files={"w.csv": b"380,0.5\n780,0.5\n"})
    assert good.check() == []
    assert Scenario(text, files={"w.csv": b"380,0.4\n780,0.5\n"}).hash != good.hash
    with pytest.raises(ScenarioError, match="w.csv"):
        Scenario(text, files={}).check()


def test_copies_and_pickles_are_independent(indoor):
    for other in [indoor.copy(), copy.copy(indoor), copy.deepcopy(indoor), pickle.loads(pickle.dumps(indoor))]:
        assert other == indoor and other.hash == indoor.hash
        other["solver.seed"] = 7
        assert other != indoor and indoor["solver.seed"] == 0


def test_old_names_are_accepted_and_migrated():
    old = papilio.Scenario(
        '[solver]\nmethod = "walk"  # the reference\npaths = 64\n[display.pixel]\nmodel = "uniform"\nkind = "mirror"\n'
        "reflectance = { white = 0.5, black = 0.1 }\n"
    )
    assert old["solver.method"] == "monte-carlo"
    assert old["solver.every_bin"] == old["solver.per_wavelength"] == False  # noqa: E712
    new = old.copy()
    assert new.migrate() == [(2, '"walk"', '"monte-carlo"')]
    assert new.to_toml().startswith('format = 2\n\n[solver]\nmethod = "monte-carlo"  # the reference\n')
    assert new.hash == old.hash
    assert new.migrate() == []
    new["solver.every_bin"] = True
    assert "per_wavelength = true" in new.to_toml()
