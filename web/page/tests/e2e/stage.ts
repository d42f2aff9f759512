// The environment of the end-to-end tests: `papilio serve` on a free port, and the Chromium of the system.
//
// PAPILIO is the path of the program (default: target/release/papilio, then target/debug/papilio), CHROMIUM that of the
// browser.

import { execFileSync, spawn, type ChildProcess } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";

import { chromium, type Browser, type BrowserContextOptions, type Download, type Page, type Route } from "playwright-core";

import { idOf } from "../../src/fields/id.ts";
import { stepOf } from "../../src/model/tools.ts";

export const ROOT = fileURLToPath(new URL("../../../../", import.meta.url));

const found = (candidates: (string | undefined)[], what: string): string => {
  const one = candidates.find((path) => path && existsSync(path));
  if (!one) throw new Error(`${what} not found: ${candidates.filter(Boolean).join(", ")}`);
  return one;
};

export const PAPILIO = found(
  [process.env["PAPILIO"], join(ROOT, "target/release/papilio"), join(ROOT, "target/debug/papilio")],
  "papilio",
);
export const CHROMIUM = found(
  [process.env["CHROMIUM"], "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"],
  "Chromium",
);

export interface Memory {
  readonly now: number;
  readonly peak: number;
}

export interface Stage {
  readonly url: string;
  /** Opens the page in a new context; errors and warnings of the browser are collected in `complaints`. */
  visit(options?: BrowserContextOptions, fragment?: string): Promise<Page>;
  readonly complaints: string[];
  /** Resident memory of the server, now and at most since it was started, MB. */
  memory(): Memory;
  /** Processor time of the server since it was started, ms. */
  processorMs(): number;
  /** Kills the server and starts it again on the same port. */
  restart(): Promise<void>;
  /** Kills the server. */
  kill(): Promise<void>;
  /** Starts the server again on the same port. */
  revive(): Promise<void>;
  /** Suspends the server, or continues it. */
  halt(isHalted: boolean): void;
  /** Closes all pages, whose requests end with them. */
  leave(): Promise<void>;
  close(): Promise<void>;
}

/** A folder with the page, instead of the one in the program: for tests of a page that was built after it. */
const PAGE = process.env["PAPILIO_PAGE_FOLDER"];

const KINDS: Record<string, string> = { html: "text/html; charset=utf-8", js: "text/javascript", css: "text/css", svg: "image/svg+xml", ttf: "font/ttf" };

/** Answers a request for a file of the page, with the headers of the program. */
async function fromFolder(route: Route): Promise<void> {
  const { pathname } = new URL(route.request().url());
  const name = pathname === "/" ? "index.html" : pathname.slice(1);
  const head = await route.fetch().catch(() => null);
  const { "content-length": _, ...headers } = head?.headers() ?? {};
  const kind = KINDS[name.split(".").at(-1)!] ?? "application/octet-stream";
  await route.fulfill({ status: 200, headers: { ...headers, "content-type": kind }, body: readFileSync(join(PAGE!, name)) });
}

/** The folder of jobs, the same for a server that starts again. */
const JOBS = mkdtempSync(join(tmpdir(), "papilio-jobs-"));

async function serve(port: number): Promise<{ url: string; child: ChildProcess }> {
  const child = spawn(PAPILIO, ["serve", "--port", String(port), "--jobs", JOBS], { stdio: ["ignore", "pipe", "inherit"] });
  for await (const line of createInterface({ input: child.stdout! })) {
    const url = /http:\S+/.exec(line)?.[0];
    if (url) return { url: url.endsWith("/") ? url : `${url}/`, child };
  }
  throw new Error("papilio serve ended before it printed its address");
}

/** Reads the resident memory of a process from /proc (Linux). */
function memoryOf(pid: number): Memory {
  const status = readFileSync(`/proc/${pid}/status`, "utf8");
  const of = (key: string): number => Number(new RegExp(`^${key}:\\s+(\\d+) kB`, "m").exec(status)?.[1]) / 1024;
  return { now: of("VmRSS"), peak: of("VmHWM") };
}

