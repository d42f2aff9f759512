// Paths of keys: the page reads and writes the grammar of the program (crates/scenario/src/path.rs, with the same cases).

import assert from "node:assert/strict";
import { test } from "node:test";

import { axesOf, written } from "../../src/model/axes.ts";
import { at, isSamePath, join, keysOf, quoted, split, unquoted, type Json } from "../../src/model/json.ts";
import { differences, leaves } from "../../src/model/keys.ts";
import { areaShares, balanced, groupOf } from "../../src/model/shares.ts";
import { tableText } from "../../src/model/toml-table.ts";
import { coloured } from "../../src/model/toml.ts";

test("quoted key of path keeps its points", () => {
  for (const [text, keys] of [
    ["", []],
    ["a", ["a"]],
    [" a . b.0", ["a", "b", "0"]],
    ['states."a.b".file', ["states", "a.b", "file"]],
    [" states . 'a.b' .0", ["states", "a.b", "0"]],
    [String.raw`"a\"b.c\\".d`, [String.raw`a"b.c\ `.trim(), "d"]],
    [String.raw`'a\'.b`, ["a\\", "b"]],
    ["states.pure red.file", ["states", "pure red", "file"]],
    ["states.it's.file", ["states", "it's", "file"]],
    // A quote without its other one, or with something behind that, is a part of the name.
    ['states."a.b', ["states", '"a', "b"]],
    ['"a.b"c.d', ['"a.b"c', "d"]],
    [String.raw`"ä.\t\u20AC\U0001F98B".x`, ["ä.\t€🦋", "x"]],
  ] as const) {
    assert.deepEqual(keysOf(text), keys, text);
    if (text === "") continue;
    const [above, last] = split(text);
    assert.deepEqual([...keysOf(above), last], keys, text);
    const present = join("", ...keys);
    assert.deepEqual(keysOf(present), keys, present);
    assert.ok(isSamePath(present, text), text);
  }
  assert.ok(!isSamePath('states."a.b".file', "states.a.b.file"));
  for (const wrong of ['"a\\q"', '"\\uD800"', '"a', "a", '"a" ', "'a\nb'"]) assert.equal(unquoted(wrong), null, wrong);
});

test("names become keys that paths read as these names", () => {
  for (const name of ["a", "a.b", "pure red", " a", "", '"a"', "'a", "a=b", "a\\b.c", "a\tb", "ä.€", "a\u0085.b"]) {
    const path = join("states", name);
    assert.deepEqual(keysOf(path), ["states", name], path);
    assert.equal(at({ states: { [name]: { n: 1 } } }, join(path, "n")), 1, path);
  }
  assert.equal(join("a.b", "c"), "a.b.c");
  assert.equal(join('a."b.c"', 0, "d.e"), 'a."b.c".0."d.e"');
  assert.equal(quoted("a.\tb"), '"a.\\u0009b"');
});

const FIELDS: Json = {
  display: { pixel: { area: { "r.1": 0.6, "r 2": 0.4 }, states: { "a.b": { "r.1": 1 }, a: { b: { "r.1": 2 } } } } },
  sweep: { axes: [{ 'display.pixel.states."a.b"."r.1"': [0, 1] }] },
};

test("numbers of keys with points are found, compared and balanced by their paths", () => {
  const state = 'display.pixel.states."a.b"."r.1"';
  assert.deepEqual(
    leaves(FIELDS).map(([path]) => path),
    ['display.pixel.area."r.1"', "display.pixel.area.r 2", state, 'display.pixel.states.a.b."r.1"'],
  );
  for (const [path, value] of leaves(FIELDS)) assert.equal(at(FIELDS, path), value, path);
  const other = structuredClone(FIELDS) as { display: { pixel: { states: Record<string, Json> } } };
  other.display.pixel.states["a.b"] = { "r.1": 0.5 };
  assert.deepEqual(differences(FIELDS, other as Json), [{ path: state, before: 1, now: 0.5 }]);
  assert.equal(groupOf(FIELDS, 'display.pixel.area."r.1"')?.size, 2);
  assert.deepEqual(balanced(areaShares(FIELDS), 'display.pixel.area."r.1"', 0.7), [
    { op: "set", path: 'display.pixel.area."r.1"', value: 0.7 },
    { op: "set", path: "display.pixel.area.r 2", value: 0.3 },
  ]);
  assert.deepEqual(written(axesOf(FIELDS)!), [{ [state]: [0, 1] }]);
});

test("tables and colours of a TOML text know keys in quotes", () => {
  const text = 'title = "x"\n[ display . "a.]b" ]\nn = 1\n[display."a.]b".c]\nm = 2\n[display.a]\nk = 3\n';
  assert.equal(tableText(text, 'display."a.]b"'), '[ display . "a.]b" ]\nn = 1\n[display."a.]b".c]\nm = 2');
  assert.deepEqual(
    coloured(`states."a.b".x = 'y' # z`).map(({ kind, text }) => [kind, text]).filter(([kind]) => kind !== "plain"),
    [["key", 'states."a.b".x'], ["string", "'y'"], ["comment", "# z"]],
  );
});
