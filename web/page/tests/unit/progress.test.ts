import assert from "node:assert/strict";
import { test } from "node:test";

import { fractionOf } from "../../src/model/progress.ts";

test("the fraction of a run counts its views, and the square of the error within a view", () => {
  const at = (views_done: number, relative_error: number) => fractionOf({ views_done, views: 4, relative_error }, 0.01);
  assert.equal(at(0, Infinity), 0);
  assert.equal(at(1, 0.02), (1 + 0.25) / 4);
  // A view that has met its target may need another round, and the next view begins with a large error.
  assert.ok(at(1, 0.005) < 0.5 && at(2, 0.5) >= 0.5);
  assert.equal(at(4, 0.005), 1);
});
