// Whether the server responds. While it does not, it is asked every two seconds, and the last request is repeated as soon
// as it is back.

import { effect, signal } from "@preact/signals";

import { get } from "../api/client.ts";

/** The status of a server whose places are all in use. */
export const BUSY = 503;

/** Time between two questions, ms. */
const EVERY_MS = 2000;

/** Whether there was no response to the last request. */
export const gone = signal(false);

/** Calls `back` when the server responds again. */
export function awaitServer(back: () => void): void {
  effect(() => {
    if (!gone.value) return undefined;
    const timer = setInterval(() => {
      get("health").then(
        () => {
          if (gone.peek()) back();
        },
        () => {},
      );
    }, EVERY_MS);
    return () => clearInterval(timer);
  });
}
