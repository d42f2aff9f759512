// Uploaded files: a measured diffuser, a broken file, a very large file, and a server that has lost the files.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";

import type { Page } from "playwright-core";

import { changed, figure, ROOT, settled, stage, type Stage, tool, type } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
after(() => on.close());

async function drop(page: Page, name: string, bytes: Buffer): Promise<void> {
  const data = await page.evaluateHandle(
    ([name, base64]) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], name));
      return transfer;
    },
    [name, bytes.toString("base64")] as const,
  );
  await page.dispatchEvent("body", "drop", { dataTransfer: data });
}

const data = (name: string): Buffer => readFileSync(join(ROOT, "scenarios/data", name));

test("measured diffuser is audited, drawn, used and restored after a restart of the server", async () => {
  const page = await on.visit();
  const before = await figure(page, "Gamut % sRGB");
  await drop(page, "H65.bsdf", data("H65.bsdf"));
  await page.locator(".file .words").waitFor({ timeout: 60_000 });
  assert.match(await page.locator(".file .words").innerText(), /H65[\s\S]*energy|haze|Haze/);
  assert.ok((await page.locator(".file img.drawn").count()) > 0);
  await page.locator(".file .uses button").first().click();
  await changed(page, "Gamut % sRGB", before);
  await settled(page);
  assert.match(await page.locator('[data-part="display.diffuser"]').innerHTML(), /H65\.bsdf/);
  const used = await figure(page, "Gamut % sRGB");

  // kill -9 and restart: the next result needs the file, which the page still has.
  await on.restart();
  await page.locator('[data-part="display.glass"]').click();
  await type(page, "display.glass.index", "1.52");
  await changed(page, "Gamut % sRGB", used);
  await page.reload();
  await page.locator(".bench").waitFor({ timeout: 60_000 });
  assert.match(await page.locator('[data-part="display.diffuser"]').innerHTML(), /H65\.bsdf/);
});

test("broken file is refused with a message, and the page continues to work", async () => {
  const page = await on.visit();
  await drop(page, "broken.bsdf", Buffer.from([0, 255, 1, 254, 10, 13, 0, 0, 7]));
  await page.locator(".file .error").waitFor();
  assert.ok((await page.locator(".file .error").innerText()).length > 10);
  await drop(page, "cut.bsdf", data("H65.bsdf").subarray(0, 2000));
  await page.locator(".file .error").nth(1).waitFor();
  await type(page, "display.diffuser.haze", "0.5");
  await changed(page, "Gamut % sRGB", "28.11");
});

test("file above the size limit is refused before it is sent", async () => {
  const page = await on.visit();
  await page.evaluate(() => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([new Uint8Array(65 * 1024 * 1024)], "huge.bsdf"));
    document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
  });
  await page.locator(".file .error", { hasText: "too large" }).waitFor();
});

test("file that the open tool uses keeps it open; another one is shown under Files", async () => {
  const page = await on.visit();
  const panel = (Y: number) => Buffer.from(`state,X,Y,Z\nwhite,0.5,${Y},0.6\nblack,0.02,0.03,0.04\n`);
  for (const [file, Y] of [["first.csv", 0.51], ["second.csv", 0.52]] as const) {
    await tool(page, "compare");
    await drop(page, file, panel(Y));
    await page.getByRole("combobox", { name: "Measured panel" }).filter({ hasText: file }).waitFor();
    assert.equal(await page.locator(".middle").getAttribute("data-tool"), "compare");
    assert.equal(await page.getByRole("combobox", { name: "Measured panel" }).inputValue(), file);
    await page.locator(".tool-command code", { hasText: `papilio compare indoor-reading.toml ${file}` }).waitFor();
  }
  await drop(page, "lamp.csv", data("rgb-led.csv"));
  await page.locator('.middle[data-tool="files"]').waitFor();
  await page.locator(".file", { hasText: "lamp.csv" }).waitFor();
  assert.match(await page.locator(".file", { hasText: "first.csv" }).locator("header").innerText(), /measured panel, 5\d bytes/);
});

test("two tabs keep different files with the same name", async () => {
  const one = await on.visit();
  const two = await one.context().newPage();
  await two.goto(on.url);
  await two.locator(".bench").waitFor();
  const dropped: [Page, string, string][] = [
    [one, "rgb-led.csv", "spectrum"],
    [two, "synthetic-pixel.csv", "pixel table"],
  ];
  for (const [page, file, kind] of dropped) {
    await drop(page, "mine.csv", data(file));
    await page.locator(".file .uses button").first().waitFor();
    assert.match(await page.locator(".file").innerText(), new RegExp(kind));
  }
  for (const [page, , kind] of dropped) {
    await page.reload();
    await page.locator(".bench").waitFor();
    await tool(page, "files");
    await page.locator(".file .uses button").first().waitFor();
    assert.match(await page.locator(".file").innerText(), new RegExp(kind));
  }
});

test("kind of a file is detected from its content", async () => {
  const page = await on.visit();
  const kinds = [
    ["rgb-led.csv", "spectrum"],
    ["fused-silica.yml", "n and k"],
    ["synthetic-pixel.csv", "pixel table"],
    ["synthetic-office.hdr", "light map"],
    ["synthetic-panel.ies", "luminaire"],
  ] as const;
  for (const [name, kind] of kinds) {
    await drop(page, name, data(name));
    const file = page.locator(".file", { hasText: name });
    await file.locator(".uses button").first().waitFor();
    assert.match(await file.innerText(), new RegExp(kind));
  }
  const before = await figure(page, "White cd/m²");
  await page.locator(".file", { hasText: "synthetic-office.hdr" }).locator(".uses button").first().click();
  await changed(page, "White cd/m²", before);
});
