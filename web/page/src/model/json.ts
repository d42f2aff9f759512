// Values of a scenario as JSON, and dotted paths into them (`display.pixel.film.1.thickness_nm`). A key that contains a
// point is in quotes, as in TOML (`display.pixel.states."a.b".file`): the grammar of `crates/scenario/src/path.rs`.

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Table = { [key: string]: Json };

export const isTable = (value: Json | undefined): value is Table =>
  typeof value === "object" && value !== null && !Array.isArray(value);

/** A quoted key at the beginning of a text, with the blanks before it. */
const QUOTED = /^\s*("(?:[^"\\]|\\[^])*"|'[^']*')/;
const ESCAPES: Readonly<Record<string, string>> = { b: "\b", t: "\t", n: "\n", f: "\f", r: "\r", e: "\x1b", '"': '"', "\\": "\\" };
const ESCAPE = /\\(?:u([0-9A-Fa-f]{4})|U([0-9A-Fa-f]{8})|x([0-9A-Fa-f]{2})|([^]))/g;
/** Control characters that a quoted key has as escapes only. */
const CONTROL = /[\0-\x08\x0a-\x1f\x7f]/;

/** Returns the name of a key that is in quotes, as in TOML; null if it is not. */
export function unquoted(key: string): string | null {
  if (QUOTED.exec(key)?.[1] !== key || CONTROL.test(key)) return null;
  const inner = key.slice(1, -1);
  if (key.startsWith("'")) return inner;
  let isRight = true;
  const name = inner.replace(ESCAPE, (_, short?: string, long?: string, byte?: string, letter?: string) => {
    const code = Number.parseInt(short ?? long ?? byte ?? "", 16);
    const isScalar = code <= 0x10ffff && !(code >= 0xd800 && code <= 0xdfff);
    const one = letter === undefined ? (isScalar ? String.fromCodePoint(code) : undefined) : ESCAPES[letter];
    isRight &&= one !== undefined;
    return one ?? "";
  });
  return isRight ? name : null;
}

/** Returns a name as a key of a path: in quotes if it could be read as something else without them. */
export function quoted(name: string): string {
  const isPlain = name !== "" && name.trim() === name && !/^["']|[.=]|\p{Cc}/u.test(name);
  const escaped = (sign: string) =>
    /["\\]/.test(sign) ? `\\${sign}` : `\\u${sign.charCodeAt(0).toString(16).toUpperCase().padStart(4, "0")}`;
  return isPlain ? name : `"${name.replace(/["\\]|\p{Cc}/gu, escaped)}"`;
}

/** The places of the keys of a path that is not empty: from, to; without the points between them. */
function places(path: string): [from: number, to: number][] {
  const all: [number, number][] = [];
  for (let from = 0; ; ) {
    const quotes = QUOTED.exec(path.slice(from))?.[0].length ?? 0;
    const point = path.indexOf(".", from + quotes);
    all.push([from, point < 0 ? path.length : point]);
    if (point < 0) return all;
    from = point + 1;
  }
}

const named = (key: string): string => unquoted(key.trim()) ?? key.trim();

/** Returns the names of the keys of a path, without quotes and blanks; none for the path "". */
export function keysOf(path: string): string[] {
  if (path === "") return [];
  if (!/["'\s]/.test(path)) return path.split(".");
  return places(path).map((place) => named(path.slice(...place)));
}

/** Returns whether two paths have the same keys. */
export const isSamePath = (a: string, b: string): boolean => a === b || join("", ...keysOf(a)) === join("", ...keysOf(b));

/** Returns the child of a table or a list, or undefined. */
export function child(of: Json | undefined, key: string): Json | undefined {
  if (Array.isArray(of)) return of[Number(key)];
  return isTable(of) && Object.hasOwn(of, key) ? of[key] : undefined;
}

/** Returns the value at a path, or undefined. */
export const at = (root: Json | undefined, path: string): Json | undefined => keysOf(path).reduce(child, root);

export const tableAt = (root: Json | undefined, path: string): Table => {
  const found = at(root, path);
  return isTable(found) ? found : {};
};

export const listAt = (root: Json | undefined, path: string): Json[] => {
  const found = at(root, path);
  return Array.isArray(found) ? found : [];
};

export const numberAt = (root: Json | undefined, path: string): number | undefined => {
  const found = at(root, path);
  return typeof found === "number" ? found : undefined;
};

export const textAt = (root: Json | undefined, path: string): string | undefined => {
  const found = at(root, path);
  return typeof found === "string" ? found : undefined;
};

/** Splits a path into the path of its table or list and the name of its last key. */
export function split(path: string): [parent: string, key: string] {
  if (path === "") return ["", ""];
  const [from, to] = places(path).at(-1)!;
  return [path.slice(0, Math.max(0, from - 1)), named(path.slice(from, to))];
}

/** Appends names of keys, or indices, to a path, which may be empty. */
export const join = (path: string, ...names: (string | number)[]): string =>
  [...(path === "" ? [] : [path]), ...names.map((name) => quoted(String(name)))].join(".");
