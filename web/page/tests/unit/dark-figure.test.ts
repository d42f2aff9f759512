// Figures in the dark theme.

import assert from "node:assert/strict";
import { test } from "node:test";

import { darkFigure, inDark } from "../../src/model/dark-figure.ts";

test("ground, text and axes are exchanged, and areas keep their colours", () => {
  const svg =
    '<svg><rect fill="#ffffff"/><polyline stroke="#333333"/><text fill="#333333">a</text><rect fill="#111111"/><path stroke="#cc3311"/></svg>';
  const dark = darkFigure(svg);
  assert.match(dark, /^<svg><rect fill="#1d1d1d"\/>/);
  assert.match(dark, /<rect fill="#111111"\/>/, "the colour of a display");
  assert.match(dark, /<text fill="#bc/);
  assert.match(dark, /<path stroke="#cc3311"\/>/);
});

test("dark lines become lighter", () => {
  assert.equal(inDark("#000000"), "#e4e4e4");
  const [before, after] = ["#202080", inDark("#202080")].map((one) => parseInt(one.slice(1, 3), 16));
  assert.ok(after! > before! + 60);
});
