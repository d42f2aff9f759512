// Pending edits: the newest value of a slider replaces older ones, and the order across an insertion is preserved.

import assert from "node:assert/strict";
import { test } from "node:test";

import type { Edit } from "../../src/api/types.ts";
import type { Json } from "../../src/model/json.ts";
import { edited, merged } from "../../src/state/edits.ts";

const set = (path: string, value: unknown): Edit => ({ op: "set", path, value });

test("key that is set again keeps only the newer value", () => {
  assert.deepEqual(merged([set("a", 1), set("b", 1)], [set("a", 2)]), [set("b", 1), set("a", 2)]);
});

test("edit before an insertion stays before it", () => {
  const insert: Edit = { op: "insert", path: "display.front", index: 0, value: {} };
  const before = set("display.front.0.reflectance", 0.1);
  const after = set("display.front.0.reflectance", 0.2);
  assert.deepEqual(merged([before, insert], [after]), [before, insert, after]);
});

test("edits are applied to a copy of the fields", () => {
  const fields = { display: { pixel: { film: [{ thickness_nm: 1 }, { thickness_nm: 2 }] } } };
  const now = edited(fields, [
    set("display.pixel.film.1.thickness_nm", 9),
    { op: "move", path: "display.pixel.film", from: 1, to: 0 },
    { op: "insert", path: "display.pixel.film", index: 1, value: { thickness_nm: 5 } },
    { op: "remove", path: "display.pixel.film.2" },
    set("viewer.theta_deg", 8),
  ]);
  assert.deepEqual(now, {
    display: { pixel: { film: [{ thickness_nm: 9 }, { thickness_nm: 5 }] } },
    viewer: { theta_deg: 8 },
  });
  assert.equal(fields.display.pixel.film[1]!.thickness_nm, 2);
});

test("insertion creates a missing list", () => {
  assert.deepEqual(edited({ display: {} }, [{ op: "insert", path: "display.front", index: 0, value: 1 }]), {
    display: { front: [1] },
  });
});

test("edits of keys in quotes change these keys alone", () => {
  const fields = { states: { "a.b": { red: 1 }, a: { b: { red: 2 } } } };
  const now = edited(fields, [
    set('states."a.b".red', 0.5),
    set("states.'a.b'.blue", 0.25),
    set('states."c.d".x."e.f"', 3),
    { op: "insert", path: 'states."c.d".list', index: 0, value: 4 },
  ]);
  assert.deepEqual(now, {
    states: { "a.b": { red: 0.5, blue: 0.25 }, a: { b: { red: 2 } }, "c.d": { x: { "e.f": 3 }, list: [4] } },
  });
  assert.deepEqual(edited(fields, [{ op: "remove", path: 'states."a.b"' }]), { states: { a: { b: { red: 2 } } } });
  assert.deepEqual(merged([set('"a.b"', 1)], [set("'a.b'", 2)]), [set("'a.b'", 2)]);
});

test("edits that follow an insertion do not change its value", () => {
  const starter = { haze: 0.5, more: { index: 1.5 } };
  const insert: Edit = { op: "insert", path: "layers", index: 0, value: starter };
  for (const fields of [{ layers: [{ haze: 1 }] }, {}] as Json[]) {
    const now = edited(fields, [insert, set("layers.0.haze", 0.9), set("layers.0.more.index", 2)]) as { layers: unknown[] };
    assert.deepEqual(now.layers[0], { haze: 0.9, more: { index: 2 } });
    assert.deepEqual(starter, { haze: 0.5, more: { index: 1.5 } });
  }
});
