// The site in a browser, as files of a disk: accessibility, requests, keyboard, narrow screens, print, and pages without scripts.
//
// Environment: SITE (folder of the site), CHROMIUM (path of the browser), PAGE (folder web/page, whose axe-core and playwright-core are
// used). Run by `cargo xtask full`.
import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";
import test, { after, before } from "node:test";
import { pathToFileURL } from "node:url";

const { SITE, CHROMIUM, PAGE } = process.env;
const require = createRequire(path.join(PAGE, "package.json"));
const { chromium } = require("playwright-core");
const AXE = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const address = (page) => pathToFileURL(path.join(SITE, page)).href;
const texts = new Map(
  readdirSync(SITE, { recursive: true })
    .map((name) => name.replaceAll(path.sep, "/"))
    .filter((name) => name.endsWith(".html") && !name.startsWith("api/rust/"))
    .map((name) => [name, readFileSync(path.join(SITE, name), "utf8")]),
);

/** The first page with a text, besides the page that has everything. */
const pageWith = (text) => [...texts].find(([name, html]) => name !== "all.html" && html.includes(text))?.[0];

/** A page of each kind. Pages with equations are checked as soon as there is one. */
const KINDS = [
  ...["index.html", "scenario.html", "glossary.html", "web.html", "notebooks/1-first-display.html", "api/python/index.html"],
  ...["repository/ARCHITECTURE.html", "repository/scenarios/index.html", "repository/scenarios/matrix.toml.html"],
  ...["<figcaption>", "<math display=\"block\"", "<blockquote", "class=\"footnote"].map(pageWith).filter((name) => name !== undefined),
];

let browser;
before(async () => {
  browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
});
after(() => browser.close());

/** Opens a page; what it requests and prints is recorded. */
const opened = async (name, options = {}) => {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
  const page = await context.newPage();
  const record = { requests: [], messages: [] };
  page.on("request", (request) => record.requests.push(request.url()));
  page.on("console", (message) => record.messages.push(message.text()));
  page.on("pageerror", (error) => record.messages.push(error.message));
  await page.goto(address(name));
  return { page, context, record };
};

