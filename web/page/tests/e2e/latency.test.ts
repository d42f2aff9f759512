// Latency: random slider moves, each timed in the browser from the input event to the frame after the new result.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { changed, figure, stage, tool, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

/** Moves that take longer are listed, ms. */
const SLOW_MS = 100;

/** Sliders of all kinds: the lobe, films, a gap, angles, light. */
const SLIDERS = [
  ["display.diffuser", "haze"],
  ["display.pixel.film.1", "thickness_nm"],
  ["display.pixel.film.2", "thickness_nm"],
  ["display.pixel.film.4", "green"],
  ["lighting.directed.0", "theta_deg"],
  ["viewer", "theta_deg"],
  ["lighting.directed.0", "share"],
  ["display.diffuser", "total_transmittance"],
] as const;

/** How much longer numbers may take while the picture follows the design, too. */
const BESIDE_PICTURE = 1.5;

/** Returns the times of random moves, sorted, ms. */
async function timesOf(page: Page, moves: number): Promise<number[]> {
  const times: number[] = [];
  const slowest: string[] = [];
  for (let i = 0; i < moves; i++) {
    const [part, key] = SLIDERS[i % SLIDERS.length]!;
    const target = part.startsWith("display")
      ? page.locator(`[data-part="${part}"]`)
      : page.locator(`[data-handle^="${part}"]`);
    await target.focus();
    await page.keyboard.press("Enter");
    const ms = await page.evaluate(
      async ([key, random]) => {
        const slider = document.querySelector<HTMLInputElement>(`.field[data-path$=".${key}"] input[type=range]`)!;
        const trace = document.querySelector(".trace code")!;
        const pictured = new Promise<void>((resolve) =>
          new MutationObserver((_, watch) => (watch.disconnect(), resolve())).observe(trace, {
            childList: true,
            characterData: true,
            subtree: true,
          }),
        );
        slider.value = String(Math.round(100 + 800 * random));
        const from = performance.now();
        slider.dispatchEvent(new Event("input", { bubbles: true }));
        const refused = new Promise<void>((resolve) => setTimeout(resolve, 3000));
        await Promise.race([pictured, refused]);
        await new Promise<void>((resolve) =>
          requestAnimationFrame(() => {
            const c = new MessageChannel();
            c.port1.onmessage = () => resolve();
            c.port2.postMessage(0);
          }),
        );
        return performance.now() - from;
      },
      [key, Math.random()] as const,
    );
    times.push(ms);
    if (ms > SLOW_MS) slowest.push(`${part}.${key} ${ms.toFixed(0)}`);
    await page.waitForTimeout(30);
  }
  if (slowest.length > 0) console.log(`  over ${SLOW_MS} ms: ${slowest.join("; ")}`);
  return times.sort((a, b) => a - b);
}

const at = (times: readonly number[], fraction: number): number => times[Math.floor(fraction * times.length)]!;

/** Prints the times of a view and returns their median. */
function median(times: readonly number[], where: string): number {
  console.log(
    `latency of ${times.length} random slider moves, ${where}: median ${at(times, 0.5).toFixed(1)} ms, 95th percentile ${at(times, 0.95).toFixed(1)} ms, maximum ${at(times, 0.999).toFixed(1)} ms`,
  );
  return at(times, 0.5);
}

test("numbers of a moved lamp are shown while its picture is still computed, which is drawn once", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  await tool(page, "stage");
  const shown = page.locator('.seen-display[data-age="current"] canvas[data-drawn]');
  await shown.waitFor();
  await page.waitForLoadState("networkidle");
  const drawn = async () => Number(await page.locator(".seen-display canvas").getAttribute("data-drawn"));
  const held: Promise<void>[] = [];
  let release = (): void => {};
  const isReleased = new Promise<void>((resolve) => (release = resolve));
  await page.route("**/api/v1/image", (route) => {
    held.push(isReleased.then(() => route.continue()));
  });
  const [before, count] = [await figure(page, "White % Y"), await drawn()];
  const lamp = page.locator('[data-stage-handle^="lighting.directed.0"]');
  await lamp.focus();
  for (let i = 0; i < 5; i++) await page.keyboard.press("ArrowLeft");
  await changed(page, "White % Y", before);
  assert.equal(await page.locator(".seen-display").getAttribute("data-age"), "before");
  assert.equal(await drawn(), count, "the picture before is not drawn again");
  assert.ok(held.length > 0, "the picture is requested");
  release();
  await Promise.all(held);
  await shown.waitFor();
  await page.waitForFunction((count) => Number(document.querySelector<HTMLElement>(".seen-display canvas")!.dataset["drawn"]) > count, count);
  await page.context().close();
});

test("numbers do not wait for the picture", { timeout: 300_000 }, async () => {
  const page = await on.visit();
  const all: Record<string, number[]> = { states: [], stage: [] };
  // In turn, so that other programs slow both down.
  for (let i = 0; i < 6; i++)
    for (const where of ["states", "stage"]) {
      await tool(page, where);
      await page.waitForTimeout(600);
      all[where]!.push(...(await timesOf(page, 16)));
    }
  const [tables, beside] = ["states", "stage"].map((where) => median(all[where]!.sort((a, b) => a - b), where));
  assert.ok(beside! <= BESIDE_PICTURE * tables!, `${beside} ms beside the picture, ${tables} ms without`);
  await page.context().close();
});
