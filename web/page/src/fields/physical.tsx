// Controls for physical quantities that can be specified in several ways: a material, the spectrum of a source, a
// thickness or the gap, one angle or several.

import { isTable, type Json, type Table } from "../model/json.ts";
import { set } from "../state/live.ts";
import { Browser, names, type Kind } from "./browser.tsx";
import { Choice } from "./choice.tsx";
import { NumberField } from "./number.tsx";
import { List, Text, type Props } from "./text.tsx";

/** A name or a file, with a browser of the named ones. */
function NameOrFile({ kind, ...props }: Props & { kind: Kind }) {
  return (
    <>
      <Text {...props} options={names(kind)} />
      <Browser kind={kind} value={String(props.value ?? "")} choose={(name) => set(props.path, name)} />
    </>
  );
}

/** A refractive index: a name or a file, or a number, or n and k. */
export function Material(props: Props) {
  const { path, value, id, invalid } = props;
  const form = typeof value === "number" ? "number" : isTable(value) ? "n, k" : "name or file";
  const starts: Record<string, Json> = { number: 1.5, "n, k": { n: 1.5, k: 0.01 }, "name or file": "SiO2" };
  const number = (key: string, of: number | undefined) => (
    <NumberField
      id={key ? `${id}-${key}` : id}
      name={key || props.name}
      of={key || "index"}
      unit={key}
      value={of}
      limits={key === "k" ? { min: 0, max: 1000 } : { min: 0.001, max: 1000 }}
      invalid={invalid}
      describedBy={`${id}-help`}
      change={(to) => set(key ? `${path}.${key}` : path, to)}
    />
  );
  return (
    <div class="pair">
      <Choice
        label={`${props.name}: specified as`}
        value={form}
        options={Object.keys(starts)}
        change={(as) => set(path, starts[as])}
      />
      {form === "number" && number("", value as number)}
      {form === "n, k" && (
        <div>
          {number("n", Number((value as Table)["n"]))}
          {number("k", Number((value as Table)["k"] ?? 0))}
        </div>
      )}
      {form === "name or file" && <NameOrFile {...props} kind="materials" />}
    </div>
  );
}

/** The spectrum of a source: a name or a file, or a model. */
export function Light(props: Props) {
  const { path, value, id, invalid } = props;
  const model = isTable(value)
    ? Object.keys(value).find((key) => ["led_nm", "planck_K", "daylight_K"].includes(key))
    : undefined;
  if (Array.isArray(value)) return <p class="value">weighted sum of {value.length} models</p>;
  const starts: Record<string, Json> = {
    "name or file": "D65",
    daylight: { daylight_K: 5500 },
    "black body": { planck_K: 2856 },
    LED: { led_nm: 525, width_nm: 35 },
  };
  const form = model === "led_nm" ? "LED" : model === "planck_K" ? "black body" : model ? "daylight" : "name or file";
  return (
    <div class="pair">
      <Choice
        label={`${props.name}: specified as`}
        value={form}
        options={Object.keys(starts)}
        change={(as) => set(path, starts[as])}
      />
      {!model && <NameOrFile {...props} kind="illuminants" />}
      {isTable(value) && (
        <div>
          {Object.entries(value).map(([key, of]) => (
            <NumberField
              key={key}
              id={`${id}-${key}`}
              name={key}
              of={key}
              unit={key.endsWith("_K") ? "K" : key.endsWith("_nm") ? "nm" : ""}
              value={Number(of)}
              limits={
                key === "daylight_K"
                  ? { min: 4000, max: 25000 }
                  : key === "planck_K"
                    ? { min: 500, max: 1e5 }
                    : { min: 0.001, max: 1e6 }
              }
              invalid={invalid}
              describedBy={`${id}-help`}
              change={(to) => set(`${path}.${key}`, to)}
            />
          ))}
        </div>
      )}
    </div>
  );
}

export function Thickness(props: Props) {
  if (props.value === "gap") return <p class="value">the gap; its values for the sub-pixels are below</p>;
  const { id, path, name, value, invalid } = props;
  return (
    <NumberField
      id={id}
      name={name}
      of="thickness_nm"
      unit="nm"
      value={Number(value)}
      limits={{ min: 0, max: 1e6 }}
      invalid={invalid}
      describedBy={`${id}-help`}
      change={(to) => set(path, to)}
    />
  );
}

/** One angle, a list of them, or a range. */
export function Angles(props: Props) {
  const { path, value, id, invalid, name } = props;
  const bounds = props.found.def === "Azimuths" ? { min: -360, max: 360 } : { min: -89.9, max: 89.9 };
  const form = typeof value === "number" ? "one" : Array.isArray(value) ? "list" : "range";
  const first =
    typeof value === "number"
      ? value
      : Array.isArray(value)
        ? Number(value[0] ?? 0)
        : isTable(value)
          ? Number(value["from"])
          : 0;
  const starts: Record<string, Json> = { one: first, list: [first, first + 30], range: { from: 0, to: 60, step: 10 } };
  return (
    <div class="pair">
      <Choice
        label={`${name}: specified as`}
        value={form}
        options={Object.keys(starts)}
        change={(as) => set(path, starts[as])}
      />
      {form === "one" && (
        <NumberField
          id={id}
          name={name}
          of=""
          unit="°"
          value={first}
          limits={bounds}
          invalid={invalid}
          describedBy={`${id}-help`}
          change={(to) => set(path, to)}
        />
      )}
      {form === "list" && <List {...props} unit="°" />}
      {isTable(value) && (
        <div>
          {["from", "to", "step"].map((key) => (
            <div class="of-range" key={key}>
              <label for={`${id}-${key}`}>{key}</label>
              <NumberField
                id={`${id}-${key}`}
                name={`${name}, ${key}`}
                of=""
                unit="°"
                value={Number(value[key])}
                invalid={invalid}
                describedBy={`${id}-help`}
                limits={key === "step" ? { min: 0.1, max: 90 } : bounds}
                change={(to) => set(`${path}.${key}`, to)}
              />
            </div>
          ))}
        </div>
      )}
    </div>
  );
}
