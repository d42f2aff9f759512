// Tabs according to the ARIA pattern: arrow keys move between them and open them.

import type { Signal } from "@preact/signals";
import type { ComponentChild } from "preact";

export interface Tab {
  readonly id: string;
  readonly name: string;
  readonly body: () => ComponentChild;
}

const STEPS: Record<string, number> = { ArrowRight: 1, ArrowLeft: -1 };

interface Props {
  tabs: readonly Tab[];
  open: Signal<string>;
  /** What the tabs have in common. */
  name: string;
  show: (id: string) => void;
}

export function Tabs({ tabs, open, name: all, show }: Props) {
  const current = tabs.find(({ id }) => id === open.value) ?? tabs[0]!;
  const press = (event: KeyboardEvent) => {
    const by = STEPS[event.key];
    if (by === undefined) return;
    const next = tabs[(tabs.indexOf(current) + by + tabs.length) % tabs.length]!;
    show(next.id);
    document.getElementById(`tab-${next.id}`)?.focus();
    event.preventDefault();
  };
  return (
    <section class="tabs" aria-label={`Tools of ${all}`}>
      <div role="tablist" aria-label={`Tools of ${all}`} onKeyDown={press}>
        {tabs.map(({ id, name }) => (
          <button
            type="button"
            key={id}
            id={`tab-${id}`}
            role="tab"
            aria-selected={id === current.id}
            aria-controls="tab-panel"
            tabindex={id === current.id ? 0 : -1}
            onClick={() => show(id)}
          >
            {name}
          </button>
        ))}
      </div>
      <div id="tab-panel" role="tabpanel" aria-labelledby={`tab-${current.id}`}>
        <h2 class="spoken">{current.name}</h2>
        {current.body()}
      </div>
    </section>
  );
}
