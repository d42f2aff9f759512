// A surface by its geometry: bumps, roughness, heights or triangles of a file. A preview of what `papilio gonio` measures follows every
// change; the whole measurement, the file for the command line, and the surface as a layer of the design are one button away.

import { useEffect } from "preact/hooks";

import { faceName, facesOf, placesOf, SURFACES } from "../model/surface.ts";
import { fields as design } from "../state/design.ts";
import { fileIds } from "../state/files.ts";
import { startJob } from "../state/jobs.ts";
import * as state from "../state/surface.ts";
import { Aged } from "./aged.tsx";
import { FileButton } from "./choose.tsx";
import { AsJob } from "./jobs.tsx";
import { Menu } from "./menu.tsx";
import { Problems } from "./problems.tsx";
import { save } from "./save.ts";
import { SurfaceFields } from "./surface-fields.tsx";
import { SurfaceResult } from "./surface-result.tsx";

/** The surfaces that the design has as layers. */
function OfDesign() {
  const faces = facesOf(design.value);
  if (faces.length === 0) return null;
  return (
    <div class="controls">
      <span>Surfaces of this design:</span>
      {faces.map((face) =>
        face.isKernel ? (
          <span class="remark" key={face.path}>
            {faceName(face)}, a kernel that was measured before; its geometry is not in the scenario
          </span>
        ) : (
          <button type="button" key={face.path} onClick={() => void state.openLayer(face)}>
            {faceName(face)}
          </button>
        ),
      )}
    </div>
  );
}

/** Why the surface cannot be a layer of a display; "" if it can. */
function unusable(): string {
  const own = state.own.value;
  if (state.age.value === "failed") return "What cannot be measured cannot be a layer.";
  if (own["surface"] === "volume") return "A volume is no face, and cannot be a layer.";
  if (own["coating"]) return "A coated surface cannot be a layer.";
  return "";
}

function UseInDesign() {
  const places = placesOf(design.value);
  const why = unusable() || (places.length === 0 ? "The display has no interface that a surface can replace." : "");
  if (why) return <span class="remark">{why}</span>;
  const choose = (name: string) => {
    const place = places.find((one) => one.name === name);
    if (place) void state.use(place.edits);
  };
  return (
    <Menu items={places.map(({ name }) => ({ name }))} choose={choose} title="Put this surface into the display">
      Use in the display
    </Menu>
  );
}

function FullMeasurement() {
  const running = state.full.phase.value === "running";
  const { done = 0, of = 1 } = state.progress.value ?? {};
  return (
    <>
      {running ? (
        <button type="button" onClick={state.full.cancel}>
          Cancel
        </button>
      ) : (
        <button
          type="button"
          class="run"
          disabled={state.pending.value.length > 0}
          onClick={() => void state.measure()}
        >
          Measure with all rays
        </button>
      )}
      {!running && state.pending.value.length === 0 && (
        <AsJob start={() => startJob({ command: "gonio", scenario: state.text.value })} />
      )}
      {running && <progress max={of} value={done} aria-label="Progress of the measurement" />}
      <span role="status" data-phase={state.full.phase.value}>
        {running && `${done} of ${of} parts`}
        {state.full.phase.value === "cancelled" && "cancelled"}
      </span>
    </>
  );
}

function Tools() {
  const store = () =>
    save(`${state.name.value || "surface"}.toml`, new Blob([state.text.value], { type: "application/toml" }));
  return (
    <div class="controls">
      <b class="surface-name">{state.name.value}.toml</b>
      <Menu items={state.examples.value} choose={(name) => void state.openExample(name)}>
        Example surfaces
      </Menu>
      <FileButton label="Open a file" title="A surface (TOML), heights of a profilometer, or a mesh" stays />
      <button type="button" onClick={store} title="The file that papilio gonio measures">
        Download for papilio gonio
      </button>
      <UseInDesign />
      <FullMeasurement />
    </div>
  );
}

/** Errors that belong to no field. */
function Refusal() {
  const wrong = state.problems.value;
  if (wrong.length === 0) return null;
  const loose = wrong.filter(
    ({ path }) => !path || !document.querySelector(`#tab-panel [data-path="${CSS.escape(path)}"]`),
  );
  return (
    <div class="refusal">
      <p>
        <b>This surface cannot be measured.</b>{" "}
        {state.age.value === "refused" && "The numbers are those of the last one that could, before this change."}
      </p>
      <Problems of={loose} />
      {state.pending.value.length > 0 && (
        <button type="button" onClick={state.discard}>
          Discard the change
        </button>
      )}
    </div>
  );
}

export function SurfacePanel() {
  useEffect(() => {
    void state.enter();
    return state.leave;
  }, []);
  useEffect(state.again, [fileIds.value]);
  const kind = SURFACES[String(state.own.value["surface"] ?? "")];
  // Numbers of another surface are not shown below the name of one that cannot be measured.
  const shown = state.age.value === "failed" ? null : state.gonio.value;
  return (
    <section aria-label="Surface">
      <OfDesign />
      <Tools />
      <Problems of={state.full.problems.value} />
      <div class="surface">
        <SurfaceFields />
        <div>
          <Refusal />
          <Aged age={shown ? state.age.value : "current"} thing="surface" name={state.name.value || "surface"}>
            {shown ? (
              <SurfaceResult of={shown} />
            ) : (
              <p role="status">
                {state.problems.value.length > 0 ? "no result" : `measuring ${kind?.name ?? "the surface"}…`}
              </p>
            )}
          </Aged>
        </div>
      </div>
    </section>
  );
}
