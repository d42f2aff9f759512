// CIEDE2000 compared with the published pairs of Sharma, Wu and Dalal 2005, table 1.

import assert from "node:assert/strict";
import { test } from "node:test";

import { deltaE2000, type Lab } from "../../src/model/difference.ts";

const PAIRS: [Lab, Lab, number][] = [
  [[50, 2.6772, -79.7751], [50, 0, -82.7485], 2.0425],
  [[50, -1.3802, -84.2814], [50, 0, -82.7485], 1.0],
  [[50, 0, 0], [50, -1, 2], 2.3669],
  [[50, 2.5, 0], [50, 0, -2.5], 4.3065],
  [[50, 2.5, 0], [73, 25, -18], 27.1492],
  [[60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644],
  [[22.7233, 20.0904, -46.694], [23.0331, 14.973, -42.5619], 2.0373],
  [[2.0776, 0.0795, -1.135], [0.9033, -0.0636, -0.5514], 0.9082],
];

test("difference of the published pairs is correct and symmetric", () => {
  for (const [one, other, expected] of PAIRS) {
    assert.ok(Math.abs(deltaE2000(one, other) - expected) < 5e-5, `${one}: ${deltaE2000(one, other)}`);
    assert.ok(Math.abs(deltaE2000(other, one) - expected) < 5e-5);
  }
});
