// The directions from the side: the half circle in the plane of azimuth 0. Sources and viewer in this plane are drawn
// on the half circle, all others inside it. They can be dragged along it, or moved with arrow keys.

import { type ComponentChildren } from "preact";

import { degrees, plain } from "../model/format.ts";
import { at, isTable, listAt, numberAt, textAt, type Json, type Table } from "../model/json.ts";
import { inPlane, mirrored, nearest, seen, sense, type Direction } from "../model/plane.ts";
import { answer, fields, selected, view } from "../state/design.ts";
import { chooseView, set } from "../state/live.ts";
import { Eye, Sun } from "./glyphs.tsx";
import { lightShares } from "../model/shares.ts";

export const CENTRE = { x: 230, y: 168 } as const;
const RADIUS = 140;

const point = (theta: number, radius = RADIUS): [number, number] => {
  const angle = (theta * Math.PI) / 180;
  return [CENTRE.x + radius * Math.sin(angle), CENTRE.y - radius * Math.cos(angle)];
};

/** Returns the position of a direction in the drawing. */
function place(direction: Direction, radius = RADIUS): [number, number] {
  const [right, up] = seen(direction);
  return [CENTRE.x + radius * right, CENTRE.y - radius * up];
}

/** Returns the path of a source's disc, from edge to edge along its inclination. */
function across({ theta, phi }: Direction, radius: number): string {
  const [from, to] = [Math.max(-90, theta - radius), Math.min(90, theta + radius)];
  const steps = Math.max(2, Math.ceil(to - from));
  const points = Array.from({ length: steps + 1 }, (_, i) => place({ theta: from + ((to - from) * i) / steps, phi }));
  return `M${points.map(([x, y]) => `${x.toFixed(2)} ${y.toFixed(2)}`).join("L")}`;
}

const arc = (from: number, to: number, radius = RADIUS): string => {
  const [x0, y0] = point(from, radius);
  const [x1, y1] = point(to, radius);
  return `M${x0.toFixed(2)} ${y0.toFixed(2)}A${radius} ${radius} 0 0 1 ${x1.toFixed(2)} ${y1.toFixed(2)}`;
};

/** Maximum inclination of sources and viewers that are dragged, degrees. */
export const STEEPEST = 89;

/** Returns the inclination at the pointer, at the azimuth of `from`, in steps of 0.5° (with Alt: 0.1°). */
function under(event: PointerEvent, from: Direction): number {
  const svg = (event.currentTarget as SVGElement).ownerSVGElement!;
  const to = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM()!.inverse());
  // Only the direction of the pointer from the centre is used, not its distance.
  const far = Math.hypot(to.x - CENTRE.x, to.y - CENTRE.y) || 1;
  const radius = inPlane(from) ? far : Math.max(far, RADIUS);
  const point = [(to.x - CENTRE.x) / radius, (CENTRE.y - to.y) / radius] as const;
  return nearest(point, from, event.altKey ? 0.1 : 0.5, STEEPEST);
}

const KEYS: Record<string, number> = { ArrowDown: -1, ArrowUp: 1, PageUp: 10, PageDown: -10 };
/** Keys that move to the left and to the right in the drawing, independent of the sign of the inclination. */
const SIDEWAYS: Record<string, number> = { ArrowLeft: -1, ArrowRight: 1 };

interface HandleProps extends Direction {
  path: string;
  name: string;
  children: ComponentChildren;
  select: string;
}

/** A half circle, or half ellipse, on which directions are drawn. */
export interface Arch {
  /** Returns the position of a direction. */
  place(direction: Direction): readonly [number, number];
  /** Returns the inclination at the pointer, at the azimuth of `from`. */
  under(event: PointerEvent, from: Direction): number;
  /** The attribute with the key of a handle. */
  readonly attribute: string;
}

const HALF_CIRCLE: Arch = { place, under, attribute: "data-handle" };

const Handle = (props: HandleProps) => <AngleHandle {...props} arch={HALF_CIRCLE} />;

