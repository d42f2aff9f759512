// The control for a value, chosen by the name of its type in the schema.

import { fields } from "../state/design.ts";
import { files } from "../state/files.ts";
import { edit, set } from "../state/live.ts";
import { isTable, listAt, split, type Json, type Table } from "../model/json.ts";
import { limits, type Found } from "../model/schema.ts";
import { balanced, groupOf } from "../model/shares.ts";
import { Choice } from "./choice.tsx";
import { NumberField } from "./number.tsx";

interface Props {
  id: string;
  path: string;
  found: Found;
  value: Json | undefined;
  name: string;
  unit: string;
  invalid: boolean;
}

const MATERIALS = [
  "air", "SiO2", "MgF2", "Al2O3", "AlOx", "Si3N4", "BK7", "ITO", "Al", "Cr", "W", "Ni", "Ti", "Au", "Ag",
  "Al:BB", "Cr:BB", "W:BB", "Cr:Johnson",
];
const LIGHTS = ["D65", "D50", "A", "E", "LED-B1", "LED-B2", "LED-B3", "LED-B4", "LED-B5", "LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"];
const ANY = { min: -Infinity, max: Infinity };

/** A number at a path: a share of several takes the others along. */
function change(path: string, value: number): void {
  const group = groupOf(fields.value, path);
  if (group && group.size > 1 && value >= 0 && value <= 1) edit(balanced(group, path, value), path);
  else set(path, value);
}

export function Editor(props: Props) {
  const { path, found, value } = props;
  const { node, def } = found;
  if (node.enum) return <Choice id={props.id} value={String(value)} options={node.enum.map(String)} change={(v) => set(path, v, "")} />;
  if (node.type === "boolean") return <Toggle {...props} />;
  if (def === "MaterialSpec") return <Material {...props} />;
  if (def === "LightSpectrum") return <Light {...props} />;
  if (def === "LayerThickness") return <Thickness {...props} />;
  if (def === "Inclinations" || def === "Azimuths") return <Angles {...props} />;
  if (typeof value === "string") return <Text {...props} />;
  if (node.type === "array") return <List {...props} />;
  if (isTable(value) && node.properties) return <Inner {...props} value={value} />;
  return <Number_ {...props} />;
}

function Number_({ id, path, found, value, name, unit, invalid }: Props) {
  const first = found.node.anyOf?.map((one) => one).find((one) => one.type === "number") ?? found.node;
  return (
    <NumberField
      id={id} name={name} of={path.includes(".gap_nm.") ? "gap_nm" : split(path)[1]} unit={unit || inheritedUnit(path)} invalid={invalid} describedBy={`${id}-help`}
      value={typeof value === "number" ? value : undefined} limits={limits(first)} integer={found.node.type === "integer"}
      change={(to) => change(path, to)}
    />
  );
}

/** Gaps of sub-pixels stand under names: their unit is that of the table. */
const inheritedUnit = (path: string): string => (path.includes(".gap_nm.") ? "nm" : "");

function Toggle({ id, path, value }: Props) {
  return (
    <label class="toggle">
      <input id={id} type="checkbox" checked={value === true} onChange={(event) => set(path, event.currentTarget.checked, "")} />
      <span>{value === true ? "yes" : "no"}</span>
    </label>
  );
}

/** Free text with suggestions: names that are known, files that were dropped. */
function Text({ id, path, value, invalid, found, options = [] }: Props & { options?: string[] }) {
  const names = [...options, ...files.value.filter((file) => file.audit).map((file) => file.name)];
  const list = `${id}-list`;
  const take = (text: string) => {
    const number = Number(text);
    const wantsNumber = found.def !== "" && text.trim() !== "" && Number.isFinite(number);
    if (text !== "") set(path, wantsNumber ? number : text);
  };
  return (
    <span class="box wide">
      <input
        id={id} value={String(value ?? "")} list={list} aria-invalid={invalid} aria-describedby={`${id}-help`}
        autocomplete="off" spellcheck={false} onChange={(event) => take(event.currentTarget.value)}
      />
      <datalist id={list}>{names.map((name) => <option key={name} value={name} />)}</datalist>
    </span>
  );
}

/** A refractive index: a name or a file, or a number, or n and k. */
function Material(props: Props) {
  const { path, value, id, invalid } = props;
  const form = typeof value === "number" ? "number" : isTable(value) ? "n, k" : "name or file";
  const starts: Record<string, Json> = { "number": 1.5, "n, k": { n: 1.5, k: 0.01 }, "name or file": "SiO2" };
  const number = (key: string, of: number | undefined) => (
    <NumberField
      id={key ? `${id}-${key}` : id} name={key || props.name} of={key || "index"} unit={key} value={of} limits={key === "k" ? { min: 0, max: 1000 } : { min: 0.001, max: 1000 }}
      invalid={invalid} describedBy={`${id}-help`} change={(to) => set(key ? `${path}.${key}` : path, to)}
    />
  );
  return (
    <div class="pair">
      <Choice label={`${props.name}: given as`} value={form} options={Object.keys(starts)} change={(as) => set(path, starts[as], "")} />
      {form === "number" && number("", value as number)}
      {form === "n, k" && <div>{number("n", Number((value as Table)["n"]))}{number("k", Number((value as Table)["k"] ?? 0))}</div>}
      {form === "name or file" && <Text {...props} options={MATERIALS} />}
    </div>
  );
}

