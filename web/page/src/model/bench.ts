// A bench as one file: `.papilio`, a zip archive of designs with their data files and bench.json, which lists them. A person
// can unzip it and use the designs on the command line: data files are where the scenarios say.

import type { Target } from "./metrics.ts";
import { BadArchive, unzipped, zipped, type Limits } from "./zip.ts";

/** The version of the format. It changes if an older page would misread a newer file. */
export const VERSION = 1;
const FORMAT = "papilio-bench";
const LIST = "bench.json";
const MIB = 1 << 20;
/** Largest archive, and its contents; files are at most as large as the server reads. */
export const LARGEST = 256 * MIB;
const LIMITS: Limits = { entries: 1000, each: 64 * MIB, all: 256 * MIB };
/** Longest scenario, as in the server. */
const LONGEST = 256 * 1024;
/** Largest number of designs. */
const MOST = 64;

/** What is wrong with a file, as the end of a sentence whose subject is the file. */
export class BadBench extends Error {}

export interface BenchData {
  /** The name that the scenario uses. */
  readonly name: string;
  readonly sha256: string;
  readonly bytes: Uint8Array;
  /** A file of the program, which need not be sent to it. */
  readonly isOfProgram: boolean;
}

export interface BenchDesign {
  readonly name: string;
  readonly text: string;
  /** Time when it was kept as a version, ms; null for other designs. */
  readonly keptAt: number | null;
  /** A picture as an address of data; "" for none. */
  readonly thumbnail: string;
  readonly numbers: Readonly<Record<string, number>>;
  readonly data: readonly BenchData[];
}

export interface Bench {
  readonly designs: readonly BenchDesign[];
  /** Indices of the design that is open, and of the one with which it is compared. */
  readonly open: number;
  readonly compared: number | null;
  /** The chosen numbers with their targets. */
  readonly numbers: readonly { readonly metric: string; readonly target: Target | null }[];
  /** Names of the rooms that are shown. */
  readonly rooms: readonly string[];
  /** The name of the picture on the display; null for that of the scenario. */
  readonly picture: string | null;
}

/** Returns the path of a file that is named in a folder; null outside of the archive. */
export function pathIn(folder: string, name: string): string | null {
  const parts = folder.split("/");
  for (const part of name.split("/"))
    if (part === "..") {
      if (parts.pop() === undefined) return null;
    } else if (part !== "" && part !== ".") parts.push(part);
  return parts.join("/");
}

/** Returns a name that every file system accepts. */
export function fileNameOf(name: string): string {
  const plain = name.replace(/[^\p{L}\p{N} ._()+,-]+/gu, "-").replace(/^[ .-]+|[ .-]+$/g, "");
  return plain.slice(0, 60).trim() || "design";
}

const README = `A bench of Papilio, a simulator of reflective displays.

Drop the .papilio file on the page of "papilio serve" to continue with it.
Unzipped, every design is a scenario with its data files beside it:

    papilio run "OPEN"

bench.json lists the designs, the numbers that were shown with their targets, and the rooms.
`;

interface ListedDesign {
  readonly file: string;
  readonly name: string;
  readonly kept: string | null;
  readonly thumbnail: string | null;
  readonly numbers: Readonly<Record<string, number>>;
  readonly data: readonly { readonly name: string; readonly sha256: string; readonly of_program: boolean }[];
}

/** Base64 of a picture's address. */
const PNG = "data:image/png;base64,";
const fromBase64 = (text: string): Uint8Array => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
const toBase64 = (bytes: Uint8Array): string => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(""));

