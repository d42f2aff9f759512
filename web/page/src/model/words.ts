// The text of an error of the server.

import type { Problem } from "../api/types.ts";

/** Returns the location in the text, the message and the expected value; the hint is shown separately. */
export function words({ message, expected, line, column }: Problem, withPlace = false): string {
  const place = withPlace && line ? `Line ${line}, column ${column ?? 1}: ` : "";
  const wanted = expected ? `. Expected ${expected.replace(/^expected /, "")}` : "";
  return place + message + wanted;
}
