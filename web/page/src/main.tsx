// Starts the page with the design of the last visit, the scenario of a link, or an example.

import { render } from "preact";

import * as api from "./api/client.ts";
import { App } from "./app.tsx";
import { Schema, type Node } from "./model/schema.ts";
import { acceptDrops } from "./panels/drop.tsx";
import { schema, startProblems } from "./state/design.ts";
import { beginJobs } from "./state/jobs.ts";
import { redo, undo } from "./state/open.ts";
import { followGestures } from "./state/gesture.ts";
import { fillShelf } from "./state/shelf.ts";
import { begin } from "./state/start.ts";
import { followTheme } from "./state/theme.ts";
import "./style/page.css";

/** Reads the token of a server on another machine from the fragment, and removes it from the address. */
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

function keys(event: KeyboardEvent): void {
  const typing =
    event.target instanceof HTMLTextAreaElement ||
    // In the box of a number, undo is that of the design, too: every number that is typed is applied at once.
    (event.target instanceof HTMLInputElement && event.target.type === "text" && event.target.inputMode !== "decimal");
  if (!(event.ctrlKey || event.metaKey) || event.altKey || typing) return;
  const key = event.key.toLowerCase();
  if (key === "z" && !event.shiftKey) void undo();
  else if (key === "y" || (key === "z" && event.shiftKey)) redo();
  else return;
  event.preventDefault();
}

async function start(): Promise<void> {
  followTheme();
  takeToken();
  acceptDrops();
  followGestures();
  addEventListener("keydown", keys);
  render(<App />, document.getElementById("page")!);
  const [grammar] = await Promise.all([api.schema(), fillShelf()]);
  schema.value = new Schema(grammar as Node);
  await begin();
  beginJobs();
}

start().catch((why: unknown) => {
  startProblems.value = why instanceof api.Refused ? why.problems : [{ message: String(why) }];
});