/** Returns the archive of a bench. Designs whose data files have the same names and other contents have folders of their own. */
export async function packed(bench: Bench): Promise<Blob> {
  const encoded = (text: string) => new TextEncoder().encode(text);
  const files = new Map<string, Uint8Array>();
  const hashes = new Map<string, string>();
  const listed: ListedDesign[] = [];
  for (const [i, design] of bench.designs.entries()) {
    const paths = (folder: string) => design.data.map((one) => [pathIn(folder, one.name), one] as const);
    let folder = "designs";
    for (let n = 2; paths(folder).some(([path, { sha256 }]) => path !== null && (hashes.get(path) ?? sha256) !== sha256); n++)
      folder = `designs-${n}`;
    for (const [path, { sha256, bytes }] of paths(folder)) {
      if (path === null) continue;
      files.set(path, bytes);
      hashes.set(path, sha256);
    }
    const plain = fileNameOf(design.name);
    const named = (n: number) => `${folder}/${n === 1 ? plain : `${plain} ${n}`}.toml`;
    let n = 1;
    while (files.has(named(n))) n++;
    const file = named(n);
    files.set(file, encoded(design.text));
    hashes.set(file, file);
    const thumbnail = design.thumbnail.startsWith(PNG) ? `pictures/${i + 1}.png` : null;
    if (thumbnail) files.set(thumbnail, fromBase64(design.thumbnail.slice(PNG.length)));
    listed.push({
      file,
      name: design.name,
      kept: design.keptAt === null ? null : new Date(design.keptAt).toISOString(),
      thumbnail,
      numbers: design.numbers,
      data: design.data.map(({ name, sha256, isOfProgram }) => ({ name, sha256, of_program: isOfProgram })),
    });
  }
  const { open, compared, numbers, rooms, picture } = bench;
  const list = {
    format: FORMAT,
    version: VERSION,
    open: listed[open]?.file,
    compared: compared === null ? null : listed[compared]?.file,
    designs: listed,
    numbers,
    rooms,
    picture,
  };
  const readme = README.replace("OPEN", listed[open]?.file ?? "");
  return zipped(new Map([["README.txt", encoded(readme)], [LIST, encoded(`${JSON.stringify(list, null, 2)}\n`)], ...files]));
}

type Unknown = Readonly<Record<string, unknown>>;
const isObject = (value: unknown): value is Unknown => typeof value === "object" && value !== null && !Array.isArray(value);

/** Reads bench.json; what is not as expected is refused with its place. */
class Reader {
  constructor(
    private readonly value: unknown,
    private readonly place: string,
  ) {}
  private wrong(expected: string): never {
    throw new BadBench(`cannot be read: ${this.place} in ${LIST} is not ${expected}`);
  }
  of(key: string): Reader {
    return new Reader(isObject(this.value) ? this.value[key] : undefined, this.place === "it" ? key : `${this.place}.${key}`);
  }
  text(most = 1000): string {
    return typeof this.value === "string" && this.value.length <= most ? this.value : this.wrong("a text");
  }
  textOrNull(): string | null {
    return this.value === null || this.value === undefined ? null : this.text();
  }
  number(): number {
    return typeof this.value === "number" && Number.isFinite(this.value) ? this.value : this.wrong("a number");
  }
  is(): boolean {
    return this.value === true;
  }
  list(most: number): Reader[] {
    if (!Array.isArray(this.value) || this.value.length > most) return this.wrong(`a list of at most ${most}`);
    return this.value.map((one: unknown, i) => new Reader(one, `${this.place}[${i}]`));
  }
  numbers(): Record<string, number> {
    if (!isObject(this.value)) return this.wrong("a table of numbers");
    return Object.fromEntries(Object.keys(this.value).slice(0, 100).map((key) => [key, this.of(key).number()]));
  }
  target(): Target | null {
    if (this.value === null || this.value === undefined) return null;
    const kind = this.of("kind").text();
    if (kind !== "at_least" && kind !== "at_most") return this.wrong("a target");
    return { kind, value: this.of("value").number() };
  }
}

