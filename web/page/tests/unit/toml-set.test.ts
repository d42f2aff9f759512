// Values of a TOML text that are replaced in the page; titles and changes of designs.

import assert from "node:assert/strict";
import { test } from "node:test";

import { lastChange, titleOf } from "../../src/model/about.ts";
import { valuesOf, withValue } from "../../src/model/toml-set.ts";

const TEXT = `# A display.
title = "A \\"b\\" # no comment"
words = """
haze = 9
"""
[display.diffuser] # as bought
haze = 0.78 # H78
reflection.model = 'ward'
[display.pixel]
film = [
  { material = "SiO2", thickness_nm = 38.6 }, # [spacer
  { material = "air", thickness_nm = "gap" },
]
[[lighting.directed]]
share = 0.1
[[lighting.directed]]
share = 0.2
[lighting.directed.lobe]
width = 1e-3
`;

test("value is replaced at its place, with its comment", () => {
  for (const [path, from, to] of [
    ["display.diffuser.haze", "haze = 0.78", "haze = 0.5"],
    ["display.diffuser.reflection.model", "'ward'", '"lambertian"'],
    ["display.pixel.film.0.thickness_nm", "38.6", "40"],
    ["display.pixel.film.1.thickness_nm", '"gap"', '"gap 2"'],
    ["lighting.directed.1.share", "0.2", "0.3"],
    ["lighting.directed.1.lobe.width", "1e-3", "0.01"],
    ["title", '"A \\"b\\" # no comment"', '"C"'],
  ] as const) {
    const value = to.includes("= ") ? Number(to.split("= ")[1]) : JSON.parse(to);
    assert.equal(withValue(TEXT, path, value), TEXT.replace(from, to), path);
  }
});

test("value of a key in quotes is replaced, whatever its quotes are", () => {
  const text = `[pixel.states."a.b"]
red = 0.5
[pixel.states.a]
b.red = 0.1
[pixel]
area = { 'r.1' = 0.4, "r\\t2" = 0.6, "r.\\u0031 " = 0.7 }
`;
  for (const [path, from] of [
    ['pixel.states."a.b".red', "0.5"],
    ["pixel . states.'a.b'.red", "0.5"],
    ["pixel.states.a.b.red", "0.1"],
    ['pixel.area."r.1"', "0.4"],
    ['pixel.area."r\\u00092"', "0.6"],
    ['pixel.area."r.1 "', "0.7"],
  ] as const)
    assert.equal(withValue(text, path, 0.25), text.replace(from, "0.25"), path);
  assert.equal(withValue(text, "pixel.area.r.1", 1), null);
});

test("text is left to the server where a key is missing or the text is broken", () => {
  assert.equal(withValue(TEXT, "display.diffuser.width", 1), null);
  assert.equal(withValue(TEXT, "display.diffuser.haze", { a: 1 }), null);
  assert.equal(withValue("haze = 1\nbroken =", "haze", 2), null);
  assert.equal(withValue('haze = 1\nt = "open', "haze", 2), null);
  assert.ok(valuesOf("").size === 0);
});

test("design is named by its own title and its last change", () => {
  assert.equal(titleOf(TEXT), 'A "b" # no comment');
  assert.equal(titleOf("title = 'x'"), "x");
  assert.equal(titleOf('title = "typed"\nbroken ='), "typed");
  assert.equal(titleOf("[a]\ntitle = 'of a table'"), null);
  assert.equal(lastChange("a = 1\nb = 2", "a = 1 # same\nb = 3"), "b = 3");
  assert.equal(lastChange("a = 1\nb = 2", "a = 1"), "without b = 2");
  assert.equal(lastChange(undefined, "a = 1"), "");
});
