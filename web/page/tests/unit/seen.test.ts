// The picture on the display: bytes of the server, colours on the screen, perspective.

import assert from "node:assert/strict";
import { test } from "node:test";

import { displayed, encoded, hex, painted, times, type Triple } from "../../src/model/colour.ts";
import { anglesOf, camera, direction, extent, fitting, limited, pointAt, tiltOf, type Frame } from "../../src/model/perspective.ts";
import { glareFunction, glareOf, veil, type Lamp } from "../../src/model/glare.ts";
import { brighter, clippedShare, D65, exposure, halfValues, intensities, mixed, onScreen, unpacked } from "../../src/model/seen.ts";
import { lamps, mirrors } from "../../src/panels/image-parts.ts";
import type { Scenery } from "../../src/plots/seen.ts";
import { colours, linear } from "../../src/plots/seen-2d.ts";

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
    coverage: [1 / 3, 2 / 3],
    lamps: [
      { light: "directed.0", towards: [0.6, 0, 0.8], radius_deg: 2, is_collimated: false, XYZ: [[3, 3, 0], [6, 6, 0]] },
    ],
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
  const { factors, added } = onScreen(by, 300);
  // A perfect white has 100 cd/m2, the screen 300.
  close(factors, [3]);
  close(added, [0.039, 0.04, 0.03]);
  close(onScreen(by, "paper").factors, [0.9]);
  const bright = exposure(seen, [1, 1], 100 * Math.PI, "screen", 300);
  close(times(bright.matrix, bright.white), [1 / 3.04, 1 / 3.04, 1 / 3.04], 2e-4);
});

/** The light at a point of the canvas; null beside the display. */
function colourAt(of: Scenery, pixels: Float32Array, x: number, y: number): Triple | null {
  const into = new Float64Array(4);
  return colours(of, pixels)(x, y, into) ? [into[0]!, into[1]!, into[2]!] : null;
}

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
    mirrors: [],
    veils: [],
    subPixels: null,
  });
  close(colourAt(of([30, 10], 30), pixels, 5.5, 5.5)!, [0.5, 0.5, 0.5]);
  close(colourAt(of([30, 10], 30), pixels, 15.5, 5.5)!, [0.125, 0.125, 0.125]);
  assert.equal(colourAt(of([40, 10], 30), pixels, 4.5, 5.5), null);
  close(colourAt(of([1, 1], 1), pixels, 0.5, 0.5)!, [0.25, 0.25, 0.25]);
});

test("pixels of the canvas have the mean of what they show, between the projections of their corners", () => {
  // A ramp is its own mean, and a picture seen obliquely is where each of its points is projected to.
  const [columns, rows] = [40, 30];
  const planes = [new Uint16Array(3 * columns * rows)];
  const picture = { size: [columns, rows] as const, planes };
  const lit = { picture, factors: [1], added: [0, 0, 0] as Triple, matrix: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] as const };
  const pixels = new Float32Array(3 * columns * rows);
  for (let i = 0; i < columns * rows; i++) pixels.set([i % columns, Math.floor(i / columns), 1], 3 * i);
  for (const [tilt, scale, most] of [[0, 11, 1e-9], [0, 300, 1e-9], [50, 23, 0.02], [-60, 30, 0.02]] as const) {
    const from = camera(tiltOf(tilt, 20), 8, rows / columns);
    const frame: Frame = { canvas: [90, 70], scale, middle: [0.1, -0.05] };
    const at = colours({ lit, camera: from, frame, mirrors: [], veils: [], subPixels: null }, pixels);
    const into = new Float64Array(4);
    let [count, worst] = [0, 0];
    for (let y = 0.5; y < 70; y++)
      for (let x = 0.5; x < 90; x++) {
        const corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(([dx, dy]) => pointAt(from, frame, x + dx!, y + dy!)!);
        const places = corners.map(([p, q]) => [(p + 0.5) * columns, (0.5 - (q * columns) / rows) * rows] as const);
        const low = [0, 1].map((k) => Math.min(...places.map((one) => one[k as 0 | 1])));
        const high = [0, 1].map((k) => Math.max(...places.map((one) => one[k as 0 | 1])));
        const isInside = low[0]! >= 0 && low[1]! >= 0 && high[0]! <= columns && high[1]! <= rows;
        const isOutside = high[0]! < 0 || high[1]! < 0 || low[0]! > columns || low[1]! > rows;
        if (isOutside) assert.equal(at(x, y, into), false, `${x}, ${y}`);
        if (!isInside) continue;
        assert.ok(at(x, y, into));
        close([into[2]!, into[3]!], [1, 1], 1e-9);
        // The mean of floor(u) between two places.
        const mean = (k: 0 | 1): number => {
          const primitive = (t: number) => (Math.floor(t) * (Math.floor(t) - 1)) / 2 + Math.floor(t) * (t - Math.floor(t));
          return (primitive(high[k]!) - primitive(low[k]!)) / (high[k]! - low[k]!);
        };
        for (const k of [0, 1] as const) worst = Math.max(worst, Math.abs(into[k]! - mean(k)) / (1 + high[k]! - low[k]!));
        count++;
      }
    // Seen obliquely, what a pixel shows is computed to first order in its size.
    assert.ok(count > 50 && worst < most, `${tilt}: ${count} pixels, ${worst}`);
  }
});

