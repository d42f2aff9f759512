// Zip archives in memory (APPNOTE 6.3.10, without encryption, ZIP64 and parts): writing, and reading within limits.
//
// The directory at the end is what counts. Stated sizes are checked before anything is inflated, and no entry is inflated
// beyond its stated size, so that a small archive cannot fill the memory. The CRC-32 of every entry is checked.

import { deflated, inflated, TooLong } from "./deflate.ts";

/** What is wrong with an archive, as the end of a sentence whose subject is the archive. */
export class BadArchive extends Error {}

export interface Limits {
  readonly entries: number;
  /** Bytes of one entry, and of all together. */
  readonly each: number;
  readonly all: number;
}

const LOCAL = 0x04034b50;
const CENTRAL = 0x02014b50;
const END = 0x06054b50;
/** Lengths of the heads without their names. */
const [LOCAL_LENGTH, CENTRAL_LENGTH, END_LENGTH] = [30, 46, 22];
/** Version 2.0 of the format: folders and deflate. */
const VERSION = 20;
/** Names are UTF-8. */
const UTF8 = 1 << 11;
const ENCRYPTED = 1;
const [STORED, DEFLATED] = [0, 8];
/** 1 January 1980, so that the same contents are the same bytes. */
const DATE = 0x21;

const TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let crc = byte;
  for (let i = 0; i < 8; i++) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1;
  return crc;
});

/** CRC-32 of IEEE 802.3. */
export function crc32(bytes: Uint8Array): number {
  let crc = ~0;
  for (const byte of bytes) crc = TABLE[(crc ^ byte) & 0xff]! ^ (crc >>> 8);
  return ~crc >>> 0;
}

/** Returns a head: its fields as [bytes, value] in their order. */
function head(length: number, fields: readonly (readonly [2 | 4, number])[]): Uint8Array {
  const view = new DataView(new ArrayBuffer(length));
  let at = 0;
  for (const [bytes, value] of fields) {
    if (bytes === 2) view.setUint16(at, value, true);
    else view.setUint32(at, value, true);
    at += bytes;
  }
  return new Uint8Array(view.buffer);
}

/** Returns an archive of files by their names. */
export async function zipped(files: ReadonlyMap<string, Uint8Array>): Promise<Blob> {
  const [parts, directory]: [Uint8Array[], Uint8Array[]] = [[], []];
  let at = 0;
  for (const [path, bytes] of files) {
    const name = new TextEncoder().encode(path);
    const packed = await deflated(bytes);
    const isSmaller = packed.length < bytes.length;
    const data = isSmaller ? packed : bytes;
    const fields = [
      [2, VERSION],
      [2, UTF8],
      [2, isSmaller ? DEFLATED : STORED],
      [2, 0],
      [2, DATE],
      [4, crc32(bytes)],
      [4, data.length],
      [4, bytes.length],
      [2, name.length],
      [2, 0],
    ] as const;
    // No comment, part 0, no attributes.
    const central = [[4, CENTRAL], [2, VERSION], ...fields, [2, 0], [2, 0], [2, 0], [4, 0], [4, at]] as const;
    directory.push(head(CENTRAL_LENGTH, central), name);
    parts.push(head(LOCAL_LENGTH, [[4, LOCAL], ...fields]), name, data);
    at += LOCAL_LENGTH + name.length + data.length;
  }
  const length = directory.reduce((sum, part) => sum + part.length, 0);
  const count = files.size;
  const end = head(END_LENGTH, [[4, END], [2, 0], [2, 0], [2, count], [2, count], [4, length], [4, at], [2, 0]]);
  return new Blob([...parts, ...directory, end] as BlobPart[], { type: "application/zip" });
}

interface Entry {
  readonly name: string;
  readonly method: number;
  readonly crc: number;
  readonly packed: number;
  readonly size: number;
  readonly at: number;
}

const isPath = (name: string): boolean =>
  !/[\\\0-\x1f]/.test(name) && name.split("/").every((part) => part !== "" && part !== "." && part !== "..");

