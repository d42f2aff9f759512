// The whole bench as one file: opened in another browser it is the same; broken, foreign and newer files change nothing.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";

import { strToU8, unzipSync, zipSync } from "fflate";
import type { Page } from "playwright-core";

import { downloaded, example, figure, PAPILIO, ROOT, saved, settled, stage, tool, type, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const DIFFUSER = join(ROOT, "scenarios/data/H65.bsdf");

/** Makes a bench: a measured diffuser in the design, two versions, a target, rooms. */
async function made(page: Page): Promise<Buffer> {
  await page.getByRole("button", { name: "Keep this version" }).click();
  await page.locator("[data-version]").waitFor();
  await example(page, "measured-h78");
  await settled(page);
  await page.locator("input[type=file]").first().setInputFiles({ name: "mine.bsdf", mimeType: "", buffer: readFileSync(DIFFUSER) });
  await page.locator(".file .words").waitFor({ timeout: 60_000 });
  await page.locator(".file").getByRole("button", { name: /as the diffuser/i }).click();
  await settled(page);
  await page.getByRole("button", { name: "Keep this version" }).click();
  await page.locator("[data-version]").nth(1).waitFor();
  const contrast = page.locator('[data-figure="Contrast : 1"]');
  await contrast.getByRole("button", { name: "Contrast" }).click();
  await contrast.getByLabel("Target of Contrast", { exact: true }).fill("30");
  await contrast.getByRole("button", { name: "Set", exact: true }).click();
  await tool(page, "rooms");
  for (const room of ["indoor", "living-room", "overcast", "sunny"]) await page.getByRole("checkbox", { name: room, exact: true }).uncheck();
  await tool(page, "export");
  return (await downloaded(page, () => page.getByRole("button", { name: "Save the bench" }).click())).bytes;
}

const give = (page: Page, name: string, buffer: Uint8Array) =>
  page.locator("input[type=file]").first().setInputFiles({ name, mimeType: "", buffer: Buffer.from(buffer) });

test("bench is opened in another browser: design, versions, numbers, rooms and data; the designs run on the command line", { timeout: 240_000 }, async () => {
  const page = await on.visit();
  const bytes = await made(page);
  await tool(page, "states");
  await settled(page);
  const [scenario, white] = [await saved(page), await figure(page, "White % Y")];
  assert.match(scenario, /mine\.bsdf/);

  const folder = mkdtempSync(join(tmpdir(), "papilio-"));
  const files = unzipSync(bytes);
  for (const [name, contents] of Object.entries(files)) {
    mkdirSync(dirname(join(folder, name)), { recursive: true });
    writeFileSync(join(folder, name), contents);
  }
  const designs = Object.keys(files).filter((name) => name.startsWith("designs") && name.endsWith(".toml"));
  assert.equal(designs.length, 3, designs.join());
  for (const name of designs) execFileSync(PAPILIO, ["run", join(folder, name), "--json"], { stdio: ["ignore", "ignore", "ignore"] });
  assert.deepEqual(files["designs/mine.bsdf"], new Uint8Array(readFileSync(DIFFUSER)));

  // The server has never seen the files, and the other browser has a design of its own.
  await on.restart();
  const other = await on.visit();
  await type(other, "display.diffuser.haze", "0.61");
  await settled(other);
  await give(other, "ours.papilio", bytes);
  await other.locator(".said", { hasText: "of ours.papilio is open, and 2 versions are added" }).waitFor({ timeout: 60_000 });
  await settled(other);
  assert.equal(await saved(other), scenario);
  assert.equal(await figure(other, "White % Y"), white);
  assert.equal(await other.locator("[data-version]").count(), 2);
  await other.locator('[data-figure="Contrast : 1"]', { hasText: "at least 30" }).waitFor();
  await tool(other, "rooms");
  assert.equal(await other.getByRole("checkbox", { name: "sunny", exact: true }).isChecked(), false);
  assert.equal(await other.getByRole("checkbox", { name: "office", exact: true }).isChecked(), true);
  // A version with its own file, after a reload and another restart of the server.
  await other.reload();
  await other.locator(".bench").waitFor();
  await on.restart();
  await other.getByRole("button", { name: /^Show .*2$|^Show .*H78/ }).first().click();
  await other.locator(".said", { hasText: "is open. Undo" }).waitFor({ timeout: 30_000 });
  // The design of the other browser is not lost.
  await other.getByRole("button", { name: "Earlier" }).click();
  await other.locator(".menu [data-item]").first().click();
  await other.locator(".said", { hasText: "is open again" }).waitFor();
  await settled(other);
  assert.match(await saved(other), /haze = 0\.61/);
  // Opened twice: no version is there twice.
  await give(other, "ours.zip", bytes);
  await other.locator(".said", { hasText: "of ours.zip is open. The previous" }).waitFor({ timeout: 60_000 });
  assert.equal(await other.locator("[data-version]").count(), 2);
  on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((one) => !/ERR_|404|410|503/.test(one)));
  assert.deepEqual(on.complaints, []);
});

test("broken, foreign, newer and overfull benches change nothing, and say why", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  const bytes = await (async () => {
    await tool(page, "export");
    return (await downloaded(page, () => page.getByRole("button", { name: "Save the bench" }).click())).bytes;
  })();
  const files = unzipSync(bytes);
  const list = JSON.parse(Buffer.from(files["bench.json"]!).toString()) as { designs: { kept: string | null; name: string }[] };
  const changed = (more: object) => zipSync({ ...files, "bench.json": strToU8(JSON.stringify({ ...list, ...more })) });
  const [one] = list.designs;
  const many = Array.from({ length: 25 }, (_, i) => ({ ...one, name: `v${i}`, kept: "2026-01-01T00:00:00.000Z" }));
  const unreadable = { ...one, data: [{ name: "x.bsdf", sha256: "0", of_program: false }] };
  const before = await saved(page);
  const cases: [string, Uint8Array, RegExp][] = [
    ["cut.papilio", bytes.subarray(0, bytes.length / 2), /incomplete: its end is missing\. Nothing was changed/],
    ["text.papilio", strToU8("hello"), /not a zip archive\. Nothing/],
    ["foreign.zip", zipSync({ "a.txt": strToU8("a") }), /not a bench of Papilio: it has no bench\.json\. Nothing/],
    ["newer.papilio", changed({ version: 9 }), /newer Papilio.*Update Papilio\. Nothing/],
    ["many.papilio", changed({ designs: many }), /adds 25 versions, and 24 can be stored: remove 1 first\. Nothing/],
    [
      "unreadable.papilio",
      zipSync({ ...unzipSync(changed({ designs: [unreadable] })), "designs/x.bsdf": strToU8("\0\0") }),
      /has a file that Papilio cannot read, x\.bsdf: .*Nothing/,
    ],
  ];
  for (const [name, contents, expected] of cases) {
    await give(page, name, contents);
    await page.waitForFunction((name) => document.querySelector(".said")?.textContent?.match(new RegExp(`^${name}.*Nothing was changed`)), name);
    assert.match(await page.locator(".said").innerText(), expected);
    assert.equal(await saved(page), before, name);
    assert.equal(await page.locator("[data-version]").count(), 0, name);
  }
  await tool(page, "files");
  assert.equal(await page.locator(".file").count(), 0);
  on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((one) => !/422|503/.test(one)));
  assert.deepEqual(on.complaints, []);
});
