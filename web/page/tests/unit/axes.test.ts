import assert from "node:assert/strict";
import { test } from "node:test";

import { axesOf, listFrom, placeOf, pointAt, pointsOf, spaced, spacingOf, written } from "../../src/model/axes.ts";
import { logTicks, power, ticks } from "../../src/plots/axis.ts";
import { csv } from "../../src/model/csv.ts";
import { coloured } from "../../src/model/toml.ts";
import type { Json } from "../../src/model/json.ts";
import { lobePath, ray } from "../../src/model/rays.ts";
import { thousands } from "../../src/model/format.ts";

test("axes of a scenario are read with their spacings and written unchanged", () => {
  const axes: Json[] = [
    { "lighting.diffuse": [1, 0.5, 0], "lighting.directed.0.share": [0, 0.5, 1] },
    { "display.pixel.film.2.material": ["SiO2", "MgF2"] },
    { "display.diffuser.width": [0.01, 0.1, 1] },
  ];
  const read = axesOf({ sweep: { axes } })!;
  assert.deepEqual(
    read.map((axis) => axis.map(({ spacing }) => spacing)),
    [["range", "range"], ["list"], ["log"]],
  );
  assert.equal(pointsOf(read), 18);
  assert.deepEqual(written(read), axes);
  assert.equal(axesOf({ title: "none" }), null);
});

test("last axis of a sweep varies fastest", () => {
  const lengths = [5, 7, 2];
  for (let point = 0; point < 70; point++) assert.equal(pointAt(lengths, placeOf(lengths, point)), point);
  assert.deepEqual(placeOf(lengths, 15), [1, 0, 1]);
});

test("spaced values include both ends, and their spacing is recognised", () => {
  assert.deepEqual(spaced(0, 1, 5, false), [0, 0.25, 0.5, 0.75, 1]);
  assert.deepEqual(spaced(1, 1000, 4, true), [1, 10, 100, 1000]);
  assert.equal(spacingOf([1, 2, 4]), "log");
  assert.equal(spacingOf([1, 2, 5]), "list");
  assert.equal(spacingOf([1, 2]), "list");
});

test("typed list has numbers, words and truth values", () => {
  assert.deepEqual(listFrom("0.5, .7; 1e-3"), [0.5, 0.7, 0.001]);
  assert.deepEqual(listFrom('SiO2, "Cr:Johnson", true'), ["SiO2", "Cr:Johnson", true]);
  assert.equal(listFrom(" , "), null);
});

test("cells of a CSV file are quoted if necessary, and undefined ones are empty", () => {
  assert.equal(
    csv([
      ["a", 'b"c', "d,e"],
      [1.5, null, undefined],
      [NaN, true, ""],
    ]),
    'a,"b""c","d,e"\r\n1.5,,\r\n,true,\r\n',
  );
});

test("ticks are round, and powers of ten are written as powers", () => {
  assert.deepEqual(ticks(24.3, 28.9), [25, 26, 27, 28]);
  assert.deepEqual(logTicks(200, 3e6), [1000, 1e4, 1e5, 1e6]);
  assert.deepEqual(logTicks(0.3, 4), [0.5, 1, 2]);
  assert.deepEqual([0.01, 1, 100, 1e4, 1e-5].map(power), ["0.01", "1", "100", "10⁴", "10⁻⁵"]);
  assert.equal(thousands("21770.4"), "21\u2009770.4".replace("\u2009", thousands("21770.4")[2]!));
  assert.equal(thousands("1234.5"), "1234.5");
});

test("pieces of a line of TOML are the line", () => {
  for (const line of [
    'haze = 0.78  # wide = "no"',
    "[[sweep.axes]]",
    "a = \"x # y\", 'z'",
    "",
    "  { material = 1 },",
  ]) {
    assert.equal(
      coloured(line)
        .map(({ text }) => text)
        .join(""),
      line,
    );
  }
  assert.deepEqual(
    coloured('haze = "a"  # c').map(({ kind }) => kind),
    ["key", "plain", "string", "plain", "comment"],
  );
});

test("ray in a medium has the angle of Snell's law, and the peak of a lobe is in its direction", () => {
  const beta = -Math.sin((30 * Math.PI) / 180);
  const [, inGlass] = ray([100, 0], beta, [{ height: 60, index: 1.5 }]);
  const angle = Math.atan((100 - inGlass![0]) / 60);
  assert.ok(Math.abs(1.5 * Math.sin(angle) - 0.5) < 1e-9);
  assert.equal(lobePath([0, 0], { theta_deg: [0, 30], relative: [0.5, 1] }, 10), "M0.00 0.00L0.00 5.00L5.00 8.66Z");
});
