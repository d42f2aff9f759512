"""The examples of docs/python.md and of the README."""

import doctest
import re
import sys

import pytest
from conftest import ROOT


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(("page", "least"), [("docs/python.md", 6), ("README.md", 1)])
def test_examples_of_pages_run(page, least, monkeypatch):
    monkeypatch.chdir(ROOT)
    shown, names = blocks(page), {}
    assert len(shown) >= least
    for block in shown:  # each block uses the names of the preceding ones
        block = block.replace(", 100)", ", 20)")  # 400 designs instead of 10,000: the same code
        test = doctest.DocTestParser().get_doctest(block, names, page, page, 0)
        said = []
        runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
        failed, _ = runner.run(test, out=said.append, clear_globs=False)
        names = test.globs
        assert failed == 0, "".join(said)


def test_python_version_is_consistent_and_tested():
    """The versions in the package, the page and the README are equal, and the tests run with this version or a newer one."""
    promised = re.search(r'requires-python = ">=(3\.\d+)"', (ROOT / "python" / "pyproject.toml").read_text())[1]
    abi = re.search(r"abi3-py3(\d+)", (ROOT / "Cargo.toml").read_text())[1]
    page = re.search(r"Python (3\.\d+) or newer", (ROOT / "docs" / "python.md").read_text())[1]
    readme = re.search(r"Python package Python (3\.\d+)", (ROOT / "README.md").read_text())[1]
    needed = re.search(r"Python (3\.\d+) or later", (ROOT / "xtask" / "src" / "python.rs").read_text())[1]
    assert {promised, f"3.{abi}", page, readme, needed} == {promised}
    assert sys.version_info[:2] >= tuple(map(int, promised.split(".")))


def test_documented_extras_exist():
    """Papilio is not in a package index: extras are installed from this folder."""
    extras = set(re.findall(r"^(\w+) = \[\"", (ROOT / "python" / "pyproject.toml").read_text(), re.MULTILINE))
    pages = [*(ROOT / "docs").rglob("*.md"), *(ROOT / "python" / "papilio").glob("*.py"), ROOT / "README.md"]
    texts = [path.read_text(encoding="utf-8") for path in pages]
    named = [name for text in texts for names in re.findall(r"\./python\[([\w,]+)\]", text) for name in names.split(",")]
    assert named and set(named) <= extras
    assert not any(re.search(r"pip install \"?papilio", text) for text in texts)
