// Conversion of XYZ to screen colours: complete adaptation (CAT16) from the white of the light to D65, then sRGB. The white of the screen
// represents a perfect white diffuser in the same light. One rule holds for patches and pictures: what is brighter than the screen can show is as
// bright as it can be with the same hue, and the page says so.

export type Triple = readonly [number, number, number];

const TO_CONES: readonly Triple[] = [
  [0.401288, 0.650173, -0.051461],
  [-0.250268, 1.204414, 0.045854],
  [-0.002079, 0.048952, 0.953127],
];
const FROM_CONES: readonly Triple[] = [
  [1.862068, -1.011255, 0.1491868],
  [0.3875265, 0.6214474, -0.008973985],
  [-0.0158415, -0.03412294, 1.049964],
];
const TO_SRGB: readonly Triple[] = [
  [3.2404542, -1.5371385, -0.4985314],
  [-0.969266, 1.8760108, 0.041556],
  [0.0556434, -0.2040259, 1.0572252],
];
const D65: Triple = [0.95047, 1, 1.08883];
/** Channels up to this value are shown without a note, because the clipping is invisible. */
export const CLIPPED = 1.005;

export const times = (matrix: readonly Triple[], [x, y, z]: Triple): Triple =>
  matrix.map((row) => row[0] * x + row[1] * y + row[2] * z) as unknown as Triple;

/** Converts XYZ, relative to D65, to linear sRGB without clipping. */
export const linearSrgb = (xyz: Triple): Triple => times(TO_SRGB, xyz);

/** Returns the matrix from XYZ in a light to linear sRGB: adaptation from the white of the light to D65, and a factor. */
export function screenMatrix(white: Triple, factor: number): readonly Triple[] {
  const [from, to] = [times(TO_CONES, white.map((value) => value / white[1]) as unknown as Triple), times(TO_CONES, D65)];
  const column = (unit: Triple): Triple => {
    const cones = times(TO_CONES, unit).map((cone, i) => (factor * cone * to[i]!) / from[i]!) as unknown as Triple;
    return linearSrgb(times(FROM_CONES, cones));
  };
  const [x, y, z] = [column([1, 0, 0]), column([0, 1, 0]), column([0, 0, 1])];
  return [0, 1, 2].map((row) => [x[row]!, y[row]!, z[row]!] as const);
}

/** Adapts XYZ from a light with the chromaticity x, y to D65. */
function adapted(xyz: Triple, [x, y]: readonly [number, number]): Triple {
  const white = times(TO_CONES, [x / y, 1, (1 - x - y) / y]);
  const target = times(TO_CONES, D65);
  const cones = times(TO_CONES, xyz);
  return times(FROM_CONES, cones.map((cone, i) => (cone * target[i]!) / white[i]!) as unknown as Triple);
}

/** Encodes a component of linear sRGB, with clipping. */
export const encoded = (linear: number): number => {
  const c = Math.min(1, Math.max(0, linear));
  return c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055;
};

/** Whether a colour is brighter than the screen can show. */
export const isClipped = (linear: Triple): boolean => Math.max(...linear) > CLIPPED;

/** Returns what the screen shows of linear sRGB: too bright colours keep their hue, components below 0 become 0. */
export function displayed([r, g, b]: Triple): Triple {
  const most = Math.max(1, r, g, b);
  return [Math.max(0, r) / most, Math.max(0, g) / most, Math.max(0, b) / most];
}

/** Converts linear sRGB to a hexadecimal colour, as the screen shows it. */
export const hex = (linear: Triple): string =>
  "#" +
  displayed(linear)
    .map((c) =>
      Math.round(255 * encoded(c))
        .toString(16)
        .padStart(2, "0"),
    )
    .join("");

/**
 * Returns the colours of states in one light, and whether each is brighter than the screen can show. A display that is lit only by its own
 * light is compared with its own white, of luminance `own`.
 */
export function painted(
  states: readonly Triple[],
  white: readonly [number, number],
  own: number | null = null,
): { colour: string; isClipped: boolean }[] {
  return states.map((xyz) => {
    const linear = linearSrgb(adapted(xyz, white)).map((part) => part / (own ?? 1)) as unknown as Triple;
    return { colour: hex(linear), isClipped: isClipped(linear) };
  });
}

/** Returns true for a colour on which dark text is more readable than light text. */
export function isLight(colour: string): boolean {
  const part = (at: number) => (parseInt(colour.slice(at, at + 2), 16) / 255) ** 2.2;
  return 0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5) > 0.25;
}
