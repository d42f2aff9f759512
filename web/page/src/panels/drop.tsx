// Files that are chosen or dropped: scenarios are opened, all others are sent to the server and audited.

import { add } from "../state/files.ts";
import { pictureName } from "../state/image.ts";
import { open } from "../state/open.ts";
import { showTab } from "../state/tab.ts";

/** Maximum length of a scenario, bytes; longer files are treated as data. */
const LONGEST = 256 * 1024;

export async function take(given: readonly File[], stays = false): Promise<void> {
  for (const file of given) {
    if (file.name.endsWith(".toml") && file.size <= LONGEST) await open(await file.text(), file.name);
    else if (/^image\/(png|jpeg)$/.test(file.type)) {
      if (!stays) showTab("image");
      if (await add(file.name, file)) pictureName.value = file.name;
      else showTab("files");
    } else {
      if (!stays) showTab("files");
      await add(file.name, file);
    }
  }
}

/** Accepts files that are dropped anywhere on the page. */
export function acceptDrops(): void {
  const page = document.documentElement;
  addEventListener("dragover", (event) => {
    event.preventDefault();
    page.classList.add("dropping");
  });
  addEventListener("dragleave", (event) => event.relatedTarget === null && page.classList.remove("dropping"));
  addEventListener("drop", (event) => {
    event.preventDefault();
    page.classList.remove("dropping");
    void take([...(event.dataTransfer?.files ?? [])]);
  });
}
