// Names of states in measured files that contain those of the design: they are offered as these states, and the file with the new
// names can be saved, for the command line.

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";

import { renamable, renamed, type Renamed } from "../model/state-names.ts";
import { states } from "../state/design.ts";
import { add, fileIds } from "../state/files.ts";
import { keptFile } from "../state/keep.ts";
import { isRenamed, noteRenamed } from "../state/renamed.ts";
import { said } from "../state/said.ts";
import { save } from "./save.ts";

/** Offers to read names that contain a state of the design as that state. */
export function Rename({ name, id }: { name: string; id: string }) {
  const found = useSignal<readonly Renamed[]>([]);
  const content = useSignal("");
  const all = states.value.map(([state]) => state);
  useEffect(() => {
    void keptFile(id).then(async (bytes) => {
      content.value = (await bytes?.text()) ?? "";
      found.value = renamable(content.value, all);
    });
  }, [id, all.join()]);
  if (found.value.length === 0) return null;
  const [from, to] = [0, 1].map((k) => found.value.map((pair) => pair[k]).join(", "));
  const read = async () => {
    if (!(await add(name, new Blob([renamed(content.value, all)])))) return;
    noteRenamed(name);
    said.value = `${name} is read with the states ${to}. The file on your disk is unchanged: save the new one for the command line.`;
  };
  return (
    <button type="button" onClick={() => void read()}>
      Read {from} as {to}
    </button>
  );
}

/** Saves a file whose states were renamed: the command of a tool needs it, instead of that on the disk. */
export function SaveRenamed({ name }: { name: string }) {
  if (!isRenamed(name)) return null;
  const write = async () => {
    const bytes = await keptFile(fileIds.value[name] ?? "");
    if (bytes) save(name, new Blob([bytes], { type: "text/csv" }));
    said.value = bytes ? `${name} is saved with the states of the design.` : `The browser has not kept ${name}: choose it again.`;
  };
  return (
    <button type="button" title="The file on your disk has the former names, which the command line does not find in the design" onClick={() => void write()}>
      Save {name} with its new states
    </button>
  );
}
