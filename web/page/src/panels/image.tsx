// The picture on the display, as the reader sees it in this room: beside it the same picture on a screen, and white paper.

import { useSignalEffect } from "@preact/signals";
import { useRef } from "preact/hooks";

import { hex, times, type Triple } from "../model/colour.ts";
import { degrees, digits, plain } from "../model/format.ts";
import { halftoneName, HALFTONES, isStated } from "../model/halftones.ts";
import { camera, fitting } from "../model/perspective.ts";
import { D65, onScreen, PAPER, SCREEN_REFLECTANCE, type ScreenLight, type White } from "../model/seen.ts";
import { AGE } from "../model/glare.ts";
import { markOf } from "../state/age.ts";
import { text } from "../state/design.ts";
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
import { said } from "../state/said.ts";
import { FileButton } from "./choose.tsx";
import { fileName } from "./file-name.ts";
import { Display, imageClass, useDrawing } from "./image-display.tsx";
import { Menu } from "./menu.tsx";
import { Problems } from "./problems.tsx";
import { save } from "./save.ts";
import { usePicture } from "./stage.tsx";

const WHITES: readonly (readonly [White, string])[] = [
  ["perfect", "a perfect white in this light"],
  ["display", "the white of the display"],
  ["screen", "the screen or a perfect white, whichever is brighter"],
];

const SCREENS: readonly ScreenLight[] = ["paper", 100, 300, 1000];

/** Without a halftone, there are no states: neither for a picture nor for the panel. */
const OF_STATES = ["states.png", "frame.bin", "frame.bmp", "frame.h"];

const FILES = [...OF_STATES, "seen.png", "image.json", "palette.gpl", "palette.css", "palette-epdoptimize.json"];

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
  const download = async (what: string) => {
    try {
      said.value = `${what} is being computed in full size.`;
      save(`${fileName()}-${what}`, await pictureFile(what));
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
        items={FILES.filter((name) => !OF_STATES.includes(name) || shown.value?.seen.head.held !== null).map((name) => ({ name }))}
        choose={download}
      >
        Files
      </Menu>
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
