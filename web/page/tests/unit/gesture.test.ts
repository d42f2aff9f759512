// Where a gesture, which is one undo step, begins.

import assert from "node:assert/strict";
import { test } from "node:test";

import { byGesture, merged, type Change } from "../../src/state/edits.ts";
import { Beginnings } from "../../src/state/gesture.ts";

/** Numbers of the gestures at which `act` takes place. */
function counted(): { all: Beginnings; count: () => number } {
  let count = 0;
  return { all: new Beginnings(() => count++), count: () => count };
}

test("drag is one gesture, whatever keys are pressed meanwhile", () => {
  const { all, count } = counted();
  all.pointerDown();
  const now = count();
  all.keyDown("Alt", false, "");
  all.keyDown("ArrowUp", false, "");
  all.changed();
  assert.equal(count(), now);
  all.pointerUp();
  all.changed();
  all.pointerDown();
  assert.ok(count() > now);
});

test("each press of a key is a gesture, with its repetitions", () => {
  const { all, count } = counted();
  all.keyDown("ArrowUp", false, "box");
  for (let i = 0; i < 20; i++) all.keyDown("ArrowUp", true, "box");
  assert.equal(count(), 1);
  all.keyDown("ArrowUp", false, "box");
  assert.equal(count(), 2);
  all.keyDown("Shift", false, "");
  assert.equal(count(), 2);
});

test("typed value is one gesture, and the next one in the same box, another box or another line is another", () => {
  const { all, count } = counted();
  const typed = (box: { value: string; selectionStart: number; selectionEnd: number }, key: string, isText = false) => {
    all.keyDown(key, false, isText ? "text" : "box");
    all.beforeInput(box, isText);
    box.value = box.value.slice(0, box.selectionStart) + key + box.value.slice(box.selectionEnd);
    box.selectionStart = box.selectionEnd = box.selectionStart + 1;
  };
  const box = { value: "0.78", selectionStart: 0, selectionEnd: 4 };
  for (const key of "0.61") typed(box, key);
  assert.deepEqual([box.value, count()], ["0.61", 1]);
  box.selectionStart = 0;
  for (const key of "0.5") typed(box, key);
  assert.deepEqual([box.value, count()], ["0.5", 2]);
  const other = { value: "", selectionStart: 0, selectionEnd: 0 };
  for (const key of "12") typed(other, key);
  assert.equal(count(), 3);
  all.keyDown("Enter", false, "box");
  const before = count();
  const text = { value: "a = 1\nb = 2", selectionStart: 5, selectionEnd: 5 };
  for (const key of "23") typed(text, key, true);
  assert.equal(count(), before + 1);
  text.selectionStart = text.selectionEnd = text.value.length;
  for (const key of "34") typed(text, key, true);
  assert.equal(count(), before + 2);
});

test("changes of one key by different gestures stay apart", () => {
  const set = (value: number, gesture: string): Change => ({ op: "set", path: "haze", value, gesture });
  let all: Change[] = [];
  for (const [value, gesture] of [
    [1, "a"],
    [2, "a"],
    [3, "b"],
    [4, "c"],
    [5, "c"],
  ] as const)
    all = merged(all, [set(value, gesture)]);
  assert.deepEqual(
    byGesture(all).map((group) => group.map((one) => one.op === "set" && one.value)),
    [[2], [3], [5]],
  );
});
