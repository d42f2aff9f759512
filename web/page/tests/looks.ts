// Writes screenshots of every tool at four sizes of the window, light and dark, to be looked at: `npm run looks -- FOLDER [TOOL ...]`.

import { mkdirSync } from "node:fs";
import { join } from "node:path";

import { stepOf, TOOLS } from "../src/model/tools.ts";
import { example, stage, tool } from "./e2e/stage.ts";

const [folder = "looks", ...only] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });

const SIZES = { laptop: [1440, 900], screen: [1920, 1080], tablet: [820, 1180], phone: [390, 844] } as const;
const TOUCHED = ["tablet", "phone"];

const on = await stage();
for (const [size, [width, height]] of Object.entries(SIZES)) {
  const hasTouch = TOUCHED.includes(size);
  const page = await on.visit({ viewport: { width, height }, hasTouch });
  await page.getByRole("button", { name: "Got it" }).click();
  await example(page, "matrix");
  for (const { id } of TOOLS.filter(({ id }) => only.length === 0 || only.includes(id))) {
    await tool(page, id);
    // Some tools compute for longer, and show that until then.
    const isBusy = (): boolean => /computing|reading the|measuring the|picture…/.test(document.querySelector("#tab-panel")!.textContent!);
    await page.waitForTimeout(600);
    await page.waitForFunction(`!(${String(isBusy)})()`, undefined, { timeout: 40_000 }).catch(() => undefined);
    await page.waitForTimeout(200);
    for (const colorScheme of ["light", "dark"] as const) {
      await page.emulateMedia({ colorScheme });
      await page.waitForTimeout(150);
      const step = `${stepOf(id).id}-${id}`;
      await page.screenshot({ path: join(folder, `${step}-${size}-${colorScheme}.png`) });
    }
    await page.emulateMedia({ colorScheme: "light" });
  }
  // What does not fit into the window is moved out of it.
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  if (wide > 0) console.log(`${size}: the page is ${wide} px wider than the window`);
  await page.context().close();
}
await on.close();