test("borders of the display cover their pixels of the canvas in part", () => {
  const picture = { size: [1, 1] as const, planes: [Uint16Array.of(bits(0.5), bits(0.5), bits(0.5))] };
  const lit = { picture, factors: [1], added: [0, 0, 0] as Triple, matrix: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] as const };
  // A square of 10.5 pixels in the middle of 21: its left border is at 5.25.
  const frame: Frame = { canvas: [21, 21], scale: 10.5, middle: [0, 0] };
  const at = colours({ lit, camera: camera([0, 0], 4, 1), frame, mirrors: [], veils: [], subPixels: null }, linear(lit));
  const into = new Float64Array(4);
  const covered = (x: number) => (at(x, 10.5, into) ? into[3]! : 0);
  close([4.5, 5.5, 6.5, 15.5, 16.5].map(covered), [0, 0.75, 1, 0.75, 0], 1e-9);
});

/** A lamp to the right, 10 times as bright as a perfect white in its mirror image. */
const lampAt = (theta_deg: number, radius_deg: number): Lamp => ({
  number: 0,
  towards: direction(theta_deg, 0),
  radius_deg,
  isCollimated: false,
  image: [10, 10, 10],
  ofStates: new Map(),
});

test("mirror image of a lamp lies where the mirrored line of sight meets it, and is as wide as the lamp", () => {
  const picture = { size: [1, 1] as const, planes: [Uint16Array.of(bits(0.5), bits(0.5), bits(0.5))] };
  const identity: Triple[] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ];
  const lit = { picture, factors: [1], added: [0, 0, 0] as Triple, matrix: identity };
  for (const tilt of [0, 20]) {
    const from = camera(tiltOf(tilt, 0), 4, 1);
    const of = (mirrors: Scenery["mirrors"]): Scenery => {
      const frame: Frame = { canvas: [1000, 1000], scale: 1000, middle: [0, 0] };
      return { lit, camera: from, frame, mirrors, veils: [], subPixels: null };
    };
    // From an inclination, the image of a lamp on the other side is in the middle.
    const lamp = lampAt(5 - tilt, 1);
    const [scenery, pixels] = [of(mirrors([lamp], identity)), linear(lit)];
    const is = (angle: number): boolean => {
      // The line of sight at an angle from that to the middle is at this place of the canvas.
      const x = 500 + 1000 * 4 * Math.tan((angle * Math.PI) / 180);
      return colourAt(scenery, pixels, x, 500)![0] > 10;
    };
    assert.deepEqual([3.9, 4.1, 5, 5.9, 6.1].map(is), [false, true, true, true, false], String(tilt));
    // The same place, on the display, by the mirrored eye.
    const at = pointAt(from, scenery.frame, 500 + 4000 * Math.tan((5 * Math.PI) / 180), 500)!;
    const wanted = from.place[0] + from.place[2] * Math.tan(((5 - tilt) * Math.PI) / 180);
    close(at, [wanted, 0], 1e-9);
  }
});

test("mirror image is drawn as the mean over the picture, and has a luminance on each state", () => {
  const seen = unpacked(response());
  // Two pixels of three are white.
  const [lamp] = lamps(seen, [1, 2]);
  close(lamp!.image, [2 * (3 + 2 * 6), 2 * (3 + 2 * 6), 0].map((value) => value / 3), 1e-9);
  close(lamp!.towards, [-0.6, 0, 0.8]);
  assert.deepEqual([lamp!.number, lamp!.radius_deg, lamp!.isCollimated], [0, 2, false]);
  assert.deepEqual([...lamp!.ofStates], [["black", 6], ["white", 12]]);
});

