// Failures of tab, server and browser must not lose changes.

import assert from "node:assert/strict";
import { spawn, type ChildProcess } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { after, before, test } from "node:test";

import { chromium, type Page } from "playwright-core";

import { play } from "./lost.ts";
import { CHROMIUM, settled, stage, type, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

/** The seed of the sequence of failures. */
const SEED = Number(process.env["PAPILIO_MISHAPS"] ?? 19);

test("fifty random failures lose no change", { timeout: 900_000 }, () => play(on, SEED, 50));

/** Starts a separate browser with a permanent profile, and opens a page in it. */
async function launched(profile: string): Promise<{ page: Page; kill(): Promise<void> }> {
  const options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--remote-debugging-port=0"];
  // A process group, so that all processes of the browser are killed together.
  const child: ChildProcess = spawn(CHROMIUM, [...options, `--user-data-dir=${profile}`, "about:blank"], {
    stdio: ["ignore", "ignore", "pipe"],
    detached: true,
  });
  let address: string | undefined;
  for await (const line of createInterface({ input: child.stderr! })) {
    address = /listening on (ws:\S+)/.exec(line)?.[1];
    if (address) break;
  }
  const browser = await chromium.connectOverCDP(address!);
  const page = await browser.contexts()[0]!.newPage();
  return {
    page,
    async kill() {
      const ended = new Promise((resolve) => child.once("exit", resolve));
      process.kill(-child.pid!, "SIGKILL");
      await ended;
      rmSync(join(profile, "SingletonLock"), { force: true });
    },
  };
}

test("killed browser loses no change that it had time to write", { timeout: 120_000 }, async () => {
  const profile = mkdtempSync(join(tmpdir(), "papilio-browser-"));
  const open: { kill(): Promise<void> }[] = [];
  try {
    for (const haze of ["0.61", "0.62", "0.63"]) {
      const first = await launched(profile);
      open.push(first);
      await first.page.goto(on.url);
      await first.page.locator(".bench").waitFor();
      await type(first.page, "display.diffuser.haze", haze);
      await settled(first.page);
      on.halt(true);
      await first.page.locator(".title").fill(`Half typed ${haze}`);
      await first.page.waitForTimeout(300);
      await open.pop()!.kill();
      on.halt(false);
      const second = await launched(profile);
      open.push(second);
      await second.page.goto(on.url);
      await second.page.locator(".bench").waitFor();
      await settled(second.page);
      const text = await second.page.evaluate(
        () => (JSON.parse(sessionStorage.getItem("papilio.tab")!) as { text: string }).text,
      );
      assert.match(text, new RegExp(`haze = ${haze}`));
      assert.match(text, new RegExp(`title = "Half typed ${haze}"`));
      await second.page.getByRole("button", { name: "Undo" }).click();
      await open.pop()!.kill();
    }
  } finally {
    on.halt(false);
    for (const browser of open) await browser.kill();
    rmSync(profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 100 });
  }
});
