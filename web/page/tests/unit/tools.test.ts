// Steps, tools, metrics and studies.

import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { test } from "node:test";

import { galleryOf, GROUPS, patchesOf } from "../../src/model/gallery.ts";
import { grouped, groupOf, matches, meets, WHOLE } from "../../src/model/metrics.ts";
import { keyOf, numberFrom, spreadOf, withSpread } from "../../src/model/study.ts";
import { tableText } from "../../src/model/toml-table.ts";
import { argument, commandFor, stepOf, STEPS, toolOf, TOOLS } from "../../src/model/tools.ts";

test("every tool belongs to one step, and its command names the file", () => {
  const ids = TOOLS.map(({ id }) => id);
  assert.equal(new Set(ids).size, ids.length);
  for (const { id } of TOOLS) assert.ok(stepOf(id).tools.includes(toolOf(id)), id);
  assert.deepEqual(STEPS.map(({ name }) => name), ["Start", "Design", "See", "Check", "Improve", "Share"]);
  assert.equal(commandFor("papilio run FILE --report", "a.toml"), "papilio run a.toml --report");
  assert.equal(argument("my $& picture's.png"), "'my $& picture'\\''s.png'");
  assert.equal(commandFor("papilio run FILE", "$& a.toml"), "papilio run '$& a.toml'");
});

test("gallery has every example once, those without a group in the last one", () => {
  const known = GROUPS.flatMap(({ examples }) => examples);
  assert.equal(new Set(known).size, known.length);
  const groups = galleryOf(["indoor", "unknown"]);
  assert.deepEqual(groups.map(({ examples }) => examples), [["indoor"], ["unknown"]]);
});

test("every example has the colours of its states (npm run thumbnails)", () => {
  const files = readdirSync(new URL("../../../../scenarios/", import.meta.url)).filter((name) => name.endsWith(".toml"));
  assert.ok(files.length > 60);
  const without = files.map((name) => name.replace(".toml", "")).filter((name) => !patchesOf(name).every((one) => /^#[0-9a-f]{6}$/.test(one)) || patchesOf(name).length === 0);
  assert.deepEqual(without, []);
});

test("metrics are found by words in any order, without their marks", () => {
  assert.ok(matches("Gamut area, u′v′ (% of sRGB) gamut_percent_srgb", "srgb gamut"));
  assert.ok(matches("Lightness L* of white", "white l"));
  assert.ok(matches("Gamut area, u′v′", "uv"));
  assert.ok(!matches("Contrast ratio", "contrast red"));
  assert.equal(groupOf("white.Y"), "white");
  assert.deepEqual([...grouped(["contrast_ratio", "white.Y", "red.Y", "white.L_star"]).keys()], [WHOLE, "white", "red"]);
});

test("target is met, missed, or unknown", () => {
  assert.equal(meets(11, { kind: "at_least", value: 10 }), true);
  assert.equal(meets(11, { kind: "at_most", value: 10 }), false);
  assert.equal(meets(null, { kind: "at_least", value: 10 }), null);
});

test("table of a scenario is shown as it is written, with its sub-tables", () => {
  const text = '[a]\nx = 1\n[optimize] # best\nstarts = 2\n[[optimize.variables]]\nkey = "k"\n[b]\ny = 2\n';
  assert.equal(tableText(text, "optimize"), '[optimize] # best\nstarts = 2\n[[optimize.variables]]\nkey = "k"');
  assert.equal(tableText(text, "sweep"), "");
});

test("distributions are read and written; others are left alone", () => {
  const key = { name: "a", key: "k", normal: { sigma: 0.02 } };
  assert.deepEqual(spreadOf(key), { kind: "normal", width: 0.02 });
  assert.deepEqual(withSpread(key, "uniform", 1), { name: "a", key: "k", uniform: { plus_minus: 1 } });
  assert.equal(spreadOf({ key: "k", normal: { sigma: 1, from: -2 } }), null);
  assert.equal(keyOf({ keys: ["a", "b"] }), "a");
  assert.equal(numberFrom("0,5"), 0.5);
  assert.equal(numberFrom(""), null);
});
