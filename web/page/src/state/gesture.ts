// The gesture of the user to which a change belongs: one undo step. A drag is one gesture from the pointer down to up, however slow it is;
// each press of a key is one, with its repetitions until it is up; so is each value that is typed. Time does not matter.

/** A name that no other gesture has, also not one of an earlier visit. */
let count = 0;
const visit = Date.now().toString(36);
let now = `${visit}-0`;

const next = (): void => void (now = `${visit}-${++count}`);

/** Returns the gesture of this moment. */
export const gesture = (): string => now;

/** Keys that are part of typing in a box. All others change a value, or leave the box. */
const isTyping = (key: string): boolean => key.length === 1 || key === "Backspace" || key === "Delete" || key === "Dead";
const MODIFIERS = ["Shift", "Control", "Alt", "Meta", "CapsLock"];

/** What is needed of a text box. */
interface Box {
  readonly value: string;
  readonly selectionStart: number | null;
  readonly selectionEnd: number | null;
}

/** The beginning of gestures, from the events of the page. */
export class Beginnings {
  private isDown = false;
  private box: Box | null = null;
  private line = -1;

  constructor(private readonly begin: () => void) {}

  pointerDown(): void {
    this.isDown = true;
    this.begin();
  }

  pointerUp(): void {
    this.isDown = false;
  }

  /** A key is pressed; `kind` is the box in which it is, or "" outside of boxes. */
  keyDown(key: string, isRepeated: boolean, kind: "box" | "text" | ""): void {
    // During a drag, a key only changes what it does.
    if (isRepeated || this.isDown || MODIFIERS.includes(key)) return;
    if (kind === "text" || (kind === "box" && isTyping(key))) return;
    this.begin();
  }

  /** Text of a box is about to change: a new value begins in another box, if all of it is replaced, and in another line. */
  beforeInput(box: Box, isText: boolean): void {
    const [from, to] = [box.selectionStart ?? 0, box.selectionEnd ?? 0];
    const isAll = from === 0 && to === box.value.length && to > 0;
    const line = isText ? box.value.slice(0, from).split("\n").length : -1;
    if (box !== this.box || isAll || line !== this.line) this.begin();
    [this.box, this.line] = [box, line];
  }

  /** A control has its new value. */
  changed(): void {
    this.box = null;
    if (!this.isDown) this.begin();
  }
}

/** The kind of box of an element; "" for other controls, sliders among them. */
function kindOf(target: EventTarget | null): "box" | "text" | "" {
  if (target instanceof HTMLTextAreaElement) return "text";
  return target instanceof HTMLInputElement && target.selectionStart !== null ? "box" : "";
}

/** Follows the gestures of the page. */
export function followGestures(): void {
  const all = new Beginnings(next);
  const early = { capture: true } as const;
  addEventListener("pointerdown", () => all.pointerDown(), early);
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => all.pointerUp(), early);
  addEventListener("keydown", (event) => all.keyDown(event.key, event.repeat, kindOf(event.target)), early);
  addEventListener(
    "beforeinput",
    ({ target }) => kindOf(target) && all.beforeInput(target as HTMLInputElement, target instanceof HTMLTextAreaElement),
    early,
  );
  // A click without pointer: by a key, or by a program.
  addEventListener("click", ({ detail }) => detail === 0 && all.changed(), early);
  // After the control has applied its value.
  addEventListener("change", () => all.changed());
}
