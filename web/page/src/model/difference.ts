// The colour difference CIEDE2000 (ISO/CIE 11664-6:2014; Sharma, Wu, Dalal, Color Res. Appl. 30, 21 (2005)).

export type Lab = readonly [number, number, number];

const RADIANS = Math.PI / 180;
const power7 = (c: number): number => Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7));
const hue = (b: number, a: number): number => (a === 0 && b === 0 ? 0 : (Math.atan2(b, a) / RADIANS + 360) % 360);

/** Returns the difference of two hues and their mean; 0 and the sum if one of the colours is grey. */
function hues(h1: number, h2: number, grey: boolean): [difference: number, mean: number] {
  if (grey) return [0, h1 + h2];
  const d = h2 - h1;
  const apart = Math.abs(d) > 180;
  const difference = apart ? d - Math.sign(d) * 360 : d;
  const mean = apart ? (h1 + h2 + (h1 + h2 < 360 ? 360 : -360)) / 2 : (h1 + h2) / 2;
  return [difference, mean];
}

export function deltaE2000([L1, a1, b1]: Lab, [L2, a2, b2]: Lab): number {
  const G = 0.5 * (1 - power7((Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2));
  const [x1, x2] = [(1 + G) * a1, (1 + G) * a2];
  const [C1, C2] = [Math.hypot(x1, b1), Math.hypot(x2, b2)];
  const [dh, h] = hues(hue(b1, x1), hue(b2, x2), C1 * C2 === 0);
  const dH = 2 * Math.sqrt(C1 * C2) * Math.sin((dh / 2) * RADIANS);
  const [L, C] = [(L1 + L2) / 2, (C1 + C2) / 2];
  const cos = (degrees: number) => Math.cos(degrees * RADIANS);
  const T = 1 - 0.17 * cos(h - 30) + 0.24 * cos(2 * h) + 0.32 * cos(3 * h + 6) - 0.2 * cos(4 * h - 63);
  const SL = 1 + (0.015 * (L - 50) ** 2) / Math.sqrt(20 + (L - 50) ** 2);
  const [SC, SH] = [1 + 0.045 * C, 1 + 0.015 * C * T];
  const RT = -Math.sin(60 * Math.exp(-(((h - 275) / 25) ** 2)) * RADIANS) * 2 * power7(C);
  const [l, c, g] = [(L2 - L1) / SL, (C2 - C1) / SC, dH / SH];
  return Math.sqrt(l * l + c * c + g * g + RT * c * g);
}
