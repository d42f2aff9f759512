// The picture on the display: its colours are those of the program, by the graphics processor and without; it follows pointer and files.

import assert from "node:assert/strict";
import { after, afterEach, before, test } from "node:test";

import type { Page } from "playwright-core";

import { choose, downloaded, example, itemsOf, settled, stage, tool, type Stage } from "./stage.ts";

let on: Stage;
before(async () => (on = await stage()));
// A search of a page that is open takes time from the next test.
afterEach(() => on.leave());
after(() => on.close());

const CANVAS = ".seen-display canvas";

/** Opens the six inks with the picture; `more` is the end of the address. */
async function sixInks(more: string): Promise<Page> {
  const page = await on.visit({}, more);
  await example(page, "six-ink");
  await page.waitForFunction(
    () => document.querySelector<HTMLInputElement>("input.title")?.value === "Six-ink electronic paper",
  );
  await fresh(page);
  return page;
}

/** Waits until the picture is that of the current light and view, and its search has ended. */
async function fresh(page: Page): Promise<void> {
  await settled(page);
  const words = { hasText: "prepared for this light and view", hasNotText: "a better one" };
  await page.locator(".seen-display figcaption", words).waitFor({ timeout: 30_000 });
  await settled(page);
}

/** Saves a file of the picture. */
const saved = (page: Page, what: string) => downloaded(page, () => choose(page, "Download files of the picture", what));

/** Decodes a PNG in the browser: columns, rows, and red, green, blue, opacity of each pixel. */
const decoded = (page: Page, png: Buffer): Promise<{ width: number; height: number; data: number[] }> =>
  page.evaluate(async (base64) => {
    const bytes = Uint8Array.from(atob(base64), (one) => one.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes]), { colorSpaceConversion: "none" });
    const { width, height } = picture;
    const context = new OffscreenCanvas(width, height).getContext("2d")!;
    context.drawImage(picture, 0, 0);
    return { width, height, data: [...context.getImageData(0, 0, width, height).data] };
  }, png.toString("base64"));

for (const [painter, more] of [
  ["WebGL2", "?webgl"],
  ["canvas", "?canvas"],
] as const)
  test(`colours of the picture by ${painter} equal those of papilio image`, { timeout: 120_000 }, async () => {
    const page = await sixInks(more);
    const canvas = page.locator(CANVAS);
    assert.equal(await canvas.getAttribute("data-painter"), painter);
    const wanted = await decoded(page, (await saved(page, "seen.png")).bytes);
    for (let i = 0; i < 4; i++) await page.getByRole("button", { name: "Larger" }).click();
    await settled(page);
    await page.mouse.move(0, 0);
    const shown = await decoded(page, await canvas.screenshot());
    const scale = Number(await canvas.getAttribute("data-scale"));
    assert.ok(scale > 3, String(scale));
    let [count, worst] = [0, 0];
    // The pixels in the middle of the canvas: its corners are round.
    for (let row = 130; row < 170; row++)
      for (let column = 200; column < 251; column++) {
        const x = Math.floor(shown.width / 2 + (column + 0.5 - wanted.width / 2) * scale);
        const y = Math.floor(shown.height / 2 + (row + 0.5 - wanted.height / 2) * scale);
        const [at, here] = [4 * (y * shown.width + x), 4 * (row * wanted.width + column)];
        for (let k = 0; k < 3; k++, count++)
          worst = Math.max(worst, Math.abs(shown.data[at + k]! - wanted.data[here + k]!));
      }
    assert.ok(count > 6000 && worst <= 1, `${count} values, largest difference ${worst}`);
    assert.deepEqual(on.complaints.splice(0), []);
  });

