// Five tasks of a new user, in the page alone, by mouse and by keyboard alone. Each prints its number of actions and how long it waited for
// the server. PAPILIO_LOOKS is a folder for a screenshot of the end of each.

import assert from "node:assert/strict";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { unzipSync } from "fflate";
import type { Locator, Page } from "playwright-core";

import { downloaded, ROOT, saved, settled, stage, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const LOOKS = process.env["PAPILIO_LOOKS"];

/** A user: acts on the page, counts the actions, and measures the time of waiting. */
class User {
  actions = 0;
  waitedMs = 0;
  constructor(
    readonly page: Page,
    readonly byKeyboard: boolean,
  ) {}

  /** Presses a button, a tab, a part or a link. */
  async press(of: Locator, key = "Enter"): Promise<void> {
    this.actions += 1;
    const one = of.first();
    if (!this.byKeyboard) return one.click();
    await this.focus(one);
    await this.page.keyboard.press(key);
  }

  /** Sets the value of a field. */
  async write(of: Locator, value: string): Promise<void> {
    this.actions += 1;
    if (this.byKeyboard) await this.focus(of.first());
    else await of.first().click();
    await this.page.keyboard.press("ControlOrMeta+a");
    await this.page.keyboard.type(value);
    await this.page.keyboard.press("Enter");
  }

  /** Takes an item of the open menu. */
  async take(item: Locator): Promise<void> {
    this.actions += 1;
    if (!this.byKeyboard) return item.first().click();
    // Arrows move through a menu.
    const name = await item.first().evaluate((one) => (one as HTMLElement).dataset["item"]);
    for (let i = 0; i < 80; i++) {
      const now = await this.page.evaluate(() => (document.activeElement as HTMLElement | null)?.dataset["item"]);
      if (now === name) break;
      await this.page.keyboard.press("ArrowDown");
    }
    await this.page.keyboard.press("Enter");
  }

  async check(of: Locator): Promise<void> {
    this.actions += 1;
    if (!this.byKeyboard) return of.check();
    await this.focus(of);
    await this.page.keyboard.press("Space");
  }

  /** Waits for what the server computes. */
  async wait(of: Locator, timeout = 180_000): Promise<void> {
    const from = Date.now();
    await of.first().waitFor({ timeout });
    this.waitedMs += Date.now() - from;
  }

  /** Opens a tool: its step, then its tab; by keyboard, the arrows move along the tabs. */
  async tool(step: string, name: string): Promise<void> {
    await this.press(this.page.getByRole("navigation", { name: "Steps" }).getByRole("button", { name: step }));
    const tab = this.page.getByRole("tab", { name, exact: true });
    if (!this.byKeyboard) return this.press(tab);
    await this.focus(this.page.locator('[role="tab"][aria-selected="true"]'));
    for (let i = 0; i < 10 && (await tab.getAttribute("aria-selected")) !== "true"; i++) {
      this.actions += 1;
      await this.page.keyboard.press("ArrowRight");
    }
    assert.equal(await tab.getAttribute("aria-selected"), "true", name);
  }

  /** What Tab reaches has the focus. */
  private async focus(of: Locator): Promise<void> {
    await of.waitFor();
    await (await of.elementHandle())!.waitForElementState("enabled");
    assert.ok(await of.evaluate((one) => (one as HTMLElement).tabIndex >= 0), `Tab does not reach ${String(of)}`);
    await of.focus();
  }
}

/** Runs a task by mouse and by keyboard. */
function task(name: string, act: (user: User) => Promise<void>): void {
  for (const byKeyboard of [false, true])
    test(`${name}, by ${byKeyboard ? "keyboard" : "mouse"}`, { timeout: 600_000 }, async () => {
      const page = await on.visit({}, "?");
      const user = new User(page, byKeyboard);
      await act(user);
      const { actions, waitedMs } = user;
      console.log(`${name}, by ${byKeyboard ? "keyboard" : "mouse"}: ${actions} actions, ${(waitedMs / 1000).toFixed(1)} s of waiting`);
      if (LOOKS) await page.screenshot({ path: join(LOOKS, `task-${name.replaceAll(/\W+/g, "-")}-${byKeyboard ? "keyboard" : "mouse"}.png`) });
      assert.deepEqual(
        on.complaints.splice(0).filter((words) => !/status of 501/.test(words)),
        [],
      );
      await page.context().close();
    });
}

task("change a film and compare", async (user) => {
  const { page } = user;
  await user.press(page.getByRole("button", { name: "Keep this version" }));
  await page.locator("[data-version]").waitFor();
  await user.press(page.locator('[data-part="display.pixel.film.1"]'));
  await user.write(page.locator('[id="f-display.pixel.film.1.thickness_nm"]'), "9");
  await user.wait(page.locator('[data-figure="Contrast : 1"] .difference'));
  await user.tool("Check", "Compare");
  await user.wait(page.locator("#tab-panel", { hasText: "display.pixel.film.1.thickness_nm" }));
  await user.tool("Design", "Side by side");
  await user.wait(page.locator('[data-column][aria-busy="false"]').nth(1));
});

task("compare with before after a change", async (user) => {
  const { page } = user;
  await user.press(page.locator('[data-part="display.pixel.film.1"]'));
  await user.write(page.locator('[id="f-display.pixel.film.1.thickness_nm"]'), "9");
  await user.press(page.getByRole("button", { name: "Compare with before" }));
  await user.wait(page.locator('[data-figure="Contrast : 1"] .difference', { hasText: /from 23\.6/ }));
  await user.press(page.getByRole("button", { name: "Side by side" }));
  await user.wait(page.locator('[data-column="Indoor reading, as opened"][aria-busy="false"]'));
  assert.deepEqual(await page.locator(".side-numbers thead tr").first().locator("th").allInnerTexts(), ["⤓", "Indoor reading, current", "Indoor reading, as opened"]);
});

task("find the best gap under a constraint, and its yield", async (user) => {
  const { page } = user;
  await user.tool("Improve", "Optimise");
  await user.press(page.locator('[data-part="display.pixel.film.4"]'));
  await user.press(page.getByRole("button", { name: /^Vary .*green/i }));
  await user.press(page.locator('[data-figure="Gamut % sRGB"]').getByRole("button", { name: /Gamut/ }));
  await user.press(page.getByRole("button", { name: "Maximise" }));
  await user.press(page.locator('[data-figure="Contrast : 1"]').getByRole("button", { name: "Contrast" }));
  await user.write(page.getByLabel("Target of Contrast", { exact: true }), "20");
  await user.press(page.getByRole("button", { name: "Take the targets of the numbers as constraints" }));
  await user.press(page.getByRole("button", { name: "Search", exact: true }));
  await user.wait(page.locator('#tab-panel [data-phase="done"]'), 400_000);
  await user.press(page.getByRole("button", { name: "Take this design" }));
  await settled(page);
  await user.tool("Improve", "Tolerance");
  await user.press(page.getByRole("button", { name: "Take variables and constraints of the search" }));
  assert.equal(await page.getByLabel("Key of tolerance 1").inputValue(), "display.pixel.gap_nm.green");
  assert.equal(await page.getByLabel("Least value of Contrast ratio").inputValue(), "20");
  await user.press(page.getByRole("button", { name: "Analyse", exact: true }));
  await user.wait(page.locator('[data-figure="yield"]'), 400_000);
  assert.match(await page.locator('[data-figure="yield"]').innerText(), /\d %/);
});

task("fit a measured panel", async (user) => {
  const { page } = user;
  await user.press(page.getByRole("navigation", { name: "Steps" }).getByRole("button", { name: "Start" }));
  await user.write(page.getByLabel("Search"), "fit");
  await user.press(page.locator('[data-example="fit"]'));
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>("input.title")?.value === "A panel from production");
  await user.tool("Improve", "Fit");
  // The dialog of the system is not part of the page.
  const chooser = page.waitForEvent("filechooser");
  await user.press(page.locator("#tab-panel").getByRole("button", { name: "Choose a measurement" }));
  await (await chooser).setFiles(join(ROOT, "scenarios/data/synthetic-film.csv"));
  await user.press(page.getByRole("button", { name: "Fit 8 variables" }));
  await user.wait(page.locator('#tab-panel [data-phase="done"]'));
  await user.press(page.getByRole("button", { name: "Take the fitted values" }));
  await settled(page);
  assert.match(await saved(page), /gap_nm = \{ red = \d/);
});

task("show the display in sunlight and at the desk", async (user) => {
  const { page } = user;
  await user.tool("See", "Rooms");
  for (const room of ["full-sun"]) await user.check(page.getByLabel(room, { exact: true }));
  for (const room of ["full-sun", "office"])
    await user.wait(page.locator(`[data-room="${room}"] figcaption`, { hasText: "contrast" }), 300_000);
  const { bytes } = await downloaded(page, async () => {
    await user.press(page.getByRole("button", { name: "Download rooms" }));
    await user.take(page.locator('.menu [data-item="png"]'));
  });
  assert.equal(bytes.subarray(1, 4).toString(), "PNG");
  await user.press(page.locator('[data-room="full-sun"]').getByRole("button", { name: "Take this light" }));
  await user.wait(page.getByRole("button", { name: "Light: full-sun", exact: true }));
});

task("hand a palette and a picture to a firmware engineer", async (user) => {
  const { page } = user;
  await user.press(page.getByRole("navigation", { name: "Steps" }).getByRole("button", { name: "Start" }));
  await user.write(page.getByLabel("Search"), "six-ink");
  await user.press(page.locator('[data-example="six-ink"]'));
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>("input.title")?.value === "Six-ink electronic paper");
  await user.tool("See", "Picture");
  const chooser = page.waitForEvent("filechooser");
  await user.press(page.locator("#tab-panel").getByRole("button", { name: "Choose a picture" }));
  await (await chooser).setFiles(join(ROOT, "scenarios/data/chelsea.png"));
  await user.wait(page.locator(".seen-display figcaption", { hasText: "prepared for this light and view" }));
  for (const [item, words] of [
    ["palette.gpl", /^GIMP Palette/],
    ["frame.h", /#define|const/],
  ] as const) {
    const from = Date.now();
    const { text } = await downloaded(page, async () => {
      await user.press(page.getByRole("button", { name: "Download files of the picture" }));
      await user.take(page.locator(`.menu [data-item="${item}"]`));
    });
    user.waitedMs += Date.now() - from;
    assert.match(text, words, item);
  }
  const { name, bytes } = await downloaded(page, async () => {
    await user.press(page.getByRole("button", { name: "Download files of the picture" }));
    await user.take(page.locator('.menu [data-item="all"]'));
  });
  assert.equal(name, "six-ink-electronic-paper-picture.zip");
  const files = Object.keys(unzipSync(bytes));
  assert.deepEqual(files.filter((one) => /^(states|frame|palette)/.test(one)).length, 7, files.join());
});
