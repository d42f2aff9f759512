"""Types: strict mypy checks of the package and of a script that uses it; the stub matches the extension module."""

import subprocess
import sys
from pathlib import Path

from conftest import FULL

HERE = Path(__file__).parent

#: Half of the time is the modules that `distributed` imports. The package only calls it, so that every day its objects have no types.
UNREAD = [] if FULL else ["distributed", "dask", "IPython"]


def strict(folder):
    """A strict check. All have the same options and the same cache of dependencies, in their environment: the first one takes long."""
    cache = Path(sys.prefix) / "mypy"
    return ["mypy", "--strict", "--disable-error-code", "import-untyped", "--cache-dir", cache, *without(folder, UNREAD)]


def without(folder, packages, *, modules=()):
    """Arguments of mypy that leave packages and modules unread: what is imported from them has no type."""
    names = [*(f"{name}.*" for name in packages), *modules]
    lines = [f"[mypy-{name}]\nfollow_imports = skip\nfollow_imports_for_stubs = true\n" for name in names]
    (folder / "mypy.ini").write_text("[mypy]\n" + "".join(lines))
    return ["--config-file", folder / "mypy.ini"]


def checked(*arguments, cwd):
    done = subprocess.run([sys.executable, "-m", *arguments], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_package_passes_strict_type_check(tmp_path):
    checked(*strict(tmp_path), "-p", "papilio", cwd=tmp_path)
    checked(*strict(tmp_path), HERE / "sample.py", cwd=tmp_path)


#: Calls that would fail, or do something else than they say.
WRONG = [
    'papilio.run("a.toml", solver="wlak")',
    'papilio.cluster.sweep("a.toml", {"solver.seed": [1, 2]}, ["white.Y"], outt="x")',
    'papilio.cluster.evaluate_many("a.toml", {"solver.seed": [1, 2]}, ["white.Y"], on_error="ignore")',
    'papilio.films.power([("SiO2", 1.0)], 550.0, substrate="Al", polarisation="q")',
    'papilio.colour.xyz([1.0, 1.0], [380, 780], observer="1932")',
    'papilio.Prepared("a.toml").evaluate({5: [1.0]}, ["white.Y"])',
]


def test_type_check_finds_wrong_calls(tmp_path):
    (tmp_path / "wrong.py").write_text("\n".join(["import papilio", *WRONG]))
    command = [sys.executable, "-m", *strict(tmp_path), "wrong.py"]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True).stdout
    lines = {int(line.split(":")[1]) for line in said.splitlines() if line.startswith("wrong.py:") and "error:" in line}
    assert lines == set(range(2, 2 + len(WRONG))), said


def test_stub_matches_extension_module(tmp_path):
    # Names, arguments and defaults are compared: types of arrays are not, and the package around the module is not needed.
    _, unread = without(tmp_path, ["numpy"], modules=["papilio"])
    checked("mypy.stubtest", "papilio._papilio", "--ignore-disjoint-bases", "--mypy-config-file", unread, cwd=tmp_path)
