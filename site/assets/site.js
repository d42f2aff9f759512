// What a page can do with scripts: search, choice of colours, copying of code, and the place in the table of contents.
(() => {
  "use strict";

  const root = document.documentElement;
  const home = root.dataset.root;

  const element = (name, attributes, ...children) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  };

  const icon = (path) => {
    const holder = element("span", { style: "display:contents" });
    holder.innerHTML = `<svg viewBox="0 0 24 24" aria-hidden="true"><path d="${path}"/></svg>`;
    return holder;
  };

  const tools = document.querySelector(".tools");

  // Search
  const MAGNIFIER = "M11 4a7 7 0 1 0 0 14 7 7 0 0 0 0-14zM20 20l-4-4";
  const opener = element("button", { type: "button", class: "find", "aria-haspopup": "dialog" }, icon(MAGNIFIER), "Search", element("kbd", {}, "/"));
  tools.append(opener);

  let index;
  /** The index is loaded when it is first needed. A script works from a disk, too. */
  const load = () =>
    new Promise((resolve, reject) => {
      if (index) return resolve(index);
      const script = element("script", { src: `${home}assets/index.js` });
      script.onload = () => resolve((index = papilioSearch.prepare(window.papilioIndex)));
      script.onerror = () => reject(new Error("the index of the search cannot be loaded"));
      document.head.append(script);
    });

  const dialog = element("dialog", { class: "search", "aria-label": "Search" });
  const input = element("input", { type: "search", "aria-label": "Search the documentation", placeholder: "Search the documentation", autocomplete: "off", spellcheck: "false" });
  const results = element("ol", {});
  const count = element("p", { class: "count", role: "status" });
  dialog.append(input, results, count);
  document.body.append(dialog);

  const result = (section, query) => {
    const [address, title, heading, part, text] = section;
    const pieces = papilioSearch.excerpt(text, query).map(([piece, isAsked]) => (isAsked ? element("mark", {}, piece) : piece));
    const where = [part, heading === "" ? "" : title].filter((word) => word !== "").join(" › ");
    const link = element("a", { href: home + address }, element("strong", {}, heading || title), " ", element("small", {}, where), element("p", {}, ...pieces));
    link.addEventListener("click", () => dialog.close());
    return element("li", {}, link);
  };

  const show = async () => {
    const query = input.value.trim();
    if (query === "") {
      results.replaceChildren();
      count.textContent = "Words of a page, a key or a metric. ↓ and ↑ move, Enter opens, Esc closes.";
      return;
    }
    try {
      const found = papilioSearch.search(await load(), query);
      if (query !== input.value.trim()) return;
      results.replaceChildren(...found.map((section) => result(section, query)));
      count.textContent = found.length === 0 ? `Nothing contains “${query}”.` : `${found.length} sections`;
    } catch (error) {
      count.textContent = error.message;
    }
  };

  const open = () => {
    if (dialog.open) return;
    dialog.showModal();
    input.select();
    load().catch(() => {});
    show();
  };

  opener.addEventListener("click", open);
  input.addEventListener("input", show);
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  dialog.addEventListener("keydown", (event) => {
    const links = [...results.querySelectorAll("a")];
    const at = links.indexOf(document.activeElement);
    if (event.key === "Enter" && document.activeElement === input) links[0]?.click();
    if (event.key !== "ArrowDown" && event.key !== "ArrowUp") return;
    event.preventDefault();
    const next = at + (event.key === "ArrowDown" ? 1 : -1);
    if (next < 0) input.focus();
    else links[Math.min(next, links.length - 1)]?.focus();
  });
  document.addEventListener("keydown", (event) => {
    const types = /^(INPUT|TEXTAREA|SELECT)$/.test(document.activeElement?.tagName ?? "");
    const asked = (event.key === "/" && !event.ctrlKey && !event.metaKey && !event.altKey) || (event.key === "k" && (event.ctrlKey || event.metaKey));
    if (!asked || types) return;
    event.preventDefault();
    open();
  });

  // Choice of colours: as the system, light, dark
  const THEMES = {
    system: ["Colours: as the system", "M3 5h18v11H3zM8 20h8M12 16v4"],
    light: ["Colours: light", "M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8zM12 2v2M12 20v2M2 12h2M20 12h2M5 5l1.4 1.4M17.6 17.6L19 19M5 19l1.4-1.4M17.6 6.4L19 5"],
    dark: ["Colours: dark", "M20 14.5A8.5 8.5 0 0 1 9.5 4a8.5 8.5 0 1 0 10.5 10.5z"],
  };
  const theme = element("button", { type: "button", class: "theme" });
  const labelled = () => {
    const [label, path] = THEMES[root.dataset.theme ?? "system"];
    theme.replaceChildren(icon(path));
    theme.setAttribute("aria-label", label);
    theme.title = label;
  };
  theme.addEventListener("click", () => {
    const names = Object.keys(THEMES);
    const next = names[(names.indexOf(root.dataset.theme ?? "system") + 1) % names.length];
    if (next === "system") delete root.dataset.theme;
    else root.dataset.theme = next;
    try {
      localStorage.setItem("papilio-theme", next);
    } catch {
      // Storage may be forbidden; then the choice lasts until the next page.
    }
    labelled();
  });
  labelled();
  tools.append(theme);

  // Copying of code: of a Python session, the code without prompts and output.
  const copied = (code) => {
    const text = code.textContent;
    if (!text.startsWith(">>> ")) return text;
    const lines = text.split("\n").filter((line) => /^(>>>|\.\.\.)( |$)/.test(line));
    return `${lines.map((line) => line.slice(4)).join("\n").trimEnd()}\n`;
  };
  // Browsers allow it to pages of this machine and of servers with https.
  const blocks = navigator.clipboard ? document.querySelectorAll(".code:not(.result)") : [];
  for (const block of blocks) {
    const button = element("button", { type: "button", class: "copy" }, "Copy");
    button.addEventListener("click", async () => {
      try {
        await navigator.clipboard.writeText(copied(block.querySelector("code")));
        button.textContent = "Copied";
      } catch {
        button.textContent = "Cannot copy";
      }
      button.classList.add("done");
      setTimeout(() => {
        button.textContent = "Copy";
        button.classList.remove("done");
      }, 1500);
    });
    block.append(button);
  }

  // What scrolls can be reached with the keyboard.
  const scrolling = () => {
    for (const box of document.querySelectorAll("pre, div.table, .equation")) {
      if (box.scrollWidth > box.clientWidth + 1) box.tabIndex = 0;
      else box.removeAttribute("tabindex");
    }
  };
  scrolling();
  addEventListener("resize", scrolling);

  // The table of contents is open where it stands beside the text, and marks the section that is read.
  const contents = document.querySelector(".contents details");
  if (contents) {
    const isWide = matchMedia("(min-width: 82.01rem)");
    const fit = () => {
      contents.open = isWide.matches;
    };
    fit();
    isWide.addEventListener("change", fit);
    const links = [...contents.querySelectorAll("a")];
    const targets = links.map((link) => document.getElementById(decodeURIComponent(link.hash.slice(1))));
    const mark = () => {
      const read = targets.findLastIndex((target) => target && target.getBoundingClientRect().top < 140);
      links.forEach((link, number) => link.classList.toggle("here", number === read));
      const at = links[read];
      if (!at || !isWide.matches) return;
      const [top, bottom] = [at.offsetTop - contents.scrollTop, at.offsetTop + at.offsetHeight - contents.scrollTop];
      if (top < 0 || bottom > contents.clientHeight) contents.scrollTop = at.offsetTop - contents.clientHeight / 2;
    };
    mark();
    addEventListener("scroll", mark, { passive: true });
  }

  // The current page is visible in a long navigation. (`scrollIntoView` would also move the place where Tab begins.)
  const pages = document.querySelector(".pages");
  const current = pages.querySelector("[aria-current]");
  if (current && current.offsetTop > pages.clientHeight - 80) pages.scrollTop = current.offsetTop - pages.clientHeight / 2;
})();
