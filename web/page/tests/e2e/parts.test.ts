// All parts that can be added or selected on the page can be computed: layers, sources, models, presets, states.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import type { Edit } from "../../src/api/types.ts";
import type { Json } from "../../src/model/json.ts";
import { freed, freeing } from "../../src/model/stack.ts";
import { changed, choose, example, figure, itemsOf, ROOT, saved, settled, stage, type Stage, type } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

/** Waits for the result of the last action, and fails with the message of a refusal. */
async function computes(page: Page, what: string): Promise<void> {
  await page.waitForTimeout(150);
  await page.locator('.picture[aria-busy="false"]').waitFor({ timeout: 30_000 });
  await page.waitForLoadState("networkidle");
  const refusal = page.locator(".refusal");
  assert.equal(await refusal.count(), 0, `${what}: ${(await refusal.allInnerTexts()).join()}`);
}

async function openIndoor(page: Page): Promise<void> {
  await example(page, "indoor");
  await computes(page, "indoor");
  await page.locator('[data-part="display.diffuser"]').click();
}

const options = (page: Page, name: string): Promise<string[]> =>
  page
    .getByLabel(name)
    .locator("option")
    .evaluateAll((all) => all.map((one) => (one as HTMLOptionElement).value).filter(Boolean));

test("every layer and every source that can be added computes", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  for (const menu of ["Add layer", "Add source"]) {
    for (const what of await itemsOf(page, menu)) {
      await openIndoor(page);
      await choose(page, menu, what);
      await computes(page, what);
    }
  }
  assert.deepEqual(on.complaints, []);
});

test("layer that needs a further key is added together with it", { timeout: 60_000 }, async () => {
  const page = await on.visit();
  await example(page, "printed-filter");
  await page.waitForFunction(() => /^Printed/.test(document.querySelector<HTMLInputElement>(".title")?.value ?? ""));
  await computes(page, "printed-filter");
  const add = page.getByRole("button", { name: "Add layer" });
  await add.click();
  const item = page.locator('.menu [data-item="component"]');
  await item.filter({ hasText: "with no gap below the front" }).waitFor({ timeout: 20_000 });
  await item.click();
  await computes(page, "front component with its gap");
  assert.match(await saved(page), /gap_mm = 0\b/);
  await page.getByRole("button", { name: "Undo" }).click();
  await computes(page, "without the front component");
  await page.locator('[data-part="display.glass.surface"]').click();
  await add.click();
  const diffuser = page.locator('.menu [data-item="diffuser"]');
  await diffuser.filter({ hasText: "in place of the bare interface" }).waitFor({ timeout: 20_000 });
  await diffuser.click();
  await computes(page, "diffuser in place of the bare interface");
  const both = await saved(page);
  assert.match(both, /haze = 0\.5/);
  assert.doesNotMatch(both, /^surface/m);
  assert.deepEqual(on.complaints.splice(0).filter((words) => !/status of 422/.test(words)), []);
});

test("panel that becomes a list of general layers keeps its numbers", { timeout: 60_000 }, async () => {
  type Answer = { fields: Json; result: { views: { states: Record<string, { Y: number }> }[] } };
  const live = async (scenario: string, edits: readonly Edit[]): Promise<Answer> => {
    const head = { method: "POST", headers: { "content-type": "application/json" } };
    const answer = await fetch(`${on.url}api/v1/live`, { ...head, body: JSON.stringify({ scenario, files: {}, edits }) });
    assert.equal(answer.status, 200, await answer.clone().text());
    return (await answer.json()) as Answer;
  };
  const numbers = ({ result }: Answer) => result.views.flatMap(({ states }) => Object.values(states).map(({ Y }) => Y));
  for (const [name, more] of [
    ["indoor", "gap_mm = 0.2\nreflectance = 0.005"],
    ["indoor", "gap_mm = 0\nreflectance = 0.005"],
    ["slab", ""],
    ["epaper", ""],
    ["reference-pixel", ""],
    ["mip-lcd", ""],
  ] as const) {
    const text = readFileSync(join(ROOT, `scenarios/${name}.toml`), "utf8").replace(more ? "reflectance = 0.005" : "", more);
    const own = await live(text, []);
    const list = freed(own.fields);
    const [before, now] = [numbers(own), numbers(await live(text, freeing(own.fields, list)))];
    before.forEach((Y, i) => assert.ok(Math.abs(now[i]! - Y) <= 1e-9 * Y, `${name} ${more}: ${now[i]} instead of ${Y}`));
    assert.equal(list.some(({ layer }) => layer["index"] === 1), more.includes("0.2"));
  }
});

test("removed source leaves its fraction to the others", async () => {
  const page = await on.visit();
  await choose(page, "Add source", "ring");
  await computes(page, "ring");
  await page.getByRole("button", { name: "Remove", exact: true }).click();
  await computes(page, "removed");
  assert.match(await saved(page), /diffuse = 0\.5\b/);
});

