// The fields of what is chosen in the drawing, under its name and its key in the scenario.

import { addFilm, addLayer, addLight, canMove, canRemove, moveSelected, removeSelected } from "../drawing/actions.ts";
import { Elsewhere, Field, Form } from "../fields/form.tsx";
import { KINDS } from "../model/kinds.ts";
import { films, layers } from "../model/stack.ts";
import { draft, draftName, fields, pending, problems, selected, text } from "../state/design.ts";
import { edit, putBack } from "../state/live.ts";
import { at, listAt, textAt } from "../model/json.ts";
import { Menu } from "./menu.tsx";
import { StatesEditor } from "./states.tsx";
import { said } from "../state/said.ts";
import { PRESETS } from "../state/shelf.ts";

/** What a path is called. */
function nameOf(path: string): string {
  const layer = layers(fields.value).find((one) => one.path === path);
  const film = films(fields.value).find((one) => one.path === path);
  if (layer) return layer.name;
  if (film) return film.thickness === null ? "Gap" : `Film of ${film.material}`;
  if (path.startsWith("lighting.directed.")) return `Light ${Number(path.split(".")[2]) + 1}`;
  if (path.startsWith("lighting.environment.")) return `Surround ${Number(path.split(".")[2]) + 1}`;
  const names: Record<string, string> = {
    "display.pixel": "Pixel",
    "display.pixel.states": "Drive states",
    lighting: "Room light",
    viewer: "Viewer",
    computing: "Computing",
  };
  return names[path] ?? path;
}

const CHIPS = ["display.pixel", "display.pixel.states", "lighting", "viewer", "computing"];

/** What layers are called in menus. */
const LAYER_NAMES = Object.fromEntries(Object.entries(KINDS).map(([kind, { menu }]) => [kind, menu ?? kind]));

/** A menu of things to add. */
function Add({
  name,
  options,
  names = {},
  add,
}: {
  name: string;
  options: readonly string[];
  names?: Record<string, string>;
  add: (what: string) => void;
}) {
  return (
    <Menu items={options.map((option) => ({ name: option, label: names[option] ?? option }))} choose={add}>
      {name}
    </Menu>
  );
}

/**
 * The light and the viewer of a room or of a standard's geometry. The viewer's own direction gives way to the
 * preset's; a front light is part of the display and stays.
 */
function enter(room: string): void {
  const guide = at(fields.value, "lighting.front_light");
  edit([
    { op: "set", path: "lighting", value: { preset: room, ...(guide === undefined ? {} : { front_light: guide }) } },
    { op: "remove", path: "viewer.theta_deg" },
    { op: "remove", path: "viewer.phi_deg" },
  ]);
  said.value = `${room}: light and viewer are the preset's${guide === undefined ? "" : "; the front light stays"}.`;
}

/** A room or a standard's geometry, which fills lighting and viewer; the one in use is shown. */
export function Room() {
  const now = /^\s*preset\s*=\s*"([^"]+)"/m.exec(text.value)?.[1] ?? "";
  return (
    <Menu
      class="room"
      label={now ? `Room preset: ${now}` : undefined}
      items={PRESETS.value}
      chosen={now}
      choose={enter}
    >
      {now || "Room or standard"}
    </Menu>
  );
}

export function Toolbar() {
  const film = textAt(fields.value, "display.pixel.model") === "film";
  return (
    <div class="toolbar" role="toolbar" aria-label="Parts of the display">
      <Add
        name="Add layer"
        options={[...Object.keys(KINDS), ...(film ? ["film of the pixel"] : [])]}
        names={LAYER_NAMES}
        add={(what) => (what === "film of the pixel" ? addFilm() : addLayer(what))}
      />
      <Add
        name="Add light"
        options={[
          "directed",
          "ring",
          "cap",
          "sky",
          ...(at(fields.value, "lighting.front_light") ? [] : ["front light"]),
        ]}
        add={addLight}
      />
      <button
        type="button"
        disabled={!canMove(-1)}
        onClick={() => moveSelected(-1)}
        aria-label="Up"
        title="Up (Alt + arrow up)"
      >
        ↑
      </button>
      <button
        type="button"
        disabled={!canMove(1)}
        onClick={() => moveSelected(1)}
        aria-label="Down"
        title="Down (Alt + arrow down)"
      >
        ↓
      </button>
      <button type="button" disabled={!canRemove()} onClick={removeSelected} title="Remove (Delete)">
        Remove
      </button>
    </div>
  );
}

/** What was refused, and the way back. */
function Refusal() {
  if (problems.value.length === 0) return null;
  const waiting = pending.value.length + (draft.value === null ? 0 : 1);
  return (
    <div class="refusal">
      <p>
        <b>
          {draft.value !== null && draftName.value
            ? `${draftName.value} does not compute.`
            : waiting > 0
              ? "Not applied yet."
              : "Not computed."}
        </b>{" "}
        The picture shows the last design that computes.
      </p>
      <Elsewhere />
      {waiting > 0 && (
        <button type="button" onClick={putBack}>
          Put it back
        </button>
      )}
    </div>
  );
}

/** A coating has films of its own, top to bottom. */
function CoatingFields({ path }: { path: string }) {
  const list = `${path}.film`;
  const count = listAt(fields.value, list).length;
  const add = () => edit([{ op: "insert", path: list, index: count, value: { material: "SiO2", thickness_nm: 90 } }]);
  return (
    <>
      <Form path={path} />
      {Array.from({ length: count }, (_, i) => (
        <fieldset class="map" key={i}>
          <legend>Film {i + 1}</legend>
          <Form path={`${list}.${i}`} />
          {count > 1 && (
            <button type="button" onClick={() => edit([{ op: "remove", path: `${list}.${i}` }])}>
              Remove film {i + 1}
            </button>
          )}
        </fieldset>
      ))}
      <button type="button" onClick={add}>
        Add a film
      </button>
    </>
  );
}

function Fields({ path }: { path: string }) {
  if (path === "display.pixel.states") return <StatesEditor />;
  if (path === "display.pixel") return <Form path={path} except={["film", "states"]} />;
  if (path === "viewer") return <Form path="viewer" />;
  if (path === "lighting")
    return <Form path="lighting" except={["preset", "directed", "environment", "front_light"]} />;
  if (path === "computing")
    return (
      <>
        <h3>Solver</h3>
        <Form path="solver" except={["target"]} />
        <h3>Wavelengths</h3>
        <Form path="spectrum" />
        <h3>Metrics</h3>
        <Form path="metrics" />
      </>
    );
  if (path === "display.glass.surface") return <Field path={path} />;
  if (Array.isArray(at(fields.value, `${path}.film`))) return <CoatingFields path={path} />;
  const gap = at(fields.value, `${path}.thickness_nm`) === "gap";
  return (
    <>
      <Form path={path} />
      {gap && <Field path="display.pixel.gap_nm" />}
    </>
  );
}

export function FieldsPanel() {
  const path = selected.value;
  return (
    <section class="editor" aria-label="Fields of what is chosen">
      <nav class="chips" aria-label="Parts of the scenario">
        {CHIPS.map((chip) => (
          <button type="button" key={chip} aria-pressed={path === chip} onClick={() => (selected.value = chip)}>
            {nameOf(chip)}
          </button>
        ))}
      </nav>
      <header>
        <h2>{nameOf(path)}</h2>
        <code>{path === "computing" ? "solver, spectrum, metrics" : path}</code>
      </header>
      <Refusal />
      <Fields path={path} />
    </section>
  );
}
