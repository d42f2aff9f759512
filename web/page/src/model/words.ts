// The server's words on a problem, as sentences.

import type { Problem } from "../api/types.ts";

/** Where in the text, what is wrong, and what was expected; the hint stands apart. */
export function words({ message, expected, line, column }: Problem, withPlace = false): string {
  const place = withPlace && line ? `Line ${line}, column ${column ?? 1}: ` : "";
  const wanted = expected ? `. Expected ${expected.replace(/^expected /, "")}` : "";
  return place + message + wanted;
}
