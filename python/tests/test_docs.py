"""docs/python.md, line by line; and what the README shows."""

import doctest
import re

import pytest
from conftest import ROOT


def blocks(page):
    return re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize(("page", "least"), [("docs/python.md", 6), ("README.md", 1)])
def test_the_pages_say_what_happens(page, least, monkeypatch):
    monkeypatch.chdir(ROOT)
    shown, names = blocks(page), {}
    assert len(shown) >= least
    for block in shown:  # each goes on with the names of the one before
        test = doctest.DocTestParser().get_doctest(block, names, page, page, 0)
        said = []
        runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
        failed, _ = runner.run(test, out=said.append, clear_globs=False)
        names = test.globs
        assert failed == 0, "".join(said)
