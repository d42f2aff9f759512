// The variables of a fit are read from a scenario and written back as they were.

import assert from "node:assert/strict";
import { test } from "node:test";

import { correlated, decimalsOf, variablesOf, written } from "../../src/model/fit.ts";

const NONE = { keys: null, compensated_by: null, prior: null };

test("variables of a scenario are written as they were read", () => {
  const fields = {
    fit: {
      starts: 8,
      variables: [
        { ...NONE, key: "display.pixel.gap_nm.red", bounds: [250, 300] },
        { ...NONE, key: "meter.scale", bounds: [0.95, 1.05], prior: { mean: 1, sigma: 0.005 } },
        { ...NONE, key: null, keys: ["a.b", "a.c"], bounds: [0, 1] },
        { ...NONE, key: "a.d", compensated_by: "a.e", bounds: [0, 1] },
      ],
    },
  };
  const read = variablesOf(fields)!;
  assert.deepEqual(read.map(({ key }) => key), ["display.pixel.gap_nm.red", "meter.scale", "a.b", "a.d"]);
  assert.deepEqual(written(read), [
    { key: "display.pixel.gap_nm.red", bounds: [250, 300] },
    { key: "meter.scale", prior: { mean: 1, sigma: 0.005 }, bounds: [0.95, 1.05] },
    { keys: ["a.b", "a.c"], bounds: [0, 1] },
    { key: "a.d", compensated_by: "a.e", bounds: [0, 1] },
  ]);
  assert.equal(variablesOf({}), null);
  assert.equal(variablesOf({ fit: { variables: [] } }), null);
});

test("numbers show two digits of their errors, and the strongest correlations come first", () => {
  assert.deepEqual([0.21029, 2.04, 25, 0.00426, 0].map(decimalsOf), [2, 1, 0, 4, 5]);
  const rows = [
    [1, 0.95, null],
    [0.95, 1, -0.99],
    [null, -0.99, 1],
  ];
  assert.deepEqual(correlated(rows, 0.9), [
    { pair: [1, 2], value: -0.99 },
    { pair: [0, 1], value: 0.95 },
  ]);
  assert.deepEqual(correlated(rows, 0.999), []);
});
