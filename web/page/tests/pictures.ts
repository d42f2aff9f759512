// Writes docs/pictures/web-*.png, screenshots of the page, and scenarios/data/page.png, the picture that the page shows of a scenario
// without picture. `npm run pictures`.

import { readFileSync } from "node:fs";
import { join } from "node:path";

import { example, ROOT, settled, stage, tool } from "./e2e/stage.ts";

const on = await stage();
const SIZE = { viewport: { width: 1440, height: 900 } };
const to = (name: string) => join(ROOT, `docs/pictures/web-${name}.png`);

// A page of text and a photograph, of 480 x 360 pixels.
const inline = (path: string, kind: string) => `data:${kind};base64,${readFileSync(join(ROOT, path)).toString("base64")}`;
const own = await on.visit({ viewport: { width: 480, height: 360 } });
await own.goto("about:blank");
await own.setContent(`<style>
  @font-face { font-family: Own; src: url(${inline("crates/imaging/fonts/Roboto-Regular.ttf", "font/ttf")}) }
  @font-face { font-family: Own; font-weight: 700; src: url(${inline("crates/imaging/fonts/Roboto-Bold.ttf", "font/ttf")}) }
  body { box-sizing: border-box; height: 360px; margin: 0; padding: 16px 18px; overflow: hidden; background: #fff; color: #000; font: 15px/1.32 Own }
  h1 { margin: 0 0 6px; font-size: 24px }
  p { margin: 0 0 8px }
  img { float: right; width: 252px; margin: 2px 0 8px 14px }
  small { font-size: 11px }
</style>
<h1>Light from the room</h1>
<img src="${inline("scenarios/data/chelsea.png", "image/png")}" />
<p>A reflective display has no light of its own. What it shows is the light of the lamp, the window and the wall.</p>
<p>Paper does the same. The eye adapts to the light, and white stays white, <b>at noon and in the evening</b>.</p>
<p>Wings of some butterflies have colours without any dye: thin layers reflect one part of the spectrum, and the
colour changes with the angle of view.</p>
<small>Small print: 0123456789, 11 pixels high. The photograph is by Stefan van der Walt (CC0).</small>`);
await own.evaluate(() => document.fonts.ready.then(() => document.querySelector("img")!.decode()));
await own.screenshot({ path: join(ROOT, "scenarios/data/page.png") });
await own.close();

const page = await on.visit(SIZE);
await page.getByRole("button", { name: "Got it" }).click();
await settled(page);
await tool(page, "stage");
await page.getByText("prepared for this light and view").waitFor({ timeout: 30_000 });
await page.getByRole("button", { name: "Keep this version" }).click();
await page.locator(".said:empty").waitFor({ state: "attached", timeout: 20_000 });
await page.getByRole("button", { name: "Stop comparing" }).click();
await settled(page);
await page.screenshot({ path: to("page") });

// The picture on six inks in a warm light, seen from the side.
const inks = await on.visit({ viewport: { width: 1500, height: 900 } }, "?");
await inks.getByRole("button", { name: "Got it" }).click();
await example(inks, "six-ink");
await inks.getByLabel("White of this page").selectOption("display");
await inks.locator(".seen-display canvas").focus();
for (let i = 0; i < 24; i++) await inks.keyboard.press("ArrowRight");
await settled(inks);
await inks.getByText("prepared for this light and view").waitFor({ timeout: 30_000 });
await settled(inks);
await inks.locator(".tabs").screenshot({ path: to("picture") });

// A thinner absorber next to the pinned design, in the dark theme.
const night = await on.visit({ ...SIZE, colorScheme: "dark" });
await night.getByRole("button", { name: "Got it" }).click();
await night.getByRole("button", { name: "Keep this version" }).click();
await night.locator('[data-part="display.pixel.film.1"]').click();
await night.locator('[id="f-display.pixel.film.1.thickness_nm"]').fill("9");
await tool(night, "compare");
await night.locator(".said:empty").waitFor({ state: "attached", timeout: 20_000 });
await settled(night);
await night.screenshot({ path: to("compare") });

// Monte Carlo compared with the live result.
await tool(page, "walk");
await page.locator("#walk-aim").selectOption("0.0001");
await page.getByRole("button", { name: "Run Monte Carlo" }).click();
await page.locator('[data-phase="done"]').waitFor({ timeout: 120_000 });
await settled(page);
await page.locator(".tabs").screenshot({ path: to("walk") });

// An uploaded measured diffuser.
await page.setViewportSize({ width: 1440, height: 1060 });
await page.locator("input[type=file]").first().setInputFiles(join(ROOT, "scenarios/data/H65.bsdf"));
await page.locator(".file .words").waitFor({ timeout: 60_000 });
await settled(page);
await page.locator(".tabs").screenshot({ path: to("file") });

// A panel fitted to its measurement.
const panel = await on.visit({ viewport: { width: 1440, height: 1900 } });
await panel.getByRole("button", { name: "Got it" }).click();
await example(panel, "fit");
await settled(panel);
await tool(panel, "fit");
await panel.locator("#tab-panel input[type=file]").setInputFiles(join(ROOT, "scenarios/data/synthetic-film.csv"));
await panel.getByRole("button", { name: "Fit 8 variables" }).click();
await panel.locator('#tab-panel [data-phase="done"]').waitFor({ timeout: 120_000 });
await settled(panel);
await panel.locator(".tabs").screenshot({ path: to("fit") });

// A search, its front, and the selected design.
const found = await on.visit({ viewport: { width: 1440, height: 1000 } });
await found.getByRole("button", { name: "Got it" }).click();
await example(found, "optimize-front");
await tool(found, "optimize");
await found.getByLabel("designs", { exact: true }).fill("300");
await found.getByLabel("designs", { exact: true }).press("Enter");
await found.getByRole("button", { name: "Search", exact: true }).click();
await found.locator('#tab-panel [data-phase="done"]').waitFor({ timeout: 300_000 });
await found.locator('[data-design="4"]').click();
await settled(found);
await found.locator(".tabs").screenshot({ path: to("optimize") });

await on.close();
