// A link holds a whole scenario, and nothing that is not one is unpacked.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";

import { packed, unpacked } from "../../src/state/link.ts";

const SCENARIOS = new URL("../../../../scenarios/", import.meta.url);

test("every example goes through a link unchanged", async () => {
  for (const name of readdirSync(SCENARIOS).filter((file) => file.endsWith(".toml"))) {
    const text = readFileSync(new URL(name, SCENARIOS), "utf8");
    const fragment = await packed(text);
    assert.match(fragment, /^s=[\w-]+$/);
    assert.equal(await unpacked(`#${fragment}`), text);
    assert.equal(await unpacked(`#token=abc&${fragment}`), text);
  }
});

test("letters beyond ASCII survive", async () => {
  assert.equal(await unpacked(await packed('title = "λ/4 → 55°"')), 'title = "λ/4 → 55°"');
});

test("other fragments hold nothing", async () => {
  assert.equal(await unpacked(""), null);
  assert.equal(await unpacked("#part"), null);
});

test("a small link that unpacks to very much is refused", async () => {
  await assert.rejects(unpacked(await packed("a".repeat(5_000_000))), /more than a scenario/);
});

test("a broken link is refused", async () => {
  await assert.rejects(unpacked("#s=AAAA"));
});
