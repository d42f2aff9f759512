// A menu that saves a table as CSV and a figure as SVG or PNG. What is saved belongs to the current design; the name of a file tells where not.

import { useContext, useRef } from "preact/hooks";

import { pngOf } from "../plots/picture.ts";
import { csv, type Rows } from "../model/csv.ts";
import { exact } from "../state/live.ts";
import { said } from "../state/said.ts";
import type { Age } from "../state/revision.ts";
import { ContentContext } from "./aged.tsx";
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
  /** Whether the button shows its name beside the arrow. */
  isNamed?: true;
}

/** Longest time to wait for what is being computed, and time between two looks at it, ms. */
const LONGEST_MS = 120_000;
const LOOK_MS = 50;

/** What is added to the name of a file that does not belong to the current design. */
const ofWhich = (age: Age, thing = "design"): string =>
  age === "refused" ? `-of-last-valid-${thing}` : age === "earlier" ? `-of-earlier-${thing}` : "";

const isComputing = (age: Age): boolean => age === "before" || age === "settings" || age === "first";

/** Waits until what is shown is exact and that of the current design, and returns its age. */
async function settledAge(now: () => Age): Promise<Age> {
  // What is saved is exact, if there is an exact answer. The page shows it in the next frame.
  await exact();
  const look = () => new Promise((resolve) => setTimeout(resolve, LOOK_MS));
  await look();
  if (isComputing(now())) said.value = "Waiting for what is being computed…";
  for (let waited = 0; isComputing(now()) && waited < LONGEST_MS; waited += LOOK_MS) await look();
  const age = now();
  if (isComputing(age) || age === "failed")
    throw new Error("Not saved: what is shown does not belong to the current design.");
  return age;
}

export function Downloads(props: Props) {
  const { name, table, svg, isNamed } = props;
  const content = useContext(ContentContext);
  const shown = useRef({ props, content });
  shown.current = { props, content };
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
    const { table, svg } = shown.current.props;
    if (as === "csv") {
      const rows = await table!();
      return new Blob([typeof rows === "string" ? rows : csv(rows)], { type: "text/csv" });
    }
    const drawn = await svg!();
    return as === "svg" ? new Blob([drawn], { type: "image/svg+xml" }) : pngOf(drawn);
  };
  const choose = async (as: string) => {
    try {
      const age = await settledAge(() => shown.current.content.age);
      const { thing, name: own } = shown.current.content;
      save(`${own ?? fileName()}-${name}${ofWhich(age, thing)}.${as}`, await bytes(as));
      said.value = `${name}.${as} is saved.`;
    } catch (why) {
      said.value = why instanceof Error ? why.message : String(why);
    }
  };
  return (
    <Menu class={isNamed ? "download named" : "download"} label={`Download ${name}`} title={`Save as a file: ${name}`} items={items} choose={choose}>
      ⤓{isNamed && ` ${name}`}
    </Menu>
  );
}
