// Benches as files: complete after a round trip, read by another program's zip, refused if anything is wrong.

import assert from "node:assert/strict";
import { test } from "node:test";

import { unzipSync, zipSync, strFromU8, strToU8 } from "fflate";

import { fileNameOf, packed, pathIn, stringsOf, unpacked, type Bench } from "../../src/model/bench.ts";
import { crc32 } from "../../src/model/zip.ts";

const data = (name: string, text: string, isOfProgram = false) => ({ name, sha256: `of ${text}`, bytes: strToU8(text), isOfProgram });
const design = (name: string, text: string, more: object = {}) => ({ name, text, keptAt: null, thumbnail: "", numbers: {}, data: [], ...more });

const BENCH: Bench = {
  designs: [
    design("Indoor: now", 'file = "lobe.bsdf"', { data: [data("lobe.bsdf", "one"), data("data/H65.bsdf", "own", true)] }),
    design("Before", 'file = "lobe.bsdf"', {
      keptAt: 1_700_000_000_000,
      thumbnail: "data:image/png;base64,iVBORw0KGgo=",
      numbers: { contrast_ratio: 12.5 },
      data: [data("lobe.bsdf", "two"), data("../surfaces/etched.toml", "t", true)],
    }),
    design("Before", "title = 'with µ'", { keptAt: 1_700_000_001_000 }),
  ],
  open: 0,
  compared: 1,
  numbers: [{ metric: "white.Y", target: { kind: "at_least", value: 30 } }, { metric: "contrast_ratio", target: null }],
  rooms: ["office"],
  picture: "photo.png",
};

const bytesOf = async (bench: Bench) => new Uint8Array(await (await packed(bench)).arrayBuffer());
const refusal = async (bytes: Uint8Array): Promise<string> => {
  try {
    await unpacked(bytes);
  } catch (why) {
    return (why as Error).message;
  }
  return "";
};

test("bench is complete after a round trip, and another program reads its files", async () => {
  const bytes = await bytesOf(BENCH);
  assert.deepEqual(await unpacked(bytes), BENCH);
  const files = unzipSync(bytes);
  const names = Object.keys(files).sort();
  assert.deepEqual(names, [
    "README.txt",
    "bench.json",
    "designs-2/Before.toml",
    "designs-2/lobe.bsdf",
    "designs/Before.toml",
    "designs/Indoor- now.toml",
    "designs/data/H65.bsdf",
    "designs/lobe.bsdf",
    "pictures/2.png",
    "surfaces/etched.toml",
  ]);
  assert.equal(strFromU8(files["designs-2/lobe.bsdf"]!), "two");
  assert.match(strFromU8(files["README.txt"]!), /papilio run "designs\/Indoor- now.toml"/);
  assert.equal(JSON.parse(strFromU8(files["bench.json"]!)).version, 1);
});

test("archive that another program has packed again, in a folder, is read", async () => {
  const files = unzipSync(await bytesOf(BENCH));
  const again = Object.fromEntries(Object.entries(files).map(([name, bytes]) => [`my bench/${name}`, bytes]));
  assert.deepEqual(await unpacked(zipSync(again, { level: 9 })), BENCH);
});

test("crc of the check string is that of the standard", () => assert.equal(crc32(strToU8("123456789")), 0xcbf43926));

test("foreign, newer, broken and incomplete files are refused with the reason", async () => {
  const whole = await bytesOf(BENCH);
  const files = unzipSync(whole);
  const list = JSON.parse(strFromU8(files["bench.json"]!)) as Record<string, unknown>;
  const changed = (more: object) => zipSync({ ...files, "bench.json": strToU8(JSON.stringify({ ...list, ...more })) });
  const { "designs/lobe.bsdf": _, ...without } = files;
  const cases: [Uint8Array, RegExp][] = [
    [strToU8("a text"), /not a zip archive/],
    [whole.subarray(0, whole.length - 30), /incomplete: its end is missing/],
    [zipSync({ "a.txt": strToU8("a") }), /not a bench of Papilio: it has no bench.json/],
    [zipSync({ "bench.json": strToU8("{}") }), /not a bench of Papilio: bench.json has another format/],
    [zipSync({ "bench.json": strToU8("{") }), /bench.json is not JSON/],
    [changed({ version: 2 }), /newer Papilio: it has version 2, and this page reads version 1/],
    [changed({ version: 0 }), /has no version/],
    [changed({ open: "designs/none.toml" }), /open in bench.json is not the file of a design/],
    [changed({ rooms: "office" }), /rooms in bench.json is not a list/],
    [changed({ numbers: [{ metric: 3 }] }), /numbers\[0\]\.metric in bench.json is not a text/],
    [zipSync(without), /incomplete: it has no file designs\/lobe.bsdf/],
    [zipSync({ ...files, "../evil.txt": strToU8("a") }), /path "\.\.\/evil\.txt", which is not accepted/],
  ];
  for (const [bytes, expected] of cases) assert.match(await refusal(bytes), expected);
});

test("a changed bit anywhere is refused, or changes nothing", async () => {
  const whole = await bytesOf(BENCH);
  for (let at = 0; at < whole.length; at += 7) {
    const bytes = whole.slice();
    bytes[at]! ^= 1 << at % 8;
    const read = await unpacked(bytes).catch((why: Error) => why);
    // Bits that no reader needs: dates, versions, attributes.
    if (!(read instanceof Error)) assert.deepEqual(read, BENCH, `byte ${at}`);
  }
});

test("archives that would fill the memory are refused before that", async () => {
  const huge = new Uint8Array(65 << 20);
  const fast = { level: 1 } as const;
  assert.match(await refusal(zipSync({ "bench.json": huge }, fast)), /a file of 65 MiB, bench.json; 64 MiB are accepted/);
  const many = Object.fromEntries(Array.from({ length: 5 }, (_, i) => [`${i}.bin`, huge.subarray(0, 60 << 20)]));
  assert.match(await refusal(zipSync(many, fast)), /more than 256 MiB of files/);
  // One that states a smaller size than it has.
  const lying = zipSync({ "bench.json": huge }, fast);
  const view = new DataView(lying.buffer, lying.byteOffset);
  for (let at = 0; at + 4 <= lying.length; at++) if (view.getUint32(at, true) === 65 << 20) view.setUint32(at, 1000, true);
  assert.match(await refusal(lying), /bench.json is larger than the archive states/);
  const crowd = Object.fromEntries(Array.from({ length: 1001 }, (_, i) => [`${i}`, new Uint8Array()]));
  assert.match(await refusal(zipSync(crowd)), /more than 1000 files/);
});

test("names of files are found in a scenario, and paths stay in the archive", () => {
  const found = stringsOf(`a = "x.csv" # "y\\u0041.csv"\nb = 'z"z.csv'\nc = """\n"q.csv"\n"""`);
  for (const name of ["x.csv", "yA.csv", 'z"z.csv', "q.csv"]) assert.ok(found.has(name), name);
  assert.equal(pathIn("designs", "../surfaces/a.toml"), "surfaces/a.toml");
  assert.equal(pathIn("designs", "../../a"), null);
  assert.equal(fileNameOf("../a:b?"), "a-b");
  assert.equal(fileNameOf("…"), "design");
});
