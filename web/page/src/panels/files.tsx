// Measured files: what the audit says of each, in words and pictures, and how it is put to use.

import type { Edit } from "../api/types.ts";
import { textAt } from "../model/json.ts";
import { Drawn } from "../plots/figure.tsx";
import { fields, selected } from "../state/design.ts";
import { files, forget, type Dropped } from "../state/files.ts";
import { edit } from "../state/live.ts";
import { FileButton } from "./choose.tsx";
import { Problems } from "./problems.tsx";

const KINDS: Record<string, string> = {
  bsdf: "measured scattering",
  spectrum: "spectrum",
  material: "n and k of a material",
  pixel: "table of a pixel",
  map: "map of light",
  luminaire: "luminaire",
  profile: "profile of light",
  panel: "measured panel",
};

/** Why a use is of no use to the design on the bench, or "". */
function idle(edits: readonly Edit[]): string {
  const colours = edits.some(({ path }) => path.startsWith("display.diffuser.transmission"));
  const brings = edits.some(({ path }) => path === "display.diffuser");
  return colours && !brings && textAt(fields.value, "display.diffuser.model") !== "measured"
    ? "only a measured diffuser has a transmission spectrum of its own"
    : "";
}

/** A material can be the film that is chosen in the drawing. */
function asFilm(file: Dropped): { label: string; edits: Edit[] }[] {
  const film = /^display\.pixel\.film\.\d+$/.test(selected.value);
  if (file.audit?.kind !== "material" || !film) return [];
  return [
    { label: "Use as the chosen film", edits: [{ op: "set", path: `${selected.value}.material`, value: file.name }] },
  ];
}

function size(bytes: number): string {
  return bytes < 1e5 ? `${(bytes / 1e3).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;
}

function File({ file }: { file: Dropped }) {
  const { audit } = file;
  return (
    <article class="file">
      <header>
        <h3>{file.name}</h3>
        <small>
          {audit ? `${KINDS[audit.kind] ?? audit.kind}, ` : ""}
          {size(file.bytes)}
        </small>
        <button type="button" onClick={() => forget(file.name)} aria-label={`Forget ${file.name}`}>
          Forget
        </button>
      </header>
      {!audit && file.problems.length === 0 && <p role="status">Reading…</p>}
      <Problems of={file.problems} />
      {audit && (
        <>
          <p class="uses">
            {[...asFilm(file), ...audit.edits].map(({ label, edits }) => (
              <button
                type="button"
                key={label}
                class="run"
                disabled={idle(edits) !== ""}
                title={idle(edits)}
                onClick={() => edit(edits)}
              >
                {label}
                {idle(edits) && `: ${idle(edits)}`}
              </button>
            ))}
          </p>
          <div class="audit">
            <div class="figures">
              {audit.figures.map(({ name, svg }) => (
                <Drawn key={name} svg={svg} label={`${file.name}: ${name}`} />
              ))}
            </div>
            <pre class="words" tabindex={0} aria-label={`What ${file.name} is worth`}>
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
          or drop them anywhere: BSDF (Zemax, ASTM E1392, CSV), n-k tables, spectra, pixel tables, light maps, IES
          luminaires. They stay on this machine.
        </span>
      </div>
      {files.value.map((file) => (
        <File key={file.name} file={file} />
      ))}
    </>
  );
}
