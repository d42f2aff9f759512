// The name of files that are saved from the design.

import { title } from "../state/design.ts";

/** Returns a file name for the design, without extension. */
export const fileName = (): string =>
  title.value
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-|-$/g, "") || "scenario";
