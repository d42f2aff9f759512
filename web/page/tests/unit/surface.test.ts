// Surfaces: another kind keeps what has the same meaning, the verdict follows the audit, and places in a display are found.

import assert from "node:assert/strict";
import { test } from "node:test";

import { faceName, facesOf, ofKind, placesOf, SURFACES, verdict, type SurfaceAudit } from "../../src/model/surface.ts";
import type { Table } from "../../src/model/json.ts";
import { note } from "../../src/model/kinds.ts";
import { edited } from "../../src/state/edits.ts";

test("another kind keeps keys with the same meaning that are not defaults", () => {
  const now = { surface: "gaussian", rms_nm: 123, correlation_um: 7, index_above: 1, index_below: 1.62, rays: 200_000 };
  const isWritten = (key: string) => ["rms_nm", "correlation_um", "index_below"].includes(key);
  const exponential = {
    surface: "exponential",
    rms_nm: 123,
    correlation_um: 7,
    cutoff_um: 1,
    road: "waves",
    index_below: 1.62,
  };
  assert.deepEqual(ofKind("exponential", now, isWritten), exponential);
  assert.deepEqual(ofKind("flat", now, isWritten), { surface: "flat", index_below: 1.62 });
  assert.deepEqual(ofKind("volume", now, isWritten), { surface: "volume", ...SURFACES["volume"]!.starter });
  assert.deepEqual(ofKind("mesh", {}, isWritten, "a.obj"), { surface: "mesh", file: "a.obj" });
});

const AUDIT: SurfaceAudit = {
  rays: 2_560_000,
  dropped_rays: 0,
  energy_z: [1, -1, 1, -1],
  reciprocity_z: 1.04,
  moved_by_symmetry: 0.002,
  moved_by_balance: 0.001,
  relative_error: 0.056,
  haze_by_rays: null,
  haze_by_rays_error: null,
  waves: [],
  heights: null,
};

test("verdict states standard errors, lost rays and the error of the kernel", () => {
  const { agrees, words } = verdict(AUDIT)!;
  assert.ok(agrees);
  assert.match(words, /^Rays obey reciprocity by 1\.0 .* energy by 1\.0 standard errors/);
  assert.match(words, /0\.30 % of the light moved.* none lost; mean error of the kernel 5\.6 %/);
  assert.equal(verdict({ ...AUDIT, energy_z: [3, -3] })!.agrees, false);
  assert.match(verdict({ ...AUDIT, reciprocity_z: 2.5, dropped_rays: 2 })!.words, /^Rays miss .* 2 lost/);
  const { rays: _, ...byWaves } = AUDIT;
  assert.equal(verdict(byWaves), null);
});

const FACE = { kind: "diffuser", model: "microgeometry", surface: "../surfaces/etched.toml", rms_nm: 400 };

test("surfaces of a display are found and named", () => {
  const kernel = { kind: "diffuser", model: "microgeometry", file: "face.npz" };
  const faces = facesOf({ display: { layers: [{ kind: "medium", index: 1.5 }, FACE, kernel] } });
  assert.deepEqual(faces.map(faceName), ["etched.toml (layer 2)", "face.npz (layer 3)"]);
  assert.deepEqual(
    faces.map(({ isKernel }) => isKernel),
    [false, true],
  );
  assert.deepEqual(
    facesOf({ display: { diffuser: FACE } }).map(({ path }) => path),
    ["display.diffuser"],
  );
  assert.equal(note(FACE), "etched.toml, rms 400 nm");
});

test("surface takes the place of an interface, and of the diffuser on the glass", () => {
  const layers: Table[] = [FACE, { kind: "medium", index: 1.5 }, { kind: "rough", alpha: 0.1 }, { kind: "slab" }];
  const places = placesOf({ display: { layers } });
  assert.deepEqual(
    places.map(({ name }) => name),
    ["In place of the surface, layer 1", "In place of the rough interface, layer 3"],
  );
  const after = edited({ display: { layers } }, places[1]!.edits("mine.toml"));
  const face = { kind: "diffuser", model: "microgeometry", surface: "mine.toml", rays: 20_000 };
  assert.deepEqual(after, { display: { layers: [layers[0], layers[1], face, layers[3]] } });

  const panel = { display: { glass: { index: 1.5, surface: "fresnel" } } };
  const [glass] = placesOf(panel);
  assert.equal(glass!.name, "On the glass");
  const { kind: _, ...diffuser } = face;
  assert.deepEqual(edited(panel, glass!.edits("mine.toml")), { display: { glass: { index: 1.5 }, diffuser } });
});
