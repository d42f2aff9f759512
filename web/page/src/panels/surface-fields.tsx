// The fields of a surface: its kind, its keys with labels, units and help from the schema, and its text.

import { useSignal } from "@preact/signals";

import { Choice } from "../fields/choice.tsx";
import { NumberField } from "../fields/number.tsx";
import { isTable, split, type Json, type Table } from "../model/json.ts";
import { help, label, limits, unitOf, type Found, type Node } from "../model/schema.ts";
import { ofKind, ordered, SURFACES } from "../model/surface.ts";
import { files } from "../state/files.ts";
import { edit, own, problems, schema, set, text, fields as values, open, name as nameOf } from "../state/surface.ts";
import { FileButton } from "./choose.tsx";
import { Problems } from "./problems.tsx";

const ROOT = "microgeometry";

/** Keys that say how the surface is measured, and not what it is. */
const MEASURING = ["road", "wavelength_nm", "incidence_deg", "rays", "seed"];

/** The range of lengths, which excludes none that occurs. */
const ANY_LENGTH = / A number above 0, at most 1e6\./;

const at = (key: string): string => `${ROOT}.${key}`;
const idOf = (key: string): string => `surface-${key}`;

/** Names of the uploaded files of a kind; those that could also be heights follow. */
function filesOf(kind: "heights" | "mesh"): string[] {
  const named = (kinds: string[]) => files.value.filter(({ audit }) => audit && kinds.includes(audit.kind));
  const others = kind === "heights" ? named(["picture", "map"]) : [];
  return [...named([kind]), ...others].map(({ name }) => name);
}

/** Whether a key differs from its default, so that another kind takes it over. */
function isWritten(key: string): boolean {
  const node = schema.value?.find(at(key), values.value)?.node;
  return node !== undefined && JSON.stringify(node.default ?? null) !== JSON.stringify(own.value[key] ?? null);
}

/** The kind of the surface. Files of heights and triangles are chosen before their kind. */
export function KindField() {
  const wanted = useSignal("");
  const now = String(own.value["surface"] ?? "");
  const missing = SURFACES[wanted.value];
  const choose = (kind: string) => {
    const { file } = SURFACES[kind] ?? {};
    const [first] = file ? filesOf(file) : [];
    wanted.value = file && first === undefined ? kind : "";
    if (wanted.value === "") edit([{ op: "set", path: ROOT, value: ofKind(kind, own.value, isWritten, first) }]);
  };
  return (
    <>
      <div class="field">
        <label for="surface-kind">Surface</label>
        <select id="surface-kind" value={wanted.value || now} onChange={(event) => choose(event.currentTarget.value)}>
          {Object.entries(SURFACES).map(([kind, { name }]) => (
            <option key={kind} value={kind}>
              {name}
            </option>
          ))}
        </select>
      </div>
      {missing?.file && (
        <p class="remark" role="status">
          {missing.file === "heights"
            ? "Choose the heights of a profilometer: .npy, CSV, SDF, X3P, TIFF, a grey PNG of 16 bits or OpenEXR. "
            : "Choose a mesh that is one closed face between the media: Wavefront OBJ or STL. "}
          <FileButton label="Choose a file" stays />{" "}
          {filesOf(missing.file).length > 0 && (
            <button type="button" class="run" onClick={() => choose(wanted.value)}>
              Use {filesOf(missing.file)[0]}
            </button>
          )}
        </p>
      )}
    </>
  );
}

/** One key of the surface. */
function Key({ name }: { name: string }) {
  const found = schema.value?.find(at(name), values.value);
  if (!found) return null;
  const wrong = problems.value.filter(({ path }) => path === at(name));
  return (
    <div class={wrong.length > 0 ? "field wrong" : "field"} data-path={at(name)}>
      <label for={idOf(name)}>{found.node.title ?? label(name)}</label>
      <Control name={name} found={found} invalid={wrong.length > 0} />
      <p class="help" id={`${idOf(name)}-help`}>
        {help(found.node).replace(ANY_LENGTH, "")}
      </p>
      <Problems of={wrong} />
    </div>
  );
}

interface ControlProps {
  name: string;
  found: Found;
  invalid: boolean;
}

function Control({ name, found: { node }, invalid }: ControlProps) {
  const value = own.value[name];
  if (name === "file") return <FileField value={String(value ?? "")} />;
  if (node.enum)
    return (
      <Choice
        id={idOf(name)}
        value={String(value)}
        options={node.enum.map(String)}
        change={(to) => set(at(name), to)}
      />
    );
  if (node.type === "boolean")
    return (
      <label class="toggle">
        <input
          id={idOf(name)}
          type="checkbox"
          checked={value === true}
          onChange={(event) => set(at(name), event.currentTarget.checked)}
        />
        <span>{value === true ? "yes" : "no"}</span>
      </label>
    );
  if (isList(node)) return <ListField name={name} unit={unitOf(name, node)} value={value} invalid={invalid} />;
  return <Quantity name={name} node={node} value={value} invalid={invalid} />;
}

const isList = (node: Node): boolean =>
  node.type === "array" || (node.anyOf?.some((one) => isList(schema.value!.follow(one).node)) ?? false);

