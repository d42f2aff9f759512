// The fields of a table of the scenario, generated from its schema: required keys, those that are set, and the others,
// which can be added. Each field has a label, a unit, a range and a line of help, and shows its errors.

import { useSignal } from "@preact/signals";

import { partOf } from "../model/keys.ts";
import { fields, problems, problemsAt, schema, selected } from "../state/design.ts";
import { edit, set } from "../state/live.ts";
import { variesNow } from "../state/vary.ts";
import { at, isTable, join, split, tableAt, type Json, type Table } from "../model/json.ts";
import { help, label, uncapitalised, unit, unitOf, type Found } from "../model/schema.ts";
import { MODELS } from "../model/stack.ts";
import { Problems } from "../panels/problems.tsx";
import { Choice } from "./choice.tsx";
import { idOf } from "./id.ts";
import { Editor } from "./editor.tsx";
import { dragged } from "./number.tsx";

/** The fields of the table at a path, without the keys that are shown elsewhere. */
export function Form({ path, except = [], only }: { path: string; except?: string[]; only?: string[] }) {
  const found = schema.value?.find(path, fields.value);
  if (!found || !schema.value) return null;
  const value = tableAt(fields.value, path);
  const wanted = (key: string) =>
    !except.includes(key) && (only?.includes(key) ?? true) && !isNested(found, key, value);
  const { shown, more } = schema.value.keys(found.node, value);
  return (
    <>
      <Model path={path} found={found} value={value} />
      {shown.filter(wanted).map((key) => (
        <Field key={join(path, key)} path={join(path, key)} />
      ))}
      <More path={path} keys={more.filter(wanted)} />
    </>
  );
}

/** Returns true for a list of tables, which are shown in the drawing. */
function isNested(found: Found, key: string, value: Json): boolean {
  const node = schema.value!.chosen(found.node, value).properties?.[key];
  if (!node) return true;
  const { node: inner } = schema.value!.follow(node);
  return (
    inner.type === "array" && inner.items !== undefined && schema.value!.follow(inner.items).node.type === "object"
  );
}

/** The choice between alternatives, by `model` or `kind`. */
function Model({ path, found, value }: { path: string; found: Found; value: Json }) {
  const which = schema.value?.discriminator(found.node, value);
  if (!which) return null;
  const now = String(at(value, which.key) ?? "");
  const starters = MODELS[path] ?? MODELS[path.replace(/^.*\.(environment|layers)\.\d+$/, "$1")] ?? {};
  const values = which.values.filter((name) => name === now || starters[name]);
  if (values.length < 2) return null;
  const choose = (name: string) => {
    const stays = Object.entries(isTable(value) ? value : {}).filter(
      ([key]) => key === "share" || (key === "kind" && path.startsWith("display.layers")),
    );
    const kept = which.key === "kind" ? {} : Object.fromEntries(stays);
    set(path, { ...starters[name], ...kept });
  };
  return (
    <div class="field">
      <label for={`${idOf(path)}-model`}>{label(which.key)}</label>
      <Choice id={`${idOf(path)}-model`} value={now} options={values} change={choose} />
      <p class="help">{(which.help.get(now) ?? "").replaceAll("`", "")}</p>
    </div>
  );
}

/** Returns the label of a key: that of the schema, or the words of its name. */
const nameOf = ({ node }: Found, key: string): string => node.title ?? label(key);

/** One field, by its path. */
export function Field({ path, name, bare = false }: { path: string; name?: string; bare?: boolean }) {
  const asked = useSignal(false);
  const found = schema.value?.find(path, fields.value);
  if (!found) return null;
  const [, key] = split(path);
  const value = at(fields.value, path);
  const wrong = problemsAt(path);
  const text = name ?? nameOf(found, key);
  const id = idOf(path);
  if (isMap(found)) return <MapOf path={path} found={found} name={text} />;
  if (isGroup(found) && isTable(value)) return <Group path={path} found={found} name={text} value={value} />;
  return (
    <div class={wrong.length > 0 ? "field wrong" : "field"} data-path={path}>
      <span class="field-name">
        <label for={id}>{text}</label>
        {!bare && help(found.node) !== "" && (
          <button
            type="button"
            class="ask"
            aria-expanded={asked.value}
            aria-controls={`${id}-help`}
            aria-label={`Help: ${text}`}
            title={help(found.node)}
            onClick={() => (asked.value = !asked.value)}
          >
            ?
          </button>
        )}
        <Vary path={path} value={value} name={text} />
      </span>
      <Editor
        id={id}
        path={path}
        found={found}
        value={value}
        name={text}
        unit={unitOf(key, found.node)}
        invalid={wrong.length > 0}
      />
      {!bare && (
        <p class={asked.value ? "help shown" : "help"} id={`${id}-help`}>
          {help(found.node)}
        </p>
      )}
      {!isQuiet(path) && <Problems of={wrong} />}
    </div>
  );
}

/** A button that adds a key to the open tool of Improve. */
function Vary({ path, value, name }: { path: string; value: Json | undefined; name: string }) {
  const by = variesNow();
  if (!by || typeof value !== "number" || by.isVaried(path)) return null;
  return (
    <button type="button" class="vary" aria-label={`Vary ${name}`} title={`Vary ${path}`} onClick={() => by.add(path)}>
      Vary
    </button>
  );
}

/** While a slider is being dragged, errors at other fields would move it under the hand. */
const isQuiet = (path: string): boolean => dragged.value !== "" && dragged.value !== idOf(path);

