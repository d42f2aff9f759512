// Latency of all examples in the view that the page opens, the stage: from the click or key to the frame with the numbers and with the
// picture. Writes latency.csv and a table: `npm run latency -- FOLDER [EXAMPLE ...]`.

import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import type { Page } from "playwright-core";

import { example, exact, stage, tool } from "./e2e/stage.ts";

const [folder = "latency", ...only] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });

/** Moves of a source or of the eye, one at a time. */
const MOVES = 12;
const LOST_MS = 60_000;

interface Times {
  /** Time to the first numbers, ms; NaN: none came. */
  readonly numbers: number;
  /** Time to the picture, ms. */
  readonly picture: number;
}

/** Starts watching; `watched` then returns the times since the event that `act` sends. */
const timed = (page: Page, selector: string, key: string | null): Promise<Times> =>
  page.evaluate(
    async ([selector, key, lost]) => {
      const target = document.querySelector(selector) as HTMLElement | SVGElement;
      const frame = () =>
        new Promise<void>((resolve) =>
          requestAnimationFrame(() => {
            const channel = new MessageChannel();
            channel.port1.onmessage = () => resolve();
            channel.port2.postMessage(0);
          }),
        );
      const age = (at: string) => document.querySelector<HTMLElement>(at)?.dataset["age"] ?? "";
      const drawn = () => document.querySelector<HTMLElement>(".seen-display canvas")?.dataset["drawn"] ?? "";
      const from = performance.now();
      /** Waits until what was of the design before is of the current one. */
      const until = async (isOld: () => boolean, isNew: () => boolean): Promise<number> => {
        let wasOld = false;
        const isThere = await new Promise<boolean>((resolve) => {
          const look = () => {
            wasOld ||= isOld();
            if (wasOld && isNew()) (watch.disconnect(), resolve(true));
          };
          const watch = new MutationObserver(look);
          watch.observe(document.body, { childList: true, characterData: true, attributes: true, subtree: true });
          setTimeout(() => (watch.disconnect(), resolve(false)), lost);
          look();
        });
        await frame();
        return isThere ? performance.now() - from : Number.NaN;
      };
      const OLD = ["before", "refused", "failed"];
      const before = drawn();
      const numbers = until(
        () => OLD.includes(age(".seen-from .age-mark")),
        () => ["first", "current"].includes(age(".seen-from .age-mark")),
      );
      const picture = until(
        () => age(".seen-display") !== "current" || document.querySelector(".seen-display") === null,
        () => age(".seen-display") === "current" && drawn() !== before,
      );
      if (key === null) (target as HTMLElement).click();
      else target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
      return { numbers: await numbers, picture: await Promise.race([picture, numbers.then(() => new Promise<number>((resolve) => setTimeout(() => resolve(Number.NaN), 20_000)))]) };
    },
    [selector, key, LOST_MS] as const,
  );

const median = (of: readonly number[]): number => {
  const all = of.filter(Number.isFinite).sort((a, b) => a - b);
  return all.length > 0 ? all[Math.floor((all.length - 1) / 2)]! : Number.NaN;
};
const ms = (value: number): string => (Number.isFinite(value) ? value.toFixed(0) : "");

const on = await stage();
const page = await on.visit();
await page.getByRole("button", { name: "Got it" }).click();
// The compiler of this file wraps functions in calls of this name.
await page.evaluate("globalThis.__name = (of) => of");
await tool(page, "examples");
const names = await page.locator("[data-example]").evaluateAll((all) => all.map((one) => (one as HTMLElement).dataset["example"]!));

const rows: string[] = ["example,first_numbers_ms,first_picture_ms,moved,numbers_median_ms,picture_median_ms,server_cpu_ms_per_move"];
for (const name of names.filter((name) => only.length === 0 || only.includes(name))) {
  await tool(page, "stage");
  await example(page, "indoor");
  await exact(page);
  await page.waitForTimeout(500);
  await tool(page, "examples");
  const opened = await timed(page, `[data-example="${name}"]`, null);
  await exact(page).catch(() => undefined);
  await page.waitForTimeout(700);
  // A source of the room, or else the eye.
  const handles = await page.locator("[data-stage-handle]").evaluateAll((all) => all.map((one) => (one as HTMLElement).dataset["stageHandle"]!));
  const handle = handles.find((one) => one.startsWith("lighting.directed")) ?? handles.find((one) => one === "viewer.theta_deg") ?? handles[0];
  const moves: Times[] = [];
  const before = on.processorMs();
  for (let i = 0; handle && i < MOVES; i++) {
    moves.push(await timed(page, `[data-stage-handle="${handle}"]`, "ArrowLeft"));
    await page.waitForTimeout(30);
  }
  const cpu = (on.processorMs() - before) / Math.max(1, moves.length);
  const [numbers, picture] = [median(moves.map((one) => one.numbers)), median(moves.map((one) => one.picture))];
  rows.push([name, ms(opened.numbers), ms(opened.picture), handle ?? "", ms(numbers), ms(picture), ms(cpu)].join(","));
  console.log(rows.at(-1));
}
writeFileSync(join(folder, "latency.csv"), `${rows.join("\n")}\n`);
await on.close();
