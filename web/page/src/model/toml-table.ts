// The part of a TOML text that is one table with its sub-tables, as it is written.

import { keysOf } from "./json.ts";

const HEAD = /^\s*\[+((?:"(?:[^"\\]|\\.)*"|'[^']*'|[^\]"'])+)\]/;

/** Returns the lines of a table and of its sub-tables; "" if the text has none under a head of its own. */
export function tableText(text: string, name: string): string {
  const own: string[] = [];
  const keys = keysOf(name);
  let isOwn = false;
  for (const line of text.split("\n")) {
    const head = HEAD.exec(line)?.[1];
    if (head !== undefined) {
      const of = keysOf(head);
      isOwn = keys.every((key, i) => key === of[i]);
    }
    if (isOwn) own.push(line);
  }
  return own.join("\n").trim();
}
