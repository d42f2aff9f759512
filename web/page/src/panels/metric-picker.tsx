// The choice of a metric by typing words, in groups, according to the ARIA pattern of a combobox with a list.

import { useSignal } from "@preact/signals";
import { useEffect, useId, useRef } from "preact/hooks";

import { grouped, matches, WHOLE } from "../model/metrics.ts";
import { labelText } from "../state/labels.ts";

interface Props {
  names: readonly string[];
  /** The chosen metric; "" for a list from which one is added. */
  chosen: string;
  choose: (name: string) => void;
  /** The accessible name. */
  label: string;
  /** The id of the button. */
  id?: string;
  /** The content of the button, if it is not the chosen metric. */
  children?: string;
}

/** The most entries that are shown; typing finds the others. */
const MOST = 200;

export function MetricPicker({ names, chosen, choose, label, children, id: own }: Props) {
  const open = useSignal(false);
  const search = useSignal("");
  const active = useSignal(0);
  const button = useRef<HTMLButtonElement>(null);
  const panel = useRef<HTMLDivElement>(null);
  const id = useId();
  const found = open.value
    ? names.filter((name) => matches(`${labelText(name)} ${name}`, search.value)).slice(0, MOST)
    : [];
  const order = [...grouped(found).values()].flat();
  const at = Math.min(active.value, order.length - 1);
  const close = (withFocus: boolean) => {
    open.value = false;
    search.value = "";
    if (withFocus) button.current?.focus();
  };
  const take = (name: string | undefined) => {
    if (name === undefined) return;
    close(true);
    choose(name);
  };
  useEffect(() => {
    if (!open.value || !panel.current || !button.current) return undefined;
    panel.current.showPopover();
    const box = button.current.getBoundingClientRect();
    const height = Math.min(420, innerHeight - 24);
    panel.current.style.left = `${Math.max(8, Math.min(box.left, innerWidth - panel.current.offsetWidth - 8))}px`;
    panel.current.style.top = `${Math.max(8, Math.min(box.bottom + 2, innerHeight - height - 8))}px`;
    panel.current.style.maxHeight = `${height}px`;
    panel.current.querySelector("input")?.focus();
    active.value = Math.max(0, order.indexOf(chosen));
    const away = (event: Event) => {
      const to = event.target as Element;
      if (!panel.current?.contains(to) && !button.current?.contains(to)) close(false);
    };
    addEventListener("pointerdown", away);
    return () => removeEventListener("pointerdown", away);
  }, [open.value]);
  useEffect(() => {
    panel.current?.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
  }, [at, open.value]);
  const press = (event: KeyboardEvent) => {
    if (event.key === "ArrowDown") active.value = Math.min(order.length - 1, at + 1);
    else if (event.key === "ArrowUp") active.value = Math.max(0, at - 1);
    else if (event.key === "Enter") take(order[at]);
    else if (event.key === "Escape" || event.key === "Tab") close(true);
    else return;
    if (event.key !== "Tab") event.preventDefault();
    event.stopPropagation();
  };
  return (
    <>
      <button
        ref={button}
        id={own}
        type="button"
        class="opens metric-picker"
        aria-haspopup="listbox"
        aria-expanded={open.value}
        aria-label={chosen ? `${label}: ${labelText(chosen)}` : label}
        onClick={() => (open.value ? close(true) : (open.value = true))}
      >
        {children ?? labelText(chosen)}
      </button>
      {open.value && (
        <div class="metric-list" popover="manual" ref={panel}>
          <input
            type="text"
            role="combobox"
            aria-label={`${label}: search by words`}
            aria-expanded="true"
            aria-controls={`${id}-list`}
            aria-activedescendant={order[at] ? `${id}-${at}` : undefined}
            aria-autocomplete="list"
            placeholder="Type words: white contrast, red L*"
            value={search.value}
            onInput={(event) => {
              search.value = event.currentTarget.value;
              active.value = 0;
            }}
            onKeyDown={press}
          />
          <div role="listbox" id={`${id}-list`} aria-label={label} tabindex={-1}>
            {[...grouped(found)].map(([group, all]) => (
              <div role="group" aria-label={group} key={group}>
                <div class="group" aria-hidden="true">
                  {group === WHOLE ? group : `State ${group}`}
                </div>
                {all.map((name) => (
                  <div
                    key={name}
                    id={`${id}-${order.indexOf(name)}`}
                    role="option"
                    aria-selected={order[at] === name}
                    data-metric={name}
                    onClick={() => take(name)}
                  >
                    {labelText(name)}
                  </div>
                ))}
              </div>
            ))}
          </div>
          {found.length === 0 && <p class="remark">No metric has these words.</p>}
          {found.length === MOST && <p class="remark">The first {MOST}: type words to find others.</p>}
        </div>
      )}
    </>
  );
}
