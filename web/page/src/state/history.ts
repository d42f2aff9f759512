// Undo and redo over whole texts. A gesture (one drag, one field being typed in) is one step.

/** Most steps that are kept. */
const LIMIT = 200;
/** Changes of one gesture that follow each other this fast are one step, ms. */
const PAUSE_MS = 1500;

export interface History {
  readonly past: readonly string[];
  readonly present: string;
  readonly future: readonly string[];
  readonly gesture: string;
  readonly at: number;
}

/** One list for all that have nothing to redo: what keeps the steps sees that it is the same. */
const NONE: readonly string[] = [];

export const begin = (present: string): History => ({ past: NONE, present, future: NONE, gesture: "", at: 0 });

/** After a change; `gesture` names what was moved, "" for a change that stands for itself. */
export function record(history: History, text: string, gesture: string, now: number): History {
  if (text === history.present) return history;
  const same = gesture !== "" && gesture === history.gesture && now - history.at < PAUSE_MS && history.past.length > 0;
  const past = same ? history.past : [...history.past, history.present].slice(-LIMIT);
  return { past, present: text, future: NONE, gesture, at: now };
}

export function undo(history: History): History {
  const previous = history.past.at(-1);
  if (previous === undefined) return history;
  const future = [history.present, ...history.future];
  return { past: history.past.slice(0, -1), present: previous, future, gesture: "", at: 0 };
}

export function redo(history: History): History {
  const [next, ...future] = history.future;
  if (next === undefined) return history;
  return { past: [...history.past, history.present], present: next, future, gesture: "", at: 0 };
}
