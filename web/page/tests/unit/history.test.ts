// Undo and redo of whole texts.

import assert from "node:assert/strict";
import { test } from "node:test";

import { begin, record, redo, undo } from "../../src/state/history.ts";

test("undo and redo move by one step, and a change removes the redo steps", () => {
  let history = record(record(begin("a"), "b", ""), "c", "");
  history = undo(history);
  assert.equal(history.present, "b");
  history = undo(history);
  assert.equal(history.present, "a");
  assert.equal(undo(history), history);
  history = redo(history);
  assert.equal(history.present, "b");
  history = record(history, "d", "");
  assert.equal(redo(history), history);
  assert.equal(undo(history).present, "b");
});

test("gesture is one step, and the next one another step", () => {
  let history = begin("0");
  for (let i = 1; i <= 50; i++) history = record(history, String(i), "drag-1");
  history = record(history, "51", "drag-2");
  assert.deepEqual(history.past, ["0", "50"]);
  // Unchanged steps are the same lists, so that they are not stored again with each movement of a drag.
  const next = record(history, "52", "drag-2");
  assert.ok(next.past === history.past && next.future === history.future);
});

test("change of the same slider after an undo is a new step", () => {
  let history = record(begin("a"), "b", "haze");
  history = record(undo(history), "c", "haze");
  assert.equal(undo(history).present, "a");
});

test("number of steps is limited", () => {
  let history = begin("0");
  for (let i = 1; i < 1000; i++) history = record(history, String(i), "");
  assert.equal(history.past.length, 200);
});