test("display is tilted by pointer and keys, and its states are decided again after that", { timeout: 120_000 }, async () => {
  const page = await sixInks("?");
  const box = (await page.locator(CANVAS).boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= 10; i++) await page.mouse.move(x - 10 * i, y);
  await page.getByText("The display, seen from 30°").waitFor();
  await page.getByText("prepared for an earlier light and view").waitFor({ timeout: 30_000 });
  await page.mouse.up();
  await fresh(page);
  await page.locator(CANVAS).focus();
  await page.keyboard.press("ArrowLeft");
  await page.getByText("The display, seen from 29°").waitFor();
  await page.getByLabel("the panel keeps its picture").check();
  await page.locator(CANVAS).focus();
  await page.keyboard.press("ArrowLeft");
  await page.getByRole("button", { name: "Reset the view" }).click();
  // The design has one view, which the picture has moved: numbers and picture are of the same view.
  await page.getByText("The display, seen from 28°").waitFor();
  await page.locator(".views", { hasText: "seen from 28°" }).waitFor();
  await page.getByText("prepared for an earlier light and view").waitFor({ timeout: 30_000 });
  assert.deepEqual(on.complaints.splice(0), []);
});

test("without a halftone the picture has exact colours and no states", { timeout: 120_000 }, async () => {
  const page = await sixInks("?");
  await page.getByLabel("Halftone").selectOption("none");
  await page.getByText("exact colours without a halftone").waitFor({ timeout: 30_000 });
  await page.getByText("there are no states for the panel to download").waitFor();
  const files = await itemsOf(page, "Download files of the picture");
  assert.ok(!files.includes("states.png") && !files.includes("frame.bin") && files.includes("seen.png"), files.join());
  await page.getByLabel("Halftone").selectOption("ordered");
  await fresh(page);
  assert.ok((await itemsOf(page, "Download files of the picture")).includes("states.png"));
  assert.deepEqual(on.complaints.splice(0), []);
});

test("default halftone is shown before the search, unless one is chosen", { timeout: 120_000 }, async () => {
  const page = await on.visit({}, "?");
  const halftones: (string | null)[] = [];
  page.on("request", (request) => {
    if (!request.url().endsWith("/image")) return;
    const { halftone, held } = request.postDataJSON() as { halftone: string | null; held?: string };
    if (held === undefined) halftones.push(halftone);
  });
  const caption = page.locator(".seen-display figcaption");
  // The server may know the better one from before: all words are kept, however short they are shown.
  await page.evaluate(() => {
    const words: string[] = ((globalThis as any).words = []);
    new MutationObserver(() =>
      words.push(document.querySelector<HTMLElement>(".seen-display figcaption")?.innerText ?? ""),
    ).observe(document.body, { childList: true, characterData: true, subtree: true });
  });
  await example(page, "six-ink");
  await caption.getByText("prepared for this light and view by direct binary search").waitFor({ timeout: 60_000 });
  const words = await page.evaluate<string[]>("words");
  assert.ok(words.some((one) => one.includes("by refined error diffusion; a better one is being searched for")), words.join());
  assert.deepEqual(halftones.slice(-2), ["refined-error-diffusion", "direct-binary-search"]);
  await page.getByLabel("Halftone").selectOption("refined-error-diffusion");
  await caption.getByText("prepared for this light and view by refined error diffusion").waitFor({ timeout: 30_000 });
  await settled(page);
  assert.doesNotMatch(await caption.innerText(), /searched/);
  assert.equal(halftones.at(-1), "refined-error-diffusion");
  assert.deepEqual(on.complaints.splice(0), []);
});

/** Black and white paper below glass, seen from 20 degrees, with a round lamp. */
const GLOSSY = `
title = "Below glass"
[display.glass]
index = 1.5
surface = "fresnel"
thickness_mm = 0.3
[display.matrix]
ppi = 127
pixels = [300, 200]
[display.pixel]
model = "uniform"
kind = "lambertian"
reflectance = { white = 0.45, black = 0.03 }
[image]
text = "I"
[lighting]
illuminance_lx = 300
diffuse = 0.6
[[lighting.directed]]
theta_deg = -20
share = 0.4
radius_deg = 1
[viewer]
theta_deg = 20
distance_mm = 500
`;

