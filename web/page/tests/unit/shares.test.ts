// Fractions with the sum 1 keep this sum if one of them is changed.

import assert from "node:assert/strict";
import { test } from "node:test";

import { balanced, lightShares, without } from "../../src/model/shares.ts";
import { edited } from "../../src/state/edits.ts";
import type { Json } from "../../src/model/json.ts";

const ROOM = {
  lighting: {
    diffuse: 0.5,
    directed: [
      { theta_deg: -20, share: 0.3 },
      { theta_deg: 40, share: 0.2 },
    ],
    environment: [],
  },
};
const sum = (fields: Json) => [...lightShares(fields).values()].reduce((total, share) => total + share, 0);

test("change of a fraction scales the others in proportion", () => {
  const now = edited(ROOM, balanced(lightShares(ROOM), "lighting.directed.0.share", 0.65));
  const shares = lightShares(now);
  assert.equal(shares.get("lighting.diffuse"), 0.25);
  assert.equal(shares.get("lighting.directed.1.share"), 0.1);
  assert.ok(Math.abs(sum(now) - 1) < 1e-9);
});

test("sum is 1 for any value, also after a source has had all the light", () => {
  let now: Json = ROOM;
  for (const value of [1 / 3, 0.123457, 1, 0, 0.7]) {
    now = edited(now, balanced(lightShares(now), "lighting.directed.1.share", value));
    assert.ok(Math.abs(sum(now) - 1) < 1e-9, `${value}: ${sum(now)}`);
    for (const share of lightShares(now).values()) assert.ok(share >= 0);
  }
});

test("removed source leaves its fraction to the others", () => {
  const now = edited(ROOM, without(ROOM, "lighting.directed.0"));
  assert.equal(lightShares(now).size, 2);
  assert.ok(Math.abs(sum(now) - 1) < 1e-9);
});

test("missing diffuse fraction is the remainder", () => {
  assert.equal(lightShares({ lighting: { directed: [{ share: 0.25 }] } }).get("lighting.diffuse"), 0.75);
});
