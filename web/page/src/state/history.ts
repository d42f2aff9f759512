// Undo and redo of whole texts. A gesture (gesture.ts) is one step.

/** Maximum number of steps. */
const LIMIT = 200;

export interface History {
  readonly past: readonly string[];
  readonly present: string;
  readonly future: readonly string[];
  readonly gesture: string;
}

/** The empty list of steps; it is shared, so that an unchanged list is recognised by identity. */
const NONE: readonly string[] = [];

export const begin = (present: string): History => ({ past: NONE, present, future: NONE, gesture: "" });

/** Records a change; `gesture` is the name of the gesture, "" for a change that is always a separate step. */
export function record(history: History, text: string, gesture: string): History {
  if (text === history.present) return history;
  const same = gesture !== "" && gesture === history.gesture && history.past.length > 0;
  const past = same ? history.past : [...history.past, history.present].slice(-LIMIT);
  return { past, present: text, future: NONE, gesture };
}

export function undo(history: History): History {
  const previous = history.past.at(-1);
  if (previous === undefined) return history;
  const future = [history.present, ...history.future];
  return { past: history.past.slice(0, -1), present: previous, future, gesture: "" };
}

export function redo(history: History): History {
  const [next, ...future] = history.future;
  if (next === undefined) return history;
  return { past: [...history.past, history.present], present: next, future, gesture: "" };
}
