// The age of a content is that of the design for which it was computed.

import assert from "node:assert/strict";
import { test } from "node:test";

import { ageOf, ageOfRun, revisionOf } from "../../src/state/revision.ts";

const now = (text: string, isWaiting = false, isRefused = false) => ({
  revision: revisionOf(text, {}),
  isWaiting,
  isRefused,
});
const of = (text: string) => revisionOf(text, {});

test("content is current only for the text of the page, without changes that wait", () => {
  assert.equal(ageOf(of("a"), now("a")), "current");
  assert.equal(ageOf(of("a"), now("a", true)), "before");
  assert.equal(ageOf(of("a"), now("a", true, true)), "refused");
  assert.equal(ageOf(of("a"), now("b")), "before");
  assert.equal(ageOf(of("a"), now("b", true, true)), "before", "not of the last valid design, but of one before it");
  assert.equal(ageOf(of("a"), now("b"), true), "failed");
  assert.equal(ageOfRun(of("a"), now("a", true)), "earlier");
});

test("files of the design belong to its revision, others do not", () => {
  const text = 'file = "map.csv"';
  const withFiles = (ids: Record<string, string>) => revisionOf(text, ids);
  assert.equal(withFiles({ "map.csv": "1" }), withFiles({ "photograph.jpg": "2", "map.csv": "1" }));
  assert.notEqual(withFiles({ "map.csv": "1" }), withFiles({ "map.csv": "2" }));
  // A surface names the file of its heights.
  const ids = { "face.toml": "1", "heights.npy": "2" };
  assert.notEqual(revisionOf('surface = "face.toml"', ids), revisionOf('surface = "face.toml"', { ...ids, "heights.npy": "3" }));
});
