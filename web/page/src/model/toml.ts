// The parts of a line of TOML, for colours. Strings of several lines are not recognised; the colours are only a help.

export type Kind = "comment" | "string" | "table" | "key" | "value" | "plain";

export interface Piece {
  readonly kind: Kind;
  readonly text: string;
}

const STRING = /^("(?:[^"\\]|\\.)*"?|'[^']*'?)/;
const WORD = /^[\w.+-]+/;
const NAME = /(?:"(?:[^"\\]|\\.)*"|'[^']*'|[\w-]+)/.source;
/** A key with points, of which parts may be in quotes, up to its equals sign. */
const KEY = new RegExp(`^${NAME}(?:\\s*\\.\\s*${NAME})*(?=\\s*=)`);

/** Splits a line; the pieces together are the line. */
export function coloured(line: string): Piece[] {
  const table = /^\s*\[\[?[^\]]*\]?\]?/.exec(line)?.[0];
  const pieces: Piece[] = table ? [{ kind: "table", text: table }] : [];
  let rest = line.slice(table?.length ?? 0);
  while (rest !== "") {
    const next = piece(rest);
    const last = pieces.at(-1);
    if (last?.kind === next.kind && next.kind === "plain")
      pieces[pieces.length - 1] = { kind: "plain", text: last.text + next.text };
    else pieces.push(next);
    rest = rest.slice(next.text.length);
  }
  return pieces;
}

function piece(rest: string): Piece {
  if (rest.startsWith("#")) return { kind: "comment", text: rest };
  const key = KEY.exec(rest)?.[0];
  if (key) return { kind: "key", text: key };
  const string = STRING.exec(rest)?.[0];
  const word = string ?? WORD.exec(rest)?.[0];
  return word ? { kind: string ? "string" : "value", text: word } : { kind: "plain", text: rest[0]! };
}
