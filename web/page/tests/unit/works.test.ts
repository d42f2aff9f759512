// Stored designs: reloads, duplicated tabs, new tabs, full storage.

import assert from "node:assert/strict";
import { test } from "node:test";

import { chained, unchained } from "../../src/model/delta.ts";
import { keeper, MOST, type Keeper, type Now, type Place, type Steps } from "../../src/state/works.ts";

/** A storage of limited size, in characters. */
class LimitedStorage implements Place {
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
  change: "",
});
const none: Steps = { past: [], future: [] };
const after = (...past: string[]): Steps => ({ past, future: [] });
const titles = (keeper: Keeper): string[] => keeper.earlier().map(({ title }) => title);

test("chain of texts is small and is restored completely", () => {
  const texts = ["", "a", "ab", "aab", "ab", "", "λ/4 → 55°", "λ/2 → 55°"];
  assert.deepEqual(unchained(chained(texts)), texts);
  const long = Array.from({ length: 200 }, (_, i) => `${"x".repeat(5000)}haze = 0.${i}${"y".repeat(5000)}`);
  assert.deepEqual(unchained(JSON.parse(JSON.stringify(chained(long)))), long);
  assert.ok(JSON.stringify(chained(long)).length < 15_000);
  assert.deepEqual(unchained(undefined), []);
  assert.deepEqual(unchained([null]), []);
});

test("reload restores the design with undo and redo, and leaves no second record", () => {
  const [tab, all] = [new LimitedStorage(), new LimitedStorage()];
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
  assert.deepEqual(titles(opened(new LimitedStorage(), all)), ["four"]);
});

test("two tabs store two designs, and a third tab opens the last one", () => {
  const all = new LimitedStorage();
  const [a, b] = [new LimitedStorage(), new LimitedStorage()];
  const [one, two] = [opened(a, all), opened(b, all)];
  one.load();
  two.load();
  one.keep(at("of one"), after("start"), true);
  two.keep(at("of two"), after("start"), true);
  assert.equal(opened(a, all).load()!.work.text, "of one");
  assert.equal(opened(b, all).load()!.work.text, "of two");
  const third = opened(new LimitedStorage(), all);
  assert.equal(third.load()!.work.text, "of two");
  assert.deepEqual(titles(third), ["of one"]);
});

test("duplicated tab has a separate design, independent of the order of the writes", () => {
  for (const first of ["original", "copy"]) {
    const [tab, all] = [new LimitedStorage(), new LimitedStorage()];
    const original = opened(tab, all);
    original.load();
    original.keep(at("both"), after("start"), true);
    const copiedTab = new LimitedStorage(new Map(tab.held));
    const copy = opened(copiedTab, all);
    assert.equal(copy.load()!.work.text, "both");
    const write = {
      original: () => original.keep(at("original"), after("start", "both"), true),
      copy: () => copy.keep(at("copy"), after("start", "both"), true),
    };
    write[first as "copy"]();
    write[first === "copy" ? "original" : "copy"]();
    assert.deepEqual(titles(opened(new LimitedStorage(), all)).sort(), ["copy", "original"]);
    assert.equal(opened(tab, all).load()!.work.text, "original");
    assert.equal(opened(copiedTab, all).load()!.work.text, "copy");
    assert.deepEqual(opened(tab, all).load()!.work.past, ["start", "both"]);
  }
});

test("undo steps that another tab has removed are written again, also during a drag", () => {
  const [tab, all] = [new LimitedStorage(), new LimitedStorage()];
  const original = opened(tab, all);
  original.load();
  const steps = after("start");
  original.keep(at("both"), steps, true);
  const copy = opened(new LimitedStorage(new Map(tab.held)), all);
  copy.load();
  copy.keep(at("copy"), after("start", "both"), true);
  original.keep(at("dragged"), steps, true);
  const later = opened(new LimitedStorage(), all);
  assert.deepEqual([later.load()!.work.text, later.load()!.work.past], ["dragged", ["start"]]);
});

test("unchanged design leaves no record and removes none", () => {
  const all = new LimitedStorage();
  const one = opened(new LimitedStorage(), all);
  one.load();
  one.keep(at("indoor"), none, false);
  assert.equal(all.length, 0);
  one.keep(at("mine"), after("indoor"), true);
  const two = opened(new LimitedStorage(), all);
  two.load();
  two.keep(at("mine"), after("indoor"), false);
  assert.deepEqual(titles(opened(new LimitedStorage(), all)), ["mine"]);
});

