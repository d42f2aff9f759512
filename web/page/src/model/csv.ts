// Tables as CSV (RFC 4180), with full precision and a point as the decimal sign.

export type Cell = string | number | boolean | null | undefined;
export type Rows = readonly (readonly Cell[])[];

const cell = (value: Cell): string => {
  if (value === null || value === undefined || (typeof value === "number" && !Number.isFinite(value))) return "";
  const text = String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
};

/** Returns a table as CSV; undefined values are empty cells. */
export const csv = (rows: Rows): string => rows.map((row) => `${row.map(cell).join(",")}\r\n`).join("");

/** Returns the texts of a table of the page. */
export const rowsOf = (table: HTMLTableElement | null): Rows =>
  [...(table?.rows ?? [])].map((row) => [...row.cells].map((one) => (one.textContent ?? "").trim()));
