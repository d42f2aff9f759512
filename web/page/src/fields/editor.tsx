// The control for a value, selected by the name of its type in the schema.

import { isTable, split, type Table } from "../model/json.ts";
import { limits } from "../model/schema.ts";
import { balanced, groupOf } from "../model/shares.ts";
import { fields } from "../state/design.ts";
import { files } from "../state/files.ts";
import { edit, set } from "../state/live.ts";
import { Choice } from "./choice.tsx";
import { NumberField } from "./number.tsx";
import { Angles, Light, Material, Thickness } from "./physical.tsx";
import { List, Text, type Props } from "./text.tsx";

/** Changes a number. If it is one of several fractions with the sum 1, the others change in proportion. */
function change(path: string, value: number): void {
  const group = groupOf(fields.value, path);
  if (group && group.size > 1 && value >= 0 && value <= 1) edit(balanced(group, path, value));
  else set(path, value);
}

export function Editor(props: Props) {
  const { path, found, value } = props;
  const { node, def } = found;
  if (node.enum)
    return (
      <Choice id={props.id} value={String(value)} options={node.enum.map(String)} change={(v) => set(path, v)} />
    );
  if (node.type === "boolean") return <Toggle {...props} />;
  if (def === "MaterialSpec") return <Material {...props} />;
  if (def === "LightSpectrum") return <Light {...props} />;
  if (def === "LayerThickness") return <Thickness {...props} />;
  if (def === "Inclinations" || def === "Azimuths") return <Angles {...props} />;
  if (def === "ShareSpectrum" && spectra().length > 0) return <Share {...props} />;
  if (typeof value === "string") return <Text {...props} />;
  if (node.type === "array") return <List {...props} />;
  if (isTable(value) && node.properties) return <Inner {...props} value={value} />;
  return <Quantity {...props} />;
}

function Quantity({ id, path, found, value, name, unit, invalid }: Props) {
  const first = found.node.anyOf?.find((one) => one.type === "number") ?? found.node;
  return (
    <NumberField
      id={id}
      name={name}
      of={path.includes(".gap_nm.") ? "gap_nm" : split(path)[1]}
      unit={unit || inheritedUnit(path)}
      invalid={invalid}
      describedBy={`${id}-help`}
      value={typeof value === "number" ? value : undefined}
      limits={limits(first)}
      integer={found.node.type === "integer"}
      change={(to) => change(path, to)}
    />
  );
}

/** Names of the uploaded spectra. */
const spectra = (): string[] => files.value.filter(({ audit }) => audit?.kind === "spectrum").map(({ name }) => name);

/** A fraction: the same number at all wavelengths, or an uploaded spectrum. */
function Share(props: Props) {
  const { path, value, name } = props;
  const names = spectra();
  const now = typeof value === "string" ? value : "number";
  const options = ["number", ...names, ...(names.includes(now) || now === "number" ? [] : [now])];
  return (
    <div class="pair">
      <Choice
        label={`${name}: specified as`}
        value={now}
        options={options}
        change={(as) => set(path, as === "number" ? 0.5 : as)}
      />
      {now === "number" && <Quantity {...props} />}
    </div>
  );
}

/** The unit of a key without one: gaps have the names of sub-pixels as keys, and the unit of their table. */
const inheritedUnit = (path: string): string => (path.includes(".gap_nm.") ? "nm" : "");

function Toggle({ id, path, value }: Props) {
  return (
    <label class="toggle">
      <input
        id={id}
        type="checkbox"
        checked={value === true}
        onChange={(event) => set(path, event.currentTarget.checked)}
      />
      <span>{value === true ? "yes" : "no"}</span>
    </label>
  );
}

/** A small table inside a field. */
function Inner({ id, path, value, invalid, found }: Props & { value: Table }) {
  return (
    <div>
      {Object.entries(found.node.properties ?? {})
        .filter(([key]) => typeof value[key] === "number")
        .map(([key, node]) => (
          <NumberField
            key={key}
            id={`${id}-${key}`}
            name={key}
            of={key}
            unit=""
            value={Number(value[key])}
            limits={limits(node)}
            invalid={invalid}
            describedBy={`${id}-help`}
            change={(to) => set(`${path}.${key}`, to)}
          />
        ))}
    </div>
  );
}
