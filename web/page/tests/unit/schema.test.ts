// Forms are generated from the schema: the node at a path, keys, labels and sliders.

import assert from "node:assert/strict";
import { test } from "node:test";

import { position, span, valueAt } from "../../src/model/span.ts";
import { label, limits, Schema, uncapitalised, unit, unitOf } from "../../src/model/schema.ts";

const GRAMMAR = new Schema({
  $defs: {
    Diffuser: {
      oneOf: [
        {
          type: "object",
          properties: { model: { const: "ward" }, alpha: { type: "number", minimum: 0.005, maximum: 1 } },
          required: ["model", "alpha"],
        },
        {
          type: "object",
          properties: {
            model: { const: "k-correlation" },
            haze: { type: "number", exclusiveMinimum: 0, exclusiveMaximum: 1, description: "ASTM `haze`." },
            s: { type: "number", default: 0 },
          },
          required: ["model"],
        },
      ],
    },
  },
  type: "object",
  properties: {
    diffuser: { $ref: "#/$defs/Diffuser", description: "Beside the reference." },
    states: { type: "object", additionalProperties: { type: "object", properties: { red: { type: "number" } } } },
    films: { type: "array", items: { type: "object", properties: { t: { type: "number" } } } },
  },
});

test("value selects the alternative, and references are resolved", () => {
  const values = { diffuser: { model: "k-correlation", haze: 0.5 } };
  const found = GRAMMAR.find("diffuser.haze", values);
  assert.deepEqual(limits(found!.node), { min: 0, max: 1, open: [true, true] });
  assert.equal(GRAMMAR.find("diffuser.alpha", values), null);
  assert.equal(GRAMMAR.find("diffuser", values)!.node.description, "Beside the reference.");
  assert.equal(GRAMMAR.find("diffuser", values)!.def, "Diffuser");
  assert.equal(GRAMMAR.find("films.3.t", {})!.node.type, "number");
  assert.equal(GRAMMAR.find('states."a.b".red', { states: { "a.b": {} } })!.node.type, "number");
});

test("set keys without default come before those with a default, and the others can be added", () => {
  const found = GRAMMAR.find("diffuser", {})!;
  assert.deepEqual(GRAMMAR.keys(found.node, { model: "k-correlation", s: 0, haze: 0.5 }), {
    shown: ["haze", "s"],
    more: [],
  });
  assert.deepEqual(GRAMMAR.keys(found.node, { model: "k-correlation" }).more, ["haze", "s"]);
  assert.deepEqual(GRAMMAR.discriminator(found.node, {})!.values, ["ward", "k-correlation"]);
});

test("label and unit are derived from the key", () => {
  assert.equal(label("thickness_nm"), "Thickness");
  assert.equal(unit("thickness_nm"), "nm");
  assert.equal(unit("illuminance_lx"), "lx");
  assert.equal(unit("index"), "");
});

test("ends of a slider correspond to the ends of its range, linear or logarithmic", () => {
  for (const [key, range, value] of [
    ["thickness_nm", { min: 0, max: 1e6 }, 55.9],
    ["illuminance_lx", { min: 1e-6, max: 1e9 }, 500],
    ["haze", { min: 0, max: 1, open: [true, true] }, 0.78],
  ] as const) {
    const scale = span(key, range, value);
    assert.equal(valueAt(scale, 0), scale.min);
    assert.equal(valueAt(scale, 1), scale.max);
    assert.ok(Math.abs(valueAt(scale, position(scale, value)) / value - 1) < 0.01);
  }
  assert.ok(span("thickness_nm", { min: 0, max: 1e6 }, 900).max >= 900);
});

test("nested alternatives are found: a kind of layer with several models", () => {
  const fixed = (kind: string, model?: string) => ({
    type: "object",
    properties: { kind: { const: kind }, ...(model ? { model: { const: model }, [model]: { type: "number" } } : {}) },
  });
  const layers = new Schema({
    type: "object",
    properties: {
      layer: { oneOf: [fixed("medium"), { oneOf: [fixed("diffuser", "ward"), fixed("diffuser", "lambertian")] }] },
    },
  });
  const value = { kind: "diffuser", model: "lambertian" };
  const found = layers.find("layer", { layer: value })!;
  assert.deepEqual(layers.discriminator(found.node, value)!.values, ["ward", "lambertian"]);
  assert.deepEqual(layers.discriminator(found.node, { kind: "medium" })!.key, "kind");
  assert.ok(layers.find("layer.lambertian", { layer: value }));
  assert.equal(layers.find("layer.ward", { layer: value }), null);
});

test("units of numbers are those of their keys, or of the schema", () => {
  const of = (key: string, given?: string) => unitOf(key, given === undefined ? {} : { "x-unit": given });
  assert.deepEqual([of("range_nm"), of("azimuth_deg", "deg"), of("pitch_um"), of("text_size_pt"), of("volts", "V")], ["nm", "°", "µm", "pt", "V"]);
  assert.deepEqual([of("haze"), label("text_size_pt"), label("pitch_um")], ["", "Text size", "Pitch"]);
});

test("labels within a sentence keep the capitals of abbreviations", () => {
  assert.deepEqual(["Total transmittance", "CIE sky number", "n"].map(uncapitalised), ["total transmittance", "CIE sky number", "n"]);
});
