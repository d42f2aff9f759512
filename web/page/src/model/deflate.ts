// Raw deflate streams, by the browser, with a limit of the length that comes out.

/** Bytes that are passed on at a time: deflate makes at most 1032 times as many of them. */
const PIECE = 1 << 14;

/** Thrown for a stream that is longer than expected. */
export class TooLong extends Error {}

const inPieces = (bytes: Uint8Array): ReadableStream<Uint8Array> => {
  let at = 0;
  return new ReadableStream({
    pull(controller) {
      if (at >= bytes.length) return controller.close();
      controller.enqueue(bytes.subarray(at, at + PIECE));
      at += PIECE;
    },
  });
};

async function through(bytes: Uint8Array, stream: GenericTransformStream, longest: number): Promise<Uint8Array> {
  const parts: Uint8Array[] = [];
  let length = 0;
  const reader = (inPieces(bytes).pipeThrough(stream) as ReadableStream<Uint8Array>).getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > longest) {
      void reader.cancel().catch(() => undefined);
      throw new TooLong();
    }
    parts.push(value);
  }
  const whole = new Uint8Array(length);
  parts.reduce((at, part) => (whole.set(part, at), at + part.length), 0);
  return whole;
}

export const deflated = (bytes: Uint8Array): Promise<Uint8Array> =>
  through(bytes, new CompressionStream("deflate-raw"), Infinity);

/** Returns at most `longest` bytes; throws TooLong for more, and another error for bytes that are no such stream. */
export const inflated = (bytes: Uint8Array, longest: number): Promise<Uint8Array> =>
  through(bytes, new DecompressionStream("deflate-raw"), longest);
