// The formats of numbers.

import assert from "node:assert/strict";
import { test } from "node:test";

import { count, digits, error, fixed, plain, signed, withError } from "../../src/model/format.ts";

test("number with fixed decimals has a typographic minus sign, and a missing number is a dash", () => {
  assert.equal(fixed(0.58624, 4), "0.5862");
  assert.equal(fixed(-9.062, 2), "−9.06");
  assert.equal(fixed(-0.0001, 2), "0.00");
  assert.equal(fixed(null, 2), "–");
  assert.equal(fixed(Number.NaN, 2), "–");
});

test("error is shown only if the decimals show it", () => {
  assert.equal(error(0.004, 2), "");
  assert.equal(error(0.006, 2), "± 0.01");
  assert.equal(withError(23.65, 0.12, 2), "23.65 ± 0.12");
  assert.equal(withError(null, 0.12, 2), "–");
});

test("difference has a sign unless it is zero", () => {
  assert.equal(signed(0.5, 1), "+0.5");
  assert.equal(signed(-0.5, 1), "−0.5");
  assert.equal(signed(0.001, 1), "0.0");
});

test("number has the requested significant digits", () => {
  assert.equal(digits(23.6538, 4), "23.65");
  assert.equal(digits(0.00123456, 3), "0.00123");
  assert.equal(digits(0, 3), "0");
  assert.equal(plain(12.150000000001), "12.15");
  assert.equal(count(1048576), "1 048 576");
});
