// Tabs: one of several panels is shown.

/** Makes a list of tabs work with mouse and keyboard. @param {HTMLElement} list */
export function tabs(list) {
  const all = /** @type {HTMLElement[]} */ ([...list.querySelectorAll("[role=tab]")]);
  for (const [k, tab] of all.entries()) {
    tab.addEventListener("click", () => select(all, tab));
    tab.addEventListener("keydown", (event) => {
      const { length } = all;
      const to = { ArrowRight: (k + 1) % length, ArrowLeft: (k + length - 1) % length, Home: 0, End: length - 1 }[event.key];
      const next = all[to ?? -1];
      if (next === undefined) return;
      event.preventDefault();
      select(all, next);
      next.focus();
    });
  }
}

/** @param {HTMLElement[]} all @param {HTMLElement} chosen */
function select(all, chosen) {
  for (const tab of all) {
    const isChosen = tab === chosen;
    tab.setAttribute("aria-selected", String(isChosen));
    tab.tabIndex = isChosen ? 0 : -1;
    const panel = document.getElementById(tab.getAttribute("aria-controls") ?? "");
    if (panel !== null) panel.hidden = !isChosen;
  }
}

/** Shows the panel of a tab. @param {HTMLElement} tab */
export function open(tab) {
  const list = tab.parentElement;
  if (list !== null) select(/** @type {HTMLElement[]} */ ([...list.querySelectorAll("[role=tab]")]), tab);
}
