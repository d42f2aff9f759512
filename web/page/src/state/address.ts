// The scenario in the fragment of the page's address. It is removed from the address when the design changes.

import { effect } from "@preact/signals";

import { answer, draft, text } from "./design.ts";
import { packed, unpacked } from "./link.ts";
import { said } from "./said.ts";

/** The scenario in the address, as it was opened or written; "" for a damaged fragment. */
let inAddress: string | null = null;

/** Returns the scenario in the address; null if there is none, or if it is damaged, with a message. */
export async function linked(): Promise<string | null> {
  try {
    return await unpacked(location.hash);
  } catch {
    inAddress = "";
    said.value = "This link is damaged: it does not contain a complete scenario. The previous design is shown instead.";
    return null;
  }
}

/** Records that the scenario in the address is being opened. */
export const opening = (scenario: string): void => void (inAddress = scenario);

/** Returns the address of the page with a scenario in its fragment. */
export const addressOf = async (scenario: string): Promise<string> =>
  new URL(`#${await packed(scenario)}`, location.href).href;

/** Puts a scenario into the address. */
export function show(address: string, scenario: string): void {
  inAddress = scenario;
  history.replaceState(null, "", address);
}

/** Removes the scenario from the address at the first change, because a reload would open the old scenario again. */
export function followDesign(): void {
  effect(() => {
    const isOpen = answer.value !== null && draft.value === null;
    if (inAddress === null || !isOpen || text.value === inAddress) return;
    inAddress = null;
    history.replaceState(null, "", location.pathname + location.search);
  });
}
