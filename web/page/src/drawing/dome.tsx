// The room as the display sees it: the half circle of directions in the plane of view, with the lights and
// the viewer on it. They are dragged along it, or moved by arrow keys.

import { type ComponentChildren } from "preact";

import { degrees, plain } from "../model/format.ts";
import { at, isTable, listAt, numberAt, textAt, type Json, type Table } from "../model/json.ts";
import { fields, selected, view } from "../state/design.ts";
import { set } from "../state/live.ts";
import { Eye, Sun } from "./glyphs.tsx";
import { lightShares } from "../model/shares.ts";

export const CENTRE = { x: 230, y: 168 } as const;
const RADIUS = 140;

const point = (theta: number, radius = RADIUS): [number, number] => {
  const angle = (theta * Math.PI) / 180;
  return [CENTRE.x + radius * Math.sin(angle), CENTRE.y - radius * Math.cos(angle)];
};

const arc = (from: number, to: number, radius = RADIUS): string => {
  const [x0, y0] = point(from, radius);
  const [x1, y1] = point(to, radius);
  return `M${x0.toFixed(2)} ${y0.toFixed(2)}A${radius} ${radius} 0 0 1 ${x1.toFixed(2)} ${y1.toFixed(2)}`;
};

/** The inclination under the pointer, in steps of half a degree (Alt: of a tenth). */
function under(event: PointerEvent): number {
  const svg = (event.currentTarget as SVGElement).ownerSVGElement!;
  const to = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM()!.inverse());
  const angle = (Math.atan2(to.x - CENTRE.x, CENTRE.y - to.y) * 180) / Math.PI;
  const step = event.altKey ? 0.1 : 0.5;
  return Math.min(89, Math.max(-89, Number((Math.round(angle / step) * step).toFixed(1))));
}

const KEYS: Record<string, number> = {
  ArrowLeft: -1,
  ArrowDown: -1,
  ArrowRight: 1,
  ArrowUp: 1,
  PageUp: 10,
  PageDown: -10,
};

/** Something that is dragged along the half circle. */
function Handle({
  path,
  theta,
  name,
  children,
  select,
}: {
  path: string;
  theta: number;
  name: string;
  children: ComponentChildren;
  select: string;
}) {
  const move = (to: number) => set(path, Math.min(89, Math.max(-89, Number(to.toFixed(1)))));
  const drag = (event: PointerEvent) => {
    if ((event.currentTarget as Element).hasPointerCapture(event.pointerId)) move(under(event));
  };
  const grab = (event: PointerEvent) => {
    selected.value = select;
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
  };
  const press = (event: KeyboardEvent) => {
    const by = KEYS[event.key];
    if (event.key === "Enter" || event.key === " ") selected.value = select;
    else if (event.key === "Home") move(-89);
    else if (event.key === "End") move(89);
    else if (by !== undefined) move(theta + by * (event.shiftKey ? 5 : 1));
    else return;
    event.preventDefault();
  };
  const [x, y] = point(theta);
  return (
    <g
      class={selected.value === select ? "handle chosen" : "handle"}
      transform={`translate(${x.toFixed(2)} ${y.toFixed(2)})`}
      role="slider"
      tabindex={0}
      aria-label={`${name}, inclination`}
      aria-valuemin={-89}
      aria-valuemax={89}
      aria-valuenow={theta}
      aria-valuetext={`${theta} degrees`}
      data-handle={path}
      onPointerDown={grab}
      onPointerMove={drag}
      onKeyDown={press}
      onFocus={() => (selected.value = select)}
    >
      <circle class="target" r="17" />
      {children}
    </g>
  );
}

/** The label of a handle, outside the half circle. */
function Tag({ theta, text, radius = RADIUS + 21 }: { theta: number; text: string; radius?: number }) {
  const [x, y] = point(theta, radius);
  const anchor = theta < -20 ? "end" : theta > 20 ? "start" : "middle";
  return (
    <text class="tag" x={x} y={y + 4} text-anchor={anchor}>
      {text}
    </text>
  );
}

