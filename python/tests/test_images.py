"""Pictures on a display are those of the program."""

import copy
import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import papilio
import pytest


def colours(rows: int = 12, columns: int = 20) -> np.ndarray:
    """A picture with all kinds of colours."""
    y, x = np.mgrid[:rows, :columns]
    return np.stack([255 * x // columns, 255 * y // rows, 255 - 255 * x // columns], 2).astype(np.uint8)


def test_picture_is_that_of_the_program(scenarios: Path, program: Path, tmp_path: Path) -> None:
    file = scenarios / "six-ink.toml"
    picture = scenarios / "data" / "chelsea.png"
    small = {"display.matrix.pixels": [60, 40]}
    found = papilio.image(file, picture, set=small)
    command = [program, "image", str(file), str(picture), "--set", "display.matrix.pixels=[60,40]", "--json", "--out", str(tmp_path / "theirs")]
    theirs = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    assert found.numbers == theirs | {"hash": found.numbers["hash"]}
    assert found["seen"].shape == found["wanted"].shape == found["mapped"].shape == (40, 60, 3)
    assert (found["srgb"].dtype, found["states"].dtype, found["states"].shape) == (np.uint8, np.uint8, (40, 60))
    share = (found["states"] == found.states.index("white")).mean()
    assert share == pytest.approx(found.numbers["coverage"]["white"], abs=1e-12)
    assert found.png().startswith(b"\x89PNG")
    for path in found.save(tmp_path):
        assert path.suffix != ".png" or path.read_bytes() == (tmp_path / "theirs" / path.name).read_bytes()
    assert (tmp_path / "states.png").exists()
    once = pickle.loads(pickle.dumps(found))
    assert copy.copy(once).to_json() == found.to_json() and np.array_equal(once["seen"], found["seen"])
    assert repr(found).startswith("<papilio.Image") and "states" in found


def test_arrays_are_pictures(scenarios: Path) -> None:
    file = scenarios / "six-ink.toml"
    bytes_ = colours()
    encoded = papilio.image(file, bytes_)
    assert np.array_equal(encoded["states"], papilio.image(file, bytes_ / 255.0)["states"])
    assert np.array_equal(encoded["states"], papilio.image(file, bytes_.astype(np.uint16) * 257)["states"])
    light = np.where(bytes_ / 255 <= 0.04045, bytes_ / 255 / 12.92, ((bytes_ / 255 + 0.055) / 1.055) ** 2.4)
    linear = papilio.image(file, light, encoding="linear")
    assert np.allclose(linear["wanted"], encoded["wanted"], atol=1e-6)
    grey = papilio.image(file, np.full((5, 7), 0.3), set={"image.halftone": "none"})
    assert "states" not in grey and np.ptp(grey["seen"], axis=(0, 1)).max() == 0


def test_own_halftone_is_shown(scenarios: Path) -> None:
    file = scenarios / "six-ink.toml"
    first = papilio.image(file, colours())
    again = papilio.image(file, colours(), states=first["states"])
    assert np.array_equal(again["seen"], first["seen"]) and again.numbers["coverage"] == first.numbers["coverage"]
    black = papilio.image(file, colours(), states=np.zeros((12, 20), int))
    assert black.numbers["coverage"]["black"] == 1.0 and np.ptp(black["srgb"], axis=(0, 1)).max() == 0
    brighter = papilio.image(file, colours(), relative_to="display")
    assert brighter["srgb"].max() > first["srgb"].max()
    wide = papilio.image(file, colours(), space="display-p3", set={"image.samples_per_pixel": 2})
    # Colours of sRGB have less chroma in the numbers of a wider space.
    assert wide["srgb"].shape == (24, 40, 3) and np.ptp(wide["srgb"], axis=2).mean() < np.ptp(first["srgb"], axis=2).mean()
    assert b"cICP" in wide.png()[:100] and b"sRGB" in first.png()[:100]


def test_mistakes_are_named(scenarios: Path) -> None:
    file = scenarios / "six-ink.toml"
    for picture, message in [
        (np.zeros((4, 4, 2)), r"picture: expected a path, or an array of the shape \(rows, columns, 3\)"),
        (np.full((4, 4, 3), 1.5), "picture: 1.5 is out of range"),
        (np.zeros((4, 4, 3), int), "picture: expected uint8"),
        (np.zeros((4, 4, 3), np.uint32), "8 or 16 bits"),
    ]:
        with pytest.raises(papilio.ArgumentError, match=message):
            papilio.image(file, picture)
    for states, message in [
        (np.zeros((4, 4)), "states: expected whole numbers"),
        (np.full((12, 20), 300), "states: 300 to 300 is out of range"),
        (np.zeros((20, 12), int), r"states: the shape is \(20, 12\) \(expected \(12, 20\)"),
    ]:
        with pytest.raises(papilio.ArgumentError, match=message):
            papilio.image(file, colours(), states=states)
    with pytest.raises(papilio.DisplayError, match="up to number 6"):
        papilio.image(file, colours(), states=np.full((12, 20), 6))
    with pytest.raises(papilio.ArgumentError, match="encoding"):
        papilio.image(file, colours(), encoding="gamma")  # type: ignore[arg-type]
    with pytest.raises(papilio.ScenarioError, match="nowhere"):
        papilio.image(file, "nowhere.png")


@pytest.mark.parametrize(("packed", "rotate", "mirror"), [(None, 0, False), (4, 90, True), (8, 270, False), ("planes", 180, True)])
def test_frame_is_that_of_the_program(
    scenarios: Path, program: Path, tmp_path: Path, packed: int | str | None, rotate: int, mirror: bool
) -> None:
    file, picture = scenarios / "six-ink.toml", scenarios / "data" / "chelsea.png"
    found = papilio.image(file, picture, set={"display.matrix.pixels": [61, 40]})
    frame = pickle.loads(pickle.dumps(found)).frame(packed, rotate=rotate, mirror=mirror)
    command = [program, "image", str(file), str(picture), "--set", "display.matrix.pixels=[61,40]", "--frame", "bin,h", "--out", str(tmp_path)]
    command += [] if packed is None else ["--packed", str(packed)]
    command += ["--rotate", str(rotate)] if rotate else []
    subprocess.run(command + (["--mirror"] if mirror else []), capture_output=True, check=True)
    assert frame.data == (tmp_path / "frame.bin").read_bytes()
    assert frame.header.splitlines()[1:] == (tmp_path / "frame.h").read_text().splitlines()[1:]
    assert frame.numbers == json.loads((tmp_path / "image.json").read_text())["frame"]
    # By hand: the codes of the states, turned.
    codes = np.array([0, 1, 2, 3, 5, 6], np.uint8)[found["states"]]
    turned = np.rot90(codes, -rotate // 90)
    assert np.array_equal(frame.codes, turned[:, ::-1] if mirror else turned)


def test_files_are_saved_by_their_ends(scenarios: Path, program: Path, tmp_path: Path) -> None:
    """Each end of a name is one file of the program, byte for byte; other files are refused, and nothing is left of them."""
    file, picture = scenarios / "six-ink.toml", scenarios / "data" / "chelsea.png"
    found = pickle.loads(pickle.dumps(papilio.image(file, picture, set={"display.matrix.pixels": [61, 40]})))
    command = [program, "image", str(file), str(picture), "--set", "display.matrix.pixels=[61,40]", "--frame", "bin,bmp,h", "--out", str(tmp_path / "theirs")]
    subprocess.run(command, capture_output=True, check=True)
    own = tmp_path / "own"
    for name, theirs in [
        ("picture.png", "seen.png"),
        ("Picture.PNG", "seen.png"),
        ("states.png", "states.png"),
        ("seen.exr", "seen.exr"),
        ("light.exr", "seen.exr"),
        ("frame.bmp", "frame.bmp"),
        ("panel.bin", "frame.bin"),
        ("panel.h", "frame.h"),
    ]:
        assert found.save(own / name) == [own / name]
        ours, expected = (own / name).read_bytes(), (tmp_path / "theirs" / theirs).read_bytes()
        if theirs == "frame.h":  # the first line has the name of the program
            ours, expected = (one.partition(b"\n")[2] for one in (ours, expected))
        assert ours == expected, name
    assert json.loads(found.save(own / "numbers.json")[0].read_text()) == found.numbers
    turned = found.frame(rotate=90)
    assert turned.save(own / "turned.bmp")[0].read_bytes() == turned.bmp != found.frame().bmp
    before = sorted(own.iterdir())
    for name, words in [
        ("seen.jpg", r"path: expected a folder, or a path that ends as one of the files image.json, seen.png.*, not 'seen.jpg'"),
        ("seen.tif", "ends as one of the files"),
        ("rooms.png", "--rooms"),
        ("changed.png", "--since"),
    ]:
        with pytest.raises(papilio.ArgumentError, match=words):
            found.save(own / name)
    none = papilio.image(file, colours(), set={"image.halftone": "none"})
    for name in ("states.png", "frame.bmp", "frame.bin"):
        with pytest.raises(papilio.ArgumentError, match="without a halftone has no states"):
            none.save(tmp_path / "none" / name)
    assert sorted(own.iterdir()) == before and not (tmp_path / "none").exists()
    names = {path.name for path in found.save(tmp_path / "folder")}
    assert names == {"image.json", "seen.png", "seen.exr", "states.png"} == {path.name for path in (tmp_path / "folder").iterdir()}
    # A file that cannot be written leaves what was there.
    (own / "folder.exr").mkdir()
    assert {path.name for path in found.save(own / "folder.exr")} == names


def test_wrong_frames_are_named(scenarios: Path) -> None:
    found = papilio.image(scenarios / "six-ink.toml", colours())
    with pytest.raises(papilio.ArgumentError, match="2 bits hold codes up to 3, and the code of green is 6"):
        found.frame(2)
    with pytest.raises(papilio.ArgumentError, match="rotate"):
        found.frame(rotate=45)
    none = papilio.image(scenarios / "six-ink.toml", colours(), set={"image.halftone": "none"})
    with pytest.raises(papilio.ArgumentError, match="no states"):
        none.frame()
