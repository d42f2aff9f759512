// Usability: keyboard, error messages at their fields, accessibility (axe), light and dark theme, screen sizes.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import PATCHES_OF from "../../src/model/patches.json";
import { TOOLS } from "../../src/model/tools.ts";
import { changed, example, examples, figure, itemsOf, patches, saved, settled, stage, type Stage, tool, type } from "./stage.ts";

const PATCHES: Readonly<Record<string, readonly string[]>> = PATCHES_OF;
let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

async function violations(page: Page): Promise<string[]> {
  await page.evaluate(AXE);
  return page.evaluate(async () => {
    const { violations } = await (
      window as unknown as { axe: { run(): Promise<{ violations: { id: string; nodes: { html: string }[] }[] }> } }
    ).axe.run();
    return violations.flatMap(({ id, nodes }) => nodes.map(({ html }) => `${id}: ${html.slice(0, 160)}`));
  });
}

const TABS = TOOLS.map(({ id }) => id);

for (const colorScheme of ["light", "dark"] as const) {
  test(`page has no axe violations, ${colorScheme}`, async () => {
    const page = await on.visit({ colorScheme });
    assert.deepEqual(await violations(page), []);
    for (const tab of TABS) {
      await tool(page, tab);
      await settled(page);
      assert.deepEqual(await violations(page), [], tab);
    }
    for (const part of ["Pixel", "Drive states", "Ambient light", "Viewer", "Computation"]) {
      await page.getByRole("navigation").getByRole("button", { name: part }).click();
      assert.deepEqual(await violations(page), [], part);
    }
    await page.getByRole("button", { name: "Above" }).click();
    assert.deepEqual(await violations(page), [], "from above");
    await page.getByRole("button", { name: "TOML" }).click();
    assert.deepEqual(await violations(page), [], "TOML");
    // Fine detail of a display without thickness.
    on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((words) => !/status of 422/.test(words)));
  });
}

for (const colorScheme of ["light", "dark"] as const)
  test(`versions side by side, jobs and liquid crystals have no axe violations, ${colorScheme}`, { timeout: 120_000 }, async () => {
    const page = await on.visit({ colorScheme });
    await page.getByRole("button", { name: "Keep this version" }).click();
    await page.locator("[data-version]").waitFor();
    await page.getByRole("button", { name: "Side by side" }).first().click();
    await page.locator('[data-column][aria-busy="false"]').nth(1).waitFor({ timeout: 30_000 });
    assert.deepEqual(await violations(page), [], "side by side");
    await tool(page, "jobs");
    await page.getByLabel("Command", { exact: true }).selectOption("pixel");
    await page.getByRole("button", { name: "Start the job" }).click();
    await page.locator('[data-job="pixel"][data-phase="done"]').first().waitFor({ timeout: 60_000 });
    await page.locator('[data-job="pixel"] .fold').first().click();
    await page.locator('[data-job="pixel"] img.drawn').first().waitFor();
    assert.deepEqual(await violations(page), [], "job");
    await example(page, "mip-lcd");
    await page.locator('[data-part="display.pixel.stack.4"] .directors').waitFor();
    await page.locator('[data-part="display.pixel.stack.4"]').click();
    await settled(page);
    assert.deepEqual(await violations(page), [], "cell");
    await page.getByRole("button", { name: "Add layer" }).click();
    await page.locator('.menu [aria-disabled="true"]').first().waitFor({ timeout: 20_000 });
    assert.deepEqual(await violations(page), [], "menu of layers");
    // Layers that are refused are tried until the page is closed.
    await page.close();
    on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((words) => !/status of 422/.test(words)));
  });

/** Presses Tab until the focus is on an element. */
async function tabTo(page: Page, selector: string): Promise<void> {
  for (let i = 0; i < 250; i++) {
    if (await page.evaluate((selector) => document.activeElement?.matches(selector) ?? false, selector)) return;
    await page.keyboard.press("Tab");
  }
  assert.fail(`the keyboard does not reach ${selector}`);
}

test("keyboard alone changes a source and a field and selects a layer and a tab", async () => {
  const page = await on.visit();
  let gamut = await figure(page, "Gamut % sRGB");
  await tabTo(page, '[data-handle="lighting.directed.0.theta_deg"]');
  await page.keyboard.press("Shift+ArrowLeft");
  gamut = await changed(page, "Gamut % sRGB", gamut);
  await tabTo(page, '[data-part="display.pixel.film.0"]');
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await tabTo(page, '[id="f-display.pixel.film.1.thickness_nm"]');
  await page.keyboard.press("ArrowUp");
  gamut = await changed(page, "Gamut % sRGB", gamut);
  await settled(page);
  const scenario = await saved(page);
  assert.match(scenario, /theta_deg = -25/);
  assert.match(scenario, /thickness_nm = 13\.15/);
  await tabTo(page, "#tab-states");
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.locator('[role="tab"][aria-selected="true"]').innerText(), "Spectra");
  await tabTo(page, '[data-step="improve"]');
  await page.keyboard.press("Enter");
  assert.equal(await page.locator('[role="tab"][aria-selected="true"]').innerText(), "Sweep");
  assert.deepEqual(on.complaints, []);
});

