// Designs that are kept: reloads, duplicated tabs, new tabs, a full browser.

import assert from "node:assert/strict";
import { test } from "node:test";

import { chained, unchained } from "../../src/model/delta.ts";
import { keeper, MOST, type Keeper, type Now, type Place, type Steps } from "../../src/state/works.ts";

/** A storage that is full with so many letters. */
class Room implements Place {
  constructor(
    readonly held = new Map<string, string>(),
    readonly most = Infinity,
  ) {}
  get length(): number {
    return this.held.size;
  }
  key = (i: number): string | null => [...this.held.keys()][i] ?? null;
  getItem = (key: string): string | null => this.held.get(key) ?? null;
  removeItem = (key: string): void => void this.held.delete(key);
  setItem(key: string, value: string): void {
    const others = [...this.held].reduce((sum, [k, v]) => sum + (k === key ? 0 : k.length + v.length), 0);
    if (others + key.length + value.length > this.most) throw new Error("QuotaExceededError");
    this.held.set(key, value);
  }
}

let now = 1000;
const clock = (): number => now++;
const opened = (tab: Place | null, all: Place | null, said: string[] = []): Keeper =>
  keeper(tab, all, (words) => said.push(words), clock);

const at = (text: string): Now => ({
  text,
  draft: null,
  draftName: "",
  typed: false,
  pending: [],
  present: null,
  pinned: null,
  started: "indoor",
  files: {},
  title: text.slice(0, 20),
});
const none: Steps = { past: [], future: [] };
const after = (...past: string[]): Steps => ({ past, future: [] });
const titles = (keeper: Keeper): string[] => keeper.earlier().map(({ title }) => title);

test("a chain of texts is small, and comes back whole", () => {
  const texts = ["", "a", "ab", "aab", "ab", "", "λ/4 → 55°", "λ/2 → 55°"];
  assert.deepEqual(unchained(chained(texts)), texts);
  const long = Array.from({ length: 200 }, (_, i) => `${"x".repeat(5000)}haze = 0.${i}${"y".repeat(5000)}`);
  assert.deepEqual(unchained(JSON.parse(JSON.stringify(chained(long)))), long);
  assert.ok(JSON.stringify(chained(long)).length < 15_000);
  assert.deepEqual(unchained(undefined), []);
  assert.deepEqual(unchained([null]), []);
});

test("a reload has everything, undo and redo too, and leaves no second record", () => {
  const [tab, all] = [new Room(), new Room()];
  const first = opened(tab, all);
  assert.equal(first.load(), null);
  const pending = [{ op: "set", path: "a", value: 1 }] as const;
  first.keep({ ...at("two"), pending }, { past: ["zero", "one"], future: ["three"] }, true);
  const second = opened(tab, all);
  const { work, own } = second.load()!;
  assert.ok(own);
  assert.deepEqual([work.text, work.past, work.future, work.pending], ["two", ["zero", "one"], ["three"], pending]);
  assert.deepEqual(titles(second), []);
  second.keep(at("four"), after("zero", "one", "two"), true);
  assert.deepEqual(titles(opened(new Room(), all)), ["four"]);
});

test("two tabs keep two designs; a third one goes on with the last", () => {
  const all = new Room();
  const [a, b] = [new Room(), new Room()];
  const [one, two] = [opened(a, all), opened(b, all)];
  one.load();
  two.load();
  one.keep(at("of one"), after("start"), true);
  two.keep(at("of two"), after("start"), true);
  assert.equal(opened(a, all).load()!.work.text, "of one");
  assert.equal(opened(b, all).load()!.work.text, "of two");
  const third = opened(new Room(), all);
  assert.equal(third.load()!.work.text, "of two");
  assert.deepEqual(titles(third), ["of one"]);
});

test("a duplicated tab goes its own way, whichever of the two writes first", () => {
  for (const first of ["original", "copy"]) {
    const [tab, all] = [new Room(), new Room()];
    const original = opened(tab, all);
    original.load();
    original.keep(at("both"), after("start"), true);
    const copiedTab = new Room(new Map(tab.held));
    const copy = opened(copiedTab, all);
    assert.equal(copy.load()!.work.text, "both");
    const write = {
      original: () => original.keep(at("original"), after("start", "both"), true),
      copy: () => copy.keep(at("copy"), after("start", "both"), true),
    };
    write[first as "copy"]();
    write[first === "copy" ? "original" : "copy"]();
    assert.deepEqual(titles(opened(new Room(), all)).sort(), ["copy", "original"]);
    assert.equal(opened(tab, all).load()!.work.text, "original");
    assert.equal(opened(copiedTab, all).load()!.work.text, "copy");
    assert.deepEqual(opened(tab, all).load()!.work.past, ["start", "both"]);
  }
});

test("steps that another tab took away are written again, in the midst of a drag too", () => {
  const [tab, all] = [new Room(), new Room()];
  const original = opened(tab, all);
  original.load();
  const steps = after("start");
  original.keep(at("both"), steps, true);
  const copy = opened(new Room(new Map(tab.held)), all);
  copy.load();
  copy.keep(at("copy"), after("start", "both"), true);
  original.keep(at("dragged"), steps, true);
  const later = opened(new Room(), all);
  assert.deepEqual([later.load()!.work.text, later.load()!.work.past], ["dragged", ["start"]]);
});

