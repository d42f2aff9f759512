// The picture on the display, as the reader sees it in this room: beside it the same picture on a screen, and white paper.

import { useSignalEffect } from "@preact/signals";
import { useRef } from "preact/hooks";

import { hex, times, type Triple } from "../model/colour.ts";
import { degrees, digits, plain } from "../model/format.ts";
import { halftoneName, HALFTONES, isStated } from "../model/halftones.ts";
import { at, isTable, listAt } from "../model/json.ts";
import { camera, fitting } from "../model/perspective.ts";
import { D65, onScreen, PAPER, SCREEN_REFLECTANCE, type ScreenLight, type White } from "../model/seen.ts";
import { AGE } from "../model/glare.ts";
import { zipped } from "../model/zip.ts";
import { markOf } from "../state/age.ts";
import { fields, text } from "../state/design.ts";
import { FAR, imagesOfLamps, isSizeKnown, lampsSeen, veil_cd_m2 } from "../state/eye.ts";
import {
  drags,
  exposed,
  halftone,
  holds,
  imageAge,
  imageProblems,
  isGlaring,
  MOST_ZOOM,
  pictureFile,
  pictureName,
  reset,
  screenLight,
  shown,
  source,
  stepsFor,
  whiteOfPage,
  zoom,
  zoomBy,
} from "../state/image.ts";
import { set } from "../state/live.ts";
import { said } from "../state/said.ts";
import { FileButton } from "./choose.tsx";
import { fileName } from "./file-name.ts";
import { Display, imageClass, useDrawing } from "./image-display.tsx";
import { Menu, type Item } from "./menu.tsx";
import { Addition, Problems } from "./problems.tsx";
import { save } from "./save.ts";
import { usePicture } from "./stage.tsx";
import { NumberBox } from "./study-parts.tsx";

const WHITES: readonly (readonly [White, string])[] = [
  ["perfect", "a perfect white in this light"],
  ["display", "the white of the display"],
  ["screen", "the screen or a perfect white, whichever is brighter"],
];

const SCREENS: readonly ScreenLight[] = ["paper", 100, 300, 1000];

/** The files of states, which there are only with a halftone: for a picture and for the panel. */
const OF_STATES: readonly Item[] = [
  { name: "states.png", summary: "The state of each pixel: a picture with a palette" },
  { name: "frame.bin", summary: "For the panel: the code of each pixel, packed" },
  { name: "frame.bmp", summary: "For the panel: the codes as the numbers of a BMP" },
  { name: "frame.h", summary: "For the panel: the packed codes as a C header" },
];

/** The name of the archive of all files. */
const ALL = "all";

/** The files of the picture. */
const filesOf = (withStates: boolean): readonly Item[] => [
  ...(withStates ? OF_STATES : []),
  { name: "seen.png", summary: "The display as its reader sees it in this light" },
  { name: "image.json", summary: "Numbers of the picture, and the layout of the frame" },
  { name: "palette.gpl", summary: "Colours of the states: GIMP, Inkscape, Krita" },
  { name: "palette.css", summary: "Colours of the states: style sheets" },
  { name: "palette-epdoptimize.json", summary: "Colours as seen and as sent: for epdoptimize" },
];

/** The picture on a screen in the same room. */
function Screen() {
  const ref = useDrawing((canvas) => {
    const [by, picture] = [exposed.value, source.value];
    if (!by || !picture) return null;
    const { added, factors } = onScreen(by, screenLight.value);
    const size = [canvas.width, canvas.height] as const;
    const height = picture.size[1] / picture.size[0];
    return (painter) =>
      painter.draw({
        lit: { picture, factors, added, matrix: by.matrix },
        camera: camera([0, 0], 4, height),
        frame: { canvas: size, scale: fitting(size, height), middle: [0, 0] },
        mirrors: [],
        veils: [],
        subPixels: null,
      });
  });
  const reflected = plain(100 * SCREEN_REFLECTANCE);
  const by = exposed.value;
  const cd = by && (screenLight.value === "paper" ? PAPER * by.white_cd_m2 : screenLight.value);
  // Its white, D65, is bluish to an eye that is adapted to warmer light.
  const white = by ? times(by.matrix, D65.map((value) => (value * by.white[1] * cd!) / by.white_cd_m2) as unknown as Triple) : [0];
  const isBrighter = Math.max(...white) > 1.02;
  return (
    <figure class="seen-screen">
      <canvas ref={ref} role="img" aria-label="The same picture on a screen in the same light" />
      <figcaption>
        <span>
          sRGB screen of {digits(cd, 3)} cd/m², which reflects {reflected} % of the room's light
          {isBrighter && "; colours brighter than the white of this page are clipped"}
        </span>
      </figcaption>
    </figure>
  );
}

