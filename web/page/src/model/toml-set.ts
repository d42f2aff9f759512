// Setting existing keys of a TOML text in the page itself, for saving while the server does not respond. It replaces values only; all other
// edits belong to the server, which keeps comments and layout (`/edit`).

import { join, keysOf, unquoted } from "./json.ts";

/** A place in the text: from, to. */
type Span = readonly [number, number];

class Unreadable extends Error {}

/** The place of every value of a text by its path, as in `display.pixel.states."a.b".file`. */
export function valuesOf(text: string): Map<string, Span> {
  const found = new Map<string, Span>();
  /** Numbers of the tables of arrays of tables so far. */
  const counts = new Map<string, number>();
  let i = 0;
  const is = (words: string): boolean => text.startsWith(words, i);
  const skip = (pattern: RegExp): string => {
    pattern.lastIndex = i;
    const [words] = pattern.exec(text) ?? [""];
    i += words.length;
    return words;
  };
  const expect = (sign: string): void => {
    if (!is(sign)) throw new Unreadable(`${sign} expected at ${i}`);
    i += sign.length;
  };
  const blanks = () => skip(/[ \t]*/y);
  const between = () => skip(/(?:[\s]|#[^\n]*)*/y);
  const string = (): string => {
    const quote = text[i]!;
    const pattern =
      is('"""') ? /"""[^]*?[^\\]?"""+/y : is("'''") ? /'''[^]*?'''+/y : quote === '"' ? /"(?:[^"\\\n]|\\.)*"/y : /'[^'\n]*'/y;
    const words = skip(pattern);
    if (words === "") throw new Unreadable(`a string without end at ${i}`);
    return words;
  };
  const name = (): string => {
    const key = unquoted(string());
    if (key === null) throw new Unreadable(`not a key at ${i}`);
    return key;
  };
  const keys = (): string[] => {
    const all: string[] = [];
    do {
      blanks();
      const isQuoted = is('"') || is("'");
      const key = isQuoted ? name() : skip(/[A-Za-z0-9_-]+/y);
      if (key === "" && !isQuoted) throw new Unreadable(`no key at ${i}`);
      all.push(key);
      blanks();
    } while (is(".") && ++i);
    return all;
  };
  const pair = (above: string): void => {
    const path = join(above, ...keys());
    expect("=");
    blanks();
    value(path);
  };
  const value = (path: string): void => {
    const from = i;
    if (is('"') || is("'")) string();
    else if (is("[")) list(path);
    else if (is("{")) table(path);
    else if (skip(/[^\s,\]}#]+/y) === "") throw new Unreadable(`no value at ${i}`);
    found.set(path, [from, i]);
  };
  const list = (path: string): void => {
    expect("[");
    for (let number = 0; between(), !is("]"); number++) {
      value(`${path}.${number}`);
      between();
      if (!is("]")) expect(",");
    }
    expect("]");
  };
  const table = (path: string): void => {
    expect("{");
    for (; between(), !is("}"); ) {
      pair(path);
      between();
      if (!is("}")) expect(",");
    }
    expect("}");
  };
  let head = "";
  for (; between(), i < text.length; ) {
    if (!is("[")) {
      pair(head);
      continue;
    }
    const isArray = is("[[");
    expect(isArray ? "[[" : "[");
    const all = keys();
    expect(isArray ? "]]" : "]");
    // A table within an array of tables belongs to its last one.
    head = "";
    all.forEach((key, k) => {
      head = join(head, key);
      const count = counts.get(head);
      if (k === all.length - 1 && isArray) {
        counts.set(head, (count ?? -1) + 1);
        head += `.${counts.get(head)}`;
      } else if (count !== undefined) head += `.${count}`;
    });
  }
  return found;
}

/** A value as TOML; null for tables, which have a layout. */
function written(value: unknown): string | null {
  if (typeof value === "number") return Number.isFinite(value) ? String(value) : null;
  if (typeof value === "boolean") return String(value);
  if (typeof value === "string") return JSON.stringify(value);
  if (!Array.isArray(value)) return null;
  const items = value.map(written);
  return items.includes(null) ? null : `[${items.join(", ")}]`;
}

/** Returns the text with another value of a key that it has; null if it has no such key, or cannot be read here. */
export function withValue(text: string, path: string, value: unknown): string | null {
  const to = written(value);
  try {
    const place = valuesOf(text).get(join("", ...keysOf(path)));
    return place && to !== null ? text.slice(0, place[0]) + to + text.slice(place[1]) : null;
  } catch (why) {
    if (why instanceof Unreadable) return null;
    throw why;
  }
}
