// Figures of the page as files: SVG with its styles written out, and PNG.

/** Properties that the style sheets set on elements of a drawing. */
const STYLES = [
  "fill",
  "fill-opacity",
  "stroke",
  "stroke-width",
  "stroke-dasharray",
  "stroke-linejoin",
  "stroke-linecap",
  "opacity",
  "font-size",
  "font-weight",
  "font-family",
  "text-anchor",
  "paint-order",
];

/** Returns a drawing of the page as a file of its own; `below` is drawn behind it over the whole area. */
export function svgOf(drawing: SVGSVGElement, below: HTMLCanvasElement | null = null): string {
  const copy = drawing.cloneNode(true) as SVGSVGElement;
  const originals = [drawing, ...drawing.querySelectorAll("*")];
  [copy, ...copy.querySelectorAll("*")].forEach((element, i) => {
    const style = getComputedStyle(originals[i]!);
    if (element.closest("defs") && element.tagName !== "circle") return;
    for (const name of STYLES) element.setAttribute(name, style.getPropertyValue(name));
    for (const name of ["class", "style", "tabindex", "role", "data-part", "data-handle"])
      element.removeAttribute(name);
  });
  const { x, y, width, height } = drawing.viewBox.baseVal;
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", String(width));
  copy.setAttribute("height", String(height));
  const behind = (tag: string, attributes: Record<string, string>): void => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    const place = { x: String(x), y: String(y), width: String(width), height: String(height) };
    for (const [name, value] of Object.entries({ ...place, ...attributes })) element.setAttribute(name, value);
    copy.prepend(element);
  };
  if (below) behind("image", { href: below.toDataURL("image/png") });
  behind("rect", { fill: getComputedStyle(document.documentElement).getPropertyValue("--panel").trim() || "#ffffff" });
  return new XMLSerializer().serializeToString(copy);
}

/** Pixels of a PNG per unit of the drawing. */
const SCALE = 2;

/** Converts an SVG to PNG. */
export async function pngOf(svg: string): Promise<Blob> {
  const address = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  try {
    const image = new Image();
    image.src = address;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [SCALE * image.naturalWidth, SCALE * image.naturalHeight];
    const context = canvas.getContext("2d");
    if (!context) throw new Error("The browser cannot draw a PNG.");
    context.drawImage(image, 0, 0, canvas.width, canvas.height);
    return await new Promise((resolve, reject) =>
      canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("The browser cannot draw a PNG.")))),
    );
  } finally {
    URL.revokeObjectURL(address);
  }
}