/** White paper in the same light. */
function Paper() {
  const sheet = useRef<HTMLDivElement>(null);
  useSignalEffect(() => {
    const by = exposed.value;
    if (!by || !sheet.current) return;
    sheet.current.style.backgroundColor = hex(times(by.matrix, by.white.map((value) => PAPER * value) as unknown as Triple));
  });
  const cd = exposed.value && PAPER * exposed.value.white_cd_m2;
  return (
    <figure class="seen-paper">
      <div ref={sheet} role="img" aria-label="White paper in the same light" />
      <figcaption>
        <span>
          Paper that reflects {plain(100 * PAPER)}{"\u00a0"}%: {digits(cd, 3)}{"\u00a0"}cd/m²
        </span>
      </figcaption>
    </figure>
  );
}

/** The halftone without a choice on the page, in words. */
function ofScenario(): string {
  const all = stepsFor(null);
  return all.length > 1 && !isStated(text.value) ? "default, then search" : `scenario: ${halftoneName(all.at(-1)!)}`;
}

function Controls() {
  const files = filesOf(shown.value?.seen.head.held !== null);
  const archive = async (): Promise<Blob> => {
    const all = new Map<string, Uint8Array>();
    for (const [i, { name }] of files.entries()) {
      said.value = `File ${i + 1} of ${files.length}, ${name}, is being computed in full size.`;
      all.set(name, new Uint8Array(await (await pictureFile(name)).arrayBuffer()));
    }
    return zipped(all);
  };
  const download = async (chosen: string) => {
    const what = chosen === ALL ? "picture.zip" : chosen;
    try {
      said.value = `${what} is being computed in full size.`;
      save(`${fileName()}-${what}`, await (chosen === ALL ? archive() : pictureFile(chosen)));
      said.value = `${what} is saved.`;
    } catch (why) {
      said.value = why instanceof Error ? why.message : String(why);
    }
  };
  return (
    <div class="controls">
      <FileButton label="Choose a picture" title="PNG or JPEG; or drop it on the page" stays />
      {pictureName.value && (
        <button type="button" onClick={() => (pictureName.value = null)} title="Show the picture of the scenario again">
          Remove {pictureName.value}
        </button>
      )}
      <Menu
        label="Download files of the picture"
        items={[...files, { name: ALL, label: "All files", summary: "One zip archive" }]}
        choose={download}
      >
        Files
      </Menu>
      <PanelSize />
      <label class="wide">
        <span>Halftone</span>
        <select value={halftone.value ?? ""} onChange={(event) => (halftone.value = event.currentTarget.value || null)}>
          <option value="">{ofScenario()}</option>
          {HALFTONES.map(([id, name]) => (
            <option key={id} value={id}>
              {name}
            </option>
          ))}
        </select>
      </label>
      <span role="group" aria-label="Zoom" class="zoom">
        <span>Zoom</span>
        <button type="button" aria-label="Smaller" onClick={() => zoomBy(1 / 1.5)} disabled={zoom.value <= 1}>
          −
        </button>
        <output>{digits(zoom.value, 2)} ×</output>
        <button type="button" aria-label="Larger" onClick={() => zoomBy(1.5)} disabled={zoom.value >= MOST_ZOOM}>
          +
        </button>
      </span>
      <span role="group" aria-label="Dragging">
        {(["tilt", "move"] as const).map((what) => (
          <button type="button" key={what} aria-pressed={drags.value === what} onClick={() => (drags.value = what)}>
            {what === "tilt" ? "Drag to tilt" : "Drag to move"}
          </button>
        ))}
      </span>
      <button type="button" onClick={reset}>
        Reset the view
      </button>
      <label class="wide">
        <span>White of this page</span>
        <select value={whiteOfPage.value} onChange={(event) => (whiteOfPage.value = event.currentTarget.value as White)}>
          {WHITES.map(([id, name]) => (
            <option key={id} value={id}>
              {name}
            </option>
          ))}
        </select>
      </label>
      <label class="wide">
        <span>White of the screen</span>
        <select
          value={String(screenLight.value)}
          onChange={({ currentTarget: { value } }) => (screenLight.value = value === "paper" ? value : Number(value))}
        >
          {SCREENS.map((light) => (
            <option key={light} value={light}>
              {light === "paper" ? "as bright as paper in this light" : `${light} cd/m²`}
            </option>
          ))}
        </select>
      </label>
      <label>
        <input type="checkbox" checked={holds.value} onChange={(event) => (holds.value = event.currentTarget.checked)} />{" "}
        the panel keeps its picture
      </label>
      <label title="Light that lenses and retina of the eye scatter over the picture">
        <input type="checkbox" checked={isGlaring.value} onChange={(event) => (isGlaring.value = event.currentTarget.checked)} />{" "}
        glare
      </label>
    </div>
  );
}

