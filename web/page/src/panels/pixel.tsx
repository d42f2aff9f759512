// The pixel alone, as by `papilio pixel`: its reflectance against angle and wavelength, and the absorptance of its layers.

import type { PixelScanned } from "../api/types.ts";
import { textAt } from "../model/json.ts";
import { Drawn } from "../plots/figure.tsx";
import { pixelAbsorbs, pixelMedium } from "../state/choices.ts";
import { fields } from "../state/design.ts";
import { useFollowed } from "../state/follow.ts";
import { Aged } from "./aged.tsx";
import { Downloads } from "./downloads.tsx";
import { Problems } from "./problems.tsx";

/** Time without changes after which the figures are requested, ms. */
const REST_MS = 300;

const NAMES: Readonly<Record<string, string>> = {
  pixel: "Reflectance of the pixel against angle and wavelength",
  absorption: "Absorptance of each layer of the film",
};

export function PixelPanel() {
  const [medium, absorbs] = [pixelMedium, pixelAbsorbs];
  const isFilm = textAt(fields.value, "display.pixel.model") === "film";
  const more = { angles: medium.value || null, absorption: isFilm && absorbs.value };
  const { value, age, problems, count } = useFollowed<PixelScanned>("pixel", more, REST_MS);
  return (
    <section class="pixel" aria-label="Pixel">
      <div class="controls">
        <label for="pixel-medium">Angles in</label>
        <select id="pixel-medium" value={medium.value} onChange={(event) => (medium.value = event.currentTarget.value)}>
          <option value="">the scenario's medium</option>
          <option value="glass">the glass above the pixel</option>
          <option value="air">air</option>
        </select>
        {isFilm && (
          <label>
            <input type="checkbox" checked={absorbs.value} onChange={(event) => (absorbs.value = event.currentTarget.checked)} />{" "}
            absorptance of each layer
          </label>
        )}
        {value?.tables.map(({ name, csv }) => (
          <Downloads key={name} name={name} table={() => csv} />
        ))}
      </div>
      <p class="remark">Without front, surface or diffuser. The light does not matter here.</p>
      <Problems of={problems} />
      {value && (
        <Aged age={age} count={count}>
          {value.figures.map(({ name, svg }) => (
            <Drawn key={name} name={name} svg={svg} label={NAMES[name] ?? name} />
          ))}
        </Aged>
      )}
    </section>
  );
}
