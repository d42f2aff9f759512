// The room of the stage: window, lamps, table, and the arch of directions above the display. Sources and eye are handles on it. The arch is the
// plane of azimuth 0 from the side; what is outside this plane is drawn inside the arch.

import { degrees } from "../model/format.ts";
import { at, listAt, numberAt, textAt, type Json } from "../model/json.ts";
import { inPlane, mirrored, nearest, seen, type Direction } from "../model/plane.ts";
import { lightShares } from "../model/shares.ts";
import { fields, selected, view } from "../state/design.ts";
import { AngleHandle, STEEPEST, viewersOf, type Arch } from "./dome.tsx";
import { Eye, Sun } from "./glyphs.tsx";

const WIDTH = 800;
const HEIGHT = 300;
/** The middle of the display on the table, and the half axes of the arch. */
const MIDDLE = { x: 400, y: 266, rx: 290, ry: 214 } as const;
/** Sources of at least this angular radius are lamps, degrees. */
const LAMP_DEG = 0.6;

function place(direction: Direction, part = 1): [number, number] {
  const [right, up] = seen(direction);
  return [MIDDLE.x + MIDDLE.rx * right * part, MIDDLE.y - MIDDLE.ry * up * part];
}

/** Returns the inclination at the pointer, in steps of 0.5° (with Alt: 0.1°). */
function under(event: PointerEvent, from: Direction): number {
  const svg = (event.currentTarget as SVGElement).ownerSVGElement!;
  const to = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM()!.inverse());
  const [right, up] = [(to.x - MIDDLE.x) / MIDDLE.rx, (MIDDLE.y - to.y) / MIDDLE.ry];
  const far = Math.hypot(right, up) || 1;
  const radius = inPlane(from) ? far : Math.max(far, 1);
  return nearest([right / radius, up / radius], from, event.altKey ? 0.1 : 0.5, STEEPEST);
}

const ARCH: Arch = { place: (direction) => place(direction), under, attribute: "data-stage-handle" };

const line = (from: number, to: number, part = 1): string => {
  const steps = Math.max(2, Math.ceil(Math.abs(to - from) / 3));
  const points = Array.from({ length: steps + 1 }, (_, i) => place({ theta: from + ((to - from) * i) / steps, phi: 0 }, part));
  return `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}`;
};

/** Wall, window and table. */
function Walls() {
  const diffuse = lightShares(fields.value).get("lighting.diffuse") ?? 0;
  const hasSky = listAt(fields.value, "lighting.environment").some((one) => /sky|overcast/.test(textAt(one, "model") ?? ""));
  const share = hasSky ? 1 : diffuse;
  const choose = () => (selected.value = "lighting");
  return (
    <>
      <g
        class="window"
        role="button"
        tabindex={0}
        aria-label={`Window and walls: diffuse light, fraction ${share.toFixed(2)} of the light`}
        aria-pressed={selected.value === "lighting"}
        onClick={choose}
        onKeyDown={(event) => (event.key === "Enter" || event.key === " ") && choose()}
      >
        <rect class="frame" x="24" y="36" width="104" height="130" rx="2" />
        <rect class="pane" x="30" y="42" width="92" height="118" ref={(e) => e?.style.setProperty("--share", String(share))} />
        <path class="hill" d="M30 138C52 116 66 134 84 124C100 116 112 128 122 122V160H30Z" />
        <path class="bar" d="M76 42V160M30 98H122" />
        <path class="sill" d="M18 166H134" />
      </g>
      <path class="table-top" d={`M-900 ${MIDDLE.y}H1700V${HEIGHT + 2}H-900Z`} />
      <path class="table-edge" d={`M-900 ${MIDDLE.y}H1700`} />
    </>
  );
}

/** The shade of a lamp. */
function Shade() {
  return (
    <>
      <path class="shade" d="M-7 -10H7L16 5H-16Z" />
      <path class="bulb" d="M-9 5A9 8 0 0 0 9 5Z" />
    </>
  );
}

function Scale() {
  return (
    <g aria-hidden="true">
      <path class="rim" d={line(-90, 90)} />
      {[-60, -30, 0, 30, 60].map((theta) => {
        const [[x0, y0], [x1, y1], [x, y]] = [place({ theta, phi: 0 }), place({ theta, phi: 0 }, 0.97), place({ theta, phi: 0 }, 0.91)];
        return (
          <g key={theta}>
            <path class="tick" d={`M${x0} ${y0}L${x1} ${y1}`} />
            <text class="scale" x={x} y={y + 4} text-anchor="middle">
              {degrees(theta)}
            </text>
          </g>
        );
      })}
    </g>
  );
}

