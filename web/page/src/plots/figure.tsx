// A figure that was drawn by the server, as an image that can be saved.

import { useEffect } from "preact/hooks";
import { useSignal } from "@preact/signals";

import { Downloads } from "../panels/downloads.tsx";
import type { Rows } from "../model/csv.ts";
import { darkFigure } from "../model/dark-figure.ts";
import { leastWidth } from "../model/figure-width.ts";
import { dark } from "../state/theme.ts";

interface Props {
  svg: string;
  label: string;
  /** The name of its file; without it, the figure is not offered for saving. */
  name?: string;
  table?: () => Rows | string;
}

export function Drawn({ svg, label, name, table }: Props) {
  const address = useSignal("");
  useEffect(() => {
    const url = URL.createObjectURL(new Blob([dark.value ? darkFigure(svg) : svg], { type: "image/svg+xml" }));
    address.value = url;
    return () => URL.revokeObjectURL(url);
  }, [svg, dark.value]);
  return address.value ? (
    <>
      {name && (
        <p class="figure-tools">
          <Downloads name={name} svg={() => svg} {...(table ? { table } : {})} />
        </p>
      )}
      <div class="drawn-box" tabindex={0} role="region" aria-label={label}>
        <img
          class="drawn"
          src={address.value}
          alt={label}
          ref={(image) => image?.style.setProperty("--least", `${leastWidth(svg)}px`)}
        />
      </div>
    </>
  ) : null;
}
