"""Files of measured scattering: the same results as the program."""

import json
import pickle
import subprocess

import pytest

from papilio import ArgumentError, FileError
from papilio.diffuser import Diffuser, lobe_names


@pytest.fixture
def h78(scenarios):
    return Diffuser(scenarios / "data" / "H78.bsdf")


def printed(program, *arguments):
    return subprocess.run([program, "diffuser", *arguments], capture_output=True, check=True, text=True).stdout


def test_audit_equals_program(h78, program, scenarios):
    path = scenarios / "data" / "H78.bsdf"
    assert h78.audit() == json.loads(printed(program, "inspect", path, "--json"))
    assert str(h78) == printed(program, "inspect", path)
    assert "<svg" in h78._repr_html_() and len(h78.figures()) == len(h78.parts)


def test_fit_equals_program(h78, program, scenarios):
    fits = h78.fit("k-correlation (s = 3)")
    assert fits == json.loads(printed(program, "fit", scenarios / "data" / "H78.bsdf", "--json", "--model", "k-correlation-3"))


def test_converted_file_can_be_read(h78, tmp_path):
    out = tmp_path / "h78.npz"
    assert h78.convert(out) == []
    assert Diffuser(out).parts == h78.parts
    assert pickle.loads(pickle.dumps(Diffuser(out))).parts == h78.parts


def test_invalid_arguments_and_files_are_named(h78, tmp_path, scenarios):
    with pytest.raises(FileError):
        Diffuser(tmp_path / "absent.bsdf")
    with pytest.raises(FileError):
        Diffuser(tmp_path)
    wrong = tmp_path / "wrong.bsdf"
    wrong.write_bytes(bytes(range(256)))
    with pytest.raises(FileError):
        Diffuser(wrong)
    for path in [5, None, "a\0b"]:
        with pytest.raises(ArgumentError, match="^path:"):
            Diffuser(path)
    with pytest.raises(ArgumentError, match="^model:"):
        h78.fit("Phong")
    with pytest.raises(ArgumentError, match="^part:"):
        h78.fit(part="side")
    with pytest.raises(ArgumentError, match="^format:"):
        h78.convert(tmp_path / "a.docx")
    with pytest.raises(ArgumentError, match="^output:"):
        h78.convert(scenarios / "data" / "H78.bsdf")
    with pytest.raises(FileError):
        h78.convert(tmp_path / "no" / "folder.npz")
    assert "GGX" in lobe_names()
