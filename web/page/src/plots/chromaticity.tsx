// The u'v' diagram: spectral locus, the gamuts of sRGB, EBU and the display, the states and the light. The gamut of the
// pinned design is dashed.

import { useComputed, useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import type { View } from "../api/types.ts";
import { hex, linearSrgb, type Triple } from "../model/colour.ts";
import { fixed, withError } from "../model/format.ts";
import { EBU, LOCUS, NAMED_NM, SRGB } from "../model/locus.ts";
import { LiveMark } from "../panels/aged.tsx";
import { Downloads } from "../panels/downloads.tsx";
import { result, showState, states, view } from "../state/design.ts";
import { highlighted, hovered, pointsAt } from "../state/hover.ts";
import { pinned, pinnedView } from "../state/pin.ts";
import { dark } from "../state/theme.ts";
import { useColours } from "./patches.tsx";
import { svgOf } from "./picture.ts";
import { LETTER, placed, type Box } from "./place.ts";

/** Scale in px per unit of u' and v', and position of the origin. */
const SCALE = 640;
const LEFT = 78;
const BOTTOM = 406;
const WIDTH = 496;
const HEIGHT = 444;

type Uv = readonly [number, number];
const x = (u: number): number => LEFT + SCALE * u;
const y = (v: number): number => BOTTOM - SCALE * v;
const path = (points: readonly Uv[], close = true): string =>
  points.map(([u, v], i) => `${i ? "L" : "M"}${x(u).toFixed(2)} ${y(v).toFixed(2)}`).join("") + (close ? "Z" : "");

const OUTLINE = path(LOCUS.map(([, u, v]) => [u, v]));

/** Returns the most luminous screen colour of a chromaticity, mixed with the background: fraction `tint` of the colour. */
function colourAt(u: number, v: number, tint: number, ground: number): string {
  const cx = (9 * u) / (6 * u - 16 * v + 12);
  const cy = (4 * v) / (6 * u - 16 * v + 12);
  const linear = linearSrgb([cx / cy, 1, (1 - cx - cy) / cy]).map((c) => Math.max(0, c));
  const most = Math.max(1e-9, ...linear);
  const mixed = linear.map((c) => ground * (1 - tint) + tint * (c / most) ** (1 / 2.2));
  return hex(mixed.map((c) => c ** 2.2) as unknown as Triple);
}

/** The tinted interior of the locus, drawn once for each theme. */
function Tint() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const night = dark.value;
  useEffect(() => {
    const context = canvas.current?.getContext("2d");
    if (!context) return;
    const ratio = 2;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, WIDTH, HEIGHT);
    context.save();
    context.clip(new Path2D(OUTLINE));
    const cell = 4;
    for (let px = LEFT; px < WIDTH; px += cell) {
      for (let py = 0; py < BOTTOM; py += cell) {
        const [u, v] = [(px + cell / 2 - LEFT) / SCALE, (BOTTOM - py - cell / 2) / SCALE];
        if (v <= 0.001) continue;
        context.fillStyle = colourAt(u, v, night ? 0.42 : 0.3, night ? 0.08 : 1);
        context.fillRect(px, py, cell + 0.5, cell + 0.5);
      }
    }
    context.restore();
  }, [night]);
  return <canvas ref={canvas} width={2 * WIDTH} height={2 * HEIGHT} aria-hidden="true" />;
}

/** The wavelength whose label has the unit: beside it, the diagram has the most room. */
const WITH_UNIT_NM = 440;
const wavelengthText = (nm: number): string => (nm === WITH_UNIT_NM ? `${nm} nm` : String(nm));

/** Returns the place of the label of a wavelength, outside the locus, and of its mark. */
function besideLocus(nm: number) {
  const i = LOCUS.findIndex(([at]) => at === nm);
  const [before, here, after] = [LOCUS[i - 1], LOCUS[i], LOCUS[i + 1]];
  if (!before || !here || !after) return null;
  const [dx, dy] = [x(after[1]) - x(before[1]), y(after[2]) - y(before[2])];
  const length = Math.hypot(dx, dy);
  const [ox, oy] = [dy / length, -dx / length];
  const [px, py] = [x(here[1]), y(here[2])];
  const anchor = ox < -0.5 ? "end" : ox > 0.5 ? "start" : "middle";
  return { mark: `M${px} ${py}L${px + 5 * ox} ${py + 5 * oy}`, x: px + 9 * ox, y: py + 9 * oy + 4 + 4 * oy, anchor };
}

