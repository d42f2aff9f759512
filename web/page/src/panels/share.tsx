// Sharing: the report and the files of the command line, a link, and the commands that do the same.

import { postForBlob, Refused } from "../api/client.ts";
import { STEPS } from "../model/tools.ts";
import { commandNow } from "../state/commands.ts";
import { addressOf, show } from "../state/address.ts";
import { benchFile } from "../state/bench.ts";
import { text } from "../state/design.ts";
import { fileIds } from "../state/files.ts";
import { ready } from "../state/ready.ts";
import { said } from "../state/said.ts";
import { showTab } from "../state/tab.ts";
import { missing, wholeText, withoutFiles } from "../state/whole.ts";
import { pngOf } from "../plots/picture.ts";
import { FileButton } from "./choose.tsx";
import { Command, scenarioFile } from "./command.tsx";
import { fileName } from "./file-name.ts";
import { save } from "./save.ts";

async function copyLink(): Promise<void> {
  const whole = await wholeText("linked");
  if (whole === null) return;
  const scenario = whole.text;
  const address = await addressOf(scenario);
  try {
    await navigator.clipboard.writeText(address);
    said.value = `The link is copied to the clipboard. It contains the whole scenario${withoutFiles(scenario)}${missing(whole)}.`;
  } catch {
    show(address, scenario);
    said.value = `The address of the page now contains the whole scenario${withoutFiles(scenario)}${missing(whole)}.`;
  }
}

async function saveBench(): Promise<void> {
  said.value = "Collecting the designs and their files…";
  try {
    const made = await benchFile();
    if (made === null) return;
    save(`${fileName()}.papilio`, made.file);
    said.value = `The bench is saved${made.words}.`;
  } catch (why) {
    said.value = `The bench is not saved: ${why instanceof Error ? why.message : String(why)}`;
  }
}

/** The files that can be exported, the same as on the command line. */
const EXPORTS: readonly (readonly [string, string])[] = [
  ["report.html", "All results on one page, to send to others; it opens in any browser"],
  ["result.json", "All numbers with their errors, for other programs"],
  ["states.csv", "Colours of all states in all views, as a table"],
  ["spectra.csv", "Reflectance factors of all states"],
  ["overview.svg", "Patches, chromaticity and spectra as one figure"],
  ["overview.png", "The same figure as a picture"],
  ["chromaticity.svg", "The u′v′ diagram"],
  ["spectra.svg", "The spectra"],
  ["patches.svg", "The states as patches"],
  ["cone.svg", "Luminance over all viewing directions"],
];

/** The status of a program that was built without PNG. */
const NOT_BUILT = 501;

/** Requests a file. A program without PNG sends the figure as SVG, which the browser converts. */
async function exported(what: string): Promise<Blob> {
  const request = (what: string) => postForBlob("export", { scenario: text.value, files: fileIds.value, what });
  try {
    return await request(what);
  } catch (why) {
    if (!(why instanceof Refused && why.status === NOT_BUILT)) throw why;
    return pngOf(await (await request(what.replace(/png$/, "svg"))).text());
  }
}

async function exportAs(what: string): Promise<void> {
  if (!(await ready("exported"))) return;
  said.value = `Exporting ${what}…`;
  try {
    save(`${fileName()}-${what}`, await exported(what));
    said.value = `${what} is saved.`;
  } catch (why) {
    said.value = why instanceof Refused ? why.message : String(why);
  }
}

export function SharePanel() {
  return (
    <section class="share" aria-label="Share">
      <div class="controls">
        <button type="button" class="run" onClick={() => void saveBench()}>
          Save the bench
        </button>
        <FileButton label="Open a bench" title="A .papilio file" stays />
        <span class="remark">
          One file, .papilio, with the design, all versions, numbers, rooms and data files. Drop it on this page to
          continue; it is a zip archive with scenarios for the command line.
        </span>
      </div>
      <div class="controls">
        <button type="button" class="run" onClick={() => void copyLink()}>
          Copy the link
        </button>
        <span class="remark">The link contains the whole scenario, without its files. Save, at the top, writes the scenario.</span>
      </div>
      <ul class="exports">
        {EXPORTS.map(([name, about]) => (
          <li key={name}>
            <button type="button" data-export={name} onClick={() => void exportAs(name)}>
              {name}
            </button>
            <span>{about}</span>
          </li>
        ))}
        {OTHERS.map(([tool, name, about]) => (
          <li key={name}>
            <button type="button" class="key-link" onClick={() => showTab(tool)}>
              {name}
            </button>
            <span>{about}</span>
          </li>
        ))}
      </ul>
    </section>
  );
}

/** Files that other tools save. */
const OTHERS = [
  ["image", "Picture, palette and frame", "seen.png, states.png, palettes and frame.h are under Files of the picture"],
  ["detail", "Sharpness, crosstalk, sparkle and gloss", "Their tables and figures are in Fine detail"],
] as const;

/** The commands of all tools. */
export function CommandsPanel() {
  const file = scenarioFile();
  return (
    <section class="commands" aria-label="Commands">
      <p class="remark">
        Every tool of this page is a command of the program. Save the scenario as {file}; then these commands give the same
        numbers.
      </p>
      {STEPS.map(({ id, name, tools }) => {
        const lines = tools.map((tool) => commandNow(tool.id, file));
        const all = tools.flatMap((tool, i) => (lines[i] && lines.indexOf(lines[i]) === i ? [{ tool, line: lines[i] }] : []));
        return (
          all.length > 0 && (
            <section key={id} aria-label={`Commands of ${name}`}>
              <h3>{name}</h3>
              {all.map(({ tool, line }) => (
                <div key={tool.id} class="command-row">
                  <button type="button" class="key-link" onClick={() => showTab(tool.id)}>
                    {tool.name}
                  </button>
                  <Command line={line} />
                </div>
              ))}
            </section>
          )
        );
      })}
    </section>
  );
}
