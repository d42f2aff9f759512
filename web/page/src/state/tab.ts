// Which of the tabs below the plots is open.

import { signal } from "@preact/signals";

export const openTab = signal("states");
