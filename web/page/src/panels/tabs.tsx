// Tabs according to the ARIA pattern: arrow keys move between them and open them.

import type { Signal } from "@preact/signals";
import type { ComponentChild } from "preact";

export interface Tab {
  readonly id: string;
  readonly name: string;
  readonly body: () => ComponentChild;
}

const STEPS: Record<string, number> = { ArrowRight: 1, ArrowLeft: -1 };

export function Tabs({ tabs, open }: { tabs: readonly Tab[]; open: Signal<string> }) {
  const current = tabs.find(({ id }) => id === open.value) ?? tabs[0]!;
  const press = (event: KeyboardEvent) => {
    const by = STEPS[event.key];
    if (by === undefined) return;
    const next = tabs[(tabs.indexOf(current) + by + tabs.length) % tabs.length]!;
    open.value = next.id;
    document.getElementById(`tab-${next.id}`)?.focus();
    event.preventDefault();
  };
  return (
    <section class="tabs" aria-label="Details of the design">
      <div role="tablist" aria-label="Details of the design" onKeyDown={press}>
        {tabs.map(({ id, name }) => (
          <button
            type="button"
            key={id}
            id={`tab-${id}`}
            role="tab"
            aria-selected={id === current.id}
            aria-controls="tab-panel"
            tabindex={id === current.id ? 0 : -1}
            onClick={(event) => {
              open.value = id;
              const tabs = event.currentTarget.closest(".tabs");
              requestAnimationFrame(() => tabs?.scrollIntoView({ block: "nearest" }));
            }}
          >
            {name}
          </button>
        ))}
      </div>
      <div id="tab-panel" role="tabpanel" aria-labelledby={`tab-${current.id}`}>
        {current.body()}
      </div>
    </section>
  );
}
