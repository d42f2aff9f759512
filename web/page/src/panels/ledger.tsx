// The energy balance: for each state, the fractions of a beam from the viewing direction, weighted by luminance.

import type { Ledger } from "../api/types.ts";
import { fixed, withError } from "../model/format.ts";
import { view } from "../state/design.ts";
import { hoverClass, pointsAt } from "../state/hover.ts";
import { Downloads } from "./downloads.tsx";

const PARTS = ["returned", "front", "diffuser", "glass", "pixel", "inactive", "unaccounted"] as const;
type Part = (typeof PARTS)[number];

const share = (ledger: Pick<Ledger, "returned" | "absorbed" | "unaccounted">, part: Part): number =>
  part === "returned" || part === "unaccounted" ? ledger[part] : (ledger.absorbed[part] ?? 0);

/** The fractions of a state as a bar. Each part has its own pattern; the numbers are in the table. */
function Bar({ name, ledger }: { name: string; ledger: Ledger }) {
  let from = 0;
  return (
    <svg
      class="ledger-bar"
      viewBox="0 0 1000 26"
      preserveAspectRatio="none"
      role="img"
      aria-label={`${name}: ${fixed(100 * ledger.returned, 1)} percent returned`}
    >
      {PARTS.map((part) => {
        const width = Math.max(0, 1000 * share(ledger, part));
        const x = from;
        from += width;
        return <rect key={part} class={`share ${part}`} x={x} width={width} height="26" />;
      })}
    </svg>
  );
}

export function LedgerPanel() {
  const all = Object.entries(view.value?.ledger ?? {});
  const used = PARTS.filter((part) => all.some(([, ledger]) => Math.abs(share(ledger, part)) > 5e-7));
  return (
    <>
      <div class="scroll" tabindex={0} role="region" aria-label="Energy balance">
        <table class="numbers ledger">
          <thead>
            <tr>
              <th scope="col">state</th>
              <th scope="col" class="bar-head">
                beam from the viewing direction
              </th>
              {used.map((part) => (
                <th scope="col" key={part}>
                  <span class={`chip share ${part}`} />
                  {part} %
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {all.map(([name, ledger]) => (
              <tr key={name} class={hoverClass(name)} {...pointsAt(name)}>
                <th scope="row">{name}</th>
                <td class="bar-cell">
                  <Bar name={name} ledger={ledger} />
                </td>
                {used.map((part) => (
                  <td key={part}>
                    {withError(100 * share(ledger, part), 100 * share(ledger.standard_error, part), 2)}
                  </td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <p class="remark">
        Fractions of a unit beam that enters from the viewing direction with the spectrum of the light, weighted by
        luminance. Light that is not returned is absorbed by the named parts.{" "}
        <Downloads
          name="energy-balance"
          table={() => [
            ["state", ...PARTS, ...PARTS.map((part) => `${part}_error`)],
            ...all.map(([name, ledger]) => [
              name,
              ...PARTS.map((part) => share(ledger, part)),
              ...PARTS.map((part) => share(ledger.standard_error, part)),
            ]),
          ]}
        />
      </p>
    </>
  );
}
