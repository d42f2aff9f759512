// The readability of black text on white, for a reader of a certain age.

import { fixed, NONE, plain, withError } from "../model/format.ts";
import { at, type Json } from "../model/json.ts";
import { Field } from "../fields/form.tsx";
import { fields, result, view } from "../state/design.ts";
import { set } from "../state/live.ts";

/** A row of the table: name, value and explanation. */
type Row = [string, string, string];

const AGES = [20, 50, 75] as const;
const KEYS = [
  { key: "age_years", name: "Age of the reader" },
  { key: "text_height_mm", name: "Height of the lower-case x" },
  { key: "distance_mm", name: "Distance of the eye" },
] as const;

/** The keys of the reader. A key that the scenario leaves out has a button that sets it to its default. */
function Reader() {
  const reader = result.value?.reader;
  if (!reader) return null;
  return (
    <div class="reader">
      {KEYS.map(({ key, name }) => {
        const path = `viewer.${key}`;
        if (at(fields.value as Json, path) !== undefined) return <Field key={key} path={path} name={name} />;
        const unit = key === "age_years" ? "years" : "mm";
        const text = `${plain(reader[key])} ${unit}`;
        return (
          <div class="field" key={key} data-path={path}>
            <span>
              {name}: {text}, not specified
            </span>{" "}
            <button type="button" class="quiet" onClick={() => set(path, reader[key])}>
              Set {name.toLowerCase()}
            </button>
          </div>
        );
      })}
    </div>
  );
}

/** Returns the rows of the dissertation's estimate for small print, or the bounds of its range. */
function smallPrint(now: NonNullable<typeof view.value>): Row[] {
  const known = AGES.filter((age) => typeof now[`reading_surrogate_age_${age}`] === "number");
  if (known.length === 0) {
    const [luminance, contrast] = [now.text_luminance_cd_m2 ?? NaN, now.text_contrast ?? NaN];
    const bounds = [
      luminance < 1000 && "the text is darker than 1000 cd/m²",
      luminance > 5200 && "the text is brighter than 5200 cd/m²",
      contrast < 0.35 && "its contrast is below 0.35",
      contrast > 0.9 && "its contrast is above 0.9",
    ].filter(Boolean);
    return [["Table 5.3 of Feng 2012", NONE, `no estimate of reading performance: ${bounds.join(", ")}`]];
  }
  return known.map((age) => {
    const key = `reading_surrogate_age_${age}` as const;
    const value = withError(100 * (now[key] ?? NaN), 100 * (now.standard_error[key] ?? 0), 1);
    return [`Small print, ${age} years`, `${value} %`, "reading performance, calibrated with Feng 2012, table 5.3"];
  });
}

/** Returns the explanation of a number, with a remark if it is outside the range of its model. */
const explained = (text: string, inRange: boolean | null | undefined): string =>
  inRange === false ? `${text}. Outside the range of its data: ${RANGE}` : text;

const RANGE = "text of 0.1 to 10 000 cd/m², details of 0.3 to 60 arcmin, readers of 23 to 75 years";

export function Readability() {
  const now = view.value;
  const reader = result.value?.reader;
  if (!now || !reader) return null;
  if (typeof now.text_luminance_cd_m2 !== "number") {
    return <p class="remark">Readability is that of black text on white: it needs the states white and black.</p>;
  }
  const error = now.standard_error;
  const detail = `${fixed(reader.detail_arcmin, 1)}′`;
  const rows: Row[] = [
    [
      "Visibility level",
      withError(now.visibility_level, error.visibility_level, 2),
      explained(
        `times the luminance difference at which a detail of ${detail} is just visible (Adrian 1989)`,
        now.visibility_level_in_range,
      ),
    ],
    [
      "Contrast margin",
      withError(now.contrast_margin, error.contrast_margin, 1),
      explained(
        `times the contrast at which strokes of ${fixed(reader.cycles_per_degree, 1)} cycles per degree are just visible (Barten 1999)`,
        now.contrast_margin_in_range,
      ),
    ],
    [
      "Text luminance",
      `${withError(now.text_luminance_cd_m2, error.text_luminance_cd_m2, 1)} cd/m²`,
      "mean of a text that is three quarters white and one quarter black",
    ],
    ["Text contrast", withError(now.text_contrast, error.text_contrast, 3), "(white − black)/(white + black/3)"],
    ...smallPrint(now),
  ];
  return (
    <div class="scroll" tabindex={0} role="region" aria-label="Readability">
      <p class="remark">
        A reader of {plain(reader.age_years)} years with text whose lower-case x is {plain(reader.text_height_mm)} mm
        high, at {plain(reader.distance_mm)} mm. 1 is just visible; fluent reading needs several times as much.
      </p>
      <table class="numbers readability">
        <tbody>
          {rows.map(([name, value, help]) => (
            <tr key={name}>
              <th scope="row">{name}</th>
              <td>{value}</td>
              <td class="words">{help}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <Reader />
    </div>
  );
}