test("what is only looked at leaves nothing behind, and takes nothing away", () => {
  const all = new Room();
  const one = opened(new Room(), all);
  one.load();
  one.keep(at("indoor"), none, false);
  assert.equal(all.length, 0);
  one.keep(at("mine"), after("indoor"), true);
  const two = opened(new Room(), all);
  two.load();
  two.keep(at("mine"), after("indoor"), false);
  assert.deepEqual(titles(opened(new Room(), all)), ["mine"]);
});

test("a link in a new tab stands beside what was kept", () => {
  const all = new Room();
  const one = opened(new Room(), all);
  one.load();
  one.keep(at("mine"), after("indoor"), true);
  const linked = opened(new Room(), all);
  linked.load();
  linked.part();
  linked.keep(at("linked"), after("indoor", "mine"), true);
  assert.deepEqual(titles(linked), ["mine"]);
});

test("an earlier design is taken up with its steps, and the one that was open stays", () => {
  const [a, all] = [new Room(), new Room()];
  const one = opened(a, all);
  one.load();
  one.keep(at("first"), after("indoor"), true);
  const two = opened(new Room(), all);
  two.load();
  two.part();
  two.keep(at("second"), after("indoor", "x"), true);
  const [earlier] = two.earlier();
  const work = two.take(earlier!.id)!;
  assert.deepEqual([work.text, work.past], ["first", ["indoor"]]);
  assert.deepEqual(titles(two), ["second"]);
  two.keep(at("first, changed"), after("indoor", "first"), true);
  assert.deepEqual(titles(two), ["second"]);
  // The tab that had it open still has it.
  assert.equal(opened(a, all).load()!.work.text, "first");
});

test("of a copy and a tab's own record the one that was written last counts", () => {
  const [tab, all] = [new Room(), new Room()];
  const one = opened(tab, all);
  one.load();
  one.keep(at("early"), none, true);
  const old = new Map(tab.held);
  one.keep(at("late"), after("early"), true);
  assert.equal(opened(new Room(old), all).load()!.work.text, "late");
});

test("of too many designs the oldest goes, and it is said", () => {
  const [all, said] = [new Room(), [] as string[]];
  for (let i = 0; i <= MOST; i++) {
    const one = opened(new Room(), all, said);
    one.load();
    one.part();
    one.keep(at(`design ${i}`), none, true);
  }
  const left = titles(opened(new Room(), all));
  assert.equal(left.length, MOST);
  assert.ok(!left.includes("design 0"));
  assert.match(said.join(), /design 0/);
});

test("in a full browser steps of undo go first, the oldest before the others, and the page says so", () => {
  const said: string[] = [];
  const [tab, all] = [new Room(new Map(), 40_000), new Room(new Map(), 40_000)];
  const text = (i: number): string => String.fromCharCode(65 + i).repeat(3000);
  const one = opened(tab, all, said);
  one.load();
  const past: string[] = [];
  for (let i = 0; i < 40; i++) {
    one.keep(at(text(i)), { past: [...past], future: [] }, true);
    past.push(text(i));
  }
  assert.match(said.join(), /oldest steps of undo/);
  const { work } = opened(tab, all).load()!;
  assert.equal(work.text, text(39));
  assert.ok(work.past.length > 3 && work.past.length < 39, String(work.past.length));
  assert.equal(work.past.at(-1), text(38));
});

test("in a full browser undo of closed tabs goes before the designs, and these before one's own", () => {
  const said: string[] = [];
  const all = new Room(new Map(), 30_000);
  const long = (name: string): string => name + name[0]!.repeat(8000);
  for (const name of ["abc", "def"]) {
    const one = opened(new Room(), all, said);
    one.load();
    one.part();
    one.keep(at(long(name)), none, true);
  }
  const own = opened(new Room(), all, said);
  own.load();
  own.part();
  own.keep(at(`ghi${"g".repeat(20_000)}`), none, true);
  assert.match(said.join(), /abca/);
  assert.equal(opened(new Room(), all).load()!.work.text.slice(0, 3), "ghi");
});

test("a browser that keeps nothing says so once, and one without a tab's storage still keeps", () => {
  const said: string[] = [];
  const blind = opened(null, null, said);
  assert.equal(blind.load(), null);
  blind.keep(at("a"), none, true);
  blind.keep(at("b"), none, true);
  assert.equal(said.length, 1);
  const all = new Room();
  opened(null, all).keep(at("kept"), none, true);
  assert.equal(opened(null, all).load()!.work.text, "kept");
});

test("a record of a former version, and one that is broken", () => {
  const all = new Room(new Map([["papilio.design", JSON.stringify({ text: "old", past: ["older"], pinned: null })]]));
  const { work, own } = opened(new Room(), all).load()!;
  assert.deepEqual([work.text, work.past, own], ["old", ["older"], false]);
  const broken = new Room(
    new Map([
      ["papilio.work.x", "{"],
      ["papilio.work.y", '{"id":"y"}'],
    ]),
  );
  assert.equal(opened(new Room(new Map([["papilio.tab", "[1"]])), broken).load(), null);
});
