// Starts the page: what was on screen at the last visit, or what a link holds, or a working example.

import { effect } from "@preact/signals";
import { render } from "preact";

import * as api from "./api/client.ts";
import type { Start } from "./api/types.ts";
import { App } from "./app.tsx";
import { Schema, type Node } from "./model/schema.ts";
import { acceptDrops } from "./panels/drop.tsx";
import { redo, undo } from "./panels/header.tsx";
import { schema, startProblems, text } from "./state/design.ts";
import { adopt, recallFiles } from "./state/files.ts";
import { recall, recallDesign, remember, rememberDesign } from "./state/keep.ts";
import { unpacked } from "./state/link.ts";
import { replace } from "./state/live.ts";
import { pinned, repin } from "./state/pin.ts";
import { said } from "./state/said.ts";
import { fillShelf } from "./state/shelf.ts";
import { followTheme } from "./state/theme.ts";
import { history as steps } from "./state/undo.ts";
import "./style/page.css";

/** The token of a server beyond loopback comes in the fragment, and does not stay in the address. */
function takeToken(): void {
  const given = /(?:^#|&)token=([^&]+)/.exec(location.hash)?.[1];
  if (given) {
    sessionStorage.setItem("papilio.token", decodeURIComponent(given));
    history.replaceState(
      null,
      "",
      location.hash.replace(/&?token=[^&]+/, "").replace(/^#&?$/, "") || location.pathname,
    );
  }
  api.useToken(sessionStorage.getItem("papilio.token") ?? "");
}

/** The name of the scenario that `papilio serve FILE` was last started with. */
const STARTED = "papilio.started";

/** What is said of a link that holds no scenario any more. */
function damaged(): null {
  said.value = "This link is damaged: it holds no whole scenario. What was open before is shown instead.";
  return null;
}

/** A link's scenario; or that of the command line, where it is a new one; or that of the last visit. */
async function firstText(): Promise<string> {
  const linked = await unpacked(location.hash).catch(damaged);
  if (linked !== null) return linked;
  const kept = recallDesign()?.text;
  const started = await api.get<Start>("start");
  if (kept && recall<string>(STARTED) === started.name) return kept;
  remember(STARTED, started.name);
  adopt(started.files);
  return started.scenario;
}

function keys(event: KeyboardEvent): void {
  const typing =
    event.target instanceof HTMLTextAreaElement ||
    (event.target instanceof HTMLInputElement && event.target.type === "text");
  if (!(event.ctrlKey || event.metaKey) || event.altKey || typing) return;
  const key = event.key.toLowerCase();
  if (key === "z" && !event.shiftKey) undo();
  else if (key === "y" || (key === "z" && event.shiftKey)) redo();
  else return;
  event.preventDefault();
}

async function start(): Promise<void> {
  followTheme();
  takeToken();
  acceptDrops();
  addEventListener("keydown", keys);
  render(<App />, document.getElementById("page")!);
  const [grammar, first] = await Promise.all([api.schema(), firstText(), fillShelf()]);
  schema.value = new Schema(grammar as Node);
  await recallFiles();
  const past = recallDesign()?.past ?? [];
  if (past.length > 0) steps.value = { ...steps.value, past };
  replace(first);
  const before = recallDesign()?.pinned;
  if (before) void repin(before);
  addEventListener(
    "hashchange",
    () =>
      void unpacked(location.hash)
        .catch(damaged)
        .then((linked) => linked !== null && replace(linked)),
  );
  effect(() => {
    if (text.value)
      rememberDesign({ text: text.value, past: steps.value.past.slice(-20), pinned: pinned.value?.text ?? null });
  });
}

start().catch((why: unknown) => {
  startProblems.value = why instanceof api.Refused ? why.problems : [{ message: String(why) }];
});
