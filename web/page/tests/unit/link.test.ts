// Links contain whole scenarios; other contents are refused.

import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";

import { packed, unpacked } from "../../src/state/link.ts";

const SCENARIOS = new URL("../../../../scenarios/", import.meta.url);

test("every example is restored from its link unchanged", async () => {
  for (const name of readdirSync(SCENARIOS).filter((file) => file.endsWith(".toml"))) {
    const text = readFileSync(new URL(name, SCENARIOS), "utf8");
    const fragment = await packed(text);
    assert.match(fragment, /^s=[\w-]+$/);
    assert.equal(await unpacked(`#${fragment}`), text);
    assert.equal(await unpacked(`#token=abc&${fragment}`), text);
  }
});

test("non-ASCII characters are restored", async () => {
  assert.equal(await unpacked(await packed('title = "λ/4 → 55°"')), 'title = "λ/4 → 55°"');
});

test("fragment without a scenario gives null", async () => {
  assert.equal(await unpacked(""), null);
  assert.equal(await unpacked("#part"), null);
});

test("small link that expands to a very large text is refused", async () => {
  await assert.rejects(unpacked(await packed("a".repeat(5_000_000))), /more than a scenario/);
});

test("broken link is refused", async () => {
  await assert.rejects(unpacked("#s=AAAA"));
});
