"""Thousands of designs: the same numbers on this machine, on a cluster, and after interruptions."""

import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import papilio
from papilio import ArgumentError, ClusterError, DesignError, _batches, cluster
from papilio._batches import Question

distributed = pytest.importorskip("distributed")
dask = pytest.importorskip("dask")

#: Number of designs in the long test; `cargo xtask python` uses 100000.
DESIGNS = int(os.environ.get("PAPILIO_DESIGNS", "144"))

MATCHING = "display.pixel.film.0.thickness_nm"
ABSORBER = "display.pixel.film.1.thickness_nm"
METRICS = ["gamut_percent_srgb", "white.Y"]


@pytest.fixture
def indoor(scenarios):
    return papilio.Scenario.load(scenarios / "indoor.toml")


@pytest.fixture(scope="module", autouse=True)
def idle_workers_rest():
    """Half of the processor time of a worker is its watching itself: its profile, its clock and its use of the machine."""
    watch = {"distributed.worker.profile.enabled": False, "distributed.admin.tick.interval": "1s", "distributed.admin.system-monitor.interval": "10s"}
    with dask.config.set(watch):
        yield


@pytest.fixture(scope="module")
def client():
    """Two worker processes of one thread each."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as workers:
        with distributed.Client(workers) as client:
            yield client


def plane(count):
    """Designs of two thicknesses: ``count``, or a few more."""
    side = int(np.ceil(np.sqrt(count)))
    return {MATCHING: np.linspace(40, 70, side)[:, None], ABSORBER: np.linspace(8, 14, side)}


def in_batches_of(monkeypatch, size):
    """Fixes the size of batches independent of computing times."""
    monkeypatch.setattr("papilio._backends._COSTS", {})
    monkeypatch.setattr("papilio._batches.batch_size", lambda *_: size)
    monkeypatch.setattr("papilio._batches.seconds_each", lambda *_: 1.0)


def test_batches_equal_single_call(indoor, monkeypatch):
    in_batches_of(monkeypatch, 7)
    designs = plane(36)
    at_once = papilio.Prepared(indoor).evaluate(designs, METRICS)
    found = cluster.evaluate_many(indoor, designs, METRICS)
    assert found.shape == (6, 6, 2) and np.array_equal(found.values, at_once)
    assert np.array_equal(found["white.Y"], at_once[..., 1])
    with pytest.raises(KeyError, match=r"red\.Y"):
        found["red.Y"]


def test_interrupted_evaluation_is_resumed(indoor, monkeypatch, tmp_path):
    in_batches_of(monkeypatch, 8)
    designs, whole = plane(36), papilio.Prepared(indoor).evaluate(plane(36), METRICS)

    def after_two(state):
        if state["done"] >= 16:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cluster.evaluate_many(indoor, designs, METRICS, out=tmp_path, progress=after_two)
    found = cluster.evaluate_many(indoor, designs, METRICS, out=tmp_path)
    assert found.reused == 16 and np.array_equal(found.values, whole)
    # A part that a power failure truncated is computed again.
    found.parts[1].write_bytes(found.parts[1].read_bytes()[:-20])
    found = cluster.evaluate_many(indoor, designs, METRICS, out=tmp_path)
    assert found.reused == 28 and np.array_equal(found.values, whole)
    assert not list(tmp_path.rglob("*.part"))


def test_repeated_evaluation_computes_only_new_parts(indoor, monkeypatch, tmp_path):
    in_batches_of(monkeypatch, 6)
    column = np.linspace(40, 70, 18)
    first = cluster.evaluate_many(indoor, {MATCHING: column}, METRICS, out=tmp_path)
    in_batches_of(monkeypatch, 5)  # after a slower trial: existing parts are still used
    longer = cluster.evaluate_many(indoor, {MATCHING: np.append(column, [71, 72])}, METRICS, out=tmp_path)
    assert (first.reused, longer.reused) == (0, 18) and longer.parts[:3] == first.parts
    assert np.array_equal(longer.values[:18], first.values)
    other = cluster.evaluate_many(indoor, {MATCHING: column}, METRICS, out=tmp_path, set={"viewer.theta_deg": 20})
    assert other.reused == 0 and other.folder != first.folder
    pandas = pytest.importorskip("pandas")
    table = pandas.read_parquet(longer.folder)
    assert len(table) == 20 and set(table) == {MATCHING, *METRICS}
    assert longer.to_pandas().sort_values(MATCHING).equals(table.sort_values(MATCHING)[longer.to_pandas().columns].reset_index(drop=True))


def test_string_variables_and_equal_batches_are_computed(indoor, monkeypatch):
    in_batches_of(monkeypatch, 2)
    words = {"display.pixel.film.2.material": np.array(["SiO2", "Al2O3", "SiO2", "Al2O3"])}
    found = cluster.evaluate_many(indoor, words, METRICS)
    assert np.array_equal(found.values[:2], found.values[2:])
    assert not np.array_equal(found.values[0], found.values[1])


def test_sweep_equals_grid(indoor, client):
    axes = {MATCHING: [50.0, 55.9, 60.0], ("display.pixel.film.2.thickness_nm", "display.pixel.film.3.thickness_nm"): [9.0, 30.0]}
    found = cluster.sweep(indoor, axes, METRICS, client=client)
    assert found.shape == (3, 2, 2)
    one = papilio.run(indoor, set={MATCHING: 60.0, "display.pixel.film.2.thickness_nm": 9.0, "display.pixel.film.3.thickness_nm": 9.0})
    assert found["white.Y"][2, 0] == pytest.approx(one["white.Y"][0], rel=2e-3)  # the scenario's error
    pytest.importorskip("xarray")
    arrays = found.to_xarray()
    assert dict(arrays.sizes) == {MATCHING: 3, "display.pixel.film.2.thickness_nm, display.pixel.film.3.thickness_nm": 2, "state": 1}
    assert arrays["gamut_percent_srgb"].attrs["units"] == "%"


def test_tolerance_on_cluster_equals_local_result(scenarios, client, tmp_path):
    of = {"tolerance.samples": 64, "tolerance.sensitivity_samples": 4}
    here = papilio.tolerance(scenarios / "tolerance.toml", set=of)
    told = []
    options = {"client": client, "out": tmp_path, "batch_seconds": 0.05, "progress": told.append}
    there = papilio.tolerance(scenarios / "tolerance.toml", set=of, **options)
    assert there.report == here.report and np.array_equal(there.values, here.values, equal_nan=True)
    assert told[-1]["done"] == told[-1]["of"] == 64 and len(told) > 1
    told.clear()
    more = papilio.tolerance(scenarios / "tolerance.toml", set=of | {"tolerance.samples": 80}, **options)
    assert told[-1]["of"] == 16 and np.array_equal(more.values[:64], here.values, equal_nan=True)


#: A search of two rounds: populations, in pieces, and descents from what they find.
BOTH = """
[optimize]
method = "both"
starts = 2
evaluations = 64
points = 3
[[optimize.variables]]
key = "display.pixel.film.0.thickness_nm"
bounds = [20, 90]
[[optimize.variables]]
key = "display.pixel.film.2.material"
choices = ["SiO2", "Al2O3"]
[[optimize.objectives]]
metric = "gamut_percent_srgb"
aim = "maximise"
[[optimize.objectives]]
metric = "white.Y"
aim = "maximise"
"""


@pytest.fixture
def sought(scenarios):
    text = (scenarios / "indoor.toml").read_text() + BOTH
    return papilio.Scenario(text, name="both.toml", folder=scenarios)


def found_by(optimum):
    return optimum.designs, optimum.own, optimum.evaluations


def test_search_on_cluster_equals_local_result(sought, client, tmp_path):
    """One thread, and workers one of which is killed: the same designs to the last bit, the same journal."""
    here = papilio.optimize(sought, threads=1, out=tmp_path / "here")
    killed = []

    def kill_one(state):
        assert state["workers"] and state["done"] <= state["of"]
        if not killed:
            killed.append(next(iter(client.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    there = papilio.optimize(sought, client=client, out=tmp_path / "there", progress=kill_one)
    assert killed and found_by(there) == found_by(here)
    journals = [(tmp_path / name / "optimize.jsonl").read_bytes() for name in ("here", "there")]
    assert journals[0] == journals[1]


def test_search_is_resumed_from_journal(sought, client, scenarios, program, tmp_path):
    """Stopped on the cluster, then resumed on this machine and by the program, from the same file."""
    whole = papilio.optimize(sought)
    journal = tmp_path / "optimize.jsonl"

    def stop(_):
        if b'"task"' in journal.read_bytes():
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        papilio.optimize(sought, client=client, out=tmp_path, progress=stop)
    part = journal.read_bytes()
    assert found_by(papilio.optimize(sought, out=tmp_path)) == found_by(whole)
    kept = journal.read_bytes()
    told = []
    assert found_by(papilio.optimize(sought, client=client, out=tmp_path, progress=told.append)) == found_by(whole)
    assert not told and journal.read_bytes() == kept
    # The program reads the scenario from the file next to its data.
    path = tmp_path / "both.toml"
    path.write_text(sought.to_toml())
    (tmp_path / "data").symlink_to(scenarios / "data")
    journal.write_bytes(part)
    command = [program, "optimize", path, "--out", tmp_path, "--no-check"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0 and " of them now," in done.stderr, done.stderr
    assert journal.read_bytes() == kept


def closing_cluster():
    """One worker, in a thread: it starts sooner than a process. Its messages are as those of a process."""
    return distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=False, protocol="tcp://", dashboard_address=":0")


def test_search_on_closed_cluster_raises_error(sought, tmp_path):
    with closing_cluster() as workers:
        client = distributed.Client(workers)

        def close(_):
            threading.Thread(target=client.close).start()
            time.sleep(0.2)

        with pytest.raises(ClusterError, match="closed"):
            papilio.optimize(sought, client=client, out=tmp_path, progress=close)
        for search in (papilio.optimize, papilio.tolerance):
            with pytest.raises(ArgumentError, match="client: the cluster is closed"):
                search(sought, client=client)
    # The results are kept, and the journal is not locked.
    assert (tmp_path / "optimize.jsonl").read_bytes().count(b"\n") >= 2
    papilio.optimize(sought, out=tmp_path)


def test_cluster_without_workers_raises_error(indoor, sought, tmp_path, monkeypatch):
    """Nothing computes: the calls end after the time that the test shortens, with the words for it."""
    monkeypatch.setattr(papilio._backends, "_PATIENCE", 0.2)
    with distributed.LocalCluster(n_workers=0, processes=False, protocol="tcp://", dashboard_address=":0") as nobody:
        with distributed.Client(nobody) as client:
            begin = time.monotonic()
            for call in (
                lambda: papilio.cluster.sweep(indoor, {"viewer.theta_deg": [0, 10]}, ["white.Y"], client=client, batch_seconds=1),
                lambda: papilio.optimize(sought, client=client, out=tmp_path),
            ):
                with pytest.warns(UserWarning, match="no workers yet"), pytest.raises(ClusterError, match="no workers for 0.2 s; start workers"):
                    call()
            assert time.monotonic() - begin < 30


def test_killed_worker_loses_no_results(indoor, client, tmp_path, capsys):
    """A worker is killed; the numbers equal those of the serial run to the last bit, and memory does not grow."""
    designs = plane(DESIGNS)
    options = {} if DESIGNS > 10000 else {"batch_seconds": 0.1}
    started = time.perf_counter()
    serial = cluster.evaluate_many(indoor, designs, METRICS, threads=1, **options)
    took_serial = time.perf_counter() - started
    started = time.perf_counter()
    parallel = cluster.evaluate_many(indoor, designs, METRICS, client=client, **options)
    took_parallel = time.perf_counter() - started
    assert np.array_equal(parallel.values, serial.values)
    killed, before = [], []

    def watch(state):
        if not before and state["done"] > state["of"] / 4:
            before.extend(megabytes(client))
        elif not killed and state["done"] > state["of"] / 2:
            killed.append(next(iter(client.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    kept = cluster.evaluate_many(indoor, designs, METRICS, client=client, out=tmp_path, progress=watch, **options)
    after = megabytes(client)
    assert killed and np.array_equal(kept.values, serial.values)
    # A batch is a few megabytes; a leak of batches is visible in the long test.
    assert max(after) < max(before) + 50
    again = cluster.evaluate_many(indoor, designs, METRICS, out=tmp_path)
    assert again.reused == again.values[..., 0].size
    with capsys.disabled():
        size = sum(part.stat().st_size for part in kept.parts) / again.reused
        print(
            f"\n{again.reused} designs: serial {took_serial:.2f} s, two workers {took_parallel:.2f} s,"
            f" speed-up {took_serial / took_parallel:.2f}; batches of {parallel.designs_per_part}; {size:.1f} bytes a design;"
            f" workers' memory {before} before, {after} MB after"
        )


def megabytes(client):
    """Memory of each worker process."""

    def resident():
        import psutil

        return round(psutil.Process().memory_info().rss / 1e6)

    return sorted(client.run(resident).values())


def test_killed_program_is_resumed(indoor, scenarios, tmp_path):
    """SIGKILL between two parts or while one is written."""
    script = (
        "import sys, numpy as np, papilio\n"
        f"papilio.cluster.evaluate_many(sys.argv[1], {{{MATCHING!r}: np.linspace(40, 70, 4000)}}, {METRICS!r},"
        " out=sys.argv[2], batch_seconds=0.01)"
    )
    with subprocess.Popen([sys.executable, "-c", script, scenarios / "indoor.toml", tmp_path]) as child:
        until = time.monotonic() + 60
        while len(list(tmp_path.rglob("*.parquet"))) < 3:
            assert child.poll() is None and time.monotonic() < until
            time.sleep(0.01)
        child.kill()
    designs = {MATCHING: np.linspace(40, 70, 4000)[:100]}
    found = cluster.evaluate_many(indoor, designs, METRICS, out=tmp_path)
    assert found.reused > 0
    assert np.array_equal(found.values, papilio.Prepared(indoor).evaluate(designs, METRICS))


def test_worker_with_other_version_or_files_is_refused(tmp_path):
    text = '[display.pixel]\nmodel = "uniform"\nkind = "lambertian"\nreflectance = { white = "w.csv", black = 0.1 }\n'
    text += '[lighting]\npreset = "indoor"\n'
    (tmp_path / "w.csv").write_text("380,0.5\n780,0.5\n")
    here = papilio.Scenario(text, folder=tmp_path)
    question = Question(here, ("lighting.illuminance_lx",), ("white.Y",), 0, here.hash)
    designs = {"lighting.illuminance_lx": np.array([100.0, 200.0])}
    assert question.evaluate(designs).shape == (2, 1)
    (tmp_path / "w.csv").write_text("380,0.4\n780,0.5\n")
    for other, says in [(question, "different contents"), (replace(question, version="0.0.1"), "0.0.1")]:
        with ThreadPoolExecutor(1) as elsewhere, pytest.raises(ClusterError, match=says):
            elsewhere.submit(pickle.loads(pickle.dumps(other)).evaluate, designs).result()


def test_cluster_closed_during_evaluation_raises_error(indoor, tmp_path):
    with closing_cluster() as workers:
        client = distributed.Client(workers)

        def close(_):
            threading.Thread(target=client.close).start()
            time.sleep(0.2)

        with pytest.raises(ClusterError, match="closed"):
            cluster.evaluate_many(indoor, plane(400), METRICS, client=client, batch_seconds=0.05, out=tmp_path, progress=close)
        with pytest.raises(ArgumentError, match="client: the cluster is closed"):
            cluster.evaluate_many(indoor, plane(4), METRICS, client=client)


@pytest.mark.parametrize("on_cluster", [False, True])
def test_invalid_design_is_named(indoor, client, on_cluster):
    designs = plane(36)
    designs[MATCHING] = designs[MATCHING].copy()
    designs[MATCHING][3, 0] = -1.0
    with pytest.raises(DesignError) as error:
        cluster.evaluate_many(indoor, designs, METRICS, client=client if on_cluster else None)
    assert error.value.design[0] == 3


@pytest.mark.parametrize("on_cluster", [False, True])
@pytest.mark.parametrize("kept", [False, True])
def test_invalid_designs_are_skipped_on_request(indoor, client, monkeypatch, tmp_path, on_cluster, kept):
    in_batches_of(monkeypatch, 5)
    designs = plane(36)
    whole = papilio.Prepared(indoor).evaluate(designs, METRICS)
    designs[MATCHING] = designs[MATCHING].copy()
    designs[MATCHING][3, 0] = -1.0
    options = {"client": client if on_cluster else None, "out": tmp_path if kept else None}
    found = cluster.evaluate_many(indoor, designs, METRICS, on_error="nan", **options)
    whole[3] = np.nan
    assert np.array_equal(found.values, whole, equal_nan=True)
    assert [at for at, _ in found.errors] == [(3, i) for i in range(6)]
    assert all("-1 is out of range" in why for _, why in found.errors)
    if kept:  # skipped designs are stored, and raise an error with on_error="raise"
        again = cluster.evaluate_many(indoor, designs, METRICS, on_error="nan", **options)
        assert again.reused == 36 and again.errors == found.errors
        with pytest.raises(DesignError, match="-1 is out of range") as error:
            cluster.evaluate_many(indoor, designs, METRICS, **options)
        assert error.value.design[0] == 3


def test_trial_with_invalid_designs_does_not_raise(indoor):
    """A cluster would log an exception of a task as a failure."""
    designs = {MATCHING: np.array([50.0, -1.0, 55.0])}
    question = Question(indoor, (MATCHING,), ("white.Y",), 0, indoor.hash)
    assert _batches.seconds_each(question, designs, skips=True) > 0
    assert _batches.seconds_each(question, designs) is None


def test_skipped_designs_are_not_logged_as_failures(indoor, client):
    """Tasks with skipped designs do not raise exceptions."""
    designs = {MATCHING: np.array([50.0, -1.0, 55.0])}
    found = cluster.evaluate_many(indoor, designs, ["white.Y"], client=client, on_error="nan", batch_seconds=0.01)
    assert len(found.errors) == 1
    logged = [line for lines in client.get_worker_logs().values() for _, line in lines]
    assert not [line for line in logged if "Compute Failed" in line and "seconds_each" in line]


@pytest.mark.parametrize("on_error", ["raise", "nan"])
def test_unknown_key_raises_scenario_error(indoor, on_error):
    with pytest.raises(papilio.ScenarioError, match="did you mean `red`") as error:
        cluster.evaluate_many(indoor, {"display.pixel.gap_nm.rde": [270.0]}, METRICS, on_error=on_error)
    assert "design" not in str(error.value)


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"variables": {MATCHING: [50.0, np.nan]}}, "variables.*nan"),
        ({"variables": {MATCHING: [50.0, 51.0], ABSORBER: [1.0, 2.0, 3.0]}}, "variables.*shapes"),
        ({"variables": {MATCHING: object()}}, "variables"),
        ({"variables": {MATCHING: [1 + 2j]}}, "variables"),
        ({"variables": {}}, "variables"),
        ({"variables": {3: [50.0]}}, "variables"),
        ({"variables": [MATCHING]}, "variables"),
        ({"metrics": "white.Y"}, "metrics"),
        ({"metrics": []}, "metrics"),
        ({"metrics": ["white.Y", "white.Y"]}, "metrics"),
        ({"metrics": ["white.wobble"]}, "metrics"),
        ({"view": 7}, "view"),
        ({"view": -1}, "view"),
        ({"batch_seconds": 0}, "batch_seconds"),
        ({"batch_seconds": float("nan")}, "batch_seconds"),
        ({"retries": -1}, "retries"),
        ({"on_error": "ignore"}, "on_error"),
        ({"threads": 0}, "threads"),
        ({"progress": 3}, "progress"),
        ({"client": "tcp://127.0.0.1:8786"}, "client"),
        ({"out": "/dev/null/x"}, "out"),
    ],
)
def test_invalid_argument_is_named(indoor, changed, says):
    arguments = {"variables": {MATCHING: [50.0, 51.0]}, "metrics": METRICS, **changed}
    with pytest.raises(papilio.PapilioError, match=says):
        cluster.evaluate_many(indoor, **arguments)


def test_folder_with_other_contents_is_refused(indoor, tmp_path):
    folder = cluster.evaluate_many(indoor, {MATCHING: [50.0]}, METRICS, out=tmp_path).folder
    (folder / "_question.json").write_text("{}")
    with pytest.raises(papilio.FileError, match="_question.json"):
        cluster.evaluate_many(indoor, {MATCHING: [50.0]}, METRICS, out=tmp_path)
