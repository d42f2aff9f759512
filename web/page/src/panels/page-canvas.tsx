// A page on the display as an eye sees it that is adapted to its light: a picture that the server has computed, without handles.

import { useEffect, useRef } from "preact/hooks";

import { digits, plain, thousands } from "../model/format.ts";
import { camera, fitting, type Tilt } from "../model/perspective.ts";
import { exposure, type Seen } from "../model/seen.ts";
import { onCanvas } from "../plots/seen-2d.ts";

/** Distance of the eye, in widths of the display. */
const DISTANCE = 4;

export function PageCanvas({ seen, tilt, label }: { seen: Seen | null | undefined; tilt: Tilt; label: string }) {
  const ref = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const canvas = ref.current;
    if (!canvas || !seen) return;
    const factors = seen.head.lights.map(() => 1);
    const { matrix } = exposure(seen, factors, 0, "perfect", "paper");
    const [height, size] = [seen.size[1] / seen.size[0], [canvas.width, canvas.height] as const];
    onCanvas(canvas).draw({
      lit: { picture: seen, factors, added: [0, 0, 0], matrix },
      camera: camera(tilt, DISTANCE, height),
      frame: { canvas: size, scale: fitting(size, height), middle: [0, 0] },
      mirrors: [],
      veils: [],
      subPixels: null,
    });
  }, [seen]);
  return <canvas ref={ref} width={400} height={300} role="img" aria-label={label} />;
}

/** Illuminance, and white and contrast of pages of the states, as in the head of the picture. */
export function pageInWords({ head: { illuminance_lx, states, colours } }: Seen): string {
  const lux = `${thousands(plain(illuminance_lx, 4))} lx`;
  const [white, black] = ["white", "black"].map((name) => colours[states.indexOf(name)]?.[1]);
  if (!white || !black) return lux;
  return `${lux}, white Y ${digits(100 * white, 3)} %, contrast ${digits(white / black, 3)} : 1`;
}
