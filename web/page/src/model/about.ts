// What tells designs apart in a list: their own titles, and what was changed in them last.

import { valuesOf } from "./toml-set.ts";

/** The string at a path of a text; null if it has none there. Throws if the text cannot be read. */
export function stringAt(text: string, path: string): string | null {
  const place = valuesOf(text).get(path);
  const written = place ? text.slice(...place) : "";
  if (written.startsWith("'")) return written.slice(1, -1) || null;
  return written.startsWith('"') ? String(JSON.parse(written)) || null : null;
}

/** The title of a scenario; null if it has none. */
export function titleOf(text: string): string | null {
  try {
    return stringAt(text, "title");
  } catch {
    // A text that is being typed: its first title.
    return /^title\s*=\s*"([^"\n]*)"/m.exec(text)?.[1] || null;
  }
}

/** Largest numbers of lines and letters of a change. */
const LINES = 2;
const LETTERS = 60;

const linesOf = (text: string): string[] =>
  text
    .split("\n")
    .map((line) => line.replace(/(^|\s)#.*$/, "").trim())
    .filter(Boolean);

/** The lines that a text has and the one before had not, shortened; or those that are gone. */
export function lastChange(before: string | undefined, now: string): string {
  if (before === undefined) return "";
  const beyond = (some: string[], others: string[]) => {
    const left = new Set(others);
    return some.filter((line) => !left.has(line));
  };
  const [old, current] = [linesOf(before), linesOf(now)];
  const [added, gone] = [beyond(current, old), beyond(old, current)];
  const words = added.length > 0 ? added.slice(0, LINES).join(", ") : gone.slice(0, LINES).join(", ");
  const short = words.length > LETTERS ? `${words.slice(0, LETTERS - 1)}…` : words;
  return added.length > 0 || short === "" ? short : `without ${short}`;
}
