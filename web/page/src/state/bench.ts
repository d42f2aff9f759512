// The whole bench as one file: the design, all versions, the numbers and rooms that are shown, and all data files.

import { get, postForBytes, Refused, upload } from "../api/client.ts";
import type { DataEntry, Upload } from "../api/types.ts";
import { BadBench, LARGEST, packed, stringsOf, unpacked, type Bench, type BenchData, type BenchDesign } from "../model/bench.ts";
import { titleOf } from "../model/about.ts";
import { draft, pending, title } from "./design.ts";
import { keptIds, type Dropped } from "./files.ts";
import { pictureName } from "./image.ts";
import { keepFile, keptFile } from "./keep.ts";
import { isTyped } from "./live.ts";
import { chosen, putFirst } from "./numbers.ts";
import { pinned } from "./pin.ts";
import { rooms, showRooms } from "./rooms.ts";
import { said } from "./said.ts";
import { begun } from "./start.ts";
import { addVersions, MOST, newOf, versions, type Version } from "./versions.ts";
import { missing, wholeText } from "./whole.ts";

type Ids = Readonly<Record<string, string>>;

/** The files of the program: their SHA-256 by name. */
async function ofProgram(): Promise<ReadonlyMap<string, string>> {
  const all = await get<DataEntry[]>("data");
  return new Map(all.map(({ name, sha256 }) => [name, sha256]));
}

const bytesFrom = async (file: string): Promise<Uint8Array> => new Uint8Array(await postForBytes("data/file", { file }));

/** Returns a file that was uploaded; null if neither the browser nor the server has it. */
async function uploaded(id: string): Promise<Uint8Array | null> {
  const kept = await keptFile(id);
  if (kept) return new Uint8Array(await kept.arrayBuffer());
  return bytesFrom(id).catch(() => null);
}

/** Collects the data files of designs; each is read once. */
class Collector {
  /** Names of files that nobody has any more. */
  readonly lost = new Set<string>();
  private readonly read = new Map<string, Promise<Uint8Array | null>>();

  constructor(private readonly program: ReadonlyMap<string, string>) {}

  private bytes(key: string, read: () => Promise<Uint8Array | null>): Promise<Uint8Array | null> {
    const known = this.read.get(key) ?? read();
    this.read.set(key, known);
    return known;
  }

  private async one(name: string, ids: Ids): Promise<BenchData | null> {
    const [id, own] = [ids[name], this.program.get(name)];
    const sha256 = id ?? own;
    if (sha256 === undefined) return null;
    const bytes = await this.bytes(sha256, () => (id ? uploaded(id) : bytesFrom(name)));
    if (bytes === null) this.lost.add(name);
    return bytes && { name, sha256, bytes, isOfProgram: id === undefined };
  }

  /** Returns the files that a text names, with those that they name, and further ones. */
  async of(text: string, ids: Ids, further: readonly string[] = []): Promise<BenchData[]> {
    const waiting = [...stringsOf(text), ...further];
    const found = new Map<string, BenchData>();
    for (let name = waiting.pop(); name !== undefined; name = waiting.pop()) {
      const data = found.has(name) ? null : await this.one(name, ids);
      if (data === null) continue;
      found.set(name, data);
      if (!name.endsWith(".toml")) continue;
      // A surface, whose meshes and heights are beside it.
      const folder = name.replace(/[^/]*$/, "");
      for (const inner of stringsOf(new TextDecoder().decode(data.bytes))) waiting.push(folder + inner, inner);
    }
    return [...found.values()];
  }
}

/** Returns the bench as a file, and what it lacks as a sentence, or ""; null if the design cannot be saved now. */
export async function benchFile(): Promise<{ readonly file: Blob; readonly words: string } | null> {
  const whole = isTyped() && pending.value.length === 0 ? { text: draft.value!, left: [] } : await wholeText("saved");
  if (whole === null) return null;
  const collector = new Collector(await ofProgram());
  const plain = { keptAt: null, thumbnail: "", numbers: {} };
  const designs: BenchDesign[] = [];
  const put = (design: BenchDesign): number => designs.push(design) - 1;
  const ids = keptIds.value;
  put({ ...plain, name: title.value, text: whole.text, data: await collector.of(whole.text, ids, Object.keys(ids)) });
  for (const { name, text, files, at, thumbnail, numbers } of versions.value)
    put({ name, text, keptAt: at, thumbnail, numbers, data: await collector.of(text, files) });
  const other = pinned.value;
  let compared: number | null = null;
  if (other) {
    compared = designs.findIndex(({ text }) => text === other.text);
    if (compared < 0) compared = put({ ...plain, name: other.title, text: other.text, data: await collector.of(other.text, ids) });
  }
  const file = await packed({ designs, open: 0, compared, numbers: chosen.value, rooms: rooms.value, picture: pictureName.value });
  const lost = [...collector.lost].join(", ");
  return { file, words: `${lost && `. These files are no longer stored, and not in it: ${lost}`}${missing(whole)}` };
}

