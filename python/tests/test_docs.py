"""Every block of Python of the documentation: it runs, and the results that it shows are compared.

docs/writing.md describes the comments above the blocks; all other blocks are tested by cli/tests/cli/docs_blocks.
"""

import doctest
import os
import re
import shutil
import subprocess
import sys
import textwrap

import pytest
from conftest import ROOT

COMMENT = r"<!--(?:(?!-->).)*-->"
BLOCK = re.compile(rf"(?P<notes>(?:^ *{COMMENT}\s*)*)^ *```python\n(?P<code>.*?)^ *```$", re.MULTILINE | re.DOTALL)


def blocks(page):
    """The notes (name, value) and the code of each block of Python of a page."""
    text = (ROOT / page).read_text(encoding="utf-8")
    for found in BLOCK.finditer(text):
        notes = re.findall(r"<!-- *(\w+):? *((?:(?!-->).)*?) *-->", found["notes"], re.DOTALL)
        yield notes, textwrap.dedent(found["code"])


PAGES = sorted(
    str(path.relative_to(ROOT))
    for path in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
    if path.name != "CHANGELOG.md" and any(blocks(path.relative_to(ROOT)))
)


def run_doctest(code, names, page):
    test = doctest.DocTestParser().get_doctest(code, names, page, page, 0)
    said = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    failed, _ = runner.run(test, out=said.append, clear_globs=False)
    assert failed == 0, "".join(said)
    return test.globs


@pytest.mark.parametrize("page", PAGES)
def test_blocks_of_page_run(page, program, monkeypatch, tmp_path):
    for folder in ("scenarios", "surfaces"):
        shutil.copytree(ROOT / folder, tmp_path / folder)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{(ROOT / program).parent}{os.pathsep}{os.environ['PATH']}")
    names = {}
    for notes, code in blocks(page):  # each block uses the names of the preceding ones
        known = dict(notes)
        assert set(known) <= {"setup", "replace", "skip", "long"}, (page, notes)
        assert known.get("skip") != "", f"{page}: a skipped block needs a reason"
        if "skip" in known or ("long" in known and "PAPILIO_DOCS_ALL" not in os.environ):
            continue
        for name, value in notes:
            if name == "setup":
                subprocess.run(value, shell=True, check=True, capture_output=True)
            if name == "replace":
                old, new = value.split(" -> ")
                assert old in code, (page, value)
                code = code.replace(old, new)
        if code.startswith(">>>"):
            names = run_doctest(code, names, page)
        else:
            exec(compile(code, page, "exec"), names)
    if "client" in names:
        names["client"].shutdown()  # a cluster of the page, in this process


def test_blocks_of_pages_are_found_and_few_are_skipped():
    notes = [dict(notes) for page in PAGES for notes, _ in blocks(page)]
    assert len(notes) >= 15, len(notes)
    assert sum("skip" in known for known in notes) <= 2


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
