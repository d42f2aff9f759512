"""The command `papilio` of the wheel, and the sources without it."""

import shutil
import subprocess
import sys
from pathlib import Path

import papilio


def said(*command, cwd=None):
    done = subprocess.run([sys.executable, *command], cwd=cwd, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def test_command_of_package_is_the_program(scenarios, program, tmp_path):
    code, out, _ = said("-m", "papilio", "run", scenarios / "indoor.toml", "--out", tmp_path / "a", "--set", "spectrum.step_nm=50")
    assert code == 0 and out
    subprocess.run([program, "run", scenarios / "indoor.toml", "--out", tmp_path / "b", "--set", "spectrum.step_nm=50"], check=True, capture_output=True)
    assert (tmp_path / "a" / "result.json").read_bytes() == (tmp_path / "b" / "result.json").read_bytes()


def test_command_returns_exit_codes_and_messages(tmp_path):
    code, _, err = said("-m", "papilio", "run", tmp_path / "absent.toml")
    assert code == 2 and "error: " in err
    code, out, _ = said("-m", "papilio", "--help")
    assert code == 0 and "Usage: papilio" in out


def test_sources_without_extension_module_are_explained(tmp_path):
    sources = Path(papilio.__file__).parent
    shutil.copytree(sources, tmp_path / "papilio", ignore=shutil.ignore_patterns("*.so", "*.pyd", "__pycache__"))
    code, _, err = said("-S", "-c", "import papilio", cwd=tmp_path)
    assert code == 1 and "without its compiled part; install it with 'pip install ./python'" in err and "circular" not in err