/** Processor time of a process, in steps of 10 ms (Linux). */
function processorMsOf(pid: number): number {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ").at(-1)!.split(" ");
  // utime and stime, in hundredths of a second.
  return 10 * (Number(fields[11]) + Number(fields[12]));
}

export async function stage(): Promise<Stage> {
  let { url, child } = await serve(0);
  const browser: Browser = await chromium.launch({
    executablePath: CHROMIUM,
    args: ["--no-sandbox", "--disable-gpu", "--force-color-profile=srgb"],
  });
  const complaints: string[] = [];
  const kill = async (): Promise<void> => {
    child.kill("SIGKILL");
    await new Promise((resolve) => child.once("exit", resolve));
  };
  const revive = async (): Promise<void> => {
    ({ child } = await serve(Number(new URL(url).port)));
  };
  return {
    url,
    complaints,
    memory: () => memoryOf(child.pid!),
    processorMs: () => processorMsOf(child.pid!),
    async visit(options = {}, fragment = "") {
      const context = await browser.newContext({
        viewport: { width: 1440, height: 900 },
        colorScheme: "light",
        ...options,
      });
      if (PAGE) await context.route((address) => !address.pathname.startsWith("/api/"), fromFolder);
      const page = await context.newPage();
      page.on(
        "console",
        (message) =>
          (message.type() === "error" || message.type() === "warning") &&
          // The page repeats what a busy server has refused.
          !/status of 503/.test(message.text()) &&
          // The software renderer of WebGL reports each screenshot and each frame that is read back.
          !/GPU stall due to ReadPixels/.test(message.text()) &&
          complaints.push(message.text()),
      );
      page.on("pageerror", (error) => complaints.push(error.message));
      page.on(
        "request",
        (request) =>
          !request.url().startsWith(url) &&
          !/^(blob|data):/.test(request.url()) &&
          complaints.push(`request to another host: ${request.url()}`),
      );
      await page.goto(url + fragment);
      await page.locator(".bench").waitFor();
      await exact(page);
      // The picture, which is shown first, has tests of its own (image.test.ts), and takes time in all others.
      await tool(page, fragment.startsWith("?") ? "image" : "states");
      return page;
    },
    kill,
    revive,
    halt: (isHalted) => void child.kill(isHalted ? "SIGSTOP" : "SIGCONT"),
    async restart() {
      await kill();
      await revive();
    },
    async leave() {
      await Promise.all(browser.contexts().map((context) => context.close()));
    },
    async close() {
      await browser.close();
      child.kill("SIGKILL");
    },
  };
}

/** Opens a tool of the page, in its step. */
export async function tool(page: Page, id: string): Promise<void> {
  await page.locator(`.steps [data-step="${stepOf(id).id}"]`).evaluate((one: HTMLElement) => one.click());
  await page.locator(`#tab-${id}`).evaluate((one: HTMLElement) => one.click());
}

/** Opens an example from the gallery. */
export async function example(page: Page, name: string): Promise<void> {
  const before = await page.locator(".middle").getAttribute("data-tool");
  await tool(page, "examples");
  await page.locator(`[data-example="${name}"]`).evaluate((one: HTMLElement) => one.click());
  await page.locator('.middle:not([data-tool="examples"])').waitFor();
  if (before && before !== "examples") await tool(page, before);
}

/** Returns the names of the examples in the gallery. */
export async function examples(page: Page): Promise<readonly string[]> {
  await tool(page, "examples");
  const all = page.locator("[data-example]");
  return all.evaluateAll((all) => all.map((one) => (one as HTMLElement).dataset["example"]!));
}

