// Soak: a visitor clicks at random for an hour, and the memory of the server is recorded; then all is left at rest for a minute. Writes
// soak.csv and soak.svg: `npm run soak -- MINUTES FOLDER`.

import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

import { TOOLS } from "../src/model/tools.ts";
import { example, stage, tool } from "./e2e/stage.ts";

const [minutes = "60", folder = "soak"] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const END_MS = Number(minutes) * 60_000;
const REST_MS = 60_000;
/** Time between two clicks, ms. */
const PAUSE_MS = 700;
/** Limits of docs/web.md, MB. */
const [PEAK_MB, REST_MB] = [700, 400];

/** The same numbers from 0 to 1 in every run (Mulberry32). */
let state = 57;
function random(): number {
  state = (state + 0x6d2b79f5) | 0;
  let t = Math.imul(state ^ (state >>> 15), 1 | state);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
}
const oneOf = <T>(all: readonly T[]): T => all[Math.floor(random() * all.length)]!;

const on = await stage();
const since = Date.now();
const rows: [seconds: number, now: number, peak: number, clicks: number][] = [];
let clicks = 0;
const sample = (): void => {
  const { now, peak } = on.memory();
  rows.push([(Date.now() - since) / 1000, now, peak, clicks]);
};
const clock = setInterval(sample, 1000);

const page = await on.visit();
// Most clicks that fail are those on what is not there at this moment.
page.setDefaultTimeout(4000);
await page.getByRole("button", { name: "Got it" }).click();
await tool(page, "examples");
const names = await page.locator("[data-example]").evaluateAll((all) => all.map((one) => (one as HTMLElement).dataset["example"]!));

/** Steps of the keyboard on whatever is a handle or a range of the page. */
async function move(): Promise<void> {
  const all = page.locator("[data-stage-handle], [data-handle], .field input[type=range]");
  const count = await all.count();
  if (count === 0) return;
  const one = all.nth(Math.floor(random() * count));
  if (!(await one.isVisible())) return;
  await one.focus({ timeout: 2000 });
  const key = oneOf(["ArrowLeft", "ArrowRight", "PageUp", "PageDown"]);
  for (let i = 0; i < 4; i++) await page.keyboard.press(key);
}

const ACTIONS: readonly [name: string, weight: number, act: () => Promise<void>][] = [
  ["open an example", 3, () => example(page, oneOf(names))],
  ["open a tool", 3, () => tool(page, oneOf(TOOLS).id)],
  ["open the stage", 2, () => tool(page, "stage")],
  ["move", 8, move],
  ["undo", 1, () => page.keyboard.press("Control+z")],
  ["keep a version", 1, () => page.getByRole("button", { name: "Keep this version" }).click({ timeout: 2000 })],
  ["reload", 1, async () => void (await page.reload(), await page.locator(".bench").waitFor())],
];
const BAG = ACTIONS.flatMap(([name, weight, act]) => Array.from({ length: weight }, () => ({ name, act })));
const failures = new Map<string, number>();

while (Date.now() - since < END_MS) {
  clicks += 1;
  const { name, act } = oneOf(BAG);
  await act().catch(() => failures.set(name, 1 + (failures.get(name) ?? 0)));
  await page.waitForTimeout(PAUSE_MS);
}
await page.context().close();
await new Promise((resolve) => setTimeout(resolve, REST_MS));
clearInterval(clock);
sample();
await on.close();

const csv = ["seconds,resident_mb,peak_mb,clicks", ...rows.map(([s, now, peak, n]) => `${s.toFixed(1)},${now.toFixed(1)},${peak.toFixed(1)},${n}`)];
writeFileSync(join(folder, "soak.csv"), `${csv.join("\n")}\n`);

/** The memory curve. */
function curve(): string {
  const [width, height, left, top, right, bottom] = [720, 300, 60, 20, 20, 45];
  const [last, most] = [rows.at(-1)![0] / 60, 800];
  const x = (minute: number): number => left + ((width - left - right) * minute) / last;
  const y = (mb: number): number => height - bottom - ((height - top - bottom) * Math.min(mb, most)) / most;
  const path = rows.map(([s, now], i) => `${i === 0 ? "M" : "L"}${x(s / 60).toFixed(1)} ${y(now).toFixed(1)}`).join("");
  const step = [1, 2, 5, 10, 20].find((one) => last / one <= 8) ?? 30;
  const ticks = Array.from({ length: Math.floor(last / step) + 1 }, (_, i) => i * step);
  const limit = (mb: number, words: string): string =>
    `<path d="M${left} ${y(mb)}H${width - right}" stroke="#b3261e" stroke-dasharray="6 4"/><text x="${width - right}" y="${y(mb) - 5}" text-anchor="end">${words}, ${mb} MB</text>`;
  return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="12" fill="#333">
<rect width="${width}" height="${height}" fill="#fff"/>
${[0, 200, 400, 600, 800].map((mb) => `<path d="M${left} ${y(mb)}H${width - right}" stroke="#ddd"/><text x="${left - 6}" y="${y(mb) + 4}" text-anchor="end">${mb}</text>`).join("\n")}
${ticks.map((minute) => `<text x="${x(minute)}" y="${height - bottom + 16}" text-anchor="middle">${minute}</text>`).join("")}
${limit(PEAK_MB, "limit at peak")}${limit(REST_MB, "limit at rest")}
<path d="${path}" fill="none" stroke="#1f5fa8" stroke-width="1.3"/>
<text x="${(left + width - right) / 2}" y="${height - 8}" text-anchor="middle">time, min</text>
<text transform="translate(14 ${(top + height - bottom) / 2}) rotate(-90)" text-anchor="middle">resident memory of the server, MB</text>
</svg>
`;
}
writeFileSync(join(folder, "soak.svg"), curve());

const [, rest, peak] = rows.at(-1)!;
const words = `${minutes} min, ${clicks} clicks, ${[...failures.values()].reduce((a, b) => a + b, 0)} of which found nothing: peak ${peak.toFixed(0)} MB (limit ${PEAK_MB}), at rest ${rest.toFixed(0)} MB (limit ${REST_MB})`;
console.log(words);
for (const [name, count] of failures) console.log(`  ${name}: ${count} found nothing`);
const errors = [...new Set(on.complaints.filter((one) => !/status of 4\d\d|net::ERR_/.test(one)))];
if (errors.length > 0) console.log(`errors in the browser:\n  ${errors.join("\n  ")}`);
if (peak > PEAK_MB || rest > REST_MB) {
  console.error("soak: the server uses more memory than docs/web.md says");
  process.exitCode = 1;
}