/** Returns the position of the end of the directory, after which a comment may follow. */
function endOf(view: DataView): number {
  for (let at = view.byteLength - END_LENGTH; at >= Math.max(0, view.byteLength - END_LENGTH - 0xffff); at--)
    if (view.getUint32(at, true) === END && at + END_LENGTH + view.getUint16(at + 20, true) === view.byteLength) return at;
  const isZip = view.byteLength >= 4 && view.getUint32(0, true) === LOCAL;
  throw new BadArchive(isZip ? "is incomplete: its end is missing" : "is not a zip archive");
}

const mib = (bytes: number): string => `${Math.round(bytes / 1024 / 1024)} MiB`;

/** Reads the directory, and checks what it states. */
function entriesOf(view: DataView, limits: Limits): Entry[] {
  const end = endOf(view);
  const [count, length, start] = [view.getUint16(end + 10, true), view.getUint32(end + 12, true), view.getUint32(end + 16, true)];
  if (count > limits.entries) throw new BadArchive(`has more than ${limits.entries} files`);
  if (start + length > end) throw new BadArchive("is damaged: its directory is not where it should be");
  const entries: Entry[] = [];
  let [at, all] = [start, 0];
  for (let i = 0; i < count; i++) {
    if (at + CENTRAL_LENGTH > end || view.getUint32(at, true) !== CENTRAL)
      throw new BadArchive("is damaged: its directory is not complete");
    const of = (offset: number) => view.getUint16(at + offset, true);
    const [flags, method, names] = [of(8), of(10), of(28)];
    const [crc, packed, size, local] = [16, 20, 24, 42].map((offset) => view.getUint32(at + offset, true)) as [number, number, number, number];
    let name: string;
    try {
      const bytes = new Uint8Array(view.buffer, view.byteOffset + at + CENTRAL_LENGTH, Math.min(names, end - at - CENTRAL_LENGTH));
      name = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
    } catch {
      throw new BadArchive("has names that are not UTF-8");
    }
    at += CENTRAL_LENGTH + names + of(30) + of(32);
    if (name.endsWith("/") && size === 0) continue;
    if (!isPath(name)) throw new BadArchive(`has a file with the path ${JSON.stringify(name)}, which is not accepted`);
    if (entries.some((one) => one.name === name)) throw new BadArchive(`has ${name} twice`);
    if (flags & ENCRYPTED) throw new BadArchive("is encrypted");
    if (method !== STORED && method !== DEFLATED) throw new BadArchive(`has ${name} in a compression that is not deflate`);
    all += size;
    if (size > limits.each) throw new BadArchive(`has a file of ${mib(size)}, ${name}; ${mib(limits.each)} are accepted`);
    if (all > limits.all) throw new BadArchive(`has more than ${mib(limits.all)} of files`);
    entries.push({ name, method, crc, packed, size, at: local });
  }
  return entries;
}

async function contents(bytes: Uint8Array, view: DataView, entry: Entry): Promise<Uint8Array> {
  const damaged = new BadArchive(`is damaged: ${entry.name} cannot be read`);
  if (entry.at + LOCAL_LENGTH > bytes.length || view.getUint32(entry.at, true) !== LOCAL) throw damaged;
  const start = entry.at + LOCAL_LENGTH + view.getUint16(entry.at + 26, true) + view.getUint16(entry.at + 28, true);
  if (start + entry.packed > bytes.length) throw damaged;
  const packed = bytes.subarray(start, start + entry.packed);
  let found: Uint8Array;
  try {
    found = entry.method === STORED ? packed : await inflated(packed, entry.size);
  } catch (why) {
    if (why instanceof TooLong) throw new BadArchive(`is damaged: ${entry.name} is larger than the archive states`);
    throw damaged;
  }
  if (found.length !== entry.size || crc32(found) !== entry.crc) throw damaged;
  return found;
}

/** Returns the files of an archive by their names; throws BadArchive if any part of it cannot be read. */
export async function unzipped(bytes: Uint8Array, limits: Limits): Promise<Map<string, Uint8Array>> {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const files = new Map<string, Uint8Array>();
  for (const entry of entriesOf(view, limits)) files.set(entry.name, await contents(bytes, view, entry));
  return files;
}
