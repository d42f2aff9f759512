// The states of a liquid-crystal cell: each a voltage, a tilt and a twist, or a file; and those of a cholesteric layer.

import { at, join, split, tableAt, textAt, type Json } from "../model/json.ts";
import { stateKind, type StateKind } from "../model/crystal.ts";
import { fields, problemsAt, shownState, showState } from "../state/design.ts";
import { files } from "../state/files.ts";
import { set } from "../state/live.ts";
import { Problems } from "../panels/problems.tsx";
import { Choice } from "./choice.tsx";
import { idOf } from "./id.ts";
import { NumberField } from "./number.tsx";

const KINDS: Readonly<Record<StateKind, string>> = { volts: "voltage", angles: "tilt and twist", file: "file of directors" };

/** The keys of a state with their words, units and ranges. */
const ANGLES = [
  ["tilt_deg", "Tilt", "°", -90, 90],
  ["twist_deg", "Twist", "°", -360, 360],
] as const;

function Value({ path, name, unit, range }: { path: string; name: string; unit: string; range: readonly [number, number] }) {
  const wrong = problemsAt(path);
  const value = at(fields.value, path);
  return (
    <div class={wrong.length > 0 ? "field wrong" : "field"} data-path={path}>
      <label for={idOf(path)}>{name}</label>
      <NumberField
        id={idOf(path)}
        name={name}
        of={split(path)[1]}
        unit={unit}
        value={typeof value === "number" ? value : undefined}
        limits={{ min: range[0], max: range[1] }}
        invalid={wrong.length > 0}
        describedBy=""
        change={(to) => set(path, to)}
      />
      <Problems of={wrong} />
    </div>
  );
}

function CellState({ path, name }: { path: string; name: string }) {
  const value = at(fields.value, path);
  const kind = stateKind(value);
  const directorFiles = files.value.map((file) => file.name).filter((file) => file.endsWith(".csv"));
  const choose = (to: string) => {
    if (to === "file") {
      if (directorFiles[0]) set(path, directorFiles[0]);
    } else set(path, to === "volts" ? { volts: 3 } : { tilt_deg: 2 });
  };
  const kinds = Object.keys(KINDS).filter((one) => one !== "file" || kind === "file" || directorFiles.length > 0);
  const wrong = problemsAt(path);
  return (
    <fieldset class="map" data-path={path}>
      <legend>
        <button type="button" class="key-link" aria-pressed={shownState.value === name} onClick={() => showState(name)} title="Show the directors of this state">
          {name}
        </button>
      </legend>
      <div class="field">
        <label for={`${idOf(path)}-kind`}>Director by</label>
        <Choice id={`${idOf(path)}-kind`} value={kind} options={kinds} change={choose} />
      </div>
      {kind === "volts" && <Value path={join(path, "volts")} name="Voltage" unit="V" range={[0, 20]} />}
      {kind === "angles" &&
        ANGLES.filter(([key]) => key === "tilt_deg" || typeof at(value as Json, key) === "number").map(([key, words, unit, min, max]) => (
          <Value key={key} path={join(path, key)} name={words} unit={unit} range={[min, max]} />
        ))}
      {kind === "file" && (
        <div class="field">
          <label for={`${idOf(path)}-file`}>File</label>
          <Choice id={`${idOf(path)}-file`} value={String(value)} options={[...new Set([String(value), ...directorFiles])]} change={(file) => set(path, file)} />
        </div>
      )}
      <Problems of={wrong} />
    </fieldset>
  );
}

/** The states of the part at a path, if it has any. */
export function CellStates({ path }: { path: string }) {
  const kind = textAt(fields.value, join(path, "kind"));
  const names = Object.keys(tableAt(fields.value, join(path, "states")));
  if (kind === "cell" && names.length > 0)
    return (
      <>
        <h3>States</h3>
        {names.map((name) => (
          <CellState key={name} path={join(join(path, "states"), name)} name={name} />
        ))}
      </>
    );
  if (kind !== "cholesteric" || names.length === 0) return null;
  return (
    <fieldset class="map">
      <legend>States</legend>
      {names.map((name) => {
        const own = join(join(path, "states"), name);
        return (
          <div class="field" key={name} data-path={own}>
            <label for={idOf(own)}>{name}</label>
            <Choice id={idOf(own)} value={String(at(fields.value, own))} options={["planar", "focal-conic"]} change={(to) => set(own, to)} />
            <Problems of={problemsAt(own)} />
          </div>
        );
      })}
    </fieldset>
  );
}