test("boxes of numbers are described by their units and their help", async () => {
  const page = await on.visit();
  await page.getByRole("button", { name: "Pixel", exact: true }).click();
  const described = await page.locator(".editor .box input").evaluateAll((all) =>
    all.map((box) => {
      const ids = box.getAttribute("aria-describedby")?.split(" ") ?? [];
      const label = document.querySelector(`label[for="${CSS.escape(box.id)}"]`)?.textContent ?? box.getAttribute("aria-label");
      return { label, unit: box.parentElement!.querySelector(".unit")?.textContent ?? "", words: ids.map((id) => document.getElementById(id)?.textContent ?? "") };
    }),
  );
  assert.ok(described.length > 5);
  for (const { label, unit, words } of described) {
    assert.ok(label, "a box without a label");
    assert.ok(unit === "" || words.includes(unit), `${label} is read without its unit ${unit}: ${words.join()}`);
  }
  assert.ok(described.some(({ label, unit }) => label === "red" && unit === "nm"));
});

test("moving through a menu selects nothing, and the focus returns to its button", async () => {
  const page = await on.visit();
  const scenario = await saved(page);
  await tool(page, "image");
  const focused = () => page.evaluate(() => (document.activeElement as HTMLElement).dataset["item"] ?? "");
  let downloads = 0;
  page.on("download", () => (downloads += 1));
  for (const name of ["Light:", "Add layer", "Add source", "Download files of the picture"]) {
    const button = page.getByRole("button", { name });
    const items = await itemsOf(page, name);
    await button.focus();
    await page.keyboard.press("ArrowDown");
    assert.equal(await button.getAttribute("aria-expanded"), "true", name);
    assert.equal(await focused(), items[0]);
    assert.deepEqual(await violations(page), [], name);
    await page.keyboard.press("ArrowDown");
    assert.equal(await focused(), items[1]);
    await page.keyboard.press("End");
    assert.equal(await focused(), items.at(-1));
    await page.keyboard.press("ArrowDown");
    assert.equal(await focused(), items[0]);
    await page.keyboard.press("ArrowUp");
    assert.equal(await focused(), items.at(-1));
    await page.keyboard.press("s");
    await page.keyboard.press("Escape");
    assert.equal(await page.getByRole("menu").count(), 0);
    assert.ok(await button.evaluate((e) => e === document.activeElement), name);
    // Letters and arrows on the button itself select nothing either.
    await page.keyboard.press("s");
    await page.keyboard.press("ArrowUp");
    // A menu with a current item opens at it: the design has the light of this preset.
    assert.equal(await focused(), name === "Light:" ? "indoor" : items.at(-1));
    await page.keyboard.press("Tab");
    assert.equal(await page.getByRole("menu").count(), 0);
  }
  assert.equal(downloads, 0);
  assert.equal(await saved(page), scenario);

  // Enter and Space select.
  await page.getByRole("button", { name: "Light:" }).focus();
  await page.keyboard.press("Enter");
  await page.keyboard.press("s");
  const room = await focused();
  assert.match(room, /^s/);
  await page.keyboard.press("Space");
  const chosen = page.getByRole("button", { name: `Light: ${room}` });
  await chosen.waitFor();
  assert.ok(await chosen.evaluate((e) => e === document.activeElement), "the focus returns to the button of the menu");
  assert.match(await saved(page), new RegExp(`preset = "${room}"`));
  await chosen.focus();
  await page.keyboard.press("ArrowDown");
  assert.equal(await focused(), room, "the current item has the focus");
  await page.mouse.click(700, 500);
  assert.equal(await page.getByRole("menu").count(), 0, "a click outside closes the menu");
});

