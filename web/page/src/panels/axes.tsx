// The fields of a sweep's axes: one or more keys that change together, each with a range or a list of values.

import { useSignal } from "@preact/signals";

import { lengthOf, listFrom, shown, spaced, spacingOf, type Axis, type Line, type Spacing } from "../model/axes.ts";
import { plain } from "../model/format.ts";
import { axes, keys, lineFor, nearKey, own } from "../state/sweep.ts";
import { KeySelect } from "./key-select.tsx";

/** Maximum number of values of an axis on the page; `papilio sweep` allows more. */
const MOST = 401;
const MOST_AXES = 4;
const FINE = 21;
const COARSE = 11;

const SPACINGS: Record<Spacing, string> = { range: "range", log: "logarithmic range", list: "list" };

const change = (index: number, axis: Axis | null): void => {
  const all = axes.value.map((one, i) => (i === index ? axis : one));
  own.value = all.filter((one): one is Axis => one !== null && one.length > 0);
};

const numbersOf = (line: Line): number[] => line.values.filter((value) => typeof value === "number");

function LineFields({ axis, index, at }: { axis: Axis; index: number; at: number }) {
  const wrong = useSignal("");
  const line = axis[at]!;
  const name = axis.length > 1 ? `axis ${index + 1}, key ${at + 1}` : `axis ${index + 1}`;
  const put = (to: Line) =>
    change(
      index,
      axis.map((one, i) => (i === at ? to : one)),
    );
  const ends = numbersOf(line);
  const [from, to, count] = [ends[0] ?? 0, ends.at(-1) ?? 1, line.values.length];
  const take = (key: "from" | "to" | "count", typed: string) => {
    const value = Number(typed.replace(",", "."));
    const isCount = key === "count";
    const right =
      typed.trim() !== "" &&
      Number.isFinite(value) &&
      (!isCount || (Number.isInteger(value) && value >= 2 && value <= MOST));
    const isLog = line.spacing === "log";
    if (!right || (isLog && !isCount && value <= 0)) {
      const wanted = isCount ? `an integer from 2 to ${MOST}` : isLog ? "a number above 0" : "a number";
      wrong.value = `“${typed}”: ${key} must be ${wanted}`;
      return;
    }
    wrong.value = "";
    const now = { from, to, count, [key]: value };
    // Keys of one axis have the same number of values.
    if (isCount)
      change(
        index,
        axis.map((one) => {
          const own = numbersOf(one);
          if (one !== line && one.spacing === "list") return one;
          return { ...one, values: spaced(own[0] ?? 0, own.at(-1) ?? 1, value, one.spacing === "log") };
        }),
      );
    else put({ ...line, values: spaced(now.from, now.to, now.count, isLog) });
  };
  const number = (key: "from" | "to" | "count", value: number) => (
    <label>
      {key}{" "}
      <input inputMode="decimal" value={plain(value, 8)} onChange={(event) => take(key, event.currentTarget.value)} />
    </label>
  );
  const respace = (spacing: Spacing) => {
    const isNumeric = ends.length > 0 && ends.length === line.values.length;
    if (spacing === "list" || !isNumeric || (spacing === "log" && (from <= 0 || to <= 0)))
      put({ ...line, spacing: "list" });
    else put({ ...line, spacing, values: spaced(from, to, Math.max(2, count), spacing === "log") });
  };
  const list = (typed: string) => {
    const values = listFrom(typed);
    wrong.value = values === null ? "a list needs at least one value, such as 0.5, 0.7" : "";
    if (values !== null) put({ path: line.path, spacing: "list", values });
  };
  return (
    <div class="controls axis">
      <KeySelect
        label={`Key of ${name}`}
        value={line.path}
        keys={keys.value}
        change={(to) => {
          const fresh = lineFor(to, count);
          put(
            axis.length > 1 || fresh.spacing === "list" || fresh.values.length >= 2
              ? fresh
              : lineFor(fresh.path, COARSE),
          );
        }}
      />
      <select
        aria-label={`Values of ${name}`}
        value={line.spacing}
        onChange={(event) => respace(event.currentTarget.value as Spacing)}
      >
        {Object.entries(SPACINGS).map(([key, words]) => (
          <option key={key} value={key}>
            {words}
          </option>
        ))}
      </select>
      {line.spacing === "list" ? (
        <label class="wide">
          values{" "}
          <input value={line.values.map(shown).join(", ")} onChange={(event) => list(event.currentTarget.value)} />
        </label>
      ) : (
        <>
          {number("from", from)}
          {number("to", to)}
          {number("count", count)}
        </>
      )}
      <button
        type="button"
        onClick={() => change(index, axis.length > 1 ? axis.filter((_, i) => i !== at) : null)}
        aria-label={`Remove ${name}`}
      >
        Remove
      </button>
      {wrong.value && (
        <p class="error" role="alert">
          {wrong.value}
        </p>
      )}
    </div>
  );
}

/** Adds an axis with a key of the part that is selected in the drawing, if it has one. */
export function addAxis(): void {
  const near = nearKey();
  if (!near) return;
  const count = axes.value.length === 0 ? FINE : COARSE;
  const coarser = (line: Line): Line => {
    const ends = numbersOf(line);
    const isFine = line.spacing !== "list" && line.values.length > COARSE && spacingOf(line.values) === line.spacing;
    return isFine ? { ...line, values: spaced(ends[0]!, ends.at(-1)!, COARSE, line.spacing === "log") } : line;
  };
  own.value = [...axes.value.map((axis) => axis.map(coarser)), [lineFor(near, count)]];
}

function addKey(index: number): void {
  const near = nearKey();
  const axis = axes.value[index];
  if (near && axis) change(index, [...axis, lineFor(near, lengthOf(axis))]);
}

export function AxesFields() {
  return (
    <div class="axes">
      {axes.value.map((axis, i) => (
        <fieldset key={i}>
          <legend>
            Axis {i + 1}
            <small>
              {" "}
              {lengthOf(axis)} values{axis.length > 1 ? "; its keys change together" : ""}
            </small>
          </legend>
          {axis.map((line, at) => (
            <LineFields key={`${at} ${line.path}`} axis={axis} index={i} at={at} />
          ))}
          <button type="button" class="quiet" onClick={() => addKey(i)}>
            Add a key that changes together with it
          </button>
        </fieldset>
      ))}
      {axes.value.length < MOST_AXES && (
        <button type="button" onClick={addAxis}>
          {axes.value.length === 0 ? "Add an axis" : `Add axis ${axes.value.length + 1}`}
        </button>
      )}
    </div>
  );
}
