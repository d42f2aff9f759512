// The readability of black text on white.

import { NONE, withError } from "../model/format.ts";
import { view } from "../state/design.ts";

const AGES = [20, 50, 75] as const;

export function Readability() {
  const now = view.value;
  if (!now) return null;
  const rows: [string, string, string][] = [
    [
      "Text luminance",
      withError(now.text_luminance_cd_m2, now.standard_error.text_luminance_cd_m2, 1),
      "cd/m²; mean of a text that is three quarters white and one quarter black",
    ],
    [
      "Text contrast",
      withError(now.text_contrast, now.standard_error.text_contrast, 3),
      "(white − black)/(white + black/3)",
    ],
    ...AGES.map((age): [string, string, string] => {
      const key = `reading_surrogate_age_${age}` as const;
      const value = now[key];
      return [
        `Small print, ${age} years`,
        typeof value !== "number" ? NONE : `${withError(100 * value, 100 * (now.standard_error[key] ?? 0), 1)} %`,
        typeof value !== "number"
          ? "outside the range of the surrogate (text luminance 1000 to 5200 cd/m², contrast 0.35 to 0.9)"
          : "reading performance, by a surrogate calibrated with Feng 2012, table 5.3",
      ];
    }),
  ];
  return (
    <div class="scroll" tabindex={0} role="region" aria-label="Readability">
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
    </div>
  );
}
