// Figures of the program in the dark theme: its ground, text, axes and dark lines are drawn in other colours on the page. What is saved is the
// program's own figure.

/** Ground and ink of the dark theme. */
const GROUND = 0x1d;
const INK = 0xe4;
/** Lines darker than this (relative luminance) are mixed with white. */
const DARK = 0.2;
const MIXED = 0.45;

const parts = (colour: string): [number, number, number] =>
  [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16)) as [number, number, number];

const hexOf = (rgb: readonly number[]): string => `#${rgb.map((one) => Math.round(one).toString(16).padStart(2, "0")).join("")}`;

/** Returns a colour of text, axes or lines in the dark theme: greys are exchanged, dark colours are lighter. */
export function inDark(colour: string): string {
  const [r, g, b] = parts(colour);
  if (r === g && g === b) return hexOf(Array(3).fill(INK + ((GROUND - INK) * r) / 255));
  const luminance = (0.2126 * r + 0.7152 * g + 0.0722 * b) / 255;
  return luminance < DARK ? hexOf([r, g, b].map((one) => one + MIXED * (255 - one))) : colour;
}

/** Returns an SVG figure of the program for the dark theme. Areas keep their colours, which are those of displays. */
export function darkFigure(svg: string): string {
  let isGround = true;
  return svg.replace(/<(\w+)\b[^>]*>/g, (element, name: string) => {
    const lines = element.replace(/\bstroke="(#[0-9a-fA-F]{6})"/g, (_, colour: string) => `stroke="${inDark(colour)}"`);
    const isText = name === "text" || name === "tspan";
    const isFirst = name === "rect" && isGround;
    if (name === "rect") isGround = false;
    return isText || isFirst
      ? lines.replace(/\bfill="(#[0-9a-fA-F]{6})"/g, (_, colour: string) => `fill="${inDark(colour)}"`)
      : lines;
  });
}
