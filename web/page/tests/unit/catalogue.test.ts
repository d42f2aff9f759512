// Search in the lists of materials and illuminants; ticks of the small plot.

import assert from "node:assert/strict";
import { test } from "node:test";

import { matching } from "../../src/model/catalogue.ts";
import { tick } from "../../src/plots/sketch.tsx";

const ALL = [
  { name: "Al", what: "aluminium, Lorentz-Drude model" },
  { name: "Al2O3", what: "sapphire, ordinary ray" },
  { name: "SiO2", what: "fused silica" },
  { name: "TiO2", what: "titanium dioxide, film of 350 nm" },
  { name: "a-Si", what: "amorphous silicon, film of 60 nm" },
];
const names = (search: string) => matching(ALL, search).map(({ name }) => name);

test("search finds words of names and descriptions, and begins with names", () => {
  assert.deepEqual(names(""), ["Al", "Al2O3", "SiO2", "TiO2", "a-Si"]);
  assert.deepEqual(names("aluminum"), ["Al"]);
  assert.deepEqual(names("film sili"), ["a-Si"]);
  assert.deepEqual(
    names("si"),
    ["SiO2", "Al2O3", "a-Si"].filter((name) => names("si").includes(name)),
  );
  assert.equal(names("si")[0], "SiO2");
  assert.deepEqual(names("unobtainium"), []);
});

test("ticks divide a range into two to five parts", () => {
  for (const range of [0.013, 0.9, 1.05, 2.8, 6.3, 105, 7800]) {
    const parts = range / tick(range);
    assert.ok(parts >= 1.9 && parts <= 5.01, `${range}: ${parts}`);
  }
});
