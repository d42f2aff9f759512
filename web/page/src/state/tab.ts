// The open tab below the plots.

import { signal } from "@preact/signals";

export const openTab = signal("states");
