// What the server refused, in its words.

import type { Problem } from "../api/types.ts";

export function Problems({ of }: { of: readonly Problem[] }) {
  return (
    <>
      {of.map(({ message, expected, hint }) => (
        <p class="error" role="alert" key={message}>
          {message}
          {expected && `. Expected ${expected}`}
          {hint && <span class="hint">{hint}</span>}
        </p>
      ))}
    </>
  );
}
