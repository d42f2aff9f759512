// The choice of the view, if the viewer has several.

import { degrees } from "../model/format.ts";
import { answer, view, viewIndex } from "../state/design.ts";
import { chooseView } from "../state/live.ts";

export function Views() {
  const all = answer.value?.views ?? [];
  const now = view.value;
  if (!now) return null;
  const name = (theta: number, phi: number) => `${degrees(theta)}${phi === 0 ? "" : `, azimuth ${degrees(phi)}`}`;
  if (all.length < 2) return <p class="views">seen from {name(now.theta_deg, now.phi_deg)}</p>;
  return (
    <p class="views">
      <label for="view">seen from</label>{" "}
      <select id="view" value={String(viewIndex.value)} onChange={(event) => chooseView(Number(event.currentTarget.value))}>
        {all.map((one, i) => (
          <option key={i} value={String(i)}>
            {name(one.theta_deg, one.phi_deg)}
          </option>
        ))}
      </select>
    </p>
  );
}
