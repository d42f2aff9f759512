// Figures are not drawn narrower than their words can be read.

import assert from "node:assert/strict";
import { test } from "node:test";

import { leastWidth } from "../../src/model/figure-width.ts";

test("figure in a narrow column is as wide as its words need, and no wider than a large one", () => {
  const of = (width: number) => leastWidth(`<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="300" viewBox="0 -20 ${width} 300">`);
  // 12 px letters of a figure of 460 px are 8.4 px high in 322 px: it fits a phone of 390 px.
  assert.deepEqual([of(460), of(760), of(1400)], [322, 532, 620]);
  assert.equal(leastWidth('<svg viewBox="0 0 500 300"/>'), 350);
  assert.equal(leastWidth("no figure"), 620);
});