test("error is shown at its field with a hint, and the change can be discarded", async () => {
  const page = await on.visit();
  const first = await figure(page, "Gamut % sRGB");
  await page.locator('[data-part="display.pixel.film.1"]').click();
  await type(page, "display.pixel.film.1.thickness_nm", "-5");
  const field = page.locator('[data-path="display.pixel.film.1.thickness_nm"]');
  await field.locator(".error").waitFor();
  assert.match(await field.locator(".error").innerText(), /out of range[\s\S]*0 to 1e6/);
  assert.equal(await page.locator('[id="f-display.pixel.film.1.thickness_nm"]').getAttribute("aria-invalid"), "true");
  assert.equal(await figure(page, "Gamut % sRGB"), first);
  await page.getByRole("button", { name: "Discard" }).click();
  await field.locator(".error").waitFor({ state: "detached" });
  await page.getByRole("button", { name: "TOML" }).click();
  await page
    .locator("#source")
    .fill((await page.locator("#source").inputValue()).replace("haze = 0.78", "hase = 0.78"));
  await page.locator("#source-errors .error").first().waitFor();
  assert.match(await page.locator("#source-errors").innerText(), /Line \d+, column \d+/);
});

for (const [width, height] of [
  [1440, 900],
  [1280, 720],
  [1024, 768],
  [768, 1024],
  [390, 844],
  [844, 390],
] as const) {
  test(`page of ${width} x ${height} cuts off no control`, async () => {
    const page = await on.visit({ viewport: { width, height } });
    // The header is widest if there is a design of another tab.
    await page.evaluate(() => {
      localStorage.setItem("papilio.work.x", JSON.stringify({ id: "x", text: "", title: "Another one" }));
      dispatchEvent(new StorageEvent("storage"));
    });
    await page.getByRole("button", { name: "Earlier" }).waitFor();
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `${wide} px wide`);
    const cut = await page.evaluate(() =>
      [...document.querySelectorAll("button, select, .box input")]
        .filter((e) => {
          const box = e.getBoundingClientRect();
          return (
            box.width > 0 && (box.left < 0 || box.right > innerWidth + 1) && !e.closest('.scroll, [role="tablist"]')
          );
        })
        .map((e) => e.outerHTML.slice(0, 100)),
    );
    assert.deepEqual(cut, []);
    // The diagrams are within their figures, and their words can be read: numbers do not cover each other.
    await tool(page, "chromaticity");
    await settled(page);
    const diagrams = await page.evaluate(() =>
      [...document.querySelectorAll<HTMLElement>("figure.chromaticity")].flatMap((figure) => {
        const [outer, inner] = [figure, figure.querySelector(".canvas")!].map((e) => e.getBoundingClientRect());
        const words = [...figure.querySelectorAll("text")].map((text) => text.getBoundingClientRect().height);
        const isIn = inner!.right <= outer!.right + 1 && inner!.bottom <= outer!.bottom + 1 && inner!.left >= outer!.left - 1;
        const numbers = [...figure.querySelectorAll("text.scale")].map((text) => {
          const { left, right, top, height } = text.getBoundingClientRect();
          return { text: text.textContent, left, right, top, height };
        });
        return outer!.width > 0 ? [{ isIn, smallest: Math.min(...words), numbers }] : [];
      }),
    );
    assert.ok(diagrams.length > 0);
    for (const { isIn, smallest, numbers } of diagrams) {
      assert.ok(isIn && smallest >= 9, JSON.stringify({ isIn, smallest }));
      for (const [k, one] of numbers.entries())
        for (const other of numbers.slice(k + 1)) {
          // Digits fill half of the height of their boxes.
          const isInRow = Math.abs(one.top - other.top) < 0.5 * Math.min(one.height, other.height);
          const isCovered = isInRow && one.left < other.right - 1 && other.left < one.right - 1;
          assert.ok(!isCovered, `${one.text} and ${other.text}`);
        }
    }
  });
}

test("every example opens with a result or a message, and has the colours of its thumbnail", async () => {
  const page = await on.visit();
  const names = await examples(page);
  assert.ok(names.length > 60, String(names.length));
  assert.deepEqual(Object.keys(PATCHES).sort(), [...names].sort());
  const bytes = (colour: string): number[] => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
  for (const name of names) {
    await example(page, name);
    const [shown, kept] = [await patches(page), PATCHES[name]!];
    assert.equal(shown.length, kept.length, name);
    // Colours by Monte Carlo differ between versions of the program.
    const differences = shown.flatMap((colour, i) => bytes(colour).map((byte, channel) => Math.abs(byte - bytes(kept[i]!)[channel]!)));
    assert.ok(Math.max(0, ...differences) <= 4, `${name}: ${shown.join(" ")}, in the gallery ${kept.join(" ")} (npm run thumbnails)`);
  }
  assert.deepEqual(
    on.complaints.filter((words) => !/status of 4\d\d/.test(words)),
    [],
  );
});
