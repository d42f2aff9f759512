// The command of the program that does the same as a tool, and the part of the scenario that describes it.

import { commandFor, toolOf } from "../model/tools.ts";
import { tableText } from "../model/toml-table.ts";
import { text } from "../state/design.ts";
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

/** The command and the table of a tool. */
export function ToolCommand({ id }: { id: string }) {
  const { command, table, showsCommand } = toolOf(id);
  if (command === null || showsCommand) return null;
  const own = table ? tableText(text.value, table) : "";
  return (
    <footer class="tool-command" aria-label="The same on the command line">
      <Command line={commandFor(command, scenarioFile())} />
      {own !== "" && (
        <details>
          <summary>[{table}] in the scenario</summary>
          <pre tabindex={0} aria-label={`The table ${table} of the scenario`}>{own}</pre>
        </details>
      )}
    </footer>
  );
}
