// The side view: equivalent directions are drawn at the same position.

import assert from "node:assert/strict";
import { test } from "node:test";

import { inPlane, mirrored, nearest, seen, sense, type Direction } from "../../src/model/plane.ts";

const close = (a: readonly number[], b: readonly number[]): void =>
  a.forEach((value, i) => assert.ok(Math.abs(value - b[i]!) < 1e-12, `${a.join()} and ${b.join()}`));

/** Returns a direction as a vector, independent of the tested code. */
function vector({ theta, phi }: Direction): [number, number, number] {
  const [t, p] = [(theta * Math.PI) / 180, (phi * Math.PI) / 180];
  return [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
}

test("equivalent directions have the same position", () => {
  for (const theta of [-89, -40, -8, 0, 8, 40, 89])
    for (const phi of [-360, -180, -90, -37, 0, 20, 90, 135, 180, 270, 360]) {
      const here = seen({ theta, phi });
      close(here, seen({ theta: -theta, phi: phi + 180 }));
      close(here, seen({ theta, phi: phi + 360 }));
      const [x, , z] = vector({ theta, phi });
      close(here, [x, z]);
    }
});

test("source at azimuth 180 is on the left, and its mirror image on the right", () => {
  close(seen({ theta: 40, phi: 180 }), seen({ theta: -40, phi: 0 }));
  assert.ok(seen({ theta: 40, phi: 180 })[0] < -0.6);
  assert.ok(seen(mirrored({ theta: 40, phi: 180 }))[0] > 0.6);
});

test("source outside the plane of the drawing is inside the half circle", () => {
  close(seen({ theta: 40, phi: 90 }), [0, Math.cos((40 * Math.PI) / 180)]);
  const [x, y] = seen({ theta: 40, phi: 60 });
  assert.ok(x > 0 && x < 0.35 && Math.hypot(x, y) < 1);
  // Specular reflection rotates the direction by 180° about the normal.
  const [mx, my, mz] = vector(mirrored({ theta: 40, phi: 60 }));
  close(
    [mx, my, mz],
    [-1, -1, 1].map((sign, i) => sign * vector({ theta: 40, phi: 60 })[i]!),
  );
});

test("direction in the plane of the drawing is recognised", () => {
  for (const phi of [0, 180, -180, 360, 0.5]) assert.ok(inPlane({ theta: 30, phi }), String(phi));
  for (const phi of [90, 5, 175, -90]) assert.ok(!inPlane({ theta: 30, phi }), String(phi));
  assert.ok(inPlane({ theta: 0, phi: 77 }));
});

test("inclination nearest to the position of a direction is its own", () => {
  for (const phi of [0, 30, 120, 180, -60, 90])
    for (const theta of [-80, -30, -0.5, 12.5, 60]) {
      const from = { theta: theta + 3 * Math.sign(theta), phi };
      assert.equal(nearest(seen({ theta, phi }), from, 0.5, 89), theta, `${theta}, ${phi}`);
    }
  assert.equal(nearest([2, 0], { theta: 0, phi: 0 }, 0.5, 89), 89);
  assert.equal(nearest([2, 0], { theta: 0, phi: 180 }, 0.5, 89), -89);
});

test("arrow keys move to the left and to the right", () => {
  for (const phi of [0, 30, 90, 120, 180, 270]) {
    const [now, then] = [seen({ theta: 10, phi }), seen({ theta: 10 + sense(phi), phi })];
    assert.ok(then[0] >= now[0], String(phi));
  }
});
