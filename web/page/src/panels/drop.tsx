// Files that are chosen or dropped: scenarios, surfaces and benches are opened, all others are sent to the server and audited.

import { openBench } from "../state/bench.ts";
import { comparedPanel } from "../state/choices.ts";
import { add, files } from "../state/files.ts";
import { pictureName } from "../state/image.ts";
import { open } from "../state/open.ts";
import { open as openSurface } from "../state/surface.ts";
import { readable } from "../state/photograph.ts";
import { said } from "../state/said.ts";
import { openTab, showTab } from "../state/tab.ts";

/** Maximum length of a scenario, bytes; longer files are treated as data. */
const LONGEST = 256 * 1024;

/** The kinds of files that tools use. */
const USES: Readonly<Record<string, readonly string[]>> = {
  compare: ["panel"],
  fit: ["panel", "spectrum", "material"],
  diffuser: ["bsdf"],
};

/** Whether a file is a surface, and not the scenario of a display. */
const isSurface = (text: string): boolean => /^\s*\[microgeometry\b/m.test(text) && !/^\s*\[+display\b/m.test(text);

/** Shows a surface in its tab. It is also a file that a layer can name. */
async function takeSurface(file: File, text: string): Promise<void> {
  if (!(await add(file.name, file))) return showTab("files");
  showTab("surface");
  openSurface(text, file.name);
}

export async function take(given: readonly File[], stays = false): Promise<void> {
  for (const file of given) {
    if (/\.(papilio|zip)$/i.test(file.name)) {
      await openBench(file);
      continue;
    }
    if (file.name.endsWith(".toml") && file.size <= LONGEST) {
      const text = await file.text();
      if (isSurface(text)) await takeSurface(file, text);
      else await open(text, file.name);
    } else if (/^image\/(png|jpeg)$/.test(file.type)) {
      if (!stays) showTab("image");
      const [bytes, words] = await readable(file);
      if (words) said.value = words;
      if (await add(file.name, bytes)) pictureName.value = file.name;
      else showTab("files");
    } else {
      // A tool that uses the file stays open.
      const of = USES[openTab.value] ?? [];
      if (!stays && of.length === 0) showTab("files");
      await add(file.name, file);
      const kind = files.value.find(({ name }) => name === file.name)?.audit?.kind;
      if (!stays && of.length > 0 && !(kind && of.includes(kind))) showTab("files");
      if (kind === "panel" && openTab.value === "compare") comparedPanel.value = file.name;
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
