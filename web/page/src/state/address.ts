// The page's address: a link's scenario in its fragment, as long as that is what is open.

import { effect } from "@preact/signals";

import { answer, draft, text } from "./design.ts";
import { packed, unpacked } from "./link.ts";
import { said } from "./said.ts";

/** The scenario that the address holds, as it was opened or written; "" for a fragment that is damaged. */
let held: string | null = null;

/** The scenario of the address; null if it has none, or a damaged one, which is said. */
export async function linked(): Promise<string | null> {
  try {
    return await unpacked(location.hash);
  } catch {
    held = "";
    said.value = "This link is damaged: it holds no whole scenario. What was open before is shown instead.";
    return null;
  }
}

/** Says that the scenario of the address is being opened. */
export const opening = (scenario: string): void => void (held = scenario);

/** The address of the page with a scenario in it. */
export const addressOf = async (scenario: string): Promise<string> =>
  new URL(`#${await packed(scenario)}`, location.href).href;

/** Puts a scenario into the address. */
export function show(address: string, scenario: string): void {
  held = scenario;
  history.replaceState(null, "", address);
}

/** Takes the scenario out of the address with the first change: a reload would bring back what was before it. */
export function followDesign(): void {
  effect(() => {
    const isOpen = answer.value !== null && draft.value === null;
    if (held === null || !isOpen || text.value === held) return;
    held = null;
    history.replaceState(null, "", location.pathname + location.search);
  });
}
