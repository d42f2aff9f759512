// Writes the colours of the states of every example, which the gallery shows, as the page shows them in the first view: `npm run thumbnails`.

import { writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

import { example, examples, patches, stage } from "./e2e/stage.ts";

const FILE = fileURLToPath(new URL("../src/model/patches.json", import.meta.url));

const on = await stage();
const page = await on.visit();
const lines: string[] = [];
for (const name of await examples(page)) {
  await example(page, name);
  lines.push(`  ${JSON.stringify(name)}: ${JSON.stringify(await patches(page))}`);
}
writeFileSync(FILE, `{\n${lines.join(",\n")}\n}\n`);
await on.close();