/** The label of a handle, outside the arch. */
function Tag({ theta, phi }: Direction) {
  const [right, up] = seen({ theta, phi });
  const far = 1 + 0.11 / (Math.hypot(right, up) || 1);
  return (
    <text
      class="tag"
      x={MIDDLE.x + MIDDLE.rx * right * far}
      y={MIDDLE.y - MIDDLE.ry * up * far + 4}
      text-anchor={right < -0.3 ? "end" : right > 0.3 ? "start" : "middle"}
    >
      {degrees(theta)}
      {phi % 360 !== 0 && `, φ ${degrees(phi)}`}
    </text>
  );
}

function Source({ source, index }: { source: Json; index: number }) {
  const here = { theta: numberAt(source, "theta_deg") ?? 0, phi: numberAt(source, "phi_deg") ?? 0 };
  const path = `lighting.directed.${index}`;
  const [x, y] = place(here);
  const [mx, my] = place(mirrored(here));
  const isLamp = (numberAt(source, "radius_deg") ?? 0) >= LAMP_DEG;
  const share = numberAt(source, "share") ?? 0;
  return (
    <>
      <path
        class="beam"
        d={`M${x} ${y}L${MIDDLE.x} ${MIDDLE.y}`}
        ref={(e) => e?.style.setProperty("opacity", String(0.3 + 0.7 * Math.sqrt(share)))}
      />
      {isLamp && <path class="cord" d={`M${x} 0V${y - 8}`} />}
      <circle class="mirror" cx={mx} cy={my} r="5">
        <title>Direction of the mirror image</title>
      </circle>
      <AngleHandle path={`${path}.theta_deg`} select={path} {...here} name={`Source ${index + 1} in the room`} arch={ARCH}>
        {isLamp ? <Shade /> : <Sun />}
      </AngleHandle>
      <Tag {...here} />
    </>
  );
}

/** Light from a ring or a cap, as the part of the arch from which it comes. */
function Environment({ source }: { source: Json }) {
  const n = (key: string, other: number) => numberAt(source, key) ?? other;
  const model = textAt(source, "model");
  const half = n("width_deg", 10) / 2;
  const [from, to] =
    model === "ring"
      ? [n("theta_deg", 35) - half, n("theta_deg", 35) + half]
      : model === "cap"
        ? [n("from_deg", 0), n("to_deg", 90)]
        : [0, 0];
  if (to === 0) return null;
  return <path class="span" d={from <= 0 ? line(-to, to, 0.94) : line(-to, -from, 0.94) + line(from, to, 0.94)} />;
}

export function Room() {
  const all = fields.value;
  const viewers = viewersOf(at(all, "viewer"));
  const now = view.value;
  return (
    <svg class="room-drawing" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} preserveAspectRatio="xMidYMax meet" role="group" aria-label="The room: light and eye">
      <Walls />
      <Scale />
      {listAt(all, "lighting.environment").map((source, i) => (
        <Environment key={i} source={source} />
      ))}
      {listAt(all, "lighting.directed").map((source, i) => (
        <Source key={i} source={source} index={i} />
      ))}
      {viewers.map(({ path, ...here }, i) => {
        const [x, y] = place(here);
        const isShown =
          now !== null && Math.abs(here.theta - now.theta_deg) < 1e-6 && Math.abs(here.phi - (now.phi_deg ?? here.phi)) < 1e-6;
        return (
          <g key={i}>
            {isShown && <path class="sight" d={`M${MIDDLE.x} ${MIDDLE.y}L${x} ${y}`} />}
            {path ? (
              <>
                <AngleHandle
                  path={path}
                  select="viewer"
                  {...here}
                  name={viewers.length > 1 ? `Eye ${i + 1} in the room` : "Eye in the room"}
                  arch={ARCH}
                >
                  <Eye />
                </AngleHandle>
                <Tag {...here} />
              </>
            ) : (
              <circle class={isShown ? "seen now" : "seen"} cx={x} cy={y} r={isShown ? 5 : 3} />
            )}
          </g>
        );
      })}
      <path class="device" d={`M${MIDDLE.x - 62} ${MIDDLE.y}h124l9 8h-142Z`} />
    </svg>
  );
}