/** A source in its own plane; the plane of drawing is phi = 0. */
function Directed({ source, index }: { source: Table; index: number }) {
  const theta = Number(source["theta_deg"] ?? 0);
  const phi = Number(source["phi_deg"] ?? 0);
  const radius = Number(source["radius_deg"] ?? 0);
  const path = `lighting.directed.${index}`;
  const strength = Math.sqrt(Number(source["share"] ?? 0));
  const turned = phi % 360 === 0 ? "" : `, φ ${degrees(phi)}`;
  const [x, y] = point(theta, RADIUS - 18);
  const [mx, my] = point(-theta);
  return (
    <>
      <path
        class="beam"
        d={`M${x} ${y}L${CENTRE.x} ${CENTRE.y}`}
        ref={(p) => p?.style.setProperty("opacity", String(0.25 + 0.75 * strength))}
      />
      <circle class="mirror" cx={mx} cy={my} r="5">
        <title>Its mirror image is seen from here</title>
      </circle>
      {radius > 0 && <path class="disc" d={arc(Math.max(-90, theta - radius), Math.min(90, theta + radius))} />}
      <Handle path={`${path}.theta_deg`} select={path} theta={theta} name={`Light ${index + 1}`}>
        <Sun />
      </Handle>
      <Tag theta={theta} text={`${degrees(theta)}${turned}`} />
    </>
  );
}

/**
 * Where the disc of a sky's sun, or a luminaire, is seen from a display of some tilt: 0 lies flat, 90 stands
 * upright and faces azimuth -90.
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

/** A disc that is not dragged: its place is told by other angles than the display's. */
function Disc({ source }: { source: Table }) {
  const disc = discOf(source);
  if (!disc || disc.theta > 90) return null;
  const theta = Math.abs(disc.phi) > 90 ? -disc.theta : disc.theta;
  const [x, y] = point(theta);
  const [bx, by] = point(theta, RADIUS - 18);
  const inPlane = Math.abs(Math.sin((disc.phi * Math.PI) / 180)) < 0.02;
  return (
    <>
      <path class="beam" d={`M${bx} ${by}L${CENTRE.x} ${CENTRE.y}`} />
      <g class="fixed" transform={`translate(${x.toFixed(2)} ${y.toFixed(2)})`}>
        <Sun />
      </g>
      <Tag theta={theta} text={`${degrees(theta)}${inPlane ? "" : `, φ ${degrees(disc.phi)}`}`} />
    </>
  );
}

/** Light from many directions, as the part of the half circle that it comes from. */
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
      aria-label={`${model} light, share ${n("share", 0)}`}
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

/** The viewer's inclinations: one, a list, or those of a range. */
function inclinations(viewer: Json | undefined): { path: string | null; theta: number }[] {
  const theta = at(viewer, "theta_deg");
  if (Array.isArray(theta)) return theta.map((value, i) => ({ path: `viewer.theta_deg.${i}`, theta: Number(value) }));
  if (!isTable(theta)) return [{ path: "viewer.theta_deg", theta: Number(theta ?? 0) }];
  const [from, to, step] = ["from", "to", "step"].map((key) => Number(theta[key])) as [number, number, number];
  const count = step > 0 ? Math.min(200, Math.floor((to - from) / step + 1e-9)) + 1 : 1;
  return Array.from({ length: count }, (_, i) => ({ path: null, theta: from + i * step }));
}

/** Rings of 30 deg, and the angles of the half circle. */
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
  const viewers = inclinations(at(all, "viewer"));
  const shown = view.value?.theta_deg;
  const choose = () => (selected.value = "lighting");
  return (
    <g class="dome">
      <g
        class={selected.value === "lighting" ? "diffuse chosen" : "diffuse"}
        role="button"
        tabindex={0}
        aria-pressed={selected.value === "lighting"}
        aria-label={`Diffuse light, share ${plain(diffuse, 3)}`}
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
      {viewers.map(({ path, theta }, i) => {
        const [x, y] = point(theta, RADIUS - 16);
        const now = shown !== undefined && Math.abs(theta - shown) < 1e-6;
        return (
          <g key={i}>
            {now && <path class="sight" d={`M${CENTRE.x} ${CENTRE.y}L${x} ${y}`} />}
            {path ? (
              <Handle
                path={path}
                select="viewer"
                theta={theta}
                name={viewers.length > 1 ? `Viewer ${i + 1}` : "Viewer"}
              >
                <Eye />
              </Handle>
            ) : (
              <circle
                class={now ? "seen now" : "seen"}
                cx={point(theta)[0]}
                cy={point(theta)[1]}
                r={now ? 5 : 3}
                onClick={() => (selected.value = "viewer")}
              />
            )}
            {path && <Tag theta={theta} text={degrees(theta)} />}
          </g>
        );
      })}
    </g>
  );
}