/** Returns the colours of the states as the page shows them, when they are exact; none where there is no result. */
export async function patches(page: Page): Promise<readonly string[]> {
  await settled(page);
  const isExact = (): boolean =>
    document.querySelector('.picture[aria-busy="false"]') !== null && document.querySelector('.age-mark[data-age="first"], .age-mark[data-age="before"]') === null;
  await page.waitForFunction(isExact, undefined, { timeout: 60_000 });
  const swatches = page.locator(".patches .swatch");
  return swatches.evaluateAll((all) =>
    all.map((one) => {
      const parts = getComputedStyle(one).backgroundColor.match(/\d+/g)!;
      return `#${parts.slice(0, 3).map((part) => Number(part).toString(16).padStart(2, "0")).join("")}`;
    }),
  );
}

/** Returns a number of the summary as it is shown. */
export const figure = (page: Page, name: string): Promise<string> =>
  page.locator(`[data-figure="${name}"] b`).innerText();

/** Waits until the shown result is not a first answer. */
export const exact = (page: Page): Promise<void> =>
  page.locator('.age-mark[data-age="first"]').waitFor({ state: "detached" });

/** Waits until a number of the summary has changed and is exact, and returns it. */
export async function changed(page: Page, name: string, from: string): Promise<string> {
  await page.waitForFunction(
    ([name, from]) =>
      document.querySelector(`[data-figure="${name}"] b`)?.textContent !== from &&
      document.querySelector('.age-mark[data-age="first"]') === null,
    [name, from] as const,
  );
  return figure(page, name);
}

/** Waits until no request is in progress. */
export async function settled(page: Page): Promise<void> {
  await page.waitForLoadState("networkidle");
  await page.waitForTimeout(150);
}

/** Returns the file that an action downloads. */
export async function downloaded(
  page: Page,
  act: () => Promise<unknown>,
): Promise<{ name: string; text: string; bytes: Buffer }> {
  const waiting: Promise<Download> = page.waitForEvent("download");
  await act();
  const download = await waiting;
  const bytes = readFileSync(await download.path());
  return { name: download.suggestedFilename(), text: bytes.toString("utf8"), bytes };
}

/** Clicks Save and returns the scenario. */
export const saved = async (page: Page): Promise<string> =>
  (await downloaded(page, () => page.getByRole("button", { name: "Save", exact: true }).click())).text;

/** Returns the result of `papilio run` for a scenario. */
export function commandLine(scenario: string): {
  views: { gamut_percent_srgb: number; contrast_ratio: number; states: Record<string, { Y: number }> }[];
} {
  const file = join(mkdtempSync(join(tmpdir(), "papilio-")), "scenario.toml");
  writeFileSync(file, scenario);
  return JSON.parse(
    execFileSync(PAPILIO, ["run", file, "--json"], {
      encoding: "utf8",
      maxBuffer: 1e9,
      stdio: ["ignore", "pipe", "ignore"],
    }),
  ) as never;
}

/** Drags a handle of the drawing; distances in px. */
export async function drag(page: Page, handle: string, dx: number, dy: number): Promise<void> {
  const box = (await page.locator(`[data-handle="${handle}"] .target`).boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 8; i++) await page.mouse.move(x + (dx * i) / 8, y + (dy * i) / 8);
  await page.mouse.up();
}

/** Opens a menu and selects an item. */
export async function choose(page: Page, menu: string | RegExp, item: string): Promise<void> {
  await page.getByRole("button", { name: menu }).click();
  await page.locator(`.menu [data-item="${item}"]`).click();
}

/** Returns all items of a menu. */
export async function itemsOf(page: Page, menu: string | RegExp): Promise<string[]> {
  await page.getByRole("button", { name: menu }).click();
  const items = await page
    .locator(".menu [data-item]")
    .evaluateAll((all) => all.map((one) => (one as HTMLElement).dataset["item"]!));
  await page.keyboard.press("Escape");
  return items;
}

/** Types a value into a field. */
export async function type(page: Page, path: string, value: string): Promise<void> {
  await page.locator(`[id=${JSON.stringify(idOf(path))}]`).fill(value);
}