function Wavelength({ nm }: { nm: number }) {
  const at = besideLocus(nm);
  return (
    at && (
      <>
        <path class="axis" d={at.mark} />
        <text class="scale" x={at.x} y={at.y} text-anchor={at.anchor}>
          {wavelengthText(nm)}
        </text>
      </>
    )
  );
}

/** Returns the box of the label of a wavelength, for text of `size` times the normal size. */
function boxOf(nm: number, size: number): Box[] {
  const at = besideLocus(nm);
  if (!at) return [];
  const width = wavelengthText(nm).length * LETTER * size;
  const left = at.x - (at.anchor === "end" ? width : at.anchor === "middle" ? width / 2 : 0);
  return [{ left, right: left + width, top: at.y - 10 * size, bottom: at.y }];
}

/** From this factor of the text on, wavelengths beside the axis have no labels: they would cover its numbers. */
const WIDE = 1.3;
const BESIDE_AXIS_NM = [490, 500];
const shownNm = (size: number): number[] => NAMED_NM.filter((nm) => size < WIDE || !BESIDE_AXIS_NM.includes(nm));

function Axes({ size }: { size: number }) {
  const [us, vs] = [
    [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
    [0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
  ];
  return (
    <g aria-hidden="true">
      {us.map((u) => (
        <path key={u} class="grid" d={`M${x(u)} ${y(0)}V${y(0.62)}`} />
      ))}
      {vs.map((v) => (
        <path key={v} class="grid" d={`M${x(0) - 34} ${y(v)}H${x(0.64)}`} />
      ))}
      <path class="axis" d={`M${x(0) - 34} ${y(0)}H${x(0.64)}`} />
      {us.map((u) => (
        <text key={u} class="scale" x={x(u)} y={y(0) + 17} text-anchor="middle">
          {u.toFixed(1)}
        </text>
      ))}
      {vs.slice(1).map((v) => (
        <text key={v} class="scale" x={x(0) - 40} y={y(v) + 4} text-anchor="end">
          {v.toFixed(1)}
        </text>
      ))}
      <text class="scale" x={x(0.35)} y={HEIGHT - 4} text-anchor="middle">
        u′
      </text>
      <text class="scale" x={6} y={y(0.35) + 4}>
        v′
      </text>
      {shownNm(size).map((nm) => (
        <Wavelength key={nm} nm={nm} />
      ))}
    </g>
  );
}

export function gamut(of: View | null): Uv[] | null {
  const corners = ["red", "green", "blue"].map((name): Uv | null => {
    const state = of?.states[name];
    return typeof state?.u_prime === "number" && typeof state.v_prime === "number"
      ? [state.u_prime, state.v_prime]
      : null;
  });
  return corners.every((corner) => corner !== null) ? (corners as Uv[]) : null;
}

/** Discs in the colours of the states with their names, and crosses for standard errors of visible size. */
function Marks({ size }: { size: number }) {
  const colours = useColours().value.colours;
  const light = result.value?.illuminant;
  const shown = states.value.flatMap(([name, s]) => {
    const [u, v] = [s.u_prime ?? NaN, s.v_prime ?? NaN];
    return Math.abs(u) < 0.7 && Math.abs(v) < 0.7 ? [{ name, u, v, se: s.standard_error }] : [];
  });
  const points = [
    ...(light ? [{ name: "light", x: x(light.u_prime), y: y(light.v_prime) }] : []),
    ...shown.map(({ name, u, v }) => ({ name, x: x(u), y: y(v) })),
  ];
  const names = placed(points, size, [WIDTH, HEIGHT], shownNm(size).flatMap((nm) => boxOf(nm, size)));
  return (
    <g>
      {light && <path class="light-mark" d={`M${x(light.u_prime) - 6} ${y(light.v_prime)}h12m-6 -6v12`} />}
      {shown.map(({ name, u, v, se }) => (
        <g key={name} class="state-mark" data-state={name} onClick={() => showState(name)} {...pointsAt(name)}>
          {SCALE * ((se.u_prime ?? 0) + (se.v_prime ?? 0)) > 2 && (
            <path
              class="se"
              d={`M${x(u - (se.u_prime ?? 0))} ${y(v)}H${x(u + (se.u_prime ?? 0))}M${x(u)} ${y(v - (se.v_prime ?? 0))}V${y(v + (se.v_prime ?? 0))}`}
            />
          )}
          <circle
            class={name === highlighted.value ? "mark chosen" : "mark"}
            cx={x(u)}
            cy={y(v)}
            r={name === hovered.value ? 9 : name === highlighted.value ? 7 : 6}
            fill={colours.get(name) ?? "#888888"}
          >
            <title>{`${name}: u′ ${fixed(u, 4)}, v′ ${fixed(v, 4)}`}</title>
          </circle>
        </g>
      ))}
      {names.map(({ name, x: nx, y: ny, anchor, from }) => (
        <g key={name} class={name === hovered.value ? "mark-name hovered" : "mark-name"}>
          {from && <path class="leader" d={`M${from[0]} ${from[1]}L${from[2]} ${from[3]}`} />}
          <text x={nx} y={ny} text-anchor={anchor}>
            {name}
          </text>
        </g>
      ))}
    </g>
  );
}

function Key({ size }: { size: number }) {
  const now = view.value;
  const [step, last] = [18 * size, gamut(pinnedView.value) ? 3 : 2];
  const top = Math.min(y(0.16), y(0.025) - step * last);
  const percent = (key: "gamut_percent_srgb" | "gamut_percent_ebu", of: string) =>
    typeof now?.[key] !== "number" ? of : `${withError(now[key], now.standard_error[key], 1)} % of ${of}`;
  const lines: readonly (readonly [text: string, kind: string, at: number])[] = [
    ...(gamut(now) ? [["display", "own", 0] as const] : []),
    [percent("gamut_percent_srgb", "sRGB"), "srgb", 1],
    [percent("gamut_percent_ebu", "EBU"), "ebu", 2],
    ...(gamut(pinnedView.value) ? [[`compared, ${fixed(pinnedView.value?.gamut_percent_srgb, 1)} %`, "pinned-line", 3] as const] : []),
  ];
  const longest = Math.max(...lines.map(([text]) => text.length));
  const left = Math.min(x(0.43) - 30 * size, WIDTH - 34 - LETTER * size * longest);
  const line = ([text, kind, at]: (typeof lines)[number]) => (
    <g transform={`translate(${left} ${top + step * at})`} key={kind}>
      <path class={kind} d="M0 -4H24" />
      <text class="key" x="31">
        {text}
      </text>
    </g>
  );
  return <g>{lines.map(line)}</g>;
}

/** Factors of the text of a small diagram: the largest, and that of its height on the screen. */
const LARGEST = 2.3;
const SMALLER = 0.88;

export function Chromaticity() {
  const own = useComputed(() => gamut(view.value));
  const before = useComputed(() => (pinned.value ? gamut(pinnedView.value) : null));
  const holder = useRef<HTMLDivElement>(null);
  const drawing = useRef<SVGSVGElement>(null);
  const size = useSignal(1);
  useEffect(() => {
    // The text stays readable if the diagram is small.
    const fit = () => {
      const { clientWidth, clientHeight } = holder.current ?? { clientWidth: WIDTH, clientHeight: HEIGHT };
      const scale = Math.min((clientWidth || WIDTH) / WIDTH, (clientHeight || HEIGHT) / HEIGHT);
      size.value = Math.min(LARGEST, Math.max(1, SMALLER / scale));
      holder.current?.style.setProperty("--size", size.value.toFixed(3));
    };
    const watch = new ResizeObserver(fit);
    if (holder.current) watch.observe(holder.current);
    return () => watch.disconnect();
  }, []);
  return (
    <figure class="chromaticity">
      <figcaption>
        <span>
          Chromaticity <small>u′v′, CIE 1976</small> <LiveMark />
        </span>
        <Downloads
          name="chromaticity"
          svg={() => svgOf(drawing.current!, holder.current!.querySelector("canvas"))}
          table={() => [
            ["state", "u_prime", "v_prime"],
            ...states.value.map(([name, state]) => [name, state.u_prime, state.v_prime]),
          ]}
        />
      </figcaption>
      <div class="canvas-room">
        <div class="canvas" ref={holder}>
          <Tint />
          <svg
            ref={drawing}
            viewBox={`0 0 ${WIDTH} ${HEIGHT}`}
            role="img"
            aria-label="u prime v prime diagram with the display's gamut; the numbers are in the table"
          >
            <Axes size={size.value} />
            <path class="locus" d={OUTLINE} />
            <path class="srgb" d={path(SRGB)} />
            <path class="ebu" d={path(EBU)} />
            {before.value && <path class="pinned-line" d={path(before.value)} />}
            {own.value && <path class="own" d={path(own.value)} />}
            <Marks size={size.value} />
            <Key size={size.value} />
          </svg>
        </div>
      </div>
    </figure>
  );
}
