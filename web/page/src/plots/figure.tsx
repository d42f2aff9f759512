// A figure that was drawn by the server, as an image.

import { useEffect } from "preact/hooks";
import { useSignal } from "@preact/signals";

export function Drawn({ svg, label }: { svg: string; label: string }) {
  const address = useSignal("");
  useEffect(() => {
    const url = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
    address.value = url;
    return () => URL.revokeObjectURL(url);
  }, [svg]);
  return address.value ? (
    <div class="drawn-box" tabindex={0} role="region" aria-label={label}>
      <img class="drawn" src={address.value} alt={label} />
    </div>
  ) : null;
}
