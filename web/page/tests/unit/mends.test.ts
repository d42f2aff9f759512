// Buttons that add what a refusal misses.

import assert from "node:assert/strict";
import { test } from "node:test";

import { mendOf } from "../../src/model/mends.ts";

const missing = (path: string | null, what: string) => ({ message: `the key \`${what}\` is missing`, path });

test("all that is missing is added together", () => {
  const mend = mendOf([missing("display.front.0.gap_mm", "gap_mm"), missing("display.glass.thickness_mm", "thickness_mm")]);
  assert.equal(mend?.words, "no gap below the front, 0.5 mm of glass");
  assert.deepEqual(mend?.edits.map(({ path }) => path), ["display.front.0.gap_mm", "display.glass.thickness_mm"]);
});

test("nothing is offered if something else is wrong", () => {
  assert.equal(mendOf([]), null);
  assert.equal(mendOf([missing("display.glass.thickness_mm", "thickness_mm"), { message: "out of range", path: "a" }]), null);
  assert.equal(mendOf([missing("display.thickness_mm", "thickness_mm")]), null);
});
