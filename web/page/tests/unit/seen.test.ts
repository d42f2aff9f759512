// The picture on the display: bytes of the server, colours on the screen, perspective.

import assert from "node:assert/strict";
import { test } from "node:test";

import { encoded, times, type Triple } from "../../src/model/colour.ts";
import { anglesOf, camera, fitting, limited, pointAt, tiltOf, type Frame } from "../../src/model/perspective.ts";
import { brighter, D65, exposure, halfValues, intensities, mixed, onScreen, unpacked } from "../../src/model/seen.ts";
import { colourAt, linear } from "../../src/plots/seen-2d.ts";

/** The bits of a number that 16 bits represent exactly. */
const bits = (value: number): number => halfValues().findIndex((known) => known === value);

/** A picture of 3 x 1 pixels in two lights, as the server sends it. */
function response(): ArrayBuffer {
  const head = {
    size: [3, 1],
    lights: [
      { light: "diffuse", white: [0.475, 0.5, 0.5] },
      { light: "directed.0", white: [0.5, 0.5, 0.25] },
    ],
    states: ["black", "white"],
    has_source: true,
  };
  let json = JSON.stringify(head);
  json = json.padEnd((json.length + 3) & ~3);
  const planes = [
    [0.25, 0.25, 0.25, 0, 0, 0, 0.125, 0.125, 0.125],
    [0.5, 0.5, 0.5, 0.25, 0.25, 0.25, 0, 0, 0],
    [1, 1, 1, 0, 0, 0, 1, 1, 1],
  ];
  const bytes = new Uint8Array(4 + json.length + 4 + 3 * 20);
  const view = new DataView(bytes.buffer);
  view.setUint32(0, json.length, true);
  bytes.set(new TextEncoder().encode(json), 4);
  bytes.set([1, 0, 1], 4 + json.length);
  planes.forEach((plane, k) =>
    plane.forEach((value, i) => view.setUint16(8 + json.length + 20 * k + 2 * i, bits(value), true)),
  );
  return bytes.buffer;
}

const close = (a: readonly number[], b: readonly number[], within = 1e-6) =>
  a.forEach((value, i) => assert.ok(Math.abs(value - b[i]!) <= within, `${a.join()} ${b.join()}`));

test("bytes of the server are read, with the mean of each state", () => {
  const seen = unpacked(response());
  assert.deepEqual([...seen.states], [1, 0, 1]);
  assert.deepEqual(seen.means[0], [
    [0, 0, 0],
    [0.1875, 0.1875, 0.1875],
  ]);
  assert.equal(seen.source!.planes[0]!.length, 9);
  assert.equal(halfValues()[0x7bff], 65504);
  assert.equal(halfValues()[0x8001], -(2 ** -24));
});

test("perfect white in any mixture of the lights is white, and the white of the display with that exposure", () => {
  const seen = unpacked(response());
  for (const factors of [
    [1, 1],
    [0.2, 3],
  ]) {
    const by = exposure(seen, factors, 500, "perfect");
    close(times(by.matrix, by.white), [1, 1, 1], 2e-4);
    const own = mixed(
      seen.means.map((light) => light[1]),
      factors,
    );
    close(times(exposure(seen, factors, 500, "display").matrix, own), [1, 1, 1], 2e-4);
  }
});

test("lamp that becomes brighter changes its own light", () => {
  const room = (lux: number, share: number) =>
    intensities({ lighting: { illuminance_lx: lux, diffuse: 1 - share, directed: [{ share }] } });
  const lights = [{ light: "diffuse" }, { light: "directed.0" }];
  close(brighter(lights, room(500, 0.5), room(1000, 0.25)), [3, 1]);
  assert.equal(room(500, 0.5).get("front_light"), 0);
});

test("screen in a room has its own light and what it reflects", () => {
  const seen = unpacked(response());
  const by = exposure(seen, [1, 1], 100 * Math.PI, "perfect");
  const { factors, added } = onScreen(by);
  // A perfect white has 100 cd/m2, the screen 300.
  close(factors, [3]);
  close(added, [0.039, 0.04, 0.03]);
  const bright = exposure(seen, [1, 1], 100 * Math.PI, "screen");
  close(times(bright.matrix, bright.white), [1 / 3.04, 1 / 3.04, 1 / 3.04], 2e-4);
});

test("colours on the canvas are those of the pixels, and means where pixels are small", () => {
  const seen = unpacked(response());
  const identity: Triple[] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ];
  const lit = { picture: seen, factors: [1, 0.5], added: [0, 0, 0] as Triple, matrix: identity };
  const pixels = linear(lit);
  close([...pixels], [0.5, 0.5, 0.5, 0.125, 0.125, 0.125, 0.125, 0.125, 0.125]);
  const of = (canvas: [number, number], scale: number) => ({
    lit,
    camera: camera([0, 0], 4, 1 / 3),
    frame: { canvas, scale, middle: [0, 0] } as Frame,
    lamps: [],
    subPixels: null,
  });
  close(colourAt(of([30, 10], 30), pixels, 5.5, 5.5)!, [0.5, 0.5, 0.5]);
  close(colourAt(of([30, 10], 30), pixels, 15.5, 5.5)!, [0.125, 0.125, 0.125]);
  assert.equal(colourAt(of([40, 10], 30), pixels, 4.5, 5.5), null);
  close(colourAt(of([1, 1], 1), pixels, 0.5, 0.5)!, [0.25, 0.25, 0.25]);
});

test("display that faces the eye fills the canvas, and its nearer side is larger", () => {
  const frame = (scale: number): Frame => ({ canvas: [400, 300], scale, middle: [0, 0] });
  const scale = fitting([400, 300], 0.75);
  close(pointAt(camera([0, 0], 3, 0.75), frame(scale), 200 + scale / 2, 150 - 0.375 * scale)!, [0.5, 0.375]);
  // From the right, the right side is nearer.
  const tilted = camera(tiltOf(60, 0), 3, 0.75);
  close(pointAt(tilted, frame(scale), 200, 150)!, [0, 0]);
  const [left, right] = [pointAt(tilted, frame(scale), 150, 150)!, pointAt(tilted, frame(scale), 250, 150)!];
  assert.ok(-left[0] > right[0] && right[0] > 0, `${left.join()} ${right.join()}`);
  assert.ok(left[0] < -50 / scale / Math.cos(Math.PI / 3));
});

test("direction of the eye has an inclination of at most 75 degrees", () => {
  assert.deepEqual(anglesOf(tiltOf(-20, 0)), { theta_deg: -20, phi_deg: 0 });
  assert.deepEqual(anglesOf(tiltOf(30, 90)), { theta_deg: 30, phi_deg: 90 });
  assert.deepEqual(anglesOf(limited([0, 300])), { theta_deg: 75, phi_deg: 90 });
});

test("sRGB of D65 is white", () => {
  assert.equal(Math.round(255 * encoded(0.5)), 188);
  close(D65, [0.95047, 1, 1.08883]);
});
