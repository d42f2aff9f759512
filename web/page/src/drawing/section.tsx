// The cross-section of the display, not to scale: the directions above it, then its layers from the front of screen to
// the mirror of the pixel. Every layer is a button; the fields of the selected layer are next to the drawing.

import { computed, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { NONE, plain } from "../model/format.ts";
import { at, join, listAt, textAt, type Json } from "../model/json.ts";
import { drives, gaps, subPixels } from "../model/drive.ts";
import { isCrystal } from "../model/crystal.ts";
import { material, type Look } from "../model/kinds.ts";
import { films, layers, type Film, type Layer } from "../model/stack.ts";
import { coloursOf } from "../plots/patches.tsx";
import { draft, fields, result, resultCount, selected, shownState, view } from "../state/design.ts";
import { isLight } from "../model/colour.ts";
import { LiveMark } from "../panels/aged.tsx";
import { Downloads } from "../panels/downloads.tsx";
import { isFaded, liveAge } from "../state/age.ts";
import { svgOf } from "../plots/picture.ts";
import type { Medium } from "../model/rays.ts";
import { Above, ABOVE_HEIGHT } from "./above.tsx";
import { crystalHeight, CrystalParts } from "./crystal.tsx";
import { CENTRE, Dome } from "./dome.tsx";
import { LEFT, Part, scaled, WIDTH, Words } from "./part.tsx";
import { Rays } from "./rays.tsx";

/** Heights of the bands. */
const USUAL: Record<Look, number> = {
  component: 19,
  guide: 19,
  diffuser: 26,
  slab: 32,
  medium: 27,
  face: 17,
  coating: 19,
  rough: 20,
};
const heightOf = (look: Look): number => scaled(USUAL[look]);
const filmHeight = (): number => scaled(18);
/** Height of the largest gap. */
const GAP = 44;
const MIRROR = 16;
const substrateHeight = (): number => scaled(22);
/** Height of the gap's band: the gap, the mirrors, and a margin. */
const GAPS = GAP + MIRROR + 6;

function Band({ layer, y }: { layer: Layer; y: number }) {
  const height = heightOf(layer.look);
  const air = layer.name === "Air gap";
  return (
    <Part path={layer.path} y={y}>
      <rect class={`band ${air ? "air" : layer.look}`} x={LEFT} width={WIDTH} height={height} />
      {(layer.look === "diffuser" || layer.look === "slab") && (
        <rect class="grain" x={LEFT} width={WIDTH} height={height} fill={`url(#grain-${layer.look})`} />
      )}
      {layer.look === "rough" && <path class="rough-line" d={zigzag(height)} />}
      <Words name={layer.name} note={layer.note} height={height} />
    </Part>
  );
}

function zigzag(height: number): string {
  const teeth = Array.from({ length: 73 }, (_, i) => `${LEFT + i * 6} ${height - (i % 2 === 0 ? 1 : 4)}`);
  return `M${teeth.join("L")}`;
}

const METALS = /^(Al|Cr|W|Ni|Ti|Au|Ag)(:|$)/;

function FilmBand({ film, y }: { film: Film; y: number }) {
  const metal = METALS.test(film.material) || film.material.includes(" k ");
  return (
    <Part path={film.path} y={y}>
      <rect class={metal ? "band film metal" : "band film"} x={LEFT} width={WIDTH} height={filmHeight()} />
      <Words name={film.material} note={`${plain(film.thickness ?? 0, 5)} nm`} height={filmHeight()} />
    </Part>
  );
}

/** A part of a sub-pixel in the drawing: its place and its gap. */
interface Cavity {
  readonly name: string;
  readonly gap: number;
  readonly x: number;
  readonly width: number;
  readonly depth: number;
}

/**
 * The cavities in the selected state, and the inactive part. The width of each sub-pixel is proportional to its area, the
 * depth to its gap.
 */
function cavities(): { parts: Cavity[]; inactive: number } {
  const all = fields.value;
  const drive = drives(all, shownState.value);
  const names = subPixels(all);
  const area = (name: string) => Number(at(all, join("display.pixel.area", name)) ?? 0);
  const sum = names.reduce((total, name) => total + area(name), 0) || 1;
  const fill = Math.min(1, Math.max(0, Number(at(all, "display.pixel.fill_factor") ?? 1)));
  const parts = names.flatMap((name) => gaps(all, name, drive.get(name) ?? 0).map((part) => ({ name, ...part })));
  const deepest = Math.max(
    1,
    ...names.flatMap((name) => [Number(at(all, join("display.pixel.gap_nm", name)) ?? 0)]),
    ...parts.map(({ gap }) => gap),
  );
  let x = LEFT;
  const placed = parts.map(({ name, part, gap }) => {
    const width = (WIDTH * fill * area(name) * part) / sum;
    x += width;
    return { name, gap, x: x - width, width, depth: (GAP * gap) / deepest };
  });
  return { parts: placed, inactive: 1 - fill };
}

/** The gap and the mirrors below it, and the inactive part of the area. */
function Gaps({ y, film }: { y: number; film: Film }) {
  const { parts, inactive } = cavities();
  const dark = Number(at(fields.value, "display.pixel.gap_nm.dark")) || 0;
  const driven = (part: { gap: number } | undefined) => part !== undefined && part.gap > dark;
  const named = parts.filter(({ width }) => width > 46);
  const start = parts.reduce((end, { x, width }) => Math.max(end, x + width), LEFT);
  return (
    <Part path={film.path} y={y}>
      <rect class="band gap" x={LEFT} width={WIDTH} height={GAPS} />
      {parts.map(({ name, gap, x, width, depth }, i) => (
        <g key={i} transform={`translate(${x.toFixed(2)} 0)`}>
          <rect
            class="cavity"
            width={Math.max(0, width - 2)}
            x="1"
            height={depth}
            fill={driven({ gap }) ? stateColour(name) : DARK}
          />
          <rect class="mirror-block" width={Math.max(0, width - 2)} x="1" y={depth} height={MIRROR} />
          {width > 46 && (
            <text class="gap-name" x={width / 2} y={depth + MIRROR / 2 + 4} text-anchor="middle">
              {width > 108 ? `${name} ${plain(gap, 4)} nm` : `${width > 60 ? plain(gap, 4) : Math.round(gap)} nm`}
            </text>
          )}
        </g>
      ))}
      {inactive > 1e-9 && (
        <g class="inactive-part">
          <rect x={start} width={LEFT + WIDTH - start} height={GAPS} fill="url(#inactive)" />
          {inactive * WIDTH > 44 && (
            <text class="gap-name" x={(start + LEFT + WIDTH) / 2} y={14} text-anchor="middle">
              inactive
            </text>
          )}
          <title>{`Inactive part of the area: ${plain(100 * inactive, 4)} %`}</title>
        </g>
      )}
      {(named[0] ? [named[0]] : []).map((part) => (
        <text
          key={part.x}
          class={isLight(driven(part) ? stateColour(part.name) : DARK) ? "gap-word on-light" : "gap-word"}
          x={part.x + 9}
          y={14}
        >
          {film.material === "air" ? "air gap" : `gap of ${film.material}`}
        </text>
      ))}
    </Part>
  );
}

/** The colour of a cavity that is not driven. */
const DARK = "#15171c";

/** The colours of the states; the cavity of a sub-pixel has the colour of the state with its name. */
const colours = computed(() => coloursOf(result.value, view.value).colours);
const stateColour = (name: string): string => colours.value.get(name) ?? "#8899aa";

function PixelParts({ top }: { top: number }) {
  const all = fields.value;
  const model = textAt(all, "display.pixel.model") ?? "";
  if (model === "liquid-crystal") return <CrystalParts top={top} />;
  if (model !== "film") {
    const note =
      model === "uniform" ? textAt(all, "display.pixel.kind") : material(at(all, "display.pixel.file") as Json);
    return (
      <Part path="display.pixel" y={top}>
        <rect class="band block" x={LEFT} width={WIDTH} height={44} />
        <Words name={`Pixel: ${model}`} note={note ?? NONE} height={44} />
      </Part>
    );
  }
  let y = top;
  const rows = films(all).map((film) => {
    const here = y;
    y += film.thickness === null ? GAPS : filmHeight();
    return film.thickness === null ? (
      <Gaps key={film.path} film={film} y={here} />
    ) : (
      <FilmBand key={film.path} film={film} y={here} />
    );
  });
  return (
    <>
      {rows}
      <Part path="display.pixel" y={y}>
        <rect class="band metal substrate" x={LEFT} width={WIDTH} height={substrateHeight()} />
        <Words
          name={`${material(at(all, "display.pixel.substrate"))} mirror`}
          note={`fill factor ${plain(Number(at(all, "display.pixel.fill_factor") ?? 1))}`}
          height={substrateHeight()}
        />
      </Part>
    </>
  );
}

function pixelHeight(): number {
  if (isCrystal(fields.value)) return crystalHeight();
  if (textAt(fields.value, "display.pixel.model") !== "film") return 44;
  const rows = listAt(fields.value, "display.pixel.film");
  return (
    rows.reduce<number>((sum, film) => sum + (at(film, "thickness_nm") === "gap" ? GAPS : filmHeight()), 0) +
    substrateHeight()
  );
}

/** Grains of a diffuser and particles of a slab. */
function Patterns() {
  return (
    <defs>
      <pattern id="grain-diffuser" width="14" height="10" patternUnits="userSpaceOnUse">
        <circle cx="3" cy="3" r="1" />
        <circle cx="10" cy="7" r="1" />
      </pattern>
      <pattern id="grain-slab" width="22" height="18" patternUnits="userSpaceOnUse">
        <circle cx="5" cy="5" r="2.2" />
        <circle cx="16" cy="9" r="1.6" />
        <circle cx="8" cy="14" r="1.4" />
      </pattern>
      <pattern id="inactive" width="6" height="6" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">
        <rect width="6" height="6" class="inactive-ground" />
        <path d="M0 0V6" class="inactive-line" />
      </pattern>
    </defs>
  );
}

/** Returns the bands of the pixel that a ray crosses at a place: the films, and the gap down to the mirror there. */
function pixelMedia(x: number): Medium[] {
  if (textAt(fields.value, "display.pixel.model") !== "film") return [];
  const { parts } = cavities();
  const here = parts.find((part) => x >= part.x && x < part.x + part.width);
  const all = films(fields.value);
  const gap = all.findIndex((film) => film.thickness === null);
  return all.slice(0, gap < 0 ? all.length : gap + 1).map((film) =>
    film.thickness === null
      ? { height: here?.depth ?? GAP / 2, index: film.material === "air" ? 1 : 1.5 }
      : // Films are much thinner than drawn: the ray passes them almost vertically.
        { height: filmHeight(), index: 4 },
  );
}

/** Whether the directions are drawn from above instead of from the side. */
const fromAbove = signal(false);

function Viewpoint() {
  const choice = (above: boolean, name: string) => (
    <button type="button" aria-pressed={fromAbove.value === above} onClick={() => (fromAbove.value = above)}>
      {name}
    </button>
  );
  return (
    <div class="viewpoint" role="group" aria-label="View of the directions">
      {choice(false, "Side")}
      {choice(true, "Above")}
    </div>
  );
}

export function Section() {
  const stack = layers(fields.value);
  const svg = useRef<SVGSVGElement>(null);
  const top = (fromAbove.value ? ABOVE_HEIGHT : CENTRE.y) + 10;
  const heights = stack.map(({ look }) => heightOf(look) + 1);
  const tops = heights.map((_, i) => top + heights.slice(0, i).reduce((sum, height) => sum + height, 0));
  const bottom = top + heights.reduce((sum, height) => sum + height, 0);
  const height = bottom + pixelHeight() + 6;
  useEffect(() => {
    if (/^lighting\.\w+/.test(selected.value) && at(fields.value, selected.value) === undefined)
      selected.value = "lighting";
    const known = svg.current?.querySelector(`[data-part="${CSS.escape(selected.value)}"]`);
    if (!known && selected.value.startsWith("display.") && selected.value !== "display.pixel.states")
      selected.value = stack[0]?.path ?? "display.pixel";
  });
  return (
    <div class="drawing">
      {/* Pending changes are drawn at once; a whole text is, when it was read. */}
      {draft.value !== null && <LiveMark />}
      <Viewpoint />
      <svg
        ref={svg}
        class={`section${isFaded(liveAge.value) ? ` of-before turn-${resultCount.value % 2}` : ""}`}
        viewBox={`0 0 460 ${height}`}
        role="group"
        aria-label="The display, its light and its viewer"
      >
        <Patterns />
        {fromAbove.value ? <Above /> : <Dome />}
        {stack.map((layer, i) => (
          <Band key={layer.path} layer={layer} y={tops[i]!} />
        ))}
        <PixelParts top={bottom} />
        {!fromAbove.value && (
          <Rays
            stack={stack}
            heights={heights}
            from={[CENTRE.x, top]}
            pixel={pixelMedia(CENTRE.x)}
            left={LEFT}
            right={LEFT + WIDTH}
          />
        )}
        <text class="scale" x={LEFT + WIDTH} y={top - 5} text-anchor="end">
          thicknesses not to scale
        </text>
      </svg>
      <span class="drawing-tools">
        <Downloads name="cross-section" svg={() => svgOf(svg.current!)} />
      </span>
    </div>
  );
}