test("what is brighter than the screen keeps its hue, in patches and in pictures", () => {
  close(displayed([0.5, 2, 1]), [0.25, 1, 0.5]);
  close(displayed([0.5, -0.1, 0.4]), [0.5, 0, 0.4]);
  assert.equal(hex([2, 2, 2]), "#ffffff");
  assert.equal(hex([0.5, 2, 1]), hex([0.25, 1, 0.5]));
  const D65_XY = [0.3127, 0.329] as const;
  const [white, black] = painted([[3.6, 3.8, 4.3], [0.1, 0.1, 0.1]], D65_XY);
  assert.deepEqual([white!.isClipped, black!.isClipped], [true, false]);
  // A dark state is as dark as beside a white that is not too bright.
  assert.equal(black!.colour, painted([[0.1, 0.1, 0.1]], D65_XY)[0]!.colour);
  const seen = unpacked(response());
  const identity: Triple[] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ];
  assert.equal(clippedShare(seen, [1, 1], identity), 0);
  assert.ok(Math.abs(clippedShare(seen, [1, 2], identity) - 1 / 3) < 1e-9);
});

test("glare function has the numbers of CIE 146", () => {
  for (const [theta, value] of [
    [0.1, 10513.3141],
    [1, 15.18053],
    [10, 0.067658],
    [100, 0.0022856],
  ] as const)
    assert.ok(Math.abs(glareFunction(theta) / value - 1) < 1e-6, String(theta));
  // At 62.5 years, the middle terms double.
  assert.ok(Math.abs(glareFunction(1, 62.5) - (10 + 2 * 5.05 + 0.00125)) < 1e-12);
  assert.equal(glareFunction(0), glareFunction(0.1));
});

test("veil comes from the part of the mirror image that lies on the display", () => {
  const from = camera([0, 0], 4, 0.75);
  const [whole, half] = [lampAt(2, 1), lampAt((Math.atan(0.125) * 180) / Math.PI, 1)].map((lamp) => glareOf(lamp, from)!);
  const solid = 2 * Math.PI * (1 - Math.cos(Math.PI / 180));
  close(whole!.light, [10 * solid, 10 * solid, 10 * solid], 1e-9);
  close(whole!.from, [Math.sin(Math.PI / 90), 0, -Math.cos(Math.PI / 90)], 1e-3);
  const share = half!.light[0] / whole!.light[0];
  assert.ok(share > 0.4 && share < 0.6, String(share));
  assert.equal(glareOf(lampAt(20, 1), from), null);
  const aside = veil(whole!, [0, 0, -1]);
  assert.ok(Math.abs(aside[1] / (10 * solid * glareFunction(2)) - 1) < 0.02, aside.join());
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

test("extent contains every pixel of the canvas at which the display is, and little more", () => {
  for (const [tilt, zoom, middle] of [[0, 1, [0, 0]], [60, 1, [0, 0]], [-75, 2, [0.1, -0.2]], [40, 8, [0.4, 0.3]]] as const) {
    const canvas = [160, 120] as const;
    const from = camera(tiltOf(tilt, 20), 0.8, 0.75);
    const frame: Frame = { canvas, scale: zoom * fitting(canvas, 0.75), middle };
    const [x, y, width, height] = extent(from, frame);
    const seen: [number, number][] = [];
    for (let j = 0; j < canvas[1]; j++)
      for (let i = 0; i < canvas[0]; i++) {
        const at = pointAt(from, frame, i + 0.5, j + 0.5);
        // Rows of the canvas begin at the top, those of the extent at the bottom.
        if (at && Math.abs(at[0]) <= 0.5 && Math.abs(at[1]) <= 0.375) seen.push([i, canvas[1] - 1 - j]);
      }
    const [columns, rows] = [seen.map(([i]) => i), seen.map(([, j]) => j)];
    for (const [all, low, size] of [[columns, x, width], [rows, y, height]] as const) {
      const [least, most] = [Math.min(...all), Math.max(...all)];
      assert.ok(low <= least && low >= least - 3, `${tilt}: from ${low}, seen from ${least}`);
      assert.ok(low + size > most && low + size <= most + 4, `${tilt}: to ${low + size}, seen to ${most}`);
    }
  }
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
