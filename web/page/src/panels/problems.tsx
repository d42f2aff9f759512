// The error messages of the server.

import { words } from "../model/words.ts";
import type { Problem } from "../api/types.ts";

export function Problems({ of, withPlace = false }: { of: readonly Problem[]; withPlace?: boolean }) {
  return (
    <>
      {of.map((problem) => (
        <p class="error" role="alert" key={problem.message}>
          {words(problem, withPlace)}
          {problem.hint && <span class="hint">{problem.hint}</span>}
        </p>
      ))}
    </>
  );
}
