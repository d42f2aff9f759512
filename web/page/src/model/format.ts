// Numbers as text: fixed decimals, standard errors with ±, a dash for a missing number.

export const NONE = "–";

const finite = (value: number | null | undefined): value is number =>
  typeof value === "number" && Number.isFinite(value);

/** Formats a number with fixed decimals and a typographic minus sign. */
export function fixed(value: number | null | undefined, decimals: number): string {
  if (!finite(value)) return NONE;
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/** Formats an error with ±; empty if it is below half a unit of the last decimal. */
export function error(value: number | null | undefined, decimals: number): string {
  return finite(value) && value >= 0.5 * 10 ** -decimals ? `± ${value.toFixed(decimals)}` : "";
}

/** Formats a number with its error, if the decimals show the error. */
export function withError(value: number | null | undefined, se: number | null | undefined, decimals: number): string {
  const seen = error(se, decimals);
  return seen && finite(value) ? `${fixed(value, decimals)} ${seen}` : fixed(value, decimals);
}

/** Formats a difference with its sign. */
export function signed(value: number | null | undefined, decimals: number): string {
  if (!finite(value)) return NONE;
  const text = fixed(value, decimals);
  return Number(value.toFixed(decimals)) > 0 ? `+${text}` : text;
}

/** Formats a number with significant digits, if possible without a power of ten. */
export function digits(value: number | null | undefined, count: number): string {
  if (!finite(value)) return NONE;
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -5 || size > 6) return plain(value, count);
  return fixed(value, Math.max(0, count - 1 - size));
}

/** Formats a number as in a field, without trailing zeros. */
export function plain(value: number, count = 6): string {
  const text = String(Number(value.toPrecision(count)));
  return text.replace("-", "−").replace(/e\+?/, "e");
}

/** Formats a count with thin spaces between the thousands. */
export function count(value: number): string {
  return Math.round(value)
    .toString()
    .replace(/\B(?=(\d{3})+$)/g, " ");
}

/** Formats an angle in degrees. */
export const degrees = (angle: number): string => `${plain(Math.round(angle * 100) / 100)}°`;

/** Puts thin spaces between the thousands of the number that a text begins with: 21 770.4. */
export function thousands(text: string): string {
  const whole = /^−?\d+/.exec(text)?.[0] ?? "";
  return whole.length < 5 ? text : whole.replace(/\B(?=(\d{3})+$)/g, " ") + text.slice(whole.length);
}
