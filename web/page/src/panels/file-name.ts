// The name of files that are saved from the design.

import { textAt } from "../model/json.ts";
import { fields } from "../state/design.ts";

/** Returns a file name for the design, without extension. */
export const fileName = (): string =>
  (textAt(fields.value, "title") ?? "untitled")
    .toLowerCase()
    .replace(/[^a-z0-9]+/g, "-")
    .replace(/^-|-$/g, "") || "scenario";
