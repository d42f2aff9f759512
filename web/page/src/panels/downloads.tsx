// A menu that saves a table as CSV and a figure as SVG or PNG.

import { pngOf } from "../plots/picture.ts";
import { csv, type Rows } from "../model/csv.ts";
import { exact } from "../state/live.ts";
import { said } from "../state/said.ts";
import { fileName } from "./file-name.ts";
import { Menu } from "./menu.tsx";
import { save } from "./save.ts";

type Maybe<T> = T | Promise<T>;

interface Props {
  /** What is saved, as a part of the file's name. */
  name: string;
  /** The rows of the table, with a head; or the text of a CSV file. */
  table?: () => Maybe<Rows | string>;
  svg?: () => Maybe<string>;
}

export function Downloads({ name, table, svg }: Props) {
  const items = [
    ...(table ? [{ name: "csv", label: "Table (CSV)" }] : []),
    ...(svg
      ? [
          { name: "svg", label: "Figure (SVG)" },
          { name: "png", label: "Figure (PNG)" },
        ]
      : []),
  ];
  const bytes = async (as: string): Promise<Blob> => {
    if (as === "csv") {
      const rows = await table!();
      return new Blob([typeof rows === "string" ? rows : csv(rows)], { type: "text/csv" });
    }
    const drawn = await svg!();
    return as === "svg" ? new Blob([drawn], { type: "image/svg+xml" }) : pngOf(drawn);
  };
  const choose = async (as: string) => {
    try {
      // What is saved is exact, if there is an exact answer.
      await exact();
      save(`${fileName()}-${name}.${as}`, await bytes(as));
      said.value = `${name}.${as} is saved.`;
    } catch (why) {
      said.value = why instanceof Error ? why.message : String(why);
    }
  };
  return (
    <Menu class="download" label={`Download ${name}`} title={`Save as a file: ${name}`} items={items} choose={choose}>
      ⤓
    </Menu>
  );
}
