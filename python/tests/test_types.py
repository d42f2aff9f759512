"""The package is typed: mypy, strictly, over it and over a script that uses it; its stub is what the module has."""

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent


def checked(*arguments, cwd):
    done = subprocess.run([sys.executable, "-m", *arguments], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_strictly(tmp_path):
    cache = ["--cache-dir", tmp_path / "cache"]
    checked("mypy", "--strict", "--disable-error-code", "import-untyped", *cache, "-p", "papilio", cwd=tmp_path)
    checked("mypy", "--strict", *cache, HERE / "sample.py", cwd=tmp_path)


def test_the_stub_is_the_extension_modules(tmp_path):
    checked("mypy.stubtest", "papilio._papilio", "--ignore-disjoint-bases", cwd=tmp_path)