/** Pixels per inch of a display whose pixels get a number first. */
const USUAL_PPI = 300;

/** The number of pixels of the panel, to which pictures are fitted. */
function PanelSize() {
  const given = listAt(fields.value, "display.matrix.pixels");
  const [columns, rows] = given.length === 2 ? (given as number[]) : [undefined, undefined];
  const now = shown.value?.seen.size ?? [400, 300];
  const put = (end: 0 | 1, value: number | null) => {
    if (value === null || value < 1) return;
    const pixels = end === 0 ? [Math.round(value), rows ?? now[1]] : [columns ?? now[0], Math.round(value)];
    if (isTable(at(fields.value, "display.matrix"))) return set("display.matrix.pixels", pixels);
    set("display.matrix", { ppi: USUAL_PPI, pixels });
    said.value = `The display has ${pixels.join(" × ")} pixels of ${USUAL_PPI} per inch: display.matrix of the scenario.`;
  };
  return (
    <span class="panel-size" title="display.matrix.pixels: pictures are fitted to it; without it, the panel has the size of the picture">
      <span>Pixels of the panel</span>
      <span>
        <NumberBox label="Columns of pixels of the panel" value={columns} put={(value) => put(0, value)} /> ×{" "}
        <NumberBox label="Rows of pixels of the panel" value={rows} put={(value) => put(1, value)} />
      </span>
    </span>
  );
}

/** Mirror images of lamps, and the veil in the eye. */
function Images() {
  if (lampsSeen.value.length === 0) return null;
  return (
    <>
      {imagesOfLamps.value.map(({ lamp, isVisible, wide_deg, onStates }) => (
        <span key={lamp.number}>
          {" "}
          Mirror image of lamp {lamp.number + 1},{" "}
          {lamp.isCollimated
            ? `whose light is collimated: drawn ${degrees(wide_deg)} wide,`
            : `${degrees(wide_deg)} wide, ${onStates.map(([state, cd]) => `${digits(cd, 3)} cd/m²${state && ` on ${state}`}`).join(" and ")}:`}{" "}
          {isVisible ? "on the display." : "beside the display from here."}
        </span>
      ))}
      {veil_cd_m2.value > 0 &&
        ` Glare: a veil of ${digits(veil_cd_m2.value, 2)} cd/m² in the middle of the display, in an eye of ${AGE} years (CIE 146).`}
    </>
  );
}

/** The mark of the words about the picture, which is read out at the picture. */
const LegendMark = () => {
  const mark = markOf(imageAge.value);
  return mark && <b>{`${mark.words}: `}</b>;
};

/** Which picture is shown, and what is contained in it. */
function Legend() {
  const now = shown.value;
  if (!now) return null;
  const { head, size } = now.seen;
  const panel = head.panel;
  const isPart = panel && (panel[0] !== size[0] || panel[1] !== size[1]);
  return (
    <p class={`remark${imageClass()}`}>
      <LegendMark />
      {now.picture}: {size[0]} × {size[1]} pixels
      {isPart && ` of the same size as the ${panel[0]} × ${panel[1]} of the display`}.{" "}
      {head.held === null
        ? "Without a halftone, there are no states for the panel to download."
        : head.neighbours_light
        ? "Light that the layers return from each pixel to others is contained."
        : "Each pixel has the colour of a uniform area of its state, without light from its neighbours."}
      {!isSizeKnown.value && ` The size of the pixels (display.matrix) is not given: the eye is drawn ${FAR} widths away.`}
      <Images />
      {head.warnings.map((warning) => (
        <span class="warning" key={warning}>
          {" "}
          Warning: {warning}
        </span>
      ))}
    </p>
  );
}

export function ImagePanel() {
  usePicture();
  return (
    <section class="seen" aria-label="Picture">
      <Problems of={imageProblems.value} />
      <Addition of={imageProblems.value} />
      <div class="seen-all">
        <Display />
        <div class={`beside${imageClass()}`}>
          <Screen />
          <Paper />
        </div>
        <div class="side">
          <Controls />
          <Legend />
        </div>
      </div>
    </section>
  );
}
