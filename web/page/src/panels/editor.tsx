// The fields of the part that is selected in the drawing, under its name and its key in the scenario.

import { addLayer, addLight, canMove, canRemove, moveSelected, PIXEL_FILM, PIXEL_PART, removeSelected } from "../drawing/actions.ts";
import { CellStates } from "../fields/cell-states.tsx";
import { Elsewhere, Field, Form } from "../fields/form.tsx";
import { CRYSTAL_KINDS, crystalParts, isCrystal, STACK } from "../model/crystal.ts";
import { KINDS } from "../model/kinds.ts";
import { films, layers, MODELS } from "../model/stack.ts";
import { firstError, isFaded, liveAge } from "../state/age.ts";
import { answer, draft, draftName, fields, pending, problems, selected } from "../state/design.ts";
import { discard, edit } from "../state/live.ts";
import { wanted } from "../state/ready.ts";
import { at, keysOf, listAt, textAt } from "../model/json.ts";
import { Menu } from "./menu.tsx";
import { Addition, Mends } from "./problems.tsx";
import { StatesEditor } from "./states.tsx";
import { facesOf } from "../model/surface.ts";
import { showLayer } from "../state/surface.ts";
import { said } from "../state/said.ts";
import { PRESETS } from "../state/shelf.ts";
import { helpedLayers, refusedLayers, tryLayers, type Help } from "../state/try-layers.ts";

/** Returns the name of the part at a path. */
function nameOf(path: string): string {
  const layer = layers(fields.value).find((one) => one.path === path);
  const film = films(fields.value).find((one) => one.path === path);
  const part = crystalParts(fields.value).find((one) => one.path === path);
  if (part) return part.name;
  if (layer) return layer.name;
  if (film) return film.thickness === null ? "Gap" : `Film of ${film.material}`;
  if (path.startsWith("lighting.directed.")) return `Source ${Number(keysOf(path)[2]) + 1}`;
  if (path.startsWith("lighting.environment.")) return `Environment ${Number(keysOf(path)[2]) + 1}`;
  const names: Record<string, string> = {
    "display.pixel": "Pixel",
    "display.pixel.states": "Drive states",
    lighting: "Ambient light",
    viewer: "Viewer",
    computing: "Computation",
  };
  return names[path] ?? path;
}

const CHIPS = ["display.pixel", "display.pixel.states", "lighting", "viewer", "computing"];

/** The names of layers in menus. */
const LAYER_NAMES = Object.fromEntries(Object.entries(KINDS).map(([kind, { menu }]) => [kind, menu ?? kind]));

/** A menu of parts to add. */
function Add({
  name,
  options,
  names = {},
  refused,
  helped,
  opens,
  add,
}: {
  name: string;
  options: readonly string[];
  names?: Record<string, string>;
  /** Why parts cannot be added here. */
  refused?: ReadonlyMap<string, string>;
  /** What is added together with parts. */
  helped?: ReadonlyMap<string, Help>;
  opens?: () => void;
  add: (what: string) => void;
}) {
  const items = options.map((option) => {
    const [why, help] = [refused?.get(option), helped?.get(option)];
    const item = { name: option, label: names[option] ?? option };
    return why !== undefined ? { ...item, refused: why } : help ? { ...item, summary: help.words } : item;
  });
  return (
    <Menu items={items} choose={add} {...(opens ? { opens } : {})}>
      {name}
    </Menu>
  );
}

/**
 * Applies a preset of lighting and viewer. It replaces the viewing direction; a front light is part of the display and
 * is kept.
 */
export function applyPreset(preset: string): void {
  const guide = at(fields.value, "lighting.front_light");
  edit([
    { op: "set", path: "lighting", value: { preset, ...(guide === undefined ? {} : { front_light: guide }) } },
    { op: "remove", path: "viewer.theta_deg" },
    { op: "remove", path: "viewer.phi_deg" },
  ]);
  said.value = `${preset}: lighting and viewer are those of the preset${guide === undefined ? "" : "; the front light is kept"}.`;
}

/** The menu of the presets of lighting and viewer (rooms, geometries of standards), with the current one. */
export function Room() {
  const now = answer.value?.preset;
  const words = now ? `${now.name}${now.changed ? ", changed" : ""}` : "";
  return (
    <Menu
      class="room"
      title="Presets of light and viewer"
      items={PRESETS.value}
      chosen={now && !now.changed ? now.name : ""}
      choose={applyPreset}
    >
      {words ? `Light: ${words}` : "Light"}
    </Menu>
  );
}

export function Toolbar() {
  const film = textAt(fields.value, "display.pixel.model") === "film";
  const parts = isCrystal(fields.value) ? Object.keys(CRYSTAL_KINDS).map((kind) => PIXEL_PART + kind) : [];
  const layerKinds = [...Object.keys(KINDS), ...(film ? [PIXEL_FILM] : []), ...parts];
  return (
    <div class="toolbar" role="toolbar" aria-label="Parts of the display">
      <Add
        name="Add layer"
        options={layerKinds}
        names={LAYER_NAMES}
        refused={refusedLayers.value}
        helped={helpedLayers.value}
        opens={() => void tryLayers(layerKinds)}
        add={(kind) => addLayer(kind, helpedLayers.value.get(kind)?.edits)}
      />
      <Add
        name="Add source"
        options={[
          "directed",
          ...Object.keys(MODELS["environment"]!),
          ...(at(fields.value, "lighting.front_light") ? [] : ["front light"]),
        ]}
        add={addLight}
      />
      <span class="moves">
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
      </span>
    </div>
  );
}

/** The errors of a refused change, and a button that discards it. */
function Refusal() {
  if (problems.value.length === 0) return null;
  const waiting = pending.value.length + (draft.value === null ? 0 : 1);
  const changes = pending.value.slice(-2).map(wanted).join(", ");
  return (
    <div class="refusal">
      <p>
        <b>
          {draft.value !== null && draftName.value
            ? `${draftName.value} cannot be computed.`
            : waiting > 0
              ? `${changes || "The change"} is not applied.`
              : "The design cannot be computed."}
        </b>{" "}
        {isFaded(liveAge.value)
          ? "The result is that of the last valid design."
          : `The exact result cannot be computed; what is shown is a first answer${firstError.value}.`}
      </p>
      <Elsewhere />
      <div class="mend">
        <Mends of={problems.value} />
        {draft.value === null && <Addition of={problems.value} />}
        {waiting > 0 && (
          <button type="button" onClick={discard}>
            Discard
          </button>
        )}
      </div>
    </div>
  );
}

/** The fields of a coating and of its films, from top to bottom. */
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

/** The fields of a part of a liquid-crystal pixel, and of its states. */
function CrystalFields({ path }: { path: string }) {
  return (
    <>
      <Form path={path} except={["states"]} />
      <CellStates path={path} />
    </>
  );
}

function Fields({ path }: { path: string }) {
  if (path === "display.pixel.states") return <StatesEditor />;
  if (path === "display.pixel") return <Form path={path} except={["film", "states", "stack"]} />;
  if (path.startsWith(`${STACK}.`)) return <CrystalFields path={path} />;
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
  const face = facesOf(fields.value).find((one) => one.path === path);
  return (
    <>
      <Form path={path} />
      {face && !face.isKernel && (
        <button type="button" onClick={() => showLayer(face)}>
          Show this surface
        </button>
      )}
      {gap && <Field path="display.pixel.gap_nm" />}
    </>
  );
}

export function FieldsPanel() {
  const path = selected.value;
  return (
    <section class="editor" aria-label="Fields of the selection">
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
      <Fields path={path} />
      <Refusal />
    </section>
  );
}
