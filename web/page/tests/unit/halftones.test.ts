// Which halftones of the picture are shown, one after the other.

import assert from "node:assert/strict";
import { test } from "node:test";

import { DEFAULT, SEARCH, stepsOf } from "../../src/model/halftones.ts";

const of = (more: object) => stepsOf({ chosen: null, own: DEFAULT, hasMatrix: true, text: 'title = "a"\n', ...more });

test("default is shown before the search, unless a halftone is named", () => {
  assert.deepEqual(of({}), [DEFAULT, SEARCH]);
  assert.deepEqual(of({ chosen: SEARCH }), [DEFAULT, SEARCH]);
  assert.deepEqual(of({ chosen: "none" }), ["none"]);
  assert.deepEqual(of({ chosen: DEFAULT }), [DEFAULT]);
  // Named by the scenario, or by its kernel.
  assert.deepEqual(of({ text: `[image]\nhalftone = "${DEFAULT}"\n` }), [DEFAULT]);
  assert.deepEqual(of({ text: `image = { halftone = "${SEARCH}" }\n`, own: SEARCH }), [DEFAULT, SEARCH]);
  assert.deepEqual(of({ text: '[image]\nkernel = "burkes"\n', own: "error-diffusion" }), ["error-diffusion"]);
  // The search needs the size of the pixels.
  assert.deepEqual(of({ hasMatrix: false }), [DEFAULT]);
  assert.deepEqual(of({ hasMatrix: false, chosen: SEARCH }), [DEFAULT, SEARCH]);
  // A text that is being typed.
  assert.deepEqual(of({ text: '[image\nhalftone = "ordered"\n', own: "ordered" }), ["ordered"]);
});
