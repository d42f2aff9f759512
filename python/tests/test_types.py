"""Types: strict mypy checks of the package and of a script that uses it; the stub matches the extension module."""

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent


#: Every check has the same options and the same cache of dependencies, in their environment: the first one takes long.
STRICT = ["mypy", "--strict", "--disable-error-code", "import-untyped", "--cache-dir", Path(sys.prefix) / "mypy"]


def checked(*arguments, cwd):
    done = subprocess.run([sys.executable, "-m", *arguments], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_package_passes_strict_type_check(tmp_path):
    checked(*STRICT, "-p", "papilio", cwd=tmp_path)
    checked(*STRICT, HERE / "sample.py", cwd=tmp_path)


#: Calls that would fail, or do something else than they say.
WRONG = [
    'papilio.run("a.toml", solver="wlak")',
    'papilio.cluster.sweep("a.toml", {"solver.seed": [1, 2]}, ["white.Y"], outt="x")',
    'papilio.cluster.evaluate_many("a.toml", {"solver.seed": [1, 2]}, ["white.Y"], on_error="ignore")',
    'papilio.films.power([("SiO2", 1.0)], 550.0, polarisation="q")',
    'papilio.colour.xyz([1.0, 1.0], [380, 780], observer="1932")',
    'papilio.Prepared("a.toml").evaluate({5: [1.0]}, ["white.Y"])',
]


def test_type_check_finds_wrong_calls(tmp_path):
    (tmp_path / "wrong.py").write_text("\n".join(["import papilio", *WRONG]))
    command = [sys.executable, "-m", *STRICT, "wrong.py"]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True).stdout
    lines = {int(line.split(":")[1]) for line in said.splitlines() if line.startswith("wrong.py:") and "error:" in line}
    assert lines == set(range(2, 2 + len(WRONG))), said


def test_stub_matches_extension_module(tmp_path):
    checked("mypy.stubtest", "papilio._papilio", "--ignore-disjoint-bases", cwd=tmp_path)