/** Sends the data files to the server, which reads and names them, and stores them in the browser. Returns what it knows of each. */
async function sent(bench: Bench, name: string): Promise<ReadonlyMap<BenchData, Upload | null>> {
  const program = await ofProgram();
  const known = new Map<BenchData, Upload | null>();
  const bySha = new Map<string, Upload>();
  // Surfaces after the meshes and heights that they name.
  const all = bench.designs.flatMap(({ data }) => data).sort((a, b) => Number(a.name.endsWith(".toml")) - Number(b.name.endsWith(".toml")));
  const isOwn = (one: BenchData) => one.isOfProgram && program.get(one.name) === one.sha256;
  const waiting = new Set(all.filter((one) => !isOwn(one)).map(({ sha256 }) => sha256));
  for (const one of all) {
    if (isOwn(one)) {
      known.set(one, null);
      continue;
    }
    let audit = bySha.get(one.sha256);
    if (!audit) {
      said.value = `Opening ${name}: file ${bySha.size + 1} of ${waiting.size}, ${one.name}…`;
      const short = one.name.split("/").at(-1)!;
      const bytes = new Blob([one.bytes as BlobPart]);
      try {
        audit = await upload<Upload>(short, bytes);
      } catch (why) {
        throw new BadBench(`has a file that Papilio cannot read, ${one.name}: ${why instanceof Refused ? why.message : String(why)}`);
      }
      if ((await keepFile(audit.id, bytes)) === null) throw new BadBench("does not fit into the storage of the browser");
      bySha.set(one.sha256, audit);
    }
    known.set(one, audit);
  }
  return known;
}

/** Opens a bench. The previous design becomes an earlier one; versions are added. Nothing is changed if any part cannot be read. */
export async function openBench(file: File): Promise<boolean> {
  said.value = `Opening ${file.name}…`;
  try {
    if (file.size > LARGEST) throw new BadBench(`is larger than ${LARGEST / 1024 / 1024} MiB`);
    const bench = await unpacked(new Uint8Array(await file.arrayBuffer()));
    const audits = await sent(bench, file.name);
    const idsOf = ({ data }: BenchDesign): Record<string, string> =>
      Object.fromEntries(data.flatMap((one) => (audits.get(one) ? [[one.name, audits.get(one)!.id] as const] : [])));
    const open = bench.designs[bench.open]!;
    const dropped = open.data.flatMap((one): Dropped[] => {
      const audit = audits.get(one);
      return audit ? [{ name: one.name, bytes: one.bytes.length, id: audit.id, audit, problems: [], isReading: false }] : [];
    });
    const added = bench.designs.flatMap((one): Omit<Version, "id">[] => {
      const { name, text, keptAt, thumbnail, numbers } = one;
      return keptAt === null ? [] : [{ name, text, files: idsOf(one), at: keptAt, thumbnail, numbers }];
    });
    const further = newOf(added).length;
    const lacking = further + versions.value.length - MOST;
    if (lacking > 0) throw new BadBench(`adds ${further} versions, and ${MOST} can be stored: remove ${lacking} first`);
    // From here on, nothing can fail.
    const count = addVersions(added);
    putFirst(bench.numbers);
    showRooms(bench.rooms);
    const other = bench.compared === null ? null : bench.designs[bench.compared]!.text;
    await begun(open.text, other, dropped, `opened from ${file.name}`);
    pictureName.value = bench.picture;
    const more = count === 0 ? "" : count === 1 ? ", and one version is added" : `, and ${count} versions are added`;
    said.value = `“${titleOf(open.text) || open.name}” of ${file.name} is open${more}. The previous design is under Earlier.`;
    return true;
  } catch (why) {
    const words = why instanceof BadBench ? why.message : `cannot be opened: ${why instanceof Error ? why.message : String(why)}`;
    said.value = `${file.name} ${words}. Nothing was changed.`;
    return false;
  }
}
