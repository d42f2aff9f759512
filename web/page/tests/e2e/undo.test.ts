// Undo is by gesture, Save needs no server, and designs under Earlier can be told apart.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { withValue, valuesOf } from "../../src/model/toml-set.ts";
import { choose, saved, settled, stage, type, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const HAZE = "display.diffuser.haze";
const GLASS = "display.glass.index";

/** Waits until all changes are in the text. */
async function taken(page: Page): Promise<void> {
  await page.waitForFunction(() => {
    const { draft, pending } = JSON.parse(sessionStorage.getItem("papilio.tab") ?? "{}") as {
      draft?: unknown;
      pending?: unknown[];
    };
    return draft === null && pending?.length === 0;
  });
}

/** The text of the design in the storage of the browser. */
const textOf = (page: Page): Promise<string> =>
  page.evaluate(() => (JSON.parse(sessionStorage.getItem("papilio.tab")!) as { text: string }).text);

/** Undoes one step and returns the value of a key. */
async function undone(page: Page, key: string): Promise<string> {
  const before = await textOf(page);
  await page.getByRole("button", { name: "Undo" }).click();
  await page.waitForFunction(
    (before) => (JSON.parse(sessionStorage.getItem("papilio.tab")!) as { text: string }).text !== before,
    before,
  );
  await taken(page);
  return new RegExp(`^${key} = (\\S+)`, "m").exec(await textOf(page))![1]!;
}

const noMore = async (page: Page): Promise<void> =>
  assert.ok(await page.getByRole("button", { name: "Undo" }).isDisabled(), "there are more steps");

test("slow drag is one step", { timeout: 60_000 }, async () => {
  const page = await on.visit();
  const first = /^theta_deg = (\S+)/m.exec(await textOf(page))![1]!;
  const box = (await page.locator('[data-handle="lighting.directed.0.theta_deg"] .target').boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 4; i++) {
    await page.mouse.move(x - 12 * i, y + 8 * i);
    await taken(page);
    await page.waitForTimeout(1700);
  }
  await page.mouse.up();
  await taken(page);
  assert.equal(await undone(page, "theta_deg"), first);
  await noMore(page);
});

test("each quick step is its own, also while the server is slow; a key that is held is one", { timeout: 60_000 }, async () => {
  const page = await on.visit();
  await page.route("**/api/v1/live", async (route) => {
    await new Promise((resolve) => setTimeout(resolve, 600));
    await route.continue().catch(() => undefined);
  });
  const field = page.locator(`[id="f-${HAZE}"]`);
  await field.focus();
  for (let i = 0; i < 3; i++) await page.keyboard.press("ArrowUp");
  await taken(page);
  const values = [await field.inputValue()];
  for (let i = 0; i < 3; i++) values.push(await undone(page, "haze"));
  const numbers = values.map(Number);
  assert.equal(numbers[3], 0.78);
  for (let i = 0; i < 3; i++) assert.ok(numbers[i]! > numbers[i + 1]!, values.join());
  await noMore(page);
  // Repetitions of a key.
  await field.focus();
  for (let i = 0; i < 5; i++) await page.keyboard.down("ArrowUp");
  await page.keyboard.up("ArrowUp");
  await taken(page);
  assert.equal(await undone(page, "haze"), "0.78");
  await noMore(page);
});

test("each typed value is one step", { timeout: 60_000 }, async () => {
  const page = await on.visit();
  const field = page.locator(`[id="f-${HAZE}"]`);
  await field.click();
  for (const value of ["0.61", "0.52", "0.43"]) {
    await page.keyboard.press("Control+a");
    await page.keyboard.type(value);
  }
  await taken(page);
  for (const value of ["0.52", "0.61", "0.78"]) assert.equal(await undone(page, "haze"), value);
  await noMore(page);
  // In three boxes, without a pause.
  await type(page, HAZE, "0.7");
  await type(page, "display.diffuser.total_transmittance", "0.8");
  await type(page, HAZE, "0.6");
  await taken(page);
  assert.equal(await undone(page, "haze"), "0.7");
  assert.equal(await undone(page, "total_transmittance"), "0.90");
  assert.equal(await undone(page, "haze"), "0.78");
  await noMore(page);
});

test("lines that are typed in the text are steps", { timeout: 60_000 }, async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "TOML" }).click();
  const source = page.locator("#source");
  const to = (words: string) =>
    source.evaluate((area: HTMLTextAreaElement, words) => {
      area.focus();
      const at = area.value.indexOf(words) + words.length;
      area.setSelectionRange(at, at);
    }, words);
  await to("haze = 0.78");
  await page.keyboard.type("12");
  await to("total_transmittance = 0.90");
  await page.keyboard.type("1");
  await taken(page);
  assert.match(await textOf(page), /haze = 0\.7812[\s\S]*total_transmittance = 0\.901/);
  assert.equal(await undone(page, "total_transmittance"), "0.90");
  assert.equal(await undone(page, "haze"), "0.78");
  await noMore(page);
});