const violations = async (page) => {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => globalThis.axe.run(document, { preload: false, runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"] }));
  return violations.flatMap(({ id, nodes }) => nodes.slice(0, 3).map(({ html, failureSummary }) => `${id}: ${html.slice(0, 200)} ${failureSummary}`));
};

for (const colorScheme of ["light", "dark"]) {
  for (const name of KINDS) {
    test(`${name} has no axe violations and prints no messages, ${colorScheme}`, async () => {
      const { page, context, record } = await opened(name, { colorScheme });
      assert.deepEqual(await violations(page), []);
      assert.deepEqual(record.messages, []);
      assert.deepEqual(record.requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:")), []);
      await context.close();
    });
  }
}

test("no page requests anything outside, not even as one with all pictures and the search", async () => {
  const { page, context, record } = await opened("all.html");
  await page.keyboard.press("/");
  await page.keyboard.type("haze");
  await page.waitForSelector(".search li a");
  assert.deepEqual(record.requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:")), []);
  assert.deepEqual(record.messages, []);
  const broken = await page.evaluate(async () => {
    const images = [...document.images];
    await Promise.all(images.map((image) => image.decode().catch(() => {})));
    return images.filter((image) => image.naturalWidth === 0).map((image) => image.src.slice(0, 100));
  });
  assert.deepEqual(broken, []);
  await context.close();
});

test("search by keyboard opens the section that is meant", async () => {
  const { page, context } = await opened("tolerance.html");
  await page.keyboard.press("/");
  await page.keyboard.type("named materials");
  await page.waitForSelector(".search li a");
  assert.deepEqual(await violations(page), []);
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await page.waitForURL(/films\.html#named-materials$/);
  await page.keyboard.press("Control+k");
  assert.ok(await page.locator("dialog.search").isVisible());
  await page.keyboard.press("Escape");
  assert.ok(!(await page.locator("dialog.search").isVisible()));
  await context.close();
});

/** Questions of engineers, and the page that one of the first three answers must be on. */
const QUESTIONS = [
  ["haze of a diffuser", "diffusers.html"],
  ["named materials", "films.html"],
  ["material of my own", "how-to/own-material.html"],
  ["yield production tolerance", "tolerance.html"],
  ["contrast ratio", "metric-names.html"],
  ["standard error monte carlo", "monte-carlo.html"],
  ["zemax bsdf", "bsdf-files.html"],
  ["crosstalk sub-pixel", "crosstalk.html"],
  ["gap_nm", "scenario.html"],
  ["front light", "scenario.html"],
  ["henyey greenstein", "scattering.html"],
  ["resume sweep", "sweeps.html"],
  ["render with mitsuba", "brdf.html"],
  ["walk", "versions.html"],
];

test("search answers questions of engineers among its first three results", async () => {
  const { page, context } = await opened("index.html");
  await page.keyboard.press("/");
  for (const [question, expected] of QUESTIONS) {
    await page.fill(".search input", question);
    await page.waitForFunction(() => document.querySelector(".search .count").textContent.includes("section"));
    const first = await page.evaluate((query) => papilioSearch.search(papilioSearch.prepare(window.papilioIndex), query, 3).map(([to]) => to), question);
    assert.ok(first.some((to) => to.split("#")[0] === expected), `${question}: ${first}`);
  }
  await context.close();
});

test("choice of colours lasts on the next page", async () => {
  const { page, context } = await opened("films.html");
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await background();
  await page.click(".theme");
  await page.click(".theme");
  assert.notEqual(await background(), light);
  await page.goto(address("light.html"));
  assert.notEqual(await background(), light);
  assert.equal(await page.getAttribute(".theme", "aria-label"), "Colours: dark");
  await context.close();
});

test("code of a session is copied without prompts and output", async () => {
  const { page, context } = await opened("python.html", { permissions: ["clipboard-read", "clipboard-write"] });
  const block = page.locator(".code", { hasText: "28.11" }).first();
  await block.hover();
  await block.locator(".copy").click();
  await page.waitForSelector(".copy.done");
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  assert.equal(copied, 'import papilio\nresult = papilio.run("scenarios/indoor.toml")\nround(float(result["gamut_percent_srgb"][0]), 2)\n');
  await context.close();
});

test("no page is wider than a narrow screen", async () => {
  const { page, context } = await opened("index.html", { viewport: { width: 360, height: 740 } });
  for (const name of texts.keys()) {
    await page.goto(address(name));
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 360, `${name}: ${width}`);
  }
  await context.close();
});

test("lines of prose have 60 to 85 characters on a wide screen", async () => {
  const { page, context } = await opened("monte-carlo.html");
  const characters = await page.evaluate(() => {
    const paragraphs = [...document.querySelectorAll("article > p")].filter((p) => p.textContent.length > 400);
    return paragraphs.map((p) => p.textContent.length / Math.round(p.getBoundingClientRect().height / Number.parseFloat(getComputedStyle(p).lineHeight)));
  });
  assert.ok(characters.length > 0);
  characters.forEach((count) => assert.ok(count > 60 && count < 85, `${count}`));
  await context.close();
});

test("without scripts, pages can be read and the menu of a narrow screen opens", async () => {
  const { page, context } = await opened("films.html", { javaScriptEnabled: false, viewport: { width: 390, height: 800 } });
  assert.ok(await page.locator("h1").isVisible());
  assert.ok(await page.locator(".code .command").first().isVisible());
  assert.ok(!(await page.locator("#navigation").isVisible()));
  await page.click(".menu");
  assert.ok(await page.locator("#navigation").isVisible());
  await page.click("#navigation a[aria-current]");
  await page.click("a.next");
  assert.notEqual(new URL(page.url()).pathname.split("/").pop(), "films.html");
  await context.close();
});

test("keyboard reaches the content first, and then the tools", async () => {
  const { page, context } = await opened("films.html");
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.textContent), "Skip to the content");
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement.id), "content");
  await context.close();
});

test("printed page has the text alone, in dark colours on white", async () => {
  const { page, context } = await opened("films.html", { colorScheme: "dark" });
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  for (const hidden of [".top", "#navigation", ".contents", ".steps"]) assert.ok(!(await page.locator(hidden).isVisible()), hidden);
  assert.ok(await page.locator("h1").isVisible());
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)");
  const paper = await page.pdf({ format: "A4" });
  assert.ok(paper.length > 20_000, `${paper.length}`);
  await context.close();
});
