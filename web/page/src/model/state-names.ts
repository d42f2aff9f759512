// Names of states in a measured file that contain the name of a state of the design, such as "White R (%)" or "panel 7 white".

/** A name in the file, and the state that it contains. */
export type Renamed = readonly [from: string, to: string];

/** Returns the character between the cells of a line. */
const delimiterOf = (text: string): string => [";", "\t"].find((one) => text.includes(one)) ?? ",";

/** Returns the name in a cell, without quotes and unit. */
const nameIn = (cell: string): string => cell.trim().replace(/^"|"$/g, "").replace(/\s*[([][^)\]]*[)\]]\s*$/, "").trim();

const wordsOf = (name: string): string[] => name.toLowerCase().split(/[^\p{L}\p{N}]+/u);

/** Returns the only state whose name is a word of a cell; null if there is none, or if the cell is that name. */
function stateIn(name: string, states: readonly string[]): string | null {
  if (states.some((state) => state.toLowerCase() === name.toLowerCase())) return null;
  const words = wordsOf(name);
  const found = states.filter((state) => words.includes(state.toLowerCase()));
  return found.length === 1 ? found[0]! : null;
}

interface Place {
  readonly row: number;
  readonly column: number;
  readonly from: string;
  readonly to: string;
}

/** Returns the cells that name states in other words: of the column `state`, or of the row that has the most of them. */
function places(rows: readonly (readonly string[])[], states: readonly string[]): Place[] {
  const at = (row: number, column: number): Place[] => {
    const from = nameIn(rows[row]![column] ?? "");
    const to = stateIn(from, states);
    return to === null ? [] : [{ row, column, from, to }];
  };
  const head = rows.findIndex((row) => row.some((cell) => nameIn(cell).toLowerCase() === "state"));
  if (head >= 0) {
    const column = rows[head]!.findIndex((cell) => nameIn(cell).toLowerCase() === "state");
    return rows.flatMap((_, row) => (row > head ? at(row, column) : []));
  }
  const all = rows.map((row, i) => row.flatMap((_, column) => at(i, column)));
  return all.reduce((best, now) => (now.length > best.length ? now : best), []);
}

/** Returns the cells of each line; none of a comment. */
function cellsOf(text: string): string[][] {
  const delimiter = delimiterOf(text.replace(/^#.*$/gm, ""));
  return text.split("\n").map((line) => (line.startsWith("#") ? [] : line.split(delimiter)));
}

/** Returns the names that are not states of the design, but contain one; none if two of them contain the same or the file has it, too. */
export function renamable(text: string, states: readonly string[]): Renamed[] {
  const rows = cellsOf(text);
  const found = new Map(places(rows, states).map(({ from, to }) => [from, to]));
  const targets = [...found.values()];
  const known = new Set(rows.flat().map((cell) => nameIn(cell).toLowerCase()));
  return targets.some((to, i) => targets.indexOf(to) !== i || known.has(to.toLowerCase())) ? [] : [...found];
}

/** Returns the text with the names of `renamable` replaced; units are kept. */
export function renamed(text: string, states: readonly string[]): string {
  const [lines, rows] = [text.split("\n"), cellsOf(text)];
  const delimiter = delimiterOf(text.replace(/^#.*$/gm, ""));
  for (const { row, column, from, to } of places(rows, states)) {
    rows[row]![column] = rows[row]![column]!.replace(from, to);
    lines[row] = rows[row]!.join(delimiter);
  }
  return lines.join("\n");
}