test("Save has the design while the server is dead, with the changes that it has not seen", { timeout: 60_000 }, async () => {
  const page = await on.visit();
  await type(page, HAZE, "0.61");
  await taken(page);
  await on.kill();
  try {
    assert.match(await saved(page), /haze = 0\.61 +# a lobe/);
    await type(page, HAZE, "0.62");
    await page.locator('[data-part="display.glass"]').click();
    await type(page, GLASS, "1.6");
    await choose(page, "Add layer", "component");
    const text = await saved(page);
    assert.match(text, /^# Changes that were not applied, because Papilio did not respond:\n# +\{"op":"insert","path":"display.front"/);
    assert.match(text, /haze = 0\.62 +# a lobe/);
    assert.match(text, /index = 1\.6\b/);
    await page.locator(".said", { hasText: "Papilio does not respond" }).waitFor();
  } finally {
    await on.revive();
  }
  await taken(page);
  assert.match(await saved(page), /haze = 0\.62\b/);
  on.complaints.splice(0);
});

test("Save has the text as it is typed, with its mistakes", async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "TOML" }).click();
  await page.locator("#source").fill("broken =");
  assert.equal(await saved(page), "broken =");
  on.complaints.splice(0);
});

test("values that the page replaces are those of the server, in every example", { timeout: 120_000 }, async () => {
  const ask = async (path: string, body?: unknown): Promise<unknown> => {
    const headers = { "Content-Type": "application/json" };
    const init = body === undefined ? {} : { method: "POST", headers, body: JSON.stringify(body) };
    return (await fetch(`${on.url}api/v1/${path}`, init)).json();
  };
  const examples = (await ask("examples")) as { name: string }[];
  let count = 0;
  for (const { name } of examples) {
    const { scenario } = (await ask(`examples/${name}`)) as { scenario: string };
    for (const [path, [from, to]] of valuesOf(scenario)) {
      if (!/^[-+0-9.e]+$/.test(scenario.slice(from, to))) continue;
      count += 1;
      if (count % 5 > 0) continue;
      const edits = [{ op: "set", path, value: 0.125 }];
      const edited = (await ask("edit", { scenario, edits })) as { scenario?: string };
      assert.equal(withValue(scenario, path, 0.125), edited.scenario, `${name}: ${path}`);
    }
  }
  assert.ok(count > 500, String(count));
});

test("designs under Earlier have their own titles, and what was changed in them", { timeout: 60_000 }, async () => {
  const page = await on.visit();
  const context = page.context();
  const tabs = await Promise.all(["0.6", "0.5"].map(async (haze) => [haze, await context.newPage()] as const));
  for (const [, other] of tabs) {
    await other.goto(on.url);
    await other.locator(".bench").waitFor();
  }
  for (const [haze, other] of tabs) {
    if (haze === "0.5") await other.locator(".title").fill("Less haze");
    await type(other, HAZE, haze);
    await taken(other);
    await other.close();
  }
  await page.bringToFront();
  await page.getByRole("button", { name: "Earlier" }).click();
  const items = await page.locator(".menu [data-item]").allInnerTexts();
  assert.ok(items.some((words) => /^Indoor reading[\s\S]*haze = 0\.6$/.test(words)), items.join("|"));
  assert.ok(items.some((words) => /^Less haze[\s\S]*haze = 0\.5$/.test(words)), items.join("|"));
  await settled(page);
});