test("every model of diffuser and pixel and every preset computes", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  for (const model of await options(page, "Model")) {
    await page.locator('[id="f-display.diffuser-model"]').selectOption(model);
    await computes(page, model);
  }
  await page.getByRole("navigation").getByRole("button", { name: "Pixel" }).click();
  for (const model of ["uniform", "film"]) {
    await page.locator('[id="f-display.pixel-model"]').selectOption(model);
    await computes(page, model);
  }
  for (const preset of await itemsOf(page, /^Light:/)) {
    await choose(page, /^Light:/, preset);
    await computes(page, preset);
  }
  // A source of the preset can be moved like any other.
  await page.locator('[data-handle^="lighting.directed.0"]').focus();
  await page.keyboard.press("ArrowLeft");
  await computes(page, "a source of the preset");
  assert.match(await saved(page), /theta_deg = 29/);
  assert.deepEqual(on.complaints, []);
});

/** Returns the position of an element of the drawing, relative to the centre of the half circle. */
async function placeOf(page: Page, selector: string): Promise<[number, number]> {
  return page
    .locator(selector)
    .first()
    .evaluate((e) => {
      const of = (e as SVGGraphicsElement).getBBox();
      const { e: x, f: y } = (e as SVGGraphicsElement).transform.baseVal.consolidate()?.matrix ?? {
        e: of.x + of.width / 2,
        f: of.y + of.height / 2,
      };
      return [x - 230, 168 - y] as [number, number];
    });
}

test("source is drawn at the same position for equivalent directions", async () => {
  const page = await on.visit();
  const handle = '[data-handle="lighting.directed.0.theta_deg"]';
  const close = (a: [number, number], b: [number, number]) =>
    assert.ok(Math.hypot(a[0] - b[0], a[1] - b[1]) < 0.1, `${a.join()} and ${b.join()}`);
  const positionsAt = async (theta: number, phi: number) => {
    await page.getByRole("button", { name: "TOML" }).click();
    const text = await page.locator("#source").inputValue();
    const table = /(\[\[lighting\.directed\]\]\n)(?:(?:theta|phi)_deg.*\n)+/;
    await page.locator("#source").fill(text.replace(table, `$1theta_deg = ${theta}\nphi_deg = ${phi}\n`));
    await computes(page, `${theta}, ${phi}`);
    assert.match(await saved(page), new RegExp(`theta_deg = ${theta}\nphi_deg = ${phi}\n`));
    await page.getByRole("button", { name: "Drawing" }).click();
    return { source: await placeOf(page, handle), mirror: await placeOf(page, "circle.mirror") };
  };
  const [sine, cosine] = [140 * Math.sin((40 * Math.PI) / 180), 140 * Math.cos((40 * Math.PI) / 180)];
  const left = await positionsAt(-40, 0);
  close(left.source, [-sine, cosine]);
  close(left.mirror, [sine, cosine]);
  const turned = await positionsAt(40, 180);
  close(turned.source, left.source);
  close(turned.mirror, left.mirror);
  // The right arrow key moves it to the right.
  await page.locator(handle).focus();
  await page.keyboard.press("ArrowRight");
  await computes(page, "moved");
  assert.match(await saved(page), /theta_deg = 39\nphi_deg = 180/);
  // Outside the plane of the drawing, it is inside the half circle, in front of or behind its mirror image.
  const across = await positionsAt(40, 90);
  close(across.source, [0, cosine]);
  close(across.mirror, [0, cosine]);
  const slanted = await positionsAt(40, 120);
  close(slanted.source, [-sine / 2, cosine]);
  close(slanted.mirror, [sine / 2, cosine]);
});

test("new state with an analogue gap is written to the scenario", async () => {
  const page = await on.visit();
  await page.getByRole("navigation").getByRole("button", { name: "Drive states" }).click();
  await page.locator("#f-new-state").fill("orange");
  await page.getByRole("button", { name: "Add", exact: true }).click();
  await page.locator(".patch", { hasText: "orange" }).waitFor();
  await page.getByLabel("green: driven by").selectOption("gap");
  await type(page, "state-green", "210");
  await computes(page, "gap");
  assert.match(await saved(page), /gap_nm = 210/);
});

test("refused value does not block the next change", async () => {
  const page = await on.visit();
  await type(page, "display.diffuser.haze", "7");
  await page.locator(".field .error").waitFor();
  await page.locator('[data-handle="viewer.theta_deg"]').focus();
  await page.keyboard.press("ArrowRight");
  await page.getByText("was discarded").waitFor();
  await computes(page, "the viewer");
  const scenario = await saved(page);
  assert.match(scenario, /haze = 0\.78/);
  assert.match(scenario, /theta_deg = 9/);
  // The refused value, and nothing else.
  assert.deepEqual(on.complaints.splice(0).filter((words) => !/status of 422/.test(words)), []);
});

