import assert from "node:assert/strict";
import { test } from "node:test";

import { LETTER, placed } from "../../src/plots/place.ts";

test("names of points at the edges stay inside the drawing and beside other text", () => {
  const [width, height] = [496, 444];
  const other = { left: 180, right: 260, top: 0, bottom: 24 };
  for (const size of [1, 1.6, 2.3])
    for (const [x, y] of [[200, 12], [480, 60], [300, 436], [480, 436]] as const) {
      const name = "magenta";
      const [at] = placed([{ name, x, y }], size, [width, height], [other]);
      const [long, half] = [LETTER * size * name.length, 8 * size];
      const left = at!.x - (at!.anchor === "end" ? long : at!.anchor === "middle" ? long / 2 : 0);
      assert.ok(left >= 0 && left + long <= width + 0.5, `${size} ${x}: ${left}`);
      assert.ok(at!.y - half >= -8 && at!.y <= height + 4, `${size} ${y}: ${at!.y}`);
      const isOver = left < other.right && left + long > other.left && at!.y - half < other.bottom - 4;
      assert.ok(!isOver, `${size} ${x} ${y}: on other text`);
    }
});
