// The part of a TOML text that is one table with its sub-tables, as it is written.

/** Returns the lines of a table and of its sub-tables; "" if the text has none under a head of its own. */
export function tableText(text: string, name: string): string {
  const own: string[] = [];
  let isOwn = false;
  for (const line of text.split("\n")) {
    const head = /^\s*\[+\s*([^\]]+?)\s*\]/.exec(line)?.[1];
    if (head !== undefined) isOwn = head === name || head.startsWith(`${name}.`);
    if (isOwn) own.push(line);
  }
  return own.join("\n").trim();
}