/** A handle that is dragged along an arch. */
export function AngleHandle({ path, theta, phi, name, children, select, arch }: HandleProps & { arch: Arch }) {
  const move = (to: number) => set(path, Math.min(STEEPEST, Math.max(-STEEPEST, Number(to.toFixed(1)))));
  const drag = (event: PointerEvent) => {
    if ((event.currentTarget as Element).hasPointerCapture(event.pointerId)) move(arch.under(event, { theta, phi }));
  };
  const grab = (event: PointerEvent) => {
    selected.value = select;
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
  };
  const press = (event: KeyboardEvent) => {
    const sideways = SIDEWAYS[event.key];
    const by = sideways === undefined ? KEYS[event.key] : sideways * sense(phi);
    if (event.key === "Enter" || event.key === " ") selected.value = select;
    else if (event.key === "Home") move(-STEEPEST);
    else if (event.key === "End") move(STEEPEST);
    else if (by !== undefined) move(theta + by * (event.shiftKey ? 5 : 1));
    else return;
    event.preventDefault();
  };
  const [x, y] = arch.place({ theta, phi });
  return (
    <g
      class={selected.value === select ? "handle chosen" : "handle"}
      transform={`translate(${x.toFixed(2)} ${y.toFixed(2)})`}
      role="slider"
      tabindex={0}
      aria-label={`${name}, inclination`}
      aria-valuemin={-STEEPEST}
      aria-valuemax={STEEPEST}
      aria-valuenow={theta}
      aria-valuetext={`${theta} degrees`}
      {...{ [arch.attribute]: path }}
      onPointerDown={grab}
      onPointerMove={drag}
      onKeyDown={press}
    >
      <circle class="target" r="17" />
      {children}
    </g>
  );
}

/** Distance of a label from its handle, px of the drawing. */
const LABEL_DISTANCE = 21;
/** Labels further to a side than this are aligned at their start or end instead of their middle. */
const SIDE = Math.sin((20 * Math.PI) / 180);

/** The label of a handle, outside the half circle: its inclination, and its azimuth if it is not 0. */
function Tag({ theta, phi }: Direction) {
  const [right, up] = seen({ theta, phi });
  const far = 1 + LABEL_DISTANCE / RADIUS / (Math.hypot(right, up) || 1);
  const anchor = right < -SIDE ? "end" : right > SIDE ? "start" : "middle";
  return (
    <text class="tag" x={CENTRE.x + RADIUS * right * far} y={CENTRE.y - RADIUS * up * far + 4} text-anchor={anchor}>
      {degrees(theta)}
      {phi % 360 !== 0 && `, φ ${degrees(phi)}`}
    </text>
  );
}

/** The tooltip of a mirror image. */
const imageTitle = (direction: Direction): string =>
  `Direction of the mirror image${inPlane(direction) ? "" : ", in front of or behind the plane of the drawing"}`;

/** A directed source, with its mirror image. */
function Directed({ source, index }: { source: Table; index: number }) {
  const theta = Number(source["theta_deg"] ?? 0);
  const phi = Number(source["phi_deg"] ?? 0);
  const radius = Number(source["radius_deg"] ?? 0);
  const path = `lighting.directed.${index}`;
  const strength = Math.sqrt(Number(source["share"] ?? 0));
  const here = { theta, phi };
  const [x, y] = place(here, RADIUS - 18);
  const [mx, my] = place(mirrored(here));
  return (
    <>
      <path
        class="beam"
        d={`M${x} ${y}L${CENTRE.x} ${CENTRE.y}`}
        ref={(p) => p?.style.setProperty("opacity", String(0.25 + 0.75 * strength))}
      />
      <circle class="mirror" cx={mx} cy={my} r="5">
        <title>{imageTitle(here)}</title>
      </circle>
      {radius > 0 && <path class="disc" d={across(here, radius)} />}
      <Handle path={`${path}.theta_deg`} select={path} {...here} name={`Source ${index + 1}`}>
        <Sun />
      </Handle>
      <Tag {...here} />
    </>
  );
}

/**
 * Returns the direction of a sky's sun or of a luminaire in the coordinates of the display, which may be tilted: 0 is
 * horizontal, 90 vertical and facing azimuth -90.
 */
