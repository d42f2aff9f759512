// The ranking of the search, on a small index. Run by `cargo xtask test` with Node.js.
import assert from "node:assert/strict";
import test from "node:test";

await import("../assets/search.js");
const { prepare, search, excerpt } = globalThis.papilioSearch;

const filler = "Light is reflected by the pixel below the glass and leaves towards the viewer. ".repeat(3);
const sections = [
  ["films.html", "Films", "", "Theory", `Coherent thin films. ${filler}`, ""],
  ["films.html#materials", "Films", "Materials", "Theory", `Names of materials, and tables of n and k. ${filler}`, ""],
  ["tolerance.html", "Tolerances", "", "How-to", `Production tolerances, percentiles and yield of films. ${filler}`, ""],
  ["scenario.html#gap", "The scenario", "gap_mm", "Reference", `The gap between components. ${filler}`, ""],
  ["metrics.html", "Metrics", "", "Reference", `Haze, contrast, Größe. films films ${filler}`, "haze contrast_ratio"],
];
const index = prepare(sections);
const addresses = (query) => search(index, query).map(([address]) => address);

test("words of a title and of a heading count more than words of the text", () => {
  assert.equal(addresses("films")[0], "films.html");
  assert.equal(addresses("materials")[0], "films.html#materials");
});

test("words of terms count more than words of the text", () => {
  assert.equal(addresses("contrast ratio")[0], "metrics.html");
});

test("plural matches singular, and capitals and accents do not matter", () => {
  assert.equal(addresses("film")[0], "films.html");
  assert.equal(addresses("TOLERANCE")[0], "tolerance.html");
  assert.deepEqual(addresses("GRÖßE"), ["metrics.html"]);
  assert.deepEqual(addresses("große"), ["metrics.html"]);
});

test("last word of a query may be the beginning of a word", () => {
  assert.equal(addresses("percent")[0], "tolerance.html");
  assert.deepEqual(addresses("percent yield"), ["tolerance.html"]);
});

test("sections with all words of the query come alone", () => {
  assert.deepEqual(addresses("production films"), ["tolerance.html"]);
  assert.equal(addresses("gap_mm")[0], "scenario.html#gap");
});

test("nothing is found for unknown words and empty queries", () => {
  assert.deepEqual(addresses("xylophone"), []);
  assert.deepEqual(addresses(" .,; "), []);
});

test("excerpt begins near the first word of the query and marks it", () => {
  const text = `${"before ".repeat(60)}the yield of films, ${"after ".repeat(60)}`;
  const pieces = excerpt(text, "film yield");
  assert.deepEqual(pieces.filter(([, isAsked]) => isAsked).map(([piece]) => piece), ["yield", "films"]);
  const shown = pieces.map(([piece]) => piece).join("");
  assert.ok(shown.startsWith("… ") && shown.endsWith(" …") && shown.length < 200, shown);
  assert.equal(excerpt("short text", "other").map(([piece]) => piece).join(""), "short text");
});