/** Returns the list of a bench, and the folder in which it is: an archive that was packed again may have a folder around it. */
function listOf(files: ReadonlyMap<string, Uint8Array>): readonly [Unknown, string] {
  const path = [...files.keys()].filter((name) => /^([^/]+\/)?bench\.json$/.test(name)).sort((a, b) => a.length - b.length)[0];
  if (path === undefined) throw new BadBench(`is not a bench of Papilio: it has no ${LIST}`);
  let list: unknown;
  try {
    list = JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(files.get(path)));
  } catch {
    throw new BadBench(`cannot be read: ${LIST} is not JSON`);
  }
  if (!isObject(list) || list["format"] !== FORMAT) throw new BadBench(`is not a bench of Papilio: ${LIST} has another format`);
  const version = list["version"];
  if (typeof version !== "number" || !Number.isInteger(version) || version < 1)
    throw new BadBench(`cannot be read: ${LIST} has no version`);
  if (version > VERSION)
    throw new BadBench(`was written by a newer Papilio: it has version ${version}, and this page reads version ${VERSION}. Update Papilio`);
  return [list, path.slice(0, -LIST.length)];
}

/** Reads a bench; throws BadBench if any part of it cannot be read. */
export async function unpacked(bytes: Uint8Array): Promise<Bench> {
  let files: Map<string, Uint8Array>;
  try {
    files = await unzipped(bytes, LIMITS);
  } catch (why) {
    throw why instanceof BadArchive ? new BadBench(why.message) : why;
  }
  const [value, root] = listOf(files);
  const list = new Reader(value, "it");
  const file = (path: string, most = Infinity): Uint8Array => {
    const found = files.get(root + path);
    if (!found) throw new BadBench(`is incomplete: it has no file ${path}`);
    if (found.length > most) throw new BadBench(`has a file that is too long: ${path}`);
    return found;
  };
  const textOf = (path: string): string => {
    try {
      return new TextDecoder("utf-8", { fatal: true }).decode(file(path, LONGEST));
    } catch (why) {
      throw why instanceof BadBench ? why : new BadBench(`cannot be read: ${path} is not UTF-8`);
    }
  };
  const paths: string[] = [];
  const designs = list.of("designs").list(MOST).map((one): BenchDesign => {
    const path = one.of("file").text();
    paths.push(path);
    const folder = path.split("/").slice(0, -1).join("/");
    const data = one.of("data").list(LIMITS.entries).map((entry): BenchData => {
      const name = entry.of("name").text();
      const at = pathIn(folder, name);
      if (at === null) throw new BadBench(`names a file outside of it: ${name}`);
      return { name, sha256: entry.of("sha256").text(), bytes: file(at), isOfProgram: entry.of("of_program").is() };
    });
    const [kept, thumbnail] = [one.of("kept").textOrNull(), one.of("thumbnail").textOrNull()];
    return {
      name: one.of("name").text(),
      text: textOf(path),
      keptAt: kept === null ? null : Date.parse(kept) || 0,
      thumbnail: thumbnail === null ? "" : PNG + toBase64(file(thumbnail, MIB)),
      numbers: one.of("numbers").numbers(),
      data,
    };
  });
  const [open, compared] = [paths.indexOf(list.of("open").text()), list.of("compared").textOrNull()];
  if (open < 0) throw new BadBench(`cannot be read: open in ${LIST} is not the file of a design`);
  return {
    designs,
    open,
    compared: compared === null || !paths.includes(compared) ? null : paths.indexOf(compared),
    numbers: list.of("numbers").list(1000).map((one) => ({ metric: one.of("metric").text(), target: one.of("target").target() })),
    rooms: list.of("rooms").list(100).map((one) => one.text()),
    picture: list.of("picture").textOrNull(),
  };
}

/** Returns the strings of a TOML text, among which are the names of its files. */
export function stringsOf(text: string): Set<string> {
  const found = new Set<string>();
  for (const [, escaped, plain] of text.matchAll(/"((?:[^"\\\n]|\\.)*)"|'([^'\n]*)'/g)) {
    if (plain !== undefined) found.add(plain);
    else
      try {
        found.add(JSON.parse(`"${escaped}"`) as string);
      } catch {
        // No name of a file.
      }
  }
  return found;
}
