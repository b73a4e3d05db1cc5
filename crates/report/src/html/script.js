"use strict";
// What all parts of the page share: data, theme, filters, tabs, copies.
const page = {
  data: JSON.parse(document.getElementById("data").textContent),
  redraw: [],
  color: name => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim(),
  all: (selector, inside) => Array.from((inside || document).querySelectorAll(selector)),
  bytes: text => Uint8Array.from(atob(text), c => c.charCodeAt(0)),
  words: text => { const b = page.bytes(text); return new Int16Array(b.buffer, 0, b.length / 2); },
  draw: () => page.redraw.forEach(f => f()),
};

(() => {
  const root = document.documentElement, button = document.getElementById("theme");
  const stored = { get: () => { try { return localStorage.getItem("theme"); } catch { return null; } },
                   set: v => { try { localStorage.setItem("theme", v); } catch { /* a page from a file may not keep anything */ } } };
  const dark = () => root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  const tell = () => { button.textContent = dark() ? "Light" : "Dark"; page.draw(); };
  if (stored.get()) root.dataset.theme = stored.get();
  button.addEventListener("click", () => { root.dataset.theme = dark() ? "light" : "dark"; stored.set(root.dataset.theme); tell(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", tell);
  addEventListener("load", tell);
})();

// Filters of the matrix: what fails, a lane, words.
(() => {
  const matrix = document.getElementById("matrix-table");
  if (!matrix) return;
  const rows = page.all("tbody tr", matrix), lane = document.getElementById("lane"), search = document.getElementById("search");
  const buttons = page.all("[data-show]"), none = document.getElementById("none");
  const show = () => {
    const failing = buttons.some(b => b.dataset.show === "fail" && b.getAttribute("aria-pressed") === "true");
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    let left = 0;
    for (const row of rows) {
      const here = page.all("td", row).filter(td => (!lane.value || td.dataset.lane === lane.value) && td.dataset.state);
      const right = words.every(w => row.dataset.text.includes(w)) && (here.length > 0 || (row.dataset.state === "fail" && !lane.value))
        && (!failing || here.some(td => td.dataset.state === "fail") || row.dataset.refused === "true");
      row.hidden = !right;
      left += right;
      const suite = document.getElementById(row.dataset.suite);
      if (suite) suite.hidden = !right;
    }
    for (const cell of page.all("[data-lane]", matrix)) cell.hidden = Boolean(lane.value) && cell.dataset.lane !== lane.value;
    none.hidden = left > 0;
    page.draw();
  };
  buttons.forEach(b => b.addEventListener("click", () => {
    buttons.forEach(o => o.setAttribute("aria-pressed", String(o === b)));
    show();
  }));
  lane.addEventListener("change", show);
  search.addEventListener("input", show);
  // Arrows go from cell to cell.
  matrix.addEventListener("keydown", event => {
    const step = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
    const cell = event.target.closest("td");
    if (!step || !cell) return;
    const visible = rows.filter(r => !r.hidden);
    let r = visible.indexOf(cell.parentElement), c = cell.cellIndex;
    for (;;) {
      r += step[0]; c += step[1];
      const next = visible[r] && visible[r].cells[c];
      if (!next || c < 1) return;
      const link = next.querySelector("a");
      if (link && !next.hidden) { link.focus(); event.preventDefault(); return; }
    }
  });
  addEventListener("keydown", event => {
    if (event.key === "/" && !/^(INPUT|SELECT|TEXTAREA)$/.test(document.activeElement.tagName)) { search.focus(); event.preventDefault(); }
  });
})();

// The ways in which a suite ran are tabs. A link to one opens its suite.
(() => {
  const choose = (tab, focus) => {
    const tabs = page.all("[role=tab]", tab.parentElement);
    for (const t of tabs) {
      const chosen = t === tab;
      t.setAttribute("aria-selected", String(chosen));
      t.tabIndex = chosen ? 0 : -1;
      document.getElementById(t.getAttribute("aria-controls")).hidden = !chosen;
    }
    if (focus) tab.focus();
    const suite = tab.closest("details.suite");
    suite.dispatchEvent(new CustomEvent("way", { detail: tab.dataset.entry }));
  };
  page.all("[role=tab]").forEach(tab => {
    tab.addEventListener("click", () => choose(tab));
    tab.addEventListener("keydown", event => {
      const tabs = page.all("[role=tab]", tab.parentElement), step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (step) choose(tabs[(tabs.indexOf(tab) + step + tabs.length) % tabs.length], true);
    });
  });
  const open = () => {
    const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!target) return;
    const suite = target.closest("details.suite");
    if (suite) { suite.open = true; suite.hidden = false; }
    const tab = document.querySelector(`[role=tab][aria-controls="${CSS.escape(target.id)}"]`);
    if (tab) choose(tab);
    (tab ? suite : target).scrollIntoView();
  };
  page.begin = () => {
    page.all("[role=tablist]").forEach(list => {
      const first = list.querySelector("[aria-selected=true]") || list.querySelector("[role=tab]");
      if (first) choose(first);
    });
    page.all("details.suite").forEach(suite => suite.addEventListener("toggle", page.draw));
    open();
  };
  addEventListener("hashchange", open);
})();

page.all("[data-copy]").forEach(button => button.addEventListener("click", async () => {
  const text = document.getElementById(button.dataset.copy).textContent;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Pages from files may have no clipboard: the old way asks nobody.
    const area = Object.assign(document.createElement("textarea"), { value: text });
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  const before = button.textContent;
  button.textContent = "Copied";
  setTimeout(() => { button.textContent = before; }, 1500);
}));

// On paper: light, and what fails or is known to is open.
(() => {
  const root = document.documentElement, suites = page.all("details.suite, #known");
  let before = [];
  addEventListener("beforeprint", () => {
    before = [root.dataset.theme || "", ...suites.map(d => d.open)];
    root.dataset.theme = "light";
    suites.forEach(d => { d.open = d.open || d.id === "known" || d.classList.contains("fail"); });
    page.draw();
  });
  addEventListener("afterprint", () => {
    if (before[0]) root.dataset.theme = before[0]; else delete root.dataset.theme;
    suites.forEach((d, k) => { d.open = before[k + 1]; });
    page.draw();
  });
})();
