// Labels of metrics are requested once, also those that are first shown while a request is in progress.

import assert from "node:assert/strict";
import { test } from "node:test";

import { labelText } from "../../src/state/labels.ts";

test("name that is shown while labels are requested gets its label, too", async () => {
  const asked: string[][] = [];
  const answers: (() => void)[] = [];
  globalThis.fetch = async (_, init) => {
    const { names } = JSON.parse(String(init?.body)) as { names: string[] };
    asked.push(names);
    await new Promise<void>((resolve) => answers.push(resolve));
    return Response.json(Object.fromEntries(names.map((name) => [name, { text: `label of ${name}` }])));
  };
  const turn = () => new Promise((resolve) => setTimeout(resolve, 5));
  labelText("white.first");
  labelText("white.second");
  await turn();
  labelText("white.third");
  await turn();
  assert.deepEqual(asked, [["white.first", "white.second"]]);
  answers[0]!();
  await turn();
  answers[1]!();
  await turn();
  assert.deepEqual(asked.slice(1), [["white.third"]]);
  const now = ["white.first", "white.second", "white.third"].map(labelText);
  assert.deepEqual(now, ["label of white.first", "label of white.second", "label of white.third"]);
  assert.equal(asked.length, 2);
});
