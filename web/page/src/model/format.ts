// Numbers as text: fixed decimals, standard errors as ±, a dash where there is none.

export const NONE = "–";

const finite = (value: number | null | undefined): value is number =>
  typeof value === "number" && Number.isFinite(value);

/** A number with so many decimals, its minus sign a real one. */
export function fixed(value: number | null | undefined, decimals: number): string {
  if (!finite(value)) return NONE;
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/** The error, where it is seen in so many decimals. */
export function error(value: number | null | undefined, decimals: number): string {
  return finite(value) && value >= 0.5 * 10 ** -decimals ? `± ${value.toFixed(decimals)}` : "";
}

/** A number with its error where that is seen. */
export function withError(value: number | null | undefined, se: number | null | undefined, decimals: number): string {
  const seen = error(se, decimals);
  return seen && finite(value) ? `${fixed(value, decimals)} ${seen}` : fixed(value, decimals);
}

/** A difference, always signed. */
export function signed(value: number | null | undefined, decimals: number): string {
  if (!finite(value)) return NONE;
  const text = fixed(value, decimals);
  return Number(value.toFixed(decimals)) > 0 ? `+${text}` : text;
}

/** So many significant digits, without a power of ten where it can be avoided. */
export function digits(value: number | null | undefined, count: number): string {
  if (!finite(value)) return NONE;
  if (value === 0) return "0";
  const size = Math.floor(Math.log10(Math.abs(value)));
  if (size < -5 || size > 6) return plain(value, count);
  return fixed(value, Math.max(0, count - 1 - size));
}

/** A bound or a value as it is written in a field: no trailing noughts. */
export function plain(value: number, count = 6): string {
  const text = String(Number(value.toPrecision(count)));
  return text.replace("-", "−").replace(/e\+?/, "e");
}

/** A large count with thin spaces between thousands. */
export function count(value: number): string {
  return Math.round(value)
    .toString()
    .replace(/\B(?=(\d{3})+$)/g, " ");
}

/** Degrees. */
export const degrees = (angle: number): string => `${plain(Math.round(angle * 100) / 100)}°`;
