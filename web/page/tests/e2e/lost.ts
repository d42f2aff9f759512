// Simulates failures: the server is killed, the tab crashes, is reloaded, closed or duplicated, links are opened. Before
// each failure, an edit is accepted and another is typed that gets no response; afterwards both must be there. The
// sequence is drawn from a seed.

import assert from "node:assert/strict";

import type { BrowserContext, CDPSession, Page } from "playwright-core";

import { unchained } from "../../src/model/delta.ts";
import { packed } from "../../src/state/link.ts";
import { saved, type, type Stage } from "./stage.ts";

/** Random numbers from 0 to 1, determined by a seed (mulberry32). */
function numbers(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

const FIRST = "display.pixel.film.1";
const SECOND = "display.pixel.film.2";

/** The record of a tab in its sessionStorage. */
interface Record {
  readonly text: string;
  readonly draft: string | null;
  readonly pending: readonly unknown[];
}

const recordOf = (page: Page): Promise<Record> =>
  page.evaluate(() => JSON.parse(sessionStorage.getItem("papilio.tab") ?? "null") as Record);

/** Waits until the server has accepted all changes. */
async function taken(page: Page): Promise<void> {
  await page.waitForFunction(() => {
    const { draft, pending } = JSON.parse(sessionStorage.getItem("papilio.tab") ?? "{}") as Partial<Record>;
    return draft === null && pending?.length === 0;
  });
}

const opened = async (page: Page): Promise<void> => page.locator(".bench").waitFor();

class Play {
  private count = 0;
  private page!: Page;
  private context!: BrowserContext;
  /** All edits that were typed and are valid, as parts of a text. */
  private readonly typed: string[] = [];
  /** The last accepted edit of the current tab, and the last typed one. */
  private accepted = "";
  private last = "";

  constructor(
    private readonly on: Stage,
    private readonly random: () => number,
  ) {}

  async begin(): Promise<void> {
    this.page = await this.on.visit();
    this.context = this.page.context();
  }

  /** Returns a value that no other edit has. */
  private value(from: number): string {
    this.count += 1;
    return String(Number((from + this.count / 100).toFixed(2)));
  }

  private note(edit: string): string {
    this.typed.push(edit);
    return edit;
  }

  private async accept(page = this.page): Promise<void> {
    const value = this.value(9);
    await page.getByRole("button", { name: "Drawing" }).click();
    await page.locator(`[data-part="${FIRST}"]`).click();
    await type(page, `${FIRST}.thickness_nm`, value);
    await taken(page);
    this.accepted = this.note(`thickness_nm = ${value}`);
  }

  /** Types an edit that gets no response: in a number, in the text, or in a box that keeps the focus. */
  private async half(page = this.page): Promise<void> {
    this.on.halt(true);
    const value = this.value(30);
    const kind = Math.floor(3 * this.random());
    if (kind === 0) {
      await page.locator(`[data-part="${SECOND}"]`).click();
      await type(page, `${SECOND}.thickness_nm`, value);
      this.last = `thickness_nm = ${value}`;
    } else if (kind === 1) {
      await page.getByRole("button", { name: "TOML" }).click();
      const text = await page.locator("#source").inputValue();
      await page.locator("#source").fill(`# typed ${value}\n${text}`);
      this.last = `# typed ${value}`;
    } else {
      await page.locator(".title").fill(`Half typed ${value}`);
      this.last = `title = "Half typed ${value}"`;
    }
    this.note(this.last);
  }

  private async check(page: Page, what: string): Promise<void> {
    await opened(page);
    await taken(page);
    await this.holds(page, what);
  }

  private async holds(page: Page, what: string): Promise<void> {
    const text = await saved(page);
    for (const edit of [this.accepted, this.last]) assert.ok(text.includes(edit), `${what}: ${edit} is lost:\n${text}`);
  }

  private async duplicate(): Promise<Page> {
    const [copy] = await Promise.all([
      this.context.waitForEvent("page"),
      this.page.evaluate(() => void window.open(location.href)),
    ]);
    await opened(copy);
    return copy;
  }

  private readonly failures = {
    reload: async () => {
      await this.half();
      this.on.halt(false);
      await this.page.reload();
      await this.check(this.page, "a reload");
    },

    "a kill of the server": async () => {
      await this.half();
      await this.on.kill();
      await this.on.revive();
      await this.page.reload();
      await this.check(this.page, "a kill of the server");
    },

    "a kill of the server during work": async () => {
      await this.on.kill();
      await this.page.locator(`[data-part="${SECOND}"]`).click();
      const value = this.value(30);
      await type(this.page, `${SECOND}.thickness_nm`, value);
      this.last = this.note(`thickness_nm = ${value}`);
      await this.page.locator(".field .error, .refusal").first().waitFor();
      await this.on.revive();
      // Save repeats the request and waits.
      await this.holds(this.page, "a kill of the server during work");
    },

    "a crash of the tab": async () => {
      const session: CDPSession = await this.context.newCDPSession(this.page);
      await this.half();
      const crashed = new Promise((resolve) => this.page.once("crash", resolve));
      session.send("Page.crash").catch(() => undefined);
      await crashed;
      this.on.halt(false);
      await session.send("Page.reload");
      // The driver cannot use a crashed page again: a duplicate of the tab replaces it.
      const [copy] = await Promise.all([this.context.waitForEvent("page"), this.reopen(session)]);
      session.send("Page.close").catch(() => undefined);
      this.page = copy;
      await this.check(copy, "a crash of the tab");
    },

    "a tab that is closed": async () => {
      await this.half();
      await this.page.close();
      this.on.halt(false);
      this.page = await this.context.newPage();
      await this.page.goto(this.on.url);
      await this.check(this.page, "a tab that is closed");
    },

    "a tab that is duplicated": async () => {
      await this.half();
      const before = [this.accepted, this.last];
      this.on.halt(false);
      const copy = await this.duplicate();
      await this.accept(copy);
      await copy.reload();
      await this.check(copy, "the duplicate");
      await copy.close();
      [this.accepted, this.last] = before as [string, string];
      await this.page.reload();
      await this.check(this.page, "the original");
    },

    "two tabs": async () => {
      const other = await this.context.newPage();
      await other.goto(this.on.url);
      await opened(other);
      await this.half();
      const before = [this.accepted, this.last];
      this.on.halt(false);
      await this.accept(other);
      await this.page.reload();
      this.accepted = before[0]!;
      await this.check(this.page, "the first of two tabs");
      await other.close();
    },

    "a link that is opened": async () => {
      await this.half();
      const value = this.value(60);
      const linked = (await recordOf(this.page)).text.replace(/^/, `# linked ${value}\n`);
      const fragment = `#${await packed(linked)}`;
      this.on.halt(false);
      if (this.random() < 0.5) await this.page.evaluate((hash) => void (location.hash = hash), fragment);
      else {
        await this.page.goto("about:blank");
        await this.page.goto(this.on.url + fragment);
      }
      await opened(this.page);
      await this.page.waitForFunction(
        (mark) => (JSON.parse(sessionStorage.getItem("papilio.tab")!) as Record).text.startsWith(mark),
        `# linked ${value}\n`,
      );
      const before = this.last;
      await this.accept();
      this.last = this.note(`# linked ${value}`);
      await this.page.reload();
      await this.check(this.page, "a change after a link");
      // Undo the change and the link.
      await this.page.getByRole("button", { name: "Undo" }).click();
      await this.page.getByRole("button", { name: "Undo" }).click();
      await taken(this.page);
      const text = await saved(this.page);
      assert.ok(text.includes(before) && !text.includes(this.last), `undo of a link: ${before} is lost:\n${text}`);
      await this.page.getByRole("button", { name: "Redo" }).click();
      await this.page.getByRole("button", { name: "Redo" }).click();
      await this.check(this.page, "redo of a link");
    },
  };

  /** Opens the address of the tab in a new one, from within the page, as soon as it is loaded again. */
  private async reopen(session: CDPSession): Promise<void> {
    for (;;) {
      const { result } = await session.send("Runtime.evaluate", {
        expression:
          "document.querySelector('.bench') && location.href.startsWith('http') && !!window.open(location.href)",
        userGesture: true,
      });
      if (result.value === true) return;
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
  }

  /** Returns a sequence of failures: each kind once in a random order, repeatedly. */
  deck(count: number): (keyof Play["failures"])[] {
    const kinds = Object.keys(this.failures) as (keyof Play["failures"])[];
    const deck: (keyof Play["failures"])[] = [];
    while (deck.length < count) {
      const left = [...kinds];
      while (left.length > 0) deck.push(...left.splice(Math.floor(left.length * this.random()), 1));
    }
    return deck.slice(0, count);
  }

  async run(kind: keyof Play["failures"]): Promise<void> {
    await this.accept();
    await this.failures[kind]();
  }

  /** Checks that everything that was ever typed is in a stored design or in its undo steps. */
  async end(): Promise<void> {
    const kept = await this.page.evaluate(() => Object.entries(localStorage));
    const texts = kept.flatMap(([key, value]) => {
      const record = key.startsWith("papilio.")
        ? (JSON.parse(value) as { text?: string; past?: unknown; future?: unknown })
        : {};
      return key.startsWith("papilio.steps.")
        ? [...unchained(record.past), ...unchained(record.future)]
        : [record.text ?? ""];
    });
    const lost = this.typed.filter((edit) => !texts.some((text) => text.includes(edit)));
    assert.deepEqual(lost, [], "edits that are in no design and in no undo step");
  }
}

/** Simulates `count` failures. */
export async function play(on: Stage, seed: number, count: number): Promise<void> {
  const all = new Play(on, numbers(seed));
  await all.begin();
  for (const [i, kind] of all.deck(count).entries()) {
    try {
      await all.run(kind);
    } catch (why) {
      throw new Error(`seed ${seed}, failure ${i + 1}, ${kind}: ${String(why)}`, { cause: why });
    }
  }
  await all.end();
  const errors = on.complaints.filter((words) => !/Failed to load resource|net::ERR_/.test(words));
  assert.deepEqual(errors, []);
}