test("layers that are added keep every comment of the text", async () => {
  const page = await on.visit();
  const before = await saved(page);
  const comments = (text: string) => text.split("\n").flatMap((line) => /#.*$/.exec(line.replace(/"[^"]*"/g, ""))?.[0] ?? []);
  await page.locator('[data-part="display.glass"]').click();
  await choose(page, "Add layer", "air gap");
  await page.locator('[data-part="display.layers.3"]').waitFor();
  await settled(page);
  const after = await saved(page);
  assert.ok(comments(before).length > 10);
  for (const comment of comments(before)) assert.ok(after.includes(comment), `${comment} is lost:\n${after}`);
  assert.match(after, /\[\[display\.layers\]\] +# a touch panel[^\n]*\nkind = "component"\nreflectance = 0\.005/);
  assert.match(after, /haze = 0\.78 +# a lobe of width/);
  await page.getByRole("button", { name: "Undo" }).click();
  await settled(page);
  assert.equal(await saved(page), before);
  assert.deepEqual(on.complaints, []);
});

test("parts of a liquid-crystal pixel have fields, and its cell is drawn with the directors of the shown state", async () => {
  const page = await on.visit();
  await example(page, "lcd-voltage");
  await settled(page);
  await page.locator('[data-part="display.pixel.stack.3"]').click();
  const rods = page.locator('[data-part="display.pixel.stack.3"] .directors');
  await rods.waitFor();
  assert.equal(await rods.getAttribute("aria-label"), "Directors of the cell in the state white");
  /** The slope of the middle row, which the voltage turns. */
  const middle = async (): Promise<number> => {
    const line = rods.locator("line").nth(2 * 9);
    const [x1, x2, y1, y2] = await Promise.all(["x1", "x2", "y1", "y2"].map(async (name) => Number(await line.getAttribute(name))));
    return Math.abs((y2! - y1!) / (x2! - x1!));
  };
  const driven = await middle();
  const volts = page.locator('[id="f-display.pixel.stack.3.states.white.volts"]');
  assert.equal(await volts.inputValue(), "3.5");
  const first = await figure(page, "White % Y");
  await volts.fill("6");
  await changed(page, "White % Y", first);
  for (let i = 0; i < 50 && (await middle()) >= 0.9 * driven; i++) await page.waitForTimeout(100);
  assert.ok((await middle()) < 0.9 * driven);
  // The other state is not driven: its molecules stand.
  await page.locator(".editor .key-link", { hasText: "black" }).click();
  await page.locator('[aria-label="Directors of the cell in the state black"]').waitFor();
  assert.ok((await middle()) > 20);
  await page.locator('[data-part="display.pixel.stack.1"]').click();
  await type(page, "display.pixel.stack.1.axis_deg", "20");
  await type(page, "display.pixel.stack.1.retardance_nm", "280");
  await settled(page);
  const scenario = await saved(page);
  assert.match(scenario, /volts = 6/);
  assert.match(scenario, /kind = "retarder", axis_deg = 20, retardance_nm = 280/);
  assert.deepEqual(on.complaints, []);
});

test("menu of layers says what cannot be added here, and why", async () => {
  const page = await on.visit();
  await example(page, "printed-filter");
  await settled(page);
  await page.getByRole("button", { name: "Add layer" }).click();
  const medium = page.locator('.menu [data-item="medium"]');
  await page.locator('.menu [data-item="medium"][aria-disabled="true"]').waitFor({ timeout: 20_000 });
  assert.match(await medium.innerText(), /does not compute the places of light for a colour filter below general layers/);
  assert.equal(await page.locator('.menu [data-item="component"]').getAttribute("aria-disabled"), null);
  await medium.click({ force: true });
  assert.equal(await page.locator(".refusal").count(), 0);
  await page.keyboard.press("Escape");
  await example(page, "mip-lcd");
  await settled(page);
  await page.getByRole("button", { name: "Add layer" }).click();
  await page.locator('.menu [data-item="pixel: retarder"]').click();
  await page.locator('[data-part="display.pixel.stack.5"]').waitFor();
  await settled(page);
  assert.equal(await page.locator(".refusal").count(), 0);
  on.complaints.splice(0, on.complaints.length, ...on.complaints.filter((one) => !/422/.test(one)));
  assert.deepEqual(on.complaints, []);
});

test("material is found in the list of papilio materials, and used", async () => {
  const page = await on.visit();
  await page.locator('[data-part="display.pixel.film.1"]').click();
  await page.getByRole("button", { name: "Browse materials" }).click();
  await page.locator(".browser").getByRole("searchbox").fill("gold");
  await page.locator(".browser-list button", { hasText: /Au/ }).first().click();
  await settled(page);
  assert.match(await saved(page), /material = "Au/);
  assert.deepEqual(on.complaints, []);
});
