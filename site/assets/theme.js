// Applies the reader's choice of colours before the page is drawn. Without a choice, the page follows the system.
(() => {
  "use strict";
  const root = document.documentElement;
  root.classList.add("scripts");
  try {
    const chosen = localStorage.getItem("papilio-theme");
    if (chosen === "light" || chosen === "dark") root.dataset.theme = chosen;
  } catch {
    // Storage may be forbidden; then the choice lasts until the next page.
  }
})();
