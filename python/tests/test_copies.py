"""Results in other processes: pickles, copies, mappings."""

import copy
import multiprocessing
import pickle

import numpy as np
import pytest

import papilio
from papilio import Scenario

SMALL = {"spectrum.step_nm": 50}


@pytest.fixture(scope="module")
def results():
    from conftest import ROOT

    indoor = ROOT / "scenarios" / "indoor.toml"
    production = papilio.tolerance(ROOT / "scenarios" / "tolerance.toml", set={"tolerance.samples": 64, "tolerance.sensitivity_samples": 0})
    cone = papilio.cone(indoor, theta_deg=[0.0, 20.0, 40.0], phi_deg=[0.0, 90.0, 180.0], set=SMALL)
    return {"result": papilio.run(indoor, set=SMALL), "cone": cone, "yield": production}


def everything(found):
    """All contents of a result, as bytes."""
    said = [repr(found), found._repr_html_(), found.title, *map(str, [found.warnings, found.notes])]
    if isinstance(found, papilio.Yield):
        return [*said, found.values.tobytes(), str(found.report), *(figure.svg for figure in found.figures().values()), *written(found)]
    said += [name + str(found[name].tobytes()) for name in found]
    if isinstance(found, papilio.Cone):
        return [*said, found.figure().svg, str(found.states)]
    return [*said, found.to_json(), str(found.views), found.to_pandas().to_csv() if pandas() else "", *written(found)]


def pandas():
    try:
        import pandas
    except ImportError:
        return None
    return pandas


def written(found):
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder:
        return [str((path.name, path.read_bytes())) for path in sorted(map(Path, found.save(folder)))]


@pytest.mark.parametrize("kind", ["result", "cone", "yield"])
def test_pickles_and_copies_equal_original(kind, results):
    found = results[kind]
    before = everything(found)
    once = pickle.loads(pickle.dumps(found))
    for other in [once, pickle.loads(pickle.dumps(once)), copy.copy(found), copy.deepcopy(found), copy.deepcopy([once])[0]]:
        assert everything(other) == before


def test_pickle_does_not_need_files(tmp_path, scenarios):
    text = '[display.pixel]\nmodel = "uniform"\nkind = "lambertian"\nreflectance = { white = "w.csv", black = 0.1 }\n'
    (tmp_path / "w.csv").write_text("380,0.5\n780,0.5\n")
    result = papilio.run(Scenario(text + '[lighting]\npreset = "indoor"\n', folder=tmp_path))
    content = pickle.dumps(result)
    (tmp_path / "w.csv").unlink()
    assert pickle.loads(content).to_json() == result.to_json()


def test_processes_return_results(scenarios, results):
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        (there,) = pool.map(run_small, [scenarios / "indoor.toml"])
    assert there.to_json() == results["result"].to_json()


def run_small(path):
    return papilio.run(path, set=SMALL)


def test_scenario_is_mapping(scenarios):
    scenario = Scenario.load(scenarios / "indoor.toml")
    assert dict(scenario) == scenario.to_dict() and list(scenario) == list(scenario.to_dict()) and len(scenario) == len(list(scenario))
    assert "display" in scenario and "display.pixel.film.0.thickness_nm" in scenario
    assert "display.pixels" not in scenario and 0 not in scenario
    assert scenario.get("solver.seed") == 0 and scenario.get("no.such") is None and scenario.get("no.such", 5) == 5
    assert dict(scenario.items()) == scenario.to_dict() and list(scenario.values()) == list(scenario.to_dict().values())


def test_results_are_mappings(results):
    for found, inside, outside in [(results["result"], ["Y", "white.Y"], "pink.Y"), (results["cone"], ["Y"], "white.Y")]:
        names = list(found)
        assert names == list(found.keys()) and len(found) == len(names) and set(dict(found)) == set(names)
        assert all(name in found for name in [*names, *inside]) and outside not in found and 0 not in found
        assert found.get(outside) is None and np.array_equal(found.get("Y"), found["Y"], equal_nan=True)
        assert [name for name, _ in found.items()] == names and len(list(found.values())) == len(names)
    assert bool(results["result"])