test("mirror image of a lamp lies on the display with its veil, and not beside it", { timeout: 120_000 }, async () => {
  const page = await on.visit({}, "?");
  const chooser = page.locator(".seen input[type=file]");
  await chooser.setInputFiles({ name: "glossy.toml", mimeType: "text/plain", buffer: Buffer.from(GLOSSY) });
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>("input.title")?.value === "Below glass");
  await fresh(page);
  const legend = page.locator(".seen .remark");
  assert.match(await legend.innerText(), /lamp 1, 2° wide, [\d.]+ cd\/m²: on the display\. Glare: a veil of/);
  const canvas = page.locator(CANVAS);
  const read = async () => {
    await settled(page);
    await page.mouse.move(0, 0);
    const { width, height, data } = await decoded(page, await canvas.screenshot());
    const scale = Number(await canvas.getAttribute("data-scale"));
    // Pixels of the display about its middle; the eye is at 500 mm, 2500 pixels of the panel.
    return (degrees: number) => {
      const x = Math.round(width / 2 + scale * 2500 * Math.tan((degrees * Math.PI) / 180));
      return data[4 * (Math.floor(height / 2) * width + x) + 1]!;
    };
  };
  const glaring = await read();
  assert.deepEqual([-0.9, 0, 0.9].map(glaring), [255, 255, 255]);
  await page.getByLabel("glare").uncheck();
  const plain = await read();
  assert.deepEqual([-0.9, 0, 0.9].map(plain), [255, 255, 255]);
  for (const degrees of [-1.2, 1.2, 2]) {
    assert.ok(plain(degrees) < 200, `${plain(degrees)}`);
    assert.ok(glaring(degrees) > plain(degrees) + 10, `${degrees}: ${glaring(degrees)} ${plain(degrees)}`);
  }
  assert.doesNotMatch(await legend.innerText(), /Glare/);
  await canvas.focus();
  for (let i = 0; i < 12; i++) await page.keyboard.press("ArrowLeft");
  await legend.getByText("beside the display from here").waitFor();
  await page.locator('.seen-display[data-age="current"]').waitFor({ timeout: 30_000 });
  assert.ok((await read())(0) < 200);
  assert.deepEqual(on.complaints.splice(0), []);
});

test("sub-pixels show where pixels are large, each in its own colour", { timeout: 120_000 }, async () => {
  for (const more of ["?webgl", "?canvas"]) {
    const page = await on.visit({}, more);
    await example(page, "matrix");
    await page.waitForFunction(() => document.querySelector<HTMLInputElement>("input.title")!.value === "Sub-pixels at 300 ppi");
    await fresh(page);
    const caption = page.locator(".seen-display figcaption");
    assert.doesNotMatch(await caption.innerText(), /Magnifier/);
    for (let i = 0; i < 9; i++) await page.getByRole("button", { name: "Larger" }).click();
    await caption.getByText("Magnifier: the panel's sub-pixels").waitFor();
    await settled(page);
    await page.mouse.move(0, 0);
    const canvas = page.locator(CANVAS);
    const { width, height, data } = await decoded(page, await canvas.screenshot());
    const scale = Number(await canvas.getAttribute("data-scale"));
    assert.ok(scale > 20, String(scale));
    // Stripes of red, green and blue with widths of 0.493, 0.381 and 0.126 of a pixel, each in its colour or dark.
    const seen = [new Set<string>(), new Set<string>(), new Set<string>()];
    for (let row = -4; row < 4; row++)
      for (let column = -6; column < 6; column++)
        [0.25, 0.68, 0.94].forEach((part, stripe) => {
          const [x, y] = [width / 2 + (column + part) * scale, height / 2 + (row + 0.5) * scale];
          const at = 4 * (Math.floor(y) * width + Math.floor(x));
          const colour = [data[at]!, data[at + 1]!, data[at + 2]!];
          seen[stripe]!.add(Math.max(...colour) > 130 ? String(colour.indexOf(Math.max(...colour))) : "dark");
        });
    // Green of this display is as blue as green.
    assert.deepEqual([...seen[0]!].sort(), ["0", "dark"]);
    assert.ok(seen[1]!.has("1") && seen[1]!.has("dark") && !seen[1]!.has("0"), [...seen[1]!].join());
    assert.ok(seen[2]!.has("2") && seen[2]!.has("dark") && !seen[2]!.has("0"), [...seen[2]!].join());
  }
  assert.deepEqual(on.complaints.splice(0), []);
});

