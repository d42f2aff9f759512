// The parts of a liquid-crystal pixel in the cross-section: axes of polarisers and retarders as seen by the viewer, and the directors of
// cells by depth in the shown state.

import { at } from "../model/json.ts";
import { crystalParts, type CrystalPart } from "../model/crystal.ts";
import { material } from "../model/kinds.ts";
import { fields, shownState } from "../state/design.ts";
import { directors } from "../state/directors.ts";
import { LEFT, Part, scaled, WIDTH, Words } from "./part.tsx";

const USUAL = 22;
const CELL = 74;
const SUBSTRATE = 22;
const heightOf = ({ kind }: CrystalPart): number => (kind === "cell" ? CELL : scaled(USUAL));

/** Height of all parts and of the reflector. */
export const crystalHeight = (): number =>
  crystalParts(fields.value).reduce((sum, part) => sum + heightOf(part), 0) + scaled(SUBSTRATE);

/** An axis as the viewer sees it: x to the right, counter-clockwise. */
function Axis({ x, y, deg, size }: { x: number; y: number; deg: number; size: number }) {
  const [dx, dy] = [size * Math.cos((deg * Math.PI) / 180), -size * Math.sin((deg * Math.PI) / 180)];
  return (
    <g class="axis-glyph">
      <circle cx={x} cy={y} r={size + 1} />
      <line x1={x - dx} y1={y - dy} x2={x + dx} y2={y + dy} />
      <title>{`Axis at ${deg}°, as seen by the viewer`}</title>
    </g>
  );
}

/** Columns of directors, and the length of one that lies in the plane of the drawing. */
const COLUMNS = 9;
const ROD = 15;
const ROWS = 5;

/** The directors of a cell, projected onto the plane of azimuth 0, which is that of the drawing. */
function Directors({ part, height }: { part: CrystalPart; height: number }) {
  const states = directors.value.get(part.index) ?? [];
  const shown = states.find(({ state }) => state === shownState.value) ?? states[0];
  if (!shown || shown.directors.length === 0) return null;
  const all = shown.directors;
  const row = (k: number) => all[Math.round((k * (all.length - 1)) / Math.max(1, ROWS - 1))] as [number, number, number];
  const [left, right] = [LEFT + 118, LEFT + WIDTH - 128];
  return (
    <g class="directors" role="img" aria-label={`Directors of the cell in the state ${shown.state}`}>
      {Array.from({ length: ROWS }, (_, k) => {
        const [x, y, z] = row(k);
        const cy = 11 + (k * (height - 22)) / (ROWS - 1);
        return Array.from({ length: COLUMNS }, (_, i) => {
          const cx = left + ((i + 0.5) * (right - left)) / COLUMNS;
          const [dx, dy] = [(ROD * x) / 2, (-ROD * z) / 2];
          // The end towards the reader of the page, out of the plane of the drawing, is thick: azimuth -90 deg.
          const end = y < -0.02 ? 1 : y > 0.02 ? -1 : 0;
          return (
            <g key={`${k} ${i}`}>
              <line x1={cx - dx} y1={cy - dy} x2={cx + dx} y2={cy + dy} />
              {end !== 0 && <circle cx={cx + end * dx} cy={cy + end * dy} r={1 + 1.1 * Math.abs(y)} />}
            </g>
          );
        });
      })}
      <title>{`Directors in the state ${shown.state}, from the side (plane of azimuth 0); a dot is the end that comes out of the plane`}</title>
    </g>
  );
}

export function CrystalParts({ top }: { top: number }) {
  const all = fields.value;
  let y = top;
  const rows = crystalParts(all).map((part) => {
    const [here, height] = [y, heightOf(part)];
    y += height;
    return (
      <Part key={part.path} path={part.path} y={here}>
        <rect class={`band crystal ${part.kind}`} x={LEFT} width={WIDTH} height={height} />
        {part.kind === "cell" && <Directors part={part} height={height} />}
        <Words name={part.name} note={part.note} height={height} />
        {part.axis !== null && <Axis x={LEFT + 98} y={height / 2} deg={part.axis} size={Math.min(9, height / 2 - 2)} />}
      </Part>
    );
  });
  return (
    <>
      {rows}
      <Part path="display.pixel" y={y}>
        <rect class="band metal substrate" x={LEFT} width={WIDTH} height={scaled(SUBSTRATE)} />
        <Words name={`Reflector: ${material(at(all, "display.pixel.substrate"))}`} note="" height={scaled(SUBSTRATE)} />
      </Part>
    </>
  );
}