const isMap = ({ node }: Found): boolean => typeof node.additionalProperties === "object" && !node.properties;

/** A table whose keys are arbitrary names: areas, gaps, reflectances of states. */
function MapOf({ path, found, name }: { path: string; found: Found; name: string }) {
  const entries = Object.keys(tableAt(fields.value, path));
  if (
    typeof found.node.additionalProperties === "object" &&
    entries.some((key) => isTable(at(fields.value, join(path, key))))
  )
    return null;
  const wrong = problemsAt(path);
  return (
    <fieldset class="map" data-path={path}>
      <legend>
        {name}
        {unit(split(path)[1]) && <small> {unit(split(path)[1])}</small>}
      </legend>
      <p class="help">{help(found.node)}</p>
      {entries.map((key) => (
        <Field key={key} path={join(path, key)} name={key} bare />
      ))}
      <Problems of={wrong} />
    </fieldset>
  );
}

/** Returns true for the reflection of a diffuser, whose fields are a group in those of the diffuser. */
const isGroup = ({ def }: Found): boolean => def === "Reflection" || def === "ReflectionBelow";

/** The keys that the lobes of a reflection need, each with a valid value, and all keys of lobes. */
const LOBES: Record<string, Table> = { lambertian: {}, "k-correlation": { width: 0.2 }, ward: { alpha: 0.1 } };
const LOBE_KEYS = ["model", "width", "haze", "alpha", "normalisation"];

/** The reflection of a diffuser: a table of its own that can be removed. */
function Group({ path, found, name, value }: { path: string; found: Found; name: string; value: Table }) {
  const model = String(value["model"] ?? "lambertian");
  const choose = (to: string) => {
    const rest = Object.entries(value).filter(([key]) => !LOBE_KEYS.includes(key));
    set(path, { ...Object.fromEntries(rest), model: to, ...LOBES[to] });
  };
  const wrong = problemsAt(path);
  return (
    <fieldset class="map group" data-path={path}>
      <legend>{name}</legend>
      <p class="help">{help(found.node)}</p>
      <div class="field" data-path={join(path, "model")}>
        <label for={`${idOf(path)}-model`}>Lobe</label>
        <Choice id={`${idOf(path)}-model`} value={model} options={Object.keys(LOBES)} change={choose} />
        <Problems of={problemsAt(join(path, "model"))} />
      </div>
      <Form path={path} except={["model"]} />
      <button type="button" class="quiet" onClick={() => edit([{ op: "remove", path }])}>
        Remove {name.toLowerCase()}
      </button>
      <Problems of={wrong} />
    </fieldset>
  );
}

/** Keys that are not set; each is added with its default or a valid value. */
function More({ path, keys }: { path: string; keys: string[] }) {
  const open = useSignal(false);
  if (keys.length === 0) return null;
  const add = (key: string) => edit([{ op: "set", path: join(path, key), value: start(join(path, key)) }]);
  return (
    <details class="more" open={open.value} onToggle={(event) => (open.value = event.currentTarget.open)}>
      <summary>
        {keys.length} more {keys.length === 1 ? "key" : "keys"}
      </summary>
      {open.value &&
        keys.map((key) => {
          const found = schema.value?.find(join(path, key), fields.value) ?? { node: {}, def: "" };
          return (
            <div class="field" key={key}>
              <button type="button" class="quiet" onClick={() => add(key)}>
                Set {uncapitalised(nameOf(found, key))}
              </button>
              <p class="help">{help(found.node)}</p>
            </div>
          );
        })}
    </details>
  );
}

/** Returns the initial value of a key that was not set. */
function start(path: string): Json {
  const found = schema.value?.find(path, fields.value);
  const node = found?.node ?? {};
  if (node.default !== undefined) return node.default;
  if (node.enum) return node.enum[0] ?? "";
  if (node.type === "boolean") return true;
  if (found?.def === "MaterialSpec") return 1.5;
  if (found?.def === "Reflection") return { total_reflectance: 0.08 };
  if (found?.def === "ReflectionBelow") return { reflectance: 0.08 };
  if (found?.def === "ShareSpectrum" && path.includes(".reflection.")) return 0.08;
  if (found?.def === "ShareSpectrum") return path.endsWith("ransmittance") ? 0.9 : 0;
  if (found?.def === "LightSpectrum") return "D65";
  if (found?.def === "FrontLight") return { illuminance_lx: 100 };
  if (node.type === "object") return {};
  if (path.endsWith("reference_state")) return "white";
  if (node.type === "string") return "";
  const { min, max } = {
    min: node.minimum ?? node.exclusiveMinimum ?? 0,
    max: node.maximum ?? node.exclusiveMaximum ?? 1,
  };
  return min > 0 ? min : max <= 1 ? (min + max) / 2 : Math.min(1, max);
}

/** The errors for which there is no field on the screen. */
export function Elsewhere() {
  const loose = problems.value.filter(
    (problem) => !problem.path || !document.querySelector(`[data-path="${CSS.escape(problem.path)}"]`),
  );
  return (
    <>
      <Problems of={loose} withPlace />
      {loose
        .filter(({ path }) => path && partOf(path) !== selected.value)
        .map(({ path }) => (
          <button type="button" key={path} onClick={() => (selected.value = partOf(path!))}>
            Show {path}
          </button>
        ))}
    </>
  );
}