test("picture that is chosen is shown, and sent to the panel; a broken one is refused", { timeout: 120_000 }, async () => {
  const page = await sixInks("?");
  const drawn = await page.evaluate(async () => {
    const canvas = new OffscreenCanvas(64, 48);
    const context = canvas.getContext("2d")!;
    context.fillStyle = "#ffffff";
    context.fillRect(0, 0, 64, 48);
    context.fillStyle = "#c00000";
    context.fillRect(8, 8, 24, 24);
    const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: "image/png" })).arrayBuffer());
    return [...bytes];
  });
  const chooser = page.locator(".seen input[type=file]");
  await chooser.setInputFiles({ name: "square.png", mimeType: "image/png", buffer: Buffer.from(drawn) });
  await page.getByText("square.png: 64 × 48 pixels").waitFor({ timeout: 30_000 });
  await fresh(page);
  const states = await saved(page, "states.png");
  assert.deepEqual(
    [...states.bytes.subarray(16, 26)],
    [0, 0, 0, 64, 0, 0, 0, 48, 8, 3],
    "an indexed picture of 64 x 48 pixels",
  );
  assert.match((await saved(page, "palette.gpl")).text, /^GIMP Palette[\s\S]*\tyellow$/m);
  await chooser.setInputFiles({ name: "cut.png", mimeType: "image/png", buffer: Buffer.from(drawn.slice(0, 60)) });
  await page.locator("#tab-panel .error").first().waitFor();
  assert.deepEqual(
    on.complaints.splice(0).filter((words) => !/status of 422/.test(words)),
    [],
  );
});

/** Opens a scenario with the picture. */
async function openText(page: Page, scenario: string, title: string): Promise<void> {
  const chooser = page.locator(".seen input[type=file]");
  await chooser.setInputFiles({ name: "own.toml", mimeType: "text/plain", buffer: Buffer.from(scenario) });
  await page.waitForFunction((title) => document.querySelector<HTMLInputElement>("input.title")?.value === title, title);
  await fresh(page);
}

test("mirror images of lamps and glare do not depend on the halftone", { timeout: 240_000 }, async () => {
  const page = await on.visit({}, "?");
  const legend = page.locator(".seen .remark");
  const images = async () => /Mirror image of lamp 1.*?(?:on black|collimated: drawn [\d.]+° wide)/.exec(await legend.innerText())?.[0];
  const inEach = async (): Promise<(string | undefined)[]> => {
    const all = [];
    for (const halftone of ["none", "error-diffusion", "ordered"]) {
      await page.getByLabel("Halftone").selectOption(halftone);
      await page.locator('.seen-display[data-age="current"]').waitFor({ timeout: 60_000 });
      all.push(await images());
    }
    return all;
  };
  await example(page, "antiglare");
  await page.waitForFunction(() => document.querySelector<HTMLInputElement>("input.title")?.value === "Antiglare glass over 300 ppi");
  const [none, ...others] = await inEach();
  assert.match(none!, /4° wide, [\d. ]+ cd\/m² on \w+ and [\d. ]+ cd\/m² on black/);
  assert.deepEqual(others, [none, none]);
  // Collimated light.
  await openText(page, GLOSSY.replace("radius_deg = 1\n", ""), "Below glass");
  const [collimated, ...rest] = await inEach();
  assert.match(collimated!, /whose light is collimated: drawn 0\.5° wide/);
  assert.match(await legend.innerText(), /on the display\. Glare: a veil of/);
  assert.deepEqual(rest, [collimated, collimated]);
  assert.deepEqual(on.complaints.splice(0), []);
});

