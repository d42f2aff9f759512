// A button that opens a menu, according to the ARIA pattern: arrow keys, Home, End and letters move in it, Enter and
// Space select an item, Escape and Tab close it. Moving through the menu selects nothing.

import { useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";

export interface Item {
  readonly name: string;
  /** The text that is shown instead of the name. */
  readonly label?: string;
  readonly summary?: string;
  /** Why it cannot be selected. */
  readonly refused?: string;
}

interface Props {
  /** The content of the button. */
  children: ComponentChildren;
  /** The accessible name, if it is not the content. */
  label?: string | undefined;
  title?: string;
  class?: string;
  items: readonly Item[];
  /** The current item of a menu that selects one of several. */
  chosen?: string;
  choose: (name: string) => unknown;
  /** Called before the menu opens. */
  opens?: () => void;
}

/** Distance between the menu and the edge of the window, px. */
const MARGIN = 8;
/** Distance that the button may move before its menu closes, px. */
const MOVED = 2;

/** Places a menu below its button, or above it if there is more room, inside the window. */
function place(menu: HTMLElement, button: HTMLElement): void {
  const at = button.getBoundingClientRect();
  const [above, below] = [at.top - MARGIN, innerHeight - at.bottom - MARGIN];
  const up = below < Math.min(menu.scrollHeight, 240) && above > below;
  menu.style.maxHeight = `${up ? above : below}px`;
  menu.style.left = `${Math.max(MARGIN, Math.min(at.left, innerWidth - menu.offsetWidth - MARGIN))}px`;
  menu.style.top = up ? `${at.top - Math.min(menu.scrollHeight + 2, above)}px` : `${at.bottom + 2}px`;
}

/** Removes the marks of code and emphasis from a summary. */
const plain = (summary: string): string => summary.replace(/[`*]/g, "");

const itemsOf = (menu: HTMLElement | null): HTMLElement[] => [
  ...(menu?.querySelectorAll<HTMLElement>("[role^=menuitem]") ?? []),
];

/** Returns the index to which a key moves from item `at`; null for keys that do not move. */
function moved(key: string, at: number, items: readonly HTMLElement[]): number | null {
  const count = items.length;
  if (key === "ArrowDown") return (at + 1) % count;
  if (key === "ArrowUp") return (at + count - 1) % count;
  if (key === "Home") return 0;
  if (key === "End") return count - 1;
  if (key.length !== 1 || key === " ") return null;
  const order = items.map((_, i) => (at + 1 + i) % count);
  return order.find((i) => items[i]!.textContent?.trim().toLowerCase().startsWith(key.toLowerCase())) ?? null;
}

export function Menu({ children, label, title, class: of = "", items, chosen, choose, opens }: Props) {
  const open = useSignal<"closed" | "first" | "last">("closed");
  const button = useRef<HTMLButtonElement>(null);
  const menu = useRef<HTMLUListElement>(null);
  const isOpen = open.value !== "closed";

  const close = (withFocus: boolean) => {
    open.value = "closed";
    if (withFocus) button.current?.focus();
  };
  const show = (which: "first" | "last") => {
    opens?.();
    open.value = which;
  };
  useLayoutEffect(() => {
    if (!isOpen || !menu.current || !button.current) return undefined;
    // In the top layer, no ancestor clips or moves it.
    menu.current.showPopover();
    place(menu.current, button.current);
    const all = itemsOf(menu.current);
    const start =
      all.find((item) => item.getAttribute("aria-checked") === "true") ?? all.at(open.value === "last" ? -1 : 0);
    start?.focus();
    const away = (event: Event) => {
      const to = event.target as Element;
      if (!menu.current?.contains(to) && !button.current?.contains(to)) close(false);
    };
    const lost = () => close(false);
    // A scroll that ended before the menu was opened may be reported after it.
    const { top, left } = button.current.getBoundingClientRect();
    const scrolled = () => {
      const now = button.current?.getBoundingClientRect();
      if (now && Math.hypot(now.top - top, now.left - left) > MOVED) close(false);
    };
    addEventListener("pointerdown", away);
    addEventListener("scroll", scrolled, true);
    addEventListener("resize", lost);
    return () => {
      removeEventListener("pointerdown", away);
      removeEventListener("scroll", scrolled, true);
      removeEventListener("resize", lost);
    };
  }, [isOpen]);

  const pressButton = (event: KeyboardEvent) => {
    if (event.key !== "ArrowDown" && event.key !== "ArrowUp") return;
    show(event.key === "ArrowDown" ? "first" : "last");
    event.preventDefault();
  };
  const pressMenu = (event: KeyboardEvent) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Tab") return close(true);
    if (event.key === "Escape") close(true);
    else {
      const all = itemsOf(menu.current);
      const to = moved(event.key, all.indexOf(document.activeElement as HTMLElement), all);
      if (to === null) return;
      all[to]?.focus();
    }
    event.preventDefault();
    event.stopPropagation();
  };
  const take = (name: string) => {
    close(true);
    void choose(name);
  };
  return (
    <>
      <button
        ref={button}
        type="button"
        class={`opens ${of}`}
        aria-haspopup="menu"
        aria-expanded={isOpen}
        aria-label={label}
        title={title}
        onClick={() => (isOpen ? close(true) : show("first"))}
        onKeyDown={pressButton}
      >
        {children}
      </button>
      {isOpen && (
        <ul
          ref={menu}
          class="menu"
          popover="manual"
          role="menu"
          aria-label={label ?? (typeof children === "string" ? children : undefined)}
          onKeyDown={pressMenu}
        >
          {items.map(({ name, label: words, summary, refused }) => (
            <li key={name} role="none">
              <button
                type="button"
                role={chosen === undefined ? "menuitem" : "menuitemradio"}
                aria-checked={chosen === undefined ? undefined : name === chosen}
                tabindex={-1}
                data-item={name}
                aria-disabled={refused === undefined ? undefined : true}
                onClick={() => refused === undefined && take(name)}
              >
                <span>{words ?? name}</span>
                {(refused ?? summary) && <small>{plain(refused ?? summary!)}</small>}
              </button>
            </li>
          ))}
        </ul>
      )}
    </>
  );
}