function discOf(source: Table): { theta: number; phi: number } | null {
  const n = (key: string) => ((numberAt(source, key) ?? 0) * Math.PI) / 180;
  const [elevation, azimuth] =
    source["model"] === "luminaire"
      ? [n("elevation_deg"), n("azimuth_deg")]
      : Number(source["sun_share"] ?? 0) > 0
        ? [n("sun_elevation_deg"), n("sun_azimuth_deg")]
        : [null, 0];
  if (elevation === null) return null;
  const tilt = n("tilt_deg");
  const [x, y, z] = [
    Math.cos(elevation) * Math.cos(azimuth),
    Math.cos(elevation) * Math.sin(azimuth),
    Math.sin(elevation),
  ];
  const [up, out] = [y * Math.cos(tilt) + z * Math.sin(tilt), z * Math.cos(tilt) - y * Math.sin(tilt)];
  return {
    theta: (Math.acos(Math.max(-1, Math.min(1, out))) * 180) / Math.PI,
    phi: (Math.atan2(up, x) * 180) / Math.PI,
  };
}

/** A disc that cannot be dragged, because its direction is given in other coordinates than the display's. */
function Disc({ source }: { source: Table }) {
  const disc = discOf(source);
  if (!disc || disc.theta > 90) return null;
  // In the plane of the drawing, a signed inclination is sufficient.
  const toLeft = sense(disc.phi) < 0;
  const here = inPlane(disc) ? { theta: toLeft ? -disc.theta : disc.theta, phi: 0 } : disc;
  const [x, y] = place(here);
  const [bx, by] = place(here, RADIUS - 18);
  return (
    <>
      <path class="beam" d={`M${bx} ${by}L${CENTRE.x} ${CENTRE.y}`} />
      <g class="fixed" transform={`translate(${x.toFixed(2)} ${y.toFixed(2)})`}>
        <Sun />
      </g>
      <Tag {...here} />
    </>
  );
}

/** An environment, drawn as the part of the half circle from which its light comes. */
function Environment({ source, index }: { source: Table; index: number }) {
  const path = `lighting.environment.${index}`;
  const model = textAt(source, "model") ?? "";
  const n = (key: string, other: number) => numberAt(source, key) ?? other;
  const [from, to] =
    model === "ring"
      ? [n("theta_deg", 35) - n("width_deg", 10) / 2, n("theta_deg", 35) + n("width_deg", 10) / 2]
      : model === "cap"
        ? [n("from_deg", 0), n("to_deg", 90)]
        : [0, 90];
  const choose = () => (selected.value = path);
  return (
    <g
      class={`surround of-${model} ${selected.value === path ? "chosen" : ""}`}
      role="button"
      tabindex={0}
      aria-label={`Environment (${model}), fraction of the light ${n("share", 0)}`}
      aria-pressed={selected.value === path}
      onClick={choose}
      onKeyDown={(event) => (event.key === "Enter" || event.key === " ") && choose()}
    >
      {model !== "luminaire" && (
        <path
          class="span"
          d={
            from <= 0
              ? arc(-to, to, RADIUS - 9 - 8 * index)
              : arc(-to, -from, RADIUS - 9 - 8 * index) + arc(from, to, RADIUS - 9 - 8 * index)
          }
        />
      )}
      <Disc source={source} />
    </g>
  );
}

/** Maximum number of angles of a range that are drawn. */
const MOST_ANGLES = 200;

/** Returns the angles at a key of the viewer (one, a list or a range), with the paths of those that can be dragged. */
function anglesAt(viewer: Json | undefined, key: string): { path: string | null; angle: number }[] {
  const angle = at(viewer, key);
  if (Array.isArray(angle)) return angle.map((value, i) => ({ path: `viewer.${key}.${i}`, angle: Number(value) }));
  if (!isTable(angle)) return [{ path: `viewer.${key}`, angle: Number(angle ?? 0) }];
  const [from, to, step] = ["from", "to", "step"].map((part) => Number(angle[part])) as [number, number, number];
  const count = step > 0 ? Math.min(MOST_ANGLES, Math.floor((to - from) / step + 1e-9)) + 1 : 1;
  // The ends of a range can be dragged.
  const end = (i: number): string | null => (i === 0 ? "from" : i === count - 1 ? "to" : null);
  return Array.from({ length: count }, (_, i) => {
    const of = end(i);
    return { path: of && `viewer.${key}.${of}`, angle: from + i * step };
  });
}