test("white that is too bright for the screen has one colour in patch and picture, with a note at both", { timeout: 120_000 }, async () => {
  for (const more of ["?webgl", "?canvas"]) {
    const page = await on.visit({}, more);
    await page.locator('[data-handle="lighting.directed.0.theta_deg"]').focus();
    for (let i = 0; i < 10; i++) await page.keyboard.press("ArrowRight");
    await page.locator(".patches .remark", { hasText: "Clipped: " }).waitFor({ timeout: 30_000 });
    assert.match(await page.locator(".patches .remark").innerText(), /white[\s\S]* brighter than the screen can show/);
    await page.getByLabel("Halftone").selectOption("none");
    await page.getByLabel("glare").uncheck();
    await page.locator('.seen-display[data-age="current"]').waitFor({ timeout: 60_000 });
    await page.locator(".seen-display figcaption", { hasText: "Clipped: " }).waitFor();
    const patch = await page
      .locator('.patch[data-state="white"] .swatch')
      .evaluate((swatch) => getComputedStyle(swatch).backgroundColor.match(/\d+/g)!.map(Number));
    await settled(page);
    const { data } = await decoded(page, await page.locator(CANVAS).screenshot());
    const colours = new Map<string, number>();
    for (let at = 0; at < data.length; at += 4) {
      const colour = data.slice(at, at + 3).join();
      colours.set(colour, (colours.get(colour) ?? 0) + 1);
    }
    // The paper of the page, which is most of the picture.
    const near = [...colours].filter(([colour]) => colour.split(",").every((value, k) => Math.abs(Number(value) - patch[k]!) <= 2));
    const count = near.reduce((sum, [, one]) => sum + one, 0);
    assert.ok(count > 0.2 * (data.length / 4), `${patch.join()}: ${[...colours].sort((a, b) => b[1] - a[1]).slice(0, 4).join(" ")}`);
    assert.ok(Math.max(...patch) === 255 && Math.min(...patch) < 250, patch.join());
    await page.close();
  }
  assert.deepEqual(on.complaints.splice(0), []);
});

test("photograph of 24 megapixels is reduced by the browser", { timeout: 240_000 }, async () => {
  const page = await on.visit({}, "?");
  await page.evaluate("globalThis.__name = (of) => of");
  const drawn = await page.evaluate(async () => {
    const canvas = new OffscreenCanvas(6000, 4000);
    const context = canvas.getContext("2d")!;
    context.fillStyle = "#c08040";
    context.fillRect(0, 0, 6000, 4000);
    const bytes = new Uint8Array(await (await canvas.convertToBlob({ type: "image/jpeg", quality: 0.9 })).arrayBuffer());
    let text = "";
    for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
    return btoa(text);
  });
  const chooser = page.locator(".seen input[type=file]");
  await chooser.setInputFiles({ name: "photo.jpg", mimeType: "image/jpeg", buffer: Buffer.from(drawn, "base64") });
  await page.locator(".said", { hasText: "it was reduced to 4242 × 2828 pixels" }).waitFor({ timeout: 60_000 });
  await page.getByText("photo.jpg: 480 × 320 pixels").waitFor({ timeout: 120_000 });
  assert.deepEqual(on.complaints.splice(0), []);
});

test("display of one state is shown in it, without a halftone", { timeout: 120_000 }, async () => {
  const page = await on.visit();
  for (const name of ["circular-polariser", "etched-grades"]) {
    await example(page, name);
    await tool(page, "stage");
    await page.locator('.seen-display[data-age="current"] figcaption', { hasText: "all of it is in its only state" }).waitFor({ timeout: 60_000 });
  }
  assert.deepEqual(on.complaints.splice(0), []);
  await page.context().close();
});