function Quantity({
  name,
  node,
  value,
  invalid,
}: {
  name: string;
  node: Node;
  value: Json | undefined;
  invalid: boolean;
}) {
  const first = node.anyOf?.find((one) => one.type !== "null") ?? node;
  const inner = schema.value!.follow(first).node;
  // The defaults of another kind are known with its first preview.
  const shown = value ?? node.default;
  return (
    <NumberField
      id={idOf(name)}
      name={node.title ?? label(name)}
      of={name.includes("index") ? "index" : name}
      unit={unitOf(name, node)}
      value={typeof shown === "number" ? shown : undefined}
      limits={limits(inner)}
      placeholder="–"
      integer={inner.type === "integer"}
      invalid={invalid}
      describedBy={`${idOf(name)}-help`}
      change={(to) => set(at(name), to)}
    />
  );
}

/** Numbers, separated by commas; an empty box is the default. */
function ListField({ name, unit, value, invalid }: { name: string; unit: string; value: Json | undefined; invalid: boolean }) {
  const take = (typed: string) => {
    const numbers = typed
      .split(/[,;\s]+/)
      .filter(Boolean)
      .map(Number);
    if (!numbers.every(Number.isFinite)) return;
    if (numbers.length > 0) set(at(name), numbers);
    else edit([{ op: "remove", path: at(name) }]);
  };
  return (
    <span class="box wide">
      <input
        id={idOf(name)}
        value={Array.isArray(value) ? value.join(", ") : String(value ?? "")}
        placeholder="default"
        aria-invalid={invalid}
        aria-describedby={unit ? `${idOf(name)}-unit ${idOf(name)}-help` : `${idOf(name)}-help`}
        autocomplete="off"
        onChange={(event) => take(event.currentTarget.value)}
      />
      {unit && (
        <span class="unit" id={`${idOf(name)}-unit`}>
          {unit}
        </span>
      )}
    </span>
  );
}

/** A file of heights or triangles, or of a spectral density. */
function FileField({ value }: { value: string }) {
  const { file } = SURFACES[String(own.value["surface"])] ?? {};
  const names = file ? filesOf(file) : files.value.filter(({ audit }) => audit).map(({ name }) => name);
  return (
    <div class="pair">
      <select id={idOf("file")} value={value} onChange={(event) => set(at("file"), event.currentTarget.value)}>
        {[...new Set([value, ...names])].map((name) => (
          <option key={name} value={name}>
            {name || "none"}
          </option>
        ))}
      </select>
      <FileButton label="Choose a file" stays />
    </div>
  );
}

const COATINGS: Record<string, Table | null> = {
  none: null,
  mirror: { kind: "mirror", reflectance: 1 },
  metal: { kind: "metal", material: "Al" },
  film: { kind: "film", film: [{ material: 2.3, thickness_nm: 60 }] },
};

/** What lies on the facets. Films are edited in the text. */
function CoatingField() {
  const value = own.value["coating"];
  const now = isTable(value) ? String(value["kind"]) : "none";
  const choose = (kind: string) => {
    const starter = COATINGS[kind];
    edit([starter ? { op: "set", path: at("coating"), value: starter } : { op: "remove", path: at("coating") }]);
  };
  const wrong = problems.value.filter(({ path }) => path?.startsWith(at("coating")));
  return (
    <div class={wrong.length > 0 ? "field wrong" : "field"}>
      <label for={idOf("coating")}>Coating</label>
      <Choice id={idOf("coating")} value={now} options={Object.keys(COATINGS)} change={choose} />
      <p class="help">
        What lies on every facet{now === "none" ? "" : "; its keys are in the text below"}. A coated surface cannot be a
        layer of a display.
      </p>
      <Problems of={wrong} />
    </div>
  );
}

/** The text of the surface, which is measured when it is left. */
function Text({ isOpen = false }: { isOpen?: boolean }) {
  const wrong = problems.value.filter(({ path }) => !path);
  return (
    <details class="more" {...(isOpen ? { open: true } : {})}>
      <summary>Text (TOML)</summary>
      <textarea
        class="surface-text"
        aria-label="Text of the surface"
        rows={12}
        spellcheck={false}
        value={text.value}
        onChange={(event) => open(event.currentTarget.value, nameOf.value)}
      />
      <Problems of={wrong} withPlace />
    </details>
  );
}

/** All fields of the surface. */
export function SurfaceFields() {
  const found = schema.value?.find(ROOT, values.value);
  if (!found || !schema.value) return null;
  if (own.value["surface"] === undefined)
    // A text that was not read yet, or cannot be: the fields of another surface would have the wrong values.
    return (
      <div class="surface-fields">
        <p class="remark" role="status">
          {problems.value.length > 0 ? "The fields are shown when the text can be read." : "reading the surface…"}
        </p>
        <Text key={problems.value.length > 0 ? "open" : "closed"} isOpen={problems.value.length > 0} />
      </div>
    );
  const kind = schema.value.chosen(found.node, own.value);
  const names = Object.keys(kind.properties ?? {}).filter((key) => key !== "surface" && key !== "coating");
  const keys = ordered(String(own.value["surface"]), names);
  const isMeasuring = (key: string) => MEASURING.includes(split(key)[1]);
  return (
    <div class="surface-fields">
      <KindField />
      {keys
        .filter((key) => !isMeasuring(key))
        .map((key) => (
          <Key key={key} name={key} />
        ))}
      {kind.properties?.["coating"] && <CoatingField />}
      <details class="more">
        <summary>How it is measured</summary>
        {keys.filter(isMeasuring).map((key) => (
          <Key key={key} name={key} />
        ))}
      </details>
      <Text />
    </div>
  );
}
