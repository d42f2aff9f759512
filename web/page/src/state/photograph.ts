// Photographs with more pixels than the server reads: the browser reduces them before they are sent.

/** Largest number of pixels that the server reads, and that of a reduced picture. */
const MOST_PIXELS = 16_000_000;
const REDUCED_PIXELS = 12_000_000;
/** Quality of a reduced JPEG picture. */
const QUALITY = 0.95;

export interface Size {
  readonly columns: number;
  readonly rows: number;
  /** Bits of a channel. */
  readonly bits: number;
}

/** Returns the size of a PNG or JPEG picture from its first bytes; null if it is not there. */
export function sizeOf(bytes: DataView): Size | null {
  if (bytes.byteLength > 25 && bytes.getUint32(0) === 0x89504e47)
    return { columns: bytes.getUint32(16), rows: bytes.getUint32(20), bits: bytes.getUint8(24) };
  if (bytes.byteLength < 4 || bytes.getUint16(0) !== 0xffd8) return null;
  for (let at = 2; at + 9 < bytes.byteLength; at += 2 + bytes.getUint16(at + 2)) {
    const marker = bytes.getUint16(at);
    if (marker >> 8 !== 0xff) return null;
    // The frame: all kinds but tables (C4, C8, CC).
    const isFrame = marker >= 0xffc0 && marker <= 0xffcf && ![0xffc4, 0xffc8, 0xffcc].includes(marker);
    if (isFrame) return { columns: bytes.getUint16(at + 7), rows: bytes.getUint16(at + 5), bits: bytes.getUint8(at + 4) };
  }
  return null;
}

/** Bytes in which the size of a JPEG picture is: after its thumbnails. */
const HEAD = 1 << 20;

/** Returns a picture that the server reads, and what was done as a sentence, or "". Heights, pictures of 16 bits, stay as they are. */
export async function readable(file: File): Promise<readonly [Blob, string]> {
  const size = sizeOf(new DataView(await file.slice(0, HEAD).arrayBuffer()));
  const pixels = size ? size.columns * size.rows : 0;
  if (pixels <= MOST_PIXELS || size!.bits > 8) return [file, ""];
  try {
    const whole = await createImageBitmap(file);
    const scale = Math.sqrt(REDUCED_PIXELS / (whole.width * whole.height));
    const [columns, rows] = [whole.width, whole.height].map((length) => Math.max(1, Math.floor(length * scale))) as [number, number];
    const canvas = new OffscreenCanvas(columns, rows);
    const context = canvas.getContext("2d")!;
    context.imageSmoothingQuality = "high";
    context.drawImage(whole, 0, 0, columns, rows);
    whole.close();
    const reduced = await canvas.convertToBlob({ type: file.type, quality: QUALITY });
    const words = `${file.name} has ${Math.round(pixels / 1e6)} megapixels, more than Papilio reads: it was reduced to ${columns} × ${rows} pixels.`;
    return [reduced, words];
  } catch {
    // What the browser cannot decode is refused by the server, with its reason.
    return [file, ""];
  }
}
