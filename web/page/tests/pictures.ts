// Writes docs/pictures/web-*.png: screenshots of the page. `npm run pictures`.

import { join } from "node:path";

import { ROOT, settled, stage } from "./e2e/stage.ts";

const on = await stage();
const SIZE = { viewport: { width: 1440, height: 900 } };
const to = (name: string) => join(ROOT, `docs/pictures/web-${name}.png`);

const page = await on.visit(SIZE);
await page.getByRole("button", { name: "Got it" }).click();
await settled(page);
await page.screenshot({ path: to("page") });

// A thinner absorber next to the pinned design, in the dark theme.
const night = await on.visit({ ...SIZE, colorScheme: "dark" });
await night.getByRole("button", { name: "Got it" }).click();
await night.getByRole("button", { name: "Pin", exact: true }).click();
await night.locator('[data-part="display.pixel.film.1"]').click();
await night.locator('[id="f-display.pixel.film.1.thickness_nm"]').fill("9");
await night.locator("#tab-compare").click();
await settled(night);
await night.screenshot({ path: to("compare") });

// Monte Carlo compared with the live result.
await page.locator("#tab-walk").click();
await page.locator("#walk-aim").selectOption("0.0001");
await page.getByRole("button", { name: "Run Monte Carlo" }).click();
await page.locator('[data-phase="done"]').waitFor({ timeout: 120_000 });
await settled(page);
await page.locator(".tabs").screenshot({ path: to("walk") });

// An uploaded measured diffuser.
await page.setViewportSize({ width: 1440, height: 1900 });
await page.locator("input[type=file]").first().setInputFiles(join(ROOT, "scenarios/data/H65.bsdf"));
await page.locator(".file .words").waitFor({ timeout: 60_000 });
await settled(page);
await page.locator(".tabs").screenshot({ path: to("file") });

await on.close();
