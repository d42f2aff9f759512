// The lines of states can be distinguished without colour.

import assert from "node:assert/strict";
import { test } from "node:test";

import { stroke } from "../../src/model/states.ts";

test("each state has dashes of its own", () => {
  const known = ["white", "black", "red", "green", "blue", "cyan", "magenta", "yellow"];
  const others = ["orange", "violet", "a", "b", "c", "d", "e"];
  const dashes = [...known.map((name) => stroke(name, 0)), ...others.map((name, i) => stroke(name, i))].map(({ dash }) => dash.join());
  assert.equal(new Set(dashes).size, dashes.length, dashes.join(" | "));
});
