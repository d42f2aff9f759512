"""Ctrl-C, progress and threads: computations release the interpreter."""

import signal
import subprocess
import sys
import threading
import time

import pytest

import papilio

# A shell that starts the tests in the background ignores SIGINT, and its children inherit that.
START = (
    "import papilio, signal, sys, numpy as np; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "path = sys.argv[1]; "
)
END = "\nprint('ended')\n"

LONG = {
    "a walk": 'papilio.run(path, solver="monte-carlo", set={"solver.paths": 1_000_000_000})',
    "a cone": "papilio.cone(path, theta_deg=np.linspace(0, 80, 4000), phi_deg=np.linspace(0, 350, 1000))",
    "a batch": 'papilio.Prepared(path).evaluate({"display.pixel.film.0.thickness_nm": np.linspace(1, 100, 1000000)}, ["white.Y"])',
    "a fit": 'papilio.fit(path.replace("indoor", "fit"), path.replace("indoor.toml", "data/synthetic-film.csv"), set={"fit.starts": 1000, "spectrum.step_nm": 1})',
    "films": 'papilio.films.reflectance([("SiO2", np.linspace(0, 1000, 10000000)), *[("Cr", 1.0)] * 2000], 550.0, substrate="Al", threads=1)',
}

# The processor time of each is more than ten times this.
MOST_CPU_SECONDS = 30


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send")
@pytest.mark.parametrize("what", LONG)
def test_ctrl_c_ends_computation_of_many_minutes(what, scenarios):
    import resource  # not on Windows

    def cpu_seconds():
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime

    script = f"{START}print('begun', flush=True)\n{LONG[what]}{END}"
    command = [sys.executable, "-c", script, scenarios / "indoor.toml"]
    before = cpu_seconds()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "begun\n"
        time.sleep(0.3)
        assert child.poll() is None, child.stderr.read()
        child.send_signal(signal.SIGINT)
        try:
            out, error = child.communicate(timeout=60)
        finally:
            child.kill()
    assert "KeyboardInterrupt" in error and "ended" not in out
    assert cpu_seconds() - before < MOST_CPU_SECONDS


def test_progress_is_reported_and_can_end_run(scenarios):
    told = []
    papilio.run(scenarios / "indoor.toml", solver="monte-carlo", set={"solver.relative_error": 2e-4}, progress=told.append)
    assert all(set(one) == {"fraction", "views_done", "views", "relative_error", "target", "paths"} for one in told)

    def stop(_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        papilio.run(scenarios / "indoor.toml", solver="monte-carlo", set={"solver.paths": 1_000_000_000}, progress=stop)


def test_interpreter_runs_during_computation(scenarios):
    """A Python thread counts during an endless Monte Carlo computation."""

    class Counted(Exception):
        pass

    counted, ended, begun = [0], threading.Event(), time.monotonic()

    def count():
        while not ended.is_set():
            counted[0] += 1
            time.sleep(0.001)

    def look(_):
        if counted[0] >= 20:
            raise Counted
        assert time.monotonic() - begun < 600

    counter = threading.Thread(target=count)
    counter.start()
    with pytest.raises(Counted):
        papilio.run(scenarios / "indoor.toml", solver="monte-carlo", set={"solver.paths": 1_000_000_000}, progress=look)
    ended.set()
    counter.join()


def test_prepared_display_works_in_several_threads(scenarios):
    prepared = papilio.Prepared(scenarios / "indoor.toml")
    alone = prepared.run({"display.pixel.film.0.thickness_nm": 50.0}).to_json()
    found = []

    def work():
        found.append(prepared.run({"display.pixel.film.0.thickness_nm": 50.0}).to_json())
        prepared.run({"display.pixel.film.0.thickness_nm": 60.0})

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [alone] * 4


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGINT to send")
@pytest.mark.parametrize("call", ["evaluate", "run"])
def test_ctrl_c_ends_only_main_thread(call, scenarios):
    """Two threads compute with one prepared display: the call of the main thread is interrupted, the other call is completed."""
    script = f"""
import papilio, sys, threading, os, signal, time, numpy as np
signal.signal(signal.SIGINT, signal.default_int_handler)
prepared = papilio.Prepared(sys.argv[1])
key, found = "display.pixel.film.0.thickness_nm", []
calls = {{
    "evaluate": lambda many: prepared.evaluate({{key: np.linspace(1, 100, many)}}, ["white.Y"], threads=1).shape[0],
    "run": lambda many: len(prepared.run({{"solver.method": "monte-carlo", "solver.paths": 2000 * many}}, threads=1).states),
}}
compute = calls[{call!r}]
compute(8)

def other():
    try:
        found.append(compute(2000))
    except BaseException as error:
        found.append(repr(error))

thread = threading.Thread(target=other)
thread.start()
time.sleep(0.3)
threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    compute(1_000_000)
except KeyboardInterrupt:
    print("interrupted", flush=True)
thread.join()
print(found)
"""
    command = [sys.executable, "-c", script, scenarios / "indoor.toml"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    lines = done.stdout.splitlines()
    assert lines[:1] == ["interrupted"], done.stdout + done.stderr
    assert lines[1] in ("[2000]", "[8]"), done.stdout + done.stderr
