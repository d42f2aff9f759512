"""Checks the mixtures of scene.py, without Mitsuba: the weights of the nested blends multiply back to the coverages."""

import array
import random
from pathlib import Path

import scene

HERE = Path(__file__).resolve().parent


class Display:
    """Materials that name their state."""

    def __init__(self, states):
        self.mirror = {"states": dict.fromkeys(states)}
        self.folder = HERE

    def material(self, state):
        return {"state": state}


def fractions(material, weight):
    """The fraction of each state in a material; `weight` returns the value of a texture."""
    if "state" in material:
        return {material["state"]: 1.0}
    found = {}
    second = weight(material["weight"]["filename"])
    for one, share in ((material["bsdf_0"], 1.0 - second), (material["bsdf_1"], second)):
        for state, fraction in fractions(one, weight).items():
            found[state] = found.get(state, 0.0) + share * fraction
    return found


def close(found, expected):
    assert all(abs(found.get(state, 0.0) - value) < 1e-6 for state, value in expected.items()), (found, expected)
    assert abs(sum(found.values()) - 1.0) < 1e-6, found


def texel(columns, rows, column, row):
    """Reads a pixel of a texture."""

    def value(name):
        data = Path(name).read_bytes()
        values = array.array("f", data[-4 * columns * rows :])
        return scene.little(values)[row * columns + column]

    return value


def check_corners():
    names = {"red": 0.3, "green": 0.85, "blue": 0.1, "grey": 0.4}
    shares = {name: Path(name) for name in names}
    corners = [state for by_green in scene.CORNERS for by_blue in by_green for state in by_blue]
    expected = {}
    for k, state in enumerate(corners):
        on = [bool(k & bit) for bit in (4, 2, 1)]
        r, g, b = (names[name] if lit else 1.0 - names[name] for name, lit in zip(names, on))
        expected[state] = r * g * b
    # The colours that are on give a state its name.
    assert corners[0] == "black" and corners[5] == "magenta" and corners[6] == "yellow" and corners[7] == "white"
    close(fractions(scene.picture(Display(corners), shares), names.get), expected)
    close(fractions(scene.picture(Display(["white", "black", "red"]), shares), names.get), {"white": 0.4, "black": 0.6})


def check_any_states():
    draw = random.Random(1)
    columns, rows = 5, 3
    states = ["a", "b", "c", "d", "never", "e"]
    coverages = {state: array.array("f") for state in states}
    for pixel in range(columns * rows):
        parts = [0.0 if state == "never" or draw.random() < 0.3 else draw.random() for state in states]
        parts[0] += 0.0 if pixel % 2 and sum(parts) > 0.0 else 0.1
        for state, part in zip(states, parts):
            coverages[state].append(part / sum(parts))
    material = scene.mixture(Display(states), coverages, columns)
    for pixel in range(columns * rows):
        found = fractions(material, texel(columns, rows, pixel % columns, pixel // columns))
        assert "never" not in found
        close(found, {state: coverages[state][pixel] for state in states})


def check_files_of_papilio_image():
    coverages, columns, rows = scene.image_coverages(HERE)
    assert (columns, rows, list(coverages)) == (4, 2, ["white", "black", "red", "blue"])
    assert [list(one) for one in coverages.values()] == [
        [1, 0, 0, 1, 0, 1, 1, 0],
        [0, 1, 0, 0, 1, 0, 0, 0],
        [0, 0, 1, 0, 0, 0, 0, 1],
        [0] * 8,
    ]
    material = scene.mixture(Display(coverages), coverages, columns)
    close(fractions(material, texel(4, 2, 2, 0)), {"red": 1.0})
    close(fractions(material, texel(4, 2, 0, 1)), {"black": 1.0})


def check_filters_of_png():
    draw = random.Random(2)
    row, above = (bytes(draw.randrange(256) for _ in range(40)) for _ in range(2))

    def nearest(left, up, corner):
        guess = left + up - corner
        return min((left, up, corner), key=lambda candidate: abs(guess - candidate))

    predictions = [lambda a, b, c: 0, lambda a, b, c: a, lambda a, b, c: b, lambda a, b, c: (a + b) // 2, nearest]
    for kind, predicted in enumerate(predictions):
        lefts, corners = b"\0" + row[:-1], b"\0" + above[:-1]
        neighbours = zip(row, lefts, above, corners)
        filtered = bytes((x - predicted(a, b, c)) % 256 for x, a, b, c in neighbours)
        assert scene.unfiltered(kind, filtered, above) == row, kind


check_corners()
check_any_states()
check_files_of_papilio_image()
check_filters_of_png()