/** A light's spectrum: a name or a file, or a model. */
function Light(props: Props) {
  const { path, value, id, invalid } = props;
  const model = isTable(value) ? Object.keys(value).find((key) => ["led_nm", "planck_K", "daylight_K"].includes(key)) : undefined;
  if (Array.isArray(value)) return <p class="value">{value.length} models, weighted</p>;
  const starts: Record<string, Json> = {
    "name or file": "D65", "daylight": { daylight_K: 5500 }, "black body": { planck_K: 2856 }, "LED": { led_nm: 525, width_nm: 35 },
  };
  const form = model === "led_nm" ? "LED" : model === "planck_K" ? "black body" : model ? "daylight" : "name or file";
  return (
    <div class="pair">
      <Choice label={`${props.name}: given as`} value={form} options={Object.keys(starts)} change={(as) => set(path, starts[as], "")} />
      {!model && <Text {...props} options={LIGHTS} />}
      {isTable(value) && (
        <div>
          {Object.entries(value).map(([key, of]) => (
            <NumberField
              key={key} id={`${id}-${key}`} name={key} of={key} unit={key.endsWith("_K") ? "K" : key.endsWith("_nm") ? "nm" : ""} value={Number(of)}
              limits={key === "daylight_K" ? { min: 4000, max: 25000 } : key === "planck_K" ? { min: 500, max: 1e5 } : { min: 0.001, max: 1e6 }}
              invalid={invalid} describedBy={`${id}-help`} change={(to) => set(`${path}.${key}`, to)}
            />
          ))}
        </div>
      )}
    </div>
  );
}

function Thickness(props: Props) {
  if (props.value === "gap") return <p class="value">the gap: each sub-pixel has its own, below</p>;
  const { id, path, name, value, invalid } = props;
  return (
    <NumberField
      id={id} name={name} of="thickness_nm" unit="nm" value={Number(value)} limits={{ min: 0, max: 1e6 }} invalid={invalid}
      describedBy={`${id}-help`} change={(to) => set(path, to)}
    />
  );
}

/** One angle, a list of them, or a range. */
function Angles(props: Props) {
  const { path, value, id, invalid, name } = props;
  const bounds = props.found.def === "Azimuths" ? { min: -360, max: 360 } : { min: -89.9, max: 89.9 };
  const form = typeof value === "number" ? "one" : Array.isArray(value) ? "list" : "range";
  const first = typeof value === "number" ? value : Array.isArray(value) ? Number(value[0] ?? 0) : isTable(value) ? Number(value["from"]) : 0;
  const starts: Record<string, Json> = { one: first, list: [first, first + 30], range: { from: 0, to: 60, step: 10 } };
  return (
    <div class="pair">
      <Choice label={`${name}: given as`} value={form} options={Object.keys(starts)} change={(as) => set(path, starts[as], "")} />
      {form === "one" && (
        <NumberField id={id} name={name} of="" unit="°" value={first} limits={bounds} invalid={invalid} describedBy={`${id}-help`} change={(to) => set(path, to)} />
      )}
      {form === "list" && <List {...props} />}
      {isTable(value) && (
        <div>
          {["from", "to", "step"].map((key) => (
            <NumberField
              key={key} id={`${id}-${key}`} name={`${name}, ${key}`} of="" unit={key} value={Number(value[key])} invalid={invalid} describedBy={`${id}-help`}
              limits={key === "step" ? { min: 0.1, max: 90 } : bounds} change={(to) => set(`${path}.${key}`, to)}
            />
          ))}
        </div>
      )}
    </div>
  );
}

/** Numbers, parted by commas. */
function List({ id, path, value, invalid }: Props) {
  const take = (text: string) => {
    const numbers = text.split(/[,;\s]+/).filter(Boolean).map(Number);
    if (numbers.length > 0 && numbers.every(Number.isFinite)) set(path, numbers);
  };
  const numbers = Array.isArray(value) ? value : listAt(value ?? null, "");
  return (
    <span class="box wide">
      <input
        id={id} value={numbers.join(", ")} aria-invalid={invalid} aria-describedby={`${id}-help`} autocomplete="off"
        onChange={(event) => take(event.currentTarget.value)}
      />
    </span>
  );
}

/** A small table inside a field. */
function Inner({ id, path, value, invalid, found }: Props & { value: Table }) {
  return (
    <div>
      {Object.entries(found.node.properties ?? {}).filter(([key]) => typeof value[key] === "number").map(([key, node]) => (
        <NumberField
          key={key} id={`${id}-${key}`} name={key} of={key} unit="" value={Number(value[key])} limits={node ? limits(node) : ANY}
          invalid={invalid} describedBy={`${id}-help`} change={(to) => set(`${path}.${key}`, to)}
        />
      ))}
    </div>
  );
}
