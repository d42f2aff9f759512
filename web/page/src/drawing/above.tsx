// The directions from above: the inclination is the radius, the azimuth the angle. Sources and viewer can be dragged
// to any direction, or moved with arrow keys (up and down: inclination; left and right: azimuth).

import type { ComponentChildren } from "preact";

import { degrees } from "../model/format.ts";
import { at, isTable, listAt, numberAt, type Json } from "../model/json.ts";
import { fields, selected } from "../state/design.ts";
import { mirrored, type Direction } from "../model/plane.ts";
import { edit } from "../state/live.ts";
import { CENTRE } from "./dome.tsx";
import { Eye, Sun } from "./glyphs.tsx";

const RADIUS = 98;
const MIDDLE = { x: CENTRE.x, y: 124 } as const;
/** Height of the view from above, px of the drawing. */
export const ABOVE_HEIGHT = 250;
const STEEPEST = 89;
/** Directions closer than this to the plane of the drawing, azimuth 0, are moved into it, degrees. */
const IN_PLANE_DEG = 3;

function point({ theta, phi }: Direction): [number, number] {
  const angle = (phi * Math.PI) / 180;
  const radius = (RADIUS * theta) / 90;
  return [MIDDLE.x + radius * Math.cos(angle), MIDDLE.y - radius * Math.sin(angle)];
}

/** Converts a direction to the form of scenarios: a signed inclination in the plane of azimuth 0. */
function normalised(theta: number, phi: number): Direction {
  const steep = Math.min(STEEPEST, theta);
  const turned = ((((phi + 180) % 360) + 360) % 360) - 180;
  if (Math.abs(turned) < IN_PLANE_DEG) return { theta: steep, phi: 0 };
  if (Math.abs(turned) > 180 - IN_PLANE_DEG) return { theta: -steep, phi: 0 };
  return { theta: steep, phi: turned };
}

function under(event: PointerEvent): Direction {
  const svg = (event.currentTarget as SVGElement).ownerSVGElement!;
  const to = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM()!.inverse());
  const [dx, dy] = [to.x - MIDDLE.x, MIDDLE.y - to.y];
  return normalised(
    Math.round((180 * Math.hypot(dx, dy)) / RADIUS) / 2,
    Math.round((Math.atan2(dy, dx) * 180) / Math.PI),
  );
}

/** A handle that is dragged over the hemisphere; `path` is its table. */
function Handle({
  path,
  theta,
  phi,
  name,
  children,
}: Direction & { path: string; name: string; children: ComponentChildren }) {
  const move = (to: Direction) =>
    edit([
      { op: "set", path: `${path}.theta_deg`, value: to.theta },
      { op: "set", path: `${path}.phi_deg`, value: to.phi },
    ]);
  const grab = (event: PointerEvent) => {
    selected.value = path;
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
  };
  const drag = (event: PointerEvent) =>
    (event.currentTarget as Element).hasPointerCapture(event.pointerId) && move(under(event));
  const press = (event: KeyboardEvent) => {
    const size = event.shiftKey ? 5 : 1;
    const steps: Record<string, Direction> = {
      ArrowUp: { theta: theta + size, phi },
      ArrowDown: { theta: theta - size, phi },
      ArrowLeft: { theta, phi: phi + 5 * size },
      ArrowRight: { theta, phi: phi - 5 * size },
    };
    if (event.key === "Enter" || event.key === " ") {
      selected.value = path;
      event.preventDefault();
    }
    const to = steps[event.key];
    if (!to) return;
    move({ theta: Math.max(-STEEPEST, Math.min(STEEPEST, to.theta)), phi: to.phi });
    event.preventDefault();
  };
  const [x, y] = point({ theta, phi });
  return (
    <g
      class={selected.value === path ? "handle chosen" : "handle"}
      transform={`translate(${x.toFixed(2)} ${y.toFixed(2)})`}
      role="slider"
      tabindex={0}
      aria-label={`${name}, inclination; left and right arrows change the azimuth`}
      aria-valuemin={-STEEPEST}
      aria-valuemax={STEEPEST}
      aria-valuenow={theta}
      aria-valuetext={`${theta} degrees, azimuth ${phi} degrees`}
      data-handle={`${path}.direction`}
      onPointerDown={grab}
      onPointerMove={drag}
      onKeyDown={press}
    >
      <circle class="target" r="17" />
      {children}
    </g>
  );
}

function Rings() {
  return (
    <g aria-hidden="true">
      <circle class="sky" cx={MIDDLE.x} cy={MIDDLE.y} r={RADIUS} />
      {[30, 60, 90].map((theta) => (
        <circle key={theta} class="rim" cx={MIDDLE.x} cy={MIDDLE.y} r={(RADIUS * theta) / 90} />
      ))}
      {[0, 90, 180, 270].map((phi) => {
        const [x, y] = point({ theta: 90, phi });
        const [tx, ty] = point({ theta: 104, phi });
        return (
          <g key={phi}>
            <path class="tick" d={`M${MIDDLE.x} ${MIDDLE.y}L${x} ${y}`} />
            <text class="scale" x={tx} y={ty + 4} text-anchor={phi === 0 ? "start" : phi === 180 ? "end" : "middle"}>
              {degrees(phi)}
            </text>
          </g>
        );
      })}
      {[30, 60].map((theta) => {
        const [x, y] = point({ theta, phi: 225 });
        return (
          <text key={theta} class="scale" x={x - 3} y={y + 11} text-anchor="end">
            {degrees(theta)}
          </text>
        );
      })}
    </g>
  );
}

export function Above() {
  const viewer = at(fields.value, "viewer") as Json | undefined;
  const [theta, phi] = [numberAt(viewer, "theta_deg"), numberAt(viewer, "phi_deg") ?? 0];
  return (
    <g class="dome">
      <Rings />
      {listAt(fields.value, "lighting.directed").map((source, i) => {
        const from = { theta: numberAt(source, "theta_deg") ?? 0, phi: numberAt(source, "phi_deg") ?? 0 };
        const [mx, my] = point(mirrored(from));
        return (
          isTable(source) && (
            <g key={i}>
              <circle class="mirror" cx={mx} cy={my} r="5">
                <title>Direction of the mirror image</title>
              </circle>
              <Handle path={`lighting.directed.${i}`} name={`Source ${i + 1}`} {...from}>
                <Sun />
              </Handle>
            </g>
          )
        );
      })}
      {theta !== undefined ? (
        <Handle path="viewer" name="Viewer" theta={theta} phi={phi}>
          <Eye />
        </Handle>
      ) : (
        <text class="scale" x={MIDDLE.x} y={ABOVE_HEIGHT - 2} text-anchor="middle">
          several views: move them in the side view or with their fields
        </text>
      )}
    </g>
  );
}
