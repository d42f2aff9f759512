// Moves of displays whose exact results take longest: the times from the input event to the first picture and to the exact
// one are printed, and every first answer must be within its error of the exact one.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { exact, example, settled, stage, tool, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

const MOVES = 50;
/** Time after which a move counts as lost, ms. */
const LOST_MS = 20_000;

interface Case {
  readonly name: string;
  readonly example: string;
  /** The parts to select, the key of each, and its range. */
  readonly keys: readonly (readonly [string, string, number, number])[];
}

const CASES: readonly Case[] = [
  {
    name: "haze 0.05 to 0.4",
    example: "indoor",
    keys: [['[data-part="display.diffuser"]', "display.diffuser.haze", 0.05, 0.4]],
  },
  {
    name: "measured H65, film and lamp",
    example: "measured-h65",
    keys: [
      ['[data-part="display.pixel.film.0"]', "display.pixel.film.0.thickness_nm", 40, 70],
      ['[data-handle^="lighting.directed.0"]', "lighting.directed.0.theta_deg", -60, -15],
    ],
  },
  {
    name: "rough glass, alpha 0.1 to 0.4",
    example: "rough-glass",
    keys: [['[data-part="display.layers.0"]', "display.layers.0.alpha", 0.1, 0.4]],
  },
  {
    name: "film under cover glass",
    example: "cover-glass",
    keys: [['[data-part="display.pixel.film.0"]', "display.pixel.film.0.thickness_nm", 40, 70]],
  },
];

/** What the page shows: times since the input, ms; white Y in %, and the relative error that the page states. */
interface Seen {
  ms: number;
  white: number;
  error: number;
}

/** Sets a field and returns what is seen first, and what is exact. */
const move = (page: Page, key: string, value: number): Promise<{ first: Seen; exact: Seen } | null> =>
  page.evaluate(
    async ([key, value, lost]) => {
      const field = document.getElementById(`f-${key}`) as HTMLInputElement;
      const [trace, white] = [".trace", '[data-figure="White % Y"] b'].map((at) => document.querySelector(at)!);
      // Without the mark of a result of the design before, which comes at once.
      const isMark = (node: Node): boolean => node instanceof HTMLElement && node.classList.contains("age-mark");
      const words = (): string => [...trace!.childNodes].filter((node) => !isMark(node)).map((node) => node.textContent).join("").trim();
      const before = words();
      const from = performance.now();
      const until = async (isReached: (text: string) => boolean) => {
        const isThere = (): boolean => ![...trace!.childNodes].some(isMark) && words() !== before && isReached(words());
        await new Promise<void>((resolve) => {
          const watch = new MutationObserver(() => isThere() && (watch.disconnect(), resolve()));
          watch.observe(trace!, { childList: true, characterData: true, subtree: true });
          setTimeout(() => (watch.disconnect(), resolve()), lost);
          if (isThere()) resolve();
        });
        // The frame after the change has been drawn.
        await new Promise<void>((resolve) =>
          requestAnimationFrame(() => {
            const c = new MessageChannel();
            c.port1.onmessage = () => resolve();
            c.port2.postMessage(0);
          }),
        );
        if (!isThere()) return null;
        const error = Number(/\u00b1([\d.e\u2212-]+) %/.exec(words())?.[1]!.replace("\u2212", "-"));
        return { ms: performance.now() - from, white: Number(white!.textContent!.split(" ")[0]), error: error / 100 };
      };
      field.value = String(value);
      field.dispatchEvent(new Event("input", { bubbles: true }));
      const first = await until(() => true);
      const exact = await until((text) => text.includes("exact"));
      return first && exact && { first, exact };
    },
    [key, value, LOST_MS] as const,
  );

/** Selects a part, so that its field is shown; an answer may redraw the part between the focus and the key. */
async function select(page: Page, part: string, key: string): Promise<void> {
  const field = page.locator(`[id="f-${key}"]`);
  for (let attempt = 0; attempt < 10 && !(await field.isVisible()); attempt++) {
    await page.locator(part).first().focus();
    await page.keyboard.press("Enter");
    await field.waitFor({ timeout: 2000 }).catch(() => undefined);
  }
  await field.waitFor();
}

/** Numbers from 0 to 1 that are the same in every run. */
const spread = (i: number): number => (0.5 + i * 0.6180339887498949) % 1;

for (const { name, example: shown, keys } of CASES) {
  test(`first answers of ${MOVES} moves are within their errors: ${name}`, { timeout: 900_000 }, async () => {
    const page = await on.visit();
    // The compiler of the tests wraps functions in calls of this name.
    await page.evaluate("globalThis.__name = (of) => of");
    if (shown !== "indoor") await example(page, shown);
    await settled(page);
    await exact(page);
    const seen: { first: Seen; exact: Seen }[] = [];
    for (let i = 0; i < MOVES; i++) {
      const [part, key, least, most] = keys[i % keys.length]!;
      await select(page, part, key);
      const one = await move(page, key, Number((least + (most - least) * spread(i)).toPrecision(4)));
      assert.ok(one, `move ${i} of ${key} has no result within ${LOST_MS} ms`);
      seen.push(one);
      await page.waitForTimeout(30);
    }
    const at = (times: number[], fraction: number): string =>
      times.sort((a, b) => a - b)[Math.min(times.length - 1, Math.floor(fraction * times.length))]!.toFixed(0);
    const words = (of: (one: (typeof seen)[number]) => number): string => {
      const times = seen.map(of);
      return `median ${at(times, 0.5)} ms, 95 % ${at(times, 0.95)} ms, maximum ${at(times, 1)} ms`;
    };
    console.log(`${name}: first picture ${words(({ first }) => first.ms)}`);
    console.log(`${name}: exact picture ${words(({ exact }) => exact.ms)}`);
    for (const { first, exact } of seen) {
      // The page shows tenths of a per cent.
      const allowed = 0.11 + exact.white * (first.error + exact.error);
      assert.ok(Math.abs(first.white - exact.white) <= allowed, JSON.stringify({ first, exact }));
    }
    await page.close();
  });
}

test("example that takes long can be cancelled while it is opened", async () => {
  const page = await on.visit();
  const first = await page.locator(".title").inputValue();
  await page.route("**/api/v1/live", async (route) => {
    await new Promise((resolve) => setTimeout(resolve, /Electronic paper/.test(route.request().postData() ?? "") ? 20_000 : 0));
    await route.continue().catch(() => undefined);
  });
  await tool(page, "examples");
  await page.locator('[data-example="epaper"]').click();
  const cancel = page.getByRole("button", { name: "Cancel", exact: true });
  await cancel.waitFor();
  await cancel.click();
  await cancel.waitFor({ state: "detached" });
  await page.waitForFunction((first) => document.querySelector<HTMLInputElement>(".title")!.value === first, first);
  assert.equal(await page.getByRole("button", { name: "Undo" }).isDisabled(), true);
  assert.ok(!(await page.locator(".design").evaluate((e) => (e as HTMLElement).inert)));
});
