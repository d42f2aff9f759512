// The command of the program that does the same as a tool, and the part of the scenario that describes it.

import { tableOf } from "../model/study.ts";
import { toolOf } from "../model/tools.ts";
import { tableText } from "../model/toml-table.ts";
import { commandNow } from "../state/commands.ts";
import { fields, text } from "../state/design.ts";
import { said } from "../state/said.ts";
import { fileName } from "./file-name.ts";

/** A command with a button that copies it. */
export function Command({ line }: { line: string }) {
  const copy = async () => {
    try {
      await navigator.clipboard.writeText(line);
      said.value = "The command is copied to the clipboard.";
    } catch {
      said.value = "The browser does not allow to copy: select the command and copy it.";
    }
  };
  return (
    <p class="command">
      <code>{line}</code>
      <button type="button" onClick={() => void copy()} aria-label="Copy the command" title="Copy the command">
        Copy
      </button>
    </p>
  );
}

/** Returns the name of the scenario's file, as Save writes it. */
export const scenarioFile = (): string => `${fileName()}.toml`;

/** Tools whose command reads a table that the scenario may not have yet. */
const STUDIES = ["sweep", "optimize", "tolerance", "fit"];

/** The command and the table of a tool. */
export function ToolCommand({ id }: { id: string }) {
  const { table, showsCommand } = toolOf(id);
  const line = commandNow(id, scenarioFile());
  if (line === null || showsCommand) return null;
  const own = table ? tableText(text.value, table) : "";
  return (
    <footer class="tool-command" aria-label="The same on the command line">
      <Command line={line} />
      {STUDIES.includes(id) && tableOf(fields.value, id) === null && (
        <small>reads [{id}] of the scenario, which “Add to the scenario” writes</small>
      )}
      {own !== "" && (
        <details>
          <summary>[{table}] in the scenario</summary>
          <pre tabindex={0} aria-label={`The table ${table} of the scenario`}>{own}</pre>
        </details>
      )}
    </footer>
  );
}
