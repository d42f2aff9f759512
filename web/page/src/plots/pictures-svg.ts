// Pictures of the page with their captions, as one figure.

import { escaped } from "./curves-svg.ts";

export interface Captioned {
  readonly canvas: Pick<HTMLCanvasElement, "width" | "height" | "toDataURL">;
  readonly title: string;
  readonly words: string;
}

/** Distance between pictures, height of a caption, and the number of columns. */
const [GAP, CAPTION, COLUMNS] = [16, 44, 2];

/** Returns a figure of all pictures, in rows of two; all have the size of the first one. */
export function picturesSvg(heading: string, pictures: readonly Captioned[]): string {
  const { width: w, height: h } = pictures[0]?.canvas ?? { width: 400, height: 300 };
  const columns = Math.max(1, Math.min(COLUMNS, pictures.length));
  const [width, top] = [columns * w + (columns + 1) * GAP, 44];
  const height = top + Math.ceil(pictures.length / columns) * (h + CAPTION);
  const shown = pictures.map(({ canvas, title, words }, i) => {
    const [x, y] = [GAP + (i % columns) * (w + GAP), top + Math.floor(i / columns) * (h + CAPTION)];
    return (
      `<image x="${x}" y="${y}" width="${w}" height="${h}" href="${canvas.toDataURL("image/png")}"/>` +
      `<text x="${x}" y="${y + h + 20}"><tspan font-weight="700">${escaped(title)}</tspan> ${escaped(words)}</text>`
    );
  });
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="Roboto, Helvetica, Arial, sans-serif" font-size="14" fill="#1c1f23">`,
    `<rect width="${width}" height="${height}" fill="#ffffff"/>`,
    `<text x="${GAP}" y="28" font-size="17" font-weight="700">${escaped(heading)}</text>`,
    ...shown,
    "</svg>",
  ].join("\n");
}