/** Returns the viewing directions; those at the first azimuth can be dragged. */
export function viewersOf(viewer: Json | undefined): (Direction & { path: string | null })[] {
  const inclinations = anglesAt(viewer, "theta_deg");
  return anglesAt(viewer, "phi_deg").flatMap(({ angle: phi }, turn) =>
    inclinations.map(({ path, angle: theta }) => ({ path: turn === 0 ? path : null, theta, phi })),
  );
}

/** Shows the view of a direction. */
function showDirection({ theta, phi }: Direction): void {
  const number = (answer.value?.views ?? []).findIndex(
    (one) => Math.abs(one.theta_deg - theta) < 1e-6 && Math.abs(one.phi_deg - phi) < 1e-6,
  );
  if (number >= 0) chooseView(number);
}

/** The scale of the half circle. */
function Scale() {
  const minor = Array.from({ length: 17 }, (_, i) => (i - 8) * 10);
  return (
    <g aria-hidden="true">
      <path class="rim" d={arc(-90, 90)} />
      {minor.map((angle) => {
        const [x0, y0] = point(angle, RADIUS);
        const [x1, y1] = point(angle, RADIUS - (angle % 30 === 0 ? 7 : 4));
        return <path key={angle} class="tick" d={`M${x0} ${y0}L${x1} ${y1}`} />;
      })}
      {[-60, -30, 0, 30, 60].map((angle) => {
        const [x, y] = point(angle, RADIUS - 16);
        return (
          <text key={angle} class="scale" x={x} y={y + 3.5} text-anchor="middle">
            {degrees(angle)}
          </text>
        );
      })}
    </g>
  );
}

export function Dome() {
  const all = fields.value;
  const diffuse = lightShares(all).get("lighting.diffuse") ?? 0;
  const viewers = viewersOf(at(all, "viewer"));
  const isShown = ({ theta, phi }: Direction): boolean =>
    view.value !== null &&
    Math.abs(theta - view.value.theta_deg) < 1e-6 &&
    Math.abs(phi - (view.value.phi_deg ?? phi)) < 1e-6;
  const choose = () => (selected.value = "lighting");
  return (
    <g class="dome">
      <g
        class={selected.value === "lighting" ? "diffuse chosen" : "diffuse"}
        role="button"
        tabindex={0}
        aria-pressed={selected.value === "lighting"}
        aria-label={`Diffuse light, fraction of the light ${plain(diffuse, 3)}`}
        onClick={choose}
        onKeyDown={(event) => (event.key === "Enter" || event.key === " ") && choose()}
      >
        <path class="sky" d={`${arc(-90, 90)}Z`} ref={(p) => p?.style.setProperty("--share", String(diffuse))} />
      </g>
      <Scale />
      {listAt(all, "lighting.environment").map((source, i) => (
        <Environment key={i} source={source as Table} index={i} />
      ))}
      {listAt(all, "lighting.directed").map((source, i) => (
        <Directed key={i} source={source as Table} index={i} />
      ))}
      {viewers.map(({ path, ...here }, i) => {
        const [x, y] = place(here, RADIUS - 16);
        const [dotX, dotY] = place(here);
        const now = isShown(here);
        return (
          <g key={i}>
            {now && <path class="sight" d={`M${CENTRE.x} ${CENTRE.y}L${x} ${y}`} />}
            {path ? (
              <Handle path={path} select="viewer" {...here} name={viewers.length > 1 ? `Viewer ${i + 1}` : "Viewer"}>
                <Eye />
              </Handle>
            ) : (
              <circle
                class={now ? "seen now" : "seen"}
                cx={dotX}
                cy={dotY}
                r={now ? 5 : 3}
                onClick={() => {
                  selected.value = "viewer";
                  showDirection(here);
                }}
              />
            )}
            {path && <Tag {...here} />}
          </g>
        );
      })}
    </g>
  );
}
