import assert from "node:assert/strict";
import { test } from "node:test";

import { renamable, renamed } from "../../src/model/state-names.ts";

const STATES = ["white", "black", "red"];

test("names of columns that contain a state are offered as that state, and their units stay", () => {
  const text = "White tile;BaSO4\nWavelength (nm);White R (%);panel-7 black;Red [%]\n400;12,4;5,1;4,6\n";
  assert.deepEqual(renamable(text, STATES), [
    ["White R", "white"],
    ["panel-7 black", "black"],
  ]);
  assert.equal(renamed(text, STATES).split("\n")[1], "Wavelength (nm);white (%);black;Red [%]");
  assert.deepEqual([0, 2, 3].map((i) => renamed(text, STATES).split("\n")[i]), [0, 2, 3].map((i) => text.split("\n")[i]));
});

test("names in the column of states are offered once", () => {
  const text = "# black; 5 nm for R_white, white, red\nstate,wavelength_nm,reflectance_factor\nR_white,400,0.1\nR_white,410,0.1\nblack,400,0.01\n";
  assert.deepEqual(renamable(text, STATES), [["R_white", "white"]]);
  assert.equal(renamed(text, STATES), text.replaceAll(/^R_white/gm, "white"));
});

test("names that are states, that contain none or two of them, or of which two contain the same, are not offered", () => {
  for (const head of ["nm,white,Black", "nm,sample 1,sample 2", "nm,red on white", "nm,white 1,white 2", "nm,white,white 2"])
    assert.deepEqual(renamable(`${head}\n400,0.1,0.2\n`, STATES), [], head);
});
