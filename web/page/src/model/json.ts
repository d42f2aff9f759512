// Values of a scenario as JSON, and dotted paths into them (`display.pixel.film.1.thickness_nm`).

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type Table = { [key: string]: Json };

export const isTable = (value: Json | undefined): value is Table =>
  typeof value === "object" && value !== null && !Array.isArray(value);

/** Returns the value at a path, or undefined. */
export function at(root: Json | undefined, path: string): Json | undefined {
  let here = root;
  for (const key of path === "" ? [] : path.split(".")) {
    if (Array.isArray(here)) here = here[Number(key)];
    else if (isTable(here)) here = here[key];
    else return undefined;
  }
  return here;
}

export const tableAt = (root: Json | undefined, path: string): Table => {
  const found = at(root, path);
  return isTable(found) ? found : {};
};

export const listAt = (root: Json | undefined, path: string): Json[] => {
  const found = at(root, path);
  return Array.isArray(found) ? found : [];
};

export const numberAt = (root: Json | undefined, path: string): number | undefined => {
  const found = at(root, path);
  return typeof found === "number" ? found : undefined;
};

export const textAt = (root: Json | undefined, path: string): string | undefined => {
  const found = at(root, path);
  return typeof found === "string" ? found : undefined;
};

/** Splits a path into the path of its table or list and the last key. */
export function split(path: string): [parent: string, key: string] {
  const dot = path.lastIndexOf(".");
  return dot < 0 ? ["", path] : [path.slice(0, dot), path.slice(dot + 1)];
}

export const join = (...keys: (string | number)[]): string => keys.filter((key) => key !== "").join(".");
