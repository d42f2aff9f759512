// Uploaded files: the audit of each, as text and figures, and its possible uses.

import type { Edit } from "../api/types.ts";
import { textAt } from "../model/json.ts";
import { Drawn } from "../plots/figure.tsx";
import { fields, selected } from "../state/design.ts";
import { showFile } from "../state/surface.ts";
import { files, forget, type Dropped } from "../state/files.ts";
import { fitTo } from "../state/fit.ts";
import { edit } from "../state/live.ts";
import { compareWith } from "./measured.tsx";
import { FileButton } from "./choose.tsx";
import { Problems } from "./problems.tsx";
import { SaveRenamed } from "./rename.tsx";

const KINDS: Record<string, string> = {
  bsdf: "measured BSDF",
  spectrum: "spectrum",
  material: "n and k of a material",
  pixel: "pixel table",
  map: "light map",
  luminaire: "luminaire",
  profile: "light profile",
  panel: "measured panel",
  picture: "picture",
  surface: "surface by its geometry",
  heights: "heights of a surface",
  mesh: "triangles of a surface",
};

/** Returns the reason why a use has no effect on the current design, or "". */
function idle(edits: readonly Edit[]): string {
  const colours = edits.some(({ path }) => path.startsWith("display.diffuser.transmission"));
  const brings = edits.some(({ path }) => path === "display.diffuser");
  return colours && !brings && textAt(fields.value, "display.diffuser.model") !== "measured"
    ? "only a measured diffuser can have a transmission spectrum"
    : "";
}

/** Offers a material for the film that is selected in the drawing. */
function asFilm(file: Dropped): { label: string; edits: Edit[] }[] {
  const film = /^display\.pixel\.film\.\d+$/.test(selected.value);
  if (file.audit?.kind !== "material" || !film) return [];
  return [
    { label: "Use as the selected film", edits: [{ op: "set", path: `${selected.value}.material`, value: file.name }] },
  ];
}

function size(bytes: number): string {
  if (bytes < 1000) return `${bytes} bytes`;
  return bytes < 1e5 ? `${(bytes / 1e3).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

function File({ file }: { file: Dropped }) {
  const { audit } = file;
  return (
    <article class="file">
      <header>
        <h3>{file.name}</h3>
        <small>
          {audit && !file.isReading ? `${KINDS[audit.kind] ?? audit.kind}, ` : ""}
          {size(file.bytes)}
        </small>
        <button type="button" onClick={() => forget(file.name)} aria-label={`Remove ${file.name}`}>
          Remove
        </button>
      </header>
      {file.isReading && <p role="status">Reading…</p>}
      <Problems of={file.problems} />
      {audit && !file.isReading && (
        <>
          <p class="uses">
            {audit.kind === "panel" && (
              <button type="button" class="run" onClick={() => compareWith(file.name)}>
                Compare with the design
              </button>
            )}
            {audit.kind === "panel" && (
              <button type="button" class="run" onClick={() => fitTo(file.name)}>
                Fit the design to it
              </button>
            )}
            <SaveRenamed name={file.name} />
            {(audit.kind === "heights" || audit.kind === "mesh") && (
              <button type="button" class="run" onClick={() => showFile(file.name, audit.kind)}>
                Use as a surface
              </button>
            )}
            {[...asFilm(file), ...audit.edits].map(({ label, edits }) => (
              <span key={label}>
                <button type="button" class="run" disabled={idle(edits) !== ""} onClick={() => edit(edits)}>
                  {label}
                </button>
                {idle(edits) && <small> {idle(edits)}</small>}
              </span>
            ))}
          </p>
          <div class="audit">
            <div class="figures">
              {audit.figures.map(({ name, svg }) => (
                <Drawn key={name} name={`${file.name}-${name}`} svg={svg} label={`${file.name}: ${name}`} />
              ))}
            </div>
            <pre class="words" tabindex={0} aria-label={`Audit of ${file.name}`}>
              {audit.words.join("\n")}
            </pre>
          </div>
        </>
      )}
    </article>
  );
}

export function FilesPanel() {
  return (
    <>
      <div class="controls">
        <FileButton label="Choose files" />
        <span class="remark">
          or drop files anywhere on the page: BSDFs (Zemax, ASTM E1392, CSV), n-k tables, spectra, pixel tables, light
          maps, IES luminaires, measured panels, pictures, surfaces and heights of profilometers. The files stay on this
          machine.
        </span>
      </div>
      {files.value.map((file) => (
        <File key={file.name} file={file} />
      ))}
    </>
  );
}