test("link in a new tab does not replace the stored design", () => {
  const all = new LimitedStorage();
  const one = opened(new LimitedStorage(), all);
  one.load();
  one.keep(at("mine"), after("indoor"), true);
  const linked = opened(new LimitedStorage(), all);
  linked.load();
  linked.part();
  linked.keep(at("linked"), after("indoor", "mine"), true);
  assert.deepEqual(titles(linked), ["mine"]);
});

test("earlier design is opened with its steps, and the previous one stays stored", () => {
  const [a, all] = [new LimitedStorage(), new LimitedStorage()];
  const one = opened(a, all);
  one.load();
  one.keep(at("first"), after("indoor"), true);
  const two = opened(new LimitedStorage(), all);
  two.load();
  two.part();
  two.keep(at("second"), after("indoor", "x"), true);
  const [earlier] = two.earlier();
  const work = two.take(earlier!.id)!;
  assert.deepEqual([work.text, work.past], ["first", ["indoor"]]);
  assert.deepEqual(titles(two), ["second"]);
  two.keep(at("first, changed"), after("indoor", "first"), true);
  assert.deepEqual(titles(two), ["second"]);
  // The other tab still has this design.
  assert.equal(opened(a, all).load()!.work.text, "first");
});

test("newer one of a tab's record and its copy is restored", () => {
  const [tab, all] = [new LimitedStorage(), new LimitedStorage()];
  const one = opened(tab, all);
  one.load();
  one.keep(at("early"), none, true);
  const old = new Map(tab.held);
  one.keep(at("late"), after("early"), true);
  assert.equal(opened(new LimitedStorage(old), all).load()!.work.text, "late");
});

test("oldest of too many designs is removed with a message", () => {
  const [all, said] = [new LimitedStorage(), [] as string[]];
  for (let i = 0; i <= MOST; i++) {
    const one = opened(new LimitedStorage(), all, said);
    one.load();
    one.part();
    one.keep(at(`design ${i}`), none, true);
  }
  const left = titles(opened(new LimitedStorage(), all));
  assert.equal(left.length, MOST);
  assert.ok(!left.includes("design 0"));
  assert.match(said.join(), /design 0/);
});

test("full storage removes the oldest undo steps first, with a message", () => {
  const said: string[] = [];
  const [tab, all] = [new LimitedStorage(new Map(), 40_000), new LimitedStorage(new Map(), 40_000)];
  const text = (i: number): string => String.fromCharCode(65 + i).repeat(3000);
  const one = opened(tab, all, said);
  one.load();
  const past: string[] = [];
  for (let i = 0; i < 40; i++) {
    one.keep(at(text(i)), { past: [...past], future: [] }, true);
    past.push(text(i));
  }
  assert.match(said.join(), /oldest undo steps/);
  const { work } = opened(tab, all).load()!;
  assert.equal(work.text, text(39));
  assert.ok(work.past.length > 3 && work.past.length < 39, String(work.past.length));
  assert.equal(work.past.at(-1), text(38));
});

test("full storage removes undo steps of closed tabs first, then their designs, and never the own design", () => {
  const said: string[] = [];
  const all = new LimitedStorage(new Map(), 30_000);
  const long = (name: string): string => name + name[0]!.repeat(8000);
  for (const name of ["abc", "def"]) {
    const one = opened(new LimitedStorage(), all, said);
    one.load();
    one.part();
    one.keep(at(long(name)), none, true);
  }
  const own = opened(new LimitedStorage(), all, said);
  own.load();
  own.part();
  own.keep(at(`ghi${"g".repeat(20_000)}`), none, true);
  assert.match(said.join(), /abca/);
  assert.equal(opened(new LimitedStorage(), all).load()!.work.text.slice(0, 3), "ghi");
});

test("browser without storage gives one message, and one without sessionStorage still stores designs", () => {
  const said: string[] = [];
  const blind = opened(null, null, said);
  assert.equal(blind.load(), null);
  blind.keep(at("a"), none, true);
  blind.keep(at("b"), none, true);
  assert.equal(said.length, 1);
  const all = new LimitedStorage();
  opened(null, all).keep(at("kept"), none, true);
  assert.equal(opened(null, all).load()!.work.text, "kept");
});

test("record of a former version is read, and a broken record is ignored", () => {
  const all = new LimitedStorage(
    new Map([["papilio.design", JSON.stringify({ text: "old", past: ["older"], pinned: null })]]),
  );
  const { work, own } = opened(new LimitedStorage(), all).load()!;
  assert.deepEqual([work.text, work.past, own], ["old", ["older"], false]);
  const broken = new LimitedStorage(
    new Map([
      ["papilio.work.x", "{"],
      ["papilio.work.y", '{"id":"y"}'],
    ]),
  );
  assert.equal(opened(new LimitedStorage(new Map([["papilio.tab", "[1"]])), broken).load(), null);
});
