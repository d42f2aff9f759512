// Requests to the server. An error has the messages of the command line, each with the key that it concerns.

import type { Edit, Live, Named, Problem } from "./types.ts";

const BASE = "api/v1";

/** An error response, or a missing response (status 0). */
export class Refused extends Error {
  constructor(
    readonly status: number,
    readonly problems: readonly Problem[],
  ) {
    super(problems.map((problem) => problem.message).join("; "));
  }
}

let token = "";
/** Sets the token that a server on another machine requires. */
export const useToken = (given: string): void => void (token = given);

const headers = (more: Record<string, string> = {}): Record<string, string> =>
  token ? { ...more, Authorization: `Bearer ${token}` } : more;

async function refusal(response: Response): Promise<Refused> {
  const text = await response.text();
  try {
    const { errors } = JSON.parse(text) as { errors?: Problem[] };
    if (errors?.length) return new Refused(response.status, errors);
  } catch {
    // The response does not come from Papilio, but for example from a proxy.
  }
  return new Refused(response.status, [
    { message: text.trim().slice(0, 400) || `The server responded with status ${response.status}.` },
  ]);
}

async function send(path: string, init: RequestInit): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(`${BASE}/${path}`, init);
  } catch (why) {
    if (init.signal?.aborted) throw why;
    throw new Refused(0, [
      {
        message: "Papilio does not respond.",
        hint: "Check that `papilio serve` is running. Your changes are stored in the browser.",
      },
    ]);
  }
  if (!response.ok) throw await refusal(response);
  return response;
}

export const get = async <T>(path: string): Promise<T> =>
  (await send(path, { headers: headers() })).json() as Promise<T>;

const posting = (body: unknown, signal?: AbortSignal): RequestInit => ({
  method: "POST",
  headers: headers({ "Content-Type": "application/json" }),
  body: JSON.stringify(body),
  ...(signal ? { signal } : {}),
});

export const post = async <T>(path: string, body: unknown, signal?: AbortSignal): Promise<T> =>
  (await send(path, posting(body, signal))).json() as Promise<T>;

export const postForBlob = async (path: string, body: unknown, signal?: AbortSignal): Promise<Blob> =>
  (await send(path, posting(body, signal))).blob();

export const postForBytes = async (path: string, body: unknown, signal?: AbortSignal): Promise<ArrayBuffer> =>
  (await send(path, posting(body, signal))).arrayBuffer();

/** A scenario and its files, as in all requests that compute something. */
export interface Work {
  scenario: string;
  files: Record<string, string>;
}

/** First answers are coarse and fast. */
export type Accuracy = "first" | "exact";

/** Requests a result; of one view alone if `view` is its number. */
export const live = (
  work: Work,
  edits: readonly Edit[],
  accuracy: Accuracy,
  view: number | null,
  signal: AbortSignal,
): Promise<Live> => post("live", { ...work, edits, accuracy, view }, signal);

export const schema = (): Promise<unknown> => get("schema");
export const list = (what: "presets" | "examples" | "displays"): Promise<Named[]> => get(what);
export const named = (what: "presets" | "examples", name: string): Promise<{ scenario: string }> =>
  get(`${what}/${encodeURIComponent(name)}`);

/** Uploads a file and returns its audit. */
export async function upload<T>(name: string, bytes: Blob): Promise<T> {
  const init = { method: "POST", headers: headers({ "Content-Type": "application/octet-stream" }), body: bytes };
  return (await send(`files?name=${encodeURIComponent(name)}`, init)).json() as Promise<T>;
}

/** Yields the events of a long computation. Aborting the signal also stops the computation on the server. */
export async function* events(
  path: string,
  body: unknown,
  signal: AbortSignal,
): AsyncGenerator<{ event: string; data: unknown }> {
  const response = await send(path, posting(body, signal));
  if (!response.body) return;
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let held = "";
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    held += value;
    const parts = held.split("\n\n");
    held = parts.pop() ?? "";
    for (const part of parts) {
      const lines = part.split("\n");
      const of = (key: string) =>
        lines.filter((line) => line.startsWith(key)).map((line) => line.slice(key.length).trim());
      const data = of("data:").join("\n");
      if (data) yield { event: of("event:")[0] ?? "message", data: JSON.parse(data) as unknown };
    }
  }
}
