"use strict";
(() => {
  const FILTERED = 8;  // smallest number of rows of a table with a filter
  const words = document.body.dataset;

  const key = (row, column) => {
    const cell = row.cells[column], value = cell.dataset.value;
    return value === undefined ? cell.textContent : Number(value);
  };

  const compare = (a, b) => {
    if (typeof a === "number" && typeof b === "number") return a - b;
    if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
    return a.localeCompare(b, undefined, { numeric: true });
  };

  const sort = (table, header) => {
    const ascending = header.getAttribute("aria-sort") !== "ascending";
    const sign = ascending ? 1 : -1, column = header.cellIndex;
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    header.setAttribute("aria-sort", ascending ? "ascending" : "descending");
    const keyed = [...table.tBodies[0].rows].map((row) => [key(row, column), row]);
    keyed.sort((one, other) => sign * compare(one[0], other[0]));
    table.tBodies[0].append(...keyed.map((pair) => pair[1]));
  };

  const filter = (table, text) => {
    const parts = text.toLowerCase().split(/\s+/).filter(Boolean);
    for (const row of table.tBodies[0].rows) {
      const content = row.textContent.toLowerCase();
      row.hidden = !parts.every((part) => content.includes(part));
    }
  };

  for (const table of document.querySelectorAll("table.data")) {
    for (const header of table.tHead.rows[0].cells) {
      if (!header.textContent.trim()) continue;
      const button = document.createElement("button");
      button.type = "button";
      button.title = words.sort;
      button.append(...header.childNodes);
      button.addEventListener("click", () => sort(table, header));
      header.append(button);
    }
    if (table.tBodies[0].rows.length >= FILTERED) {
      const input = document.createElement("input");
      input.type = "search";
      input.placeholder = words.filter;
      input.setAttribute("aria-label", `${words.filter}: ${table.caption.textContent}`);
      input.addEventListener("input", () => filter(table, input.value));
      table.caption.append(input);
    }
  }

  // What is folded or not yet loaded must be on paper too.
  const closed = new Set();
  const unfold = () => {
    for (const one of document.querySelectorAll("details:not([open])")) {
      closed.add(one);
      one.open = true;
    }
    window.signorini?.maps?.freeze();
  };
  window.addEventListener("beforeprint", unfold);
  window.addEventListener("afterprint", () => {
    for (const one of closed) one.open = false;
    closed.clear();
  });
  for (const map of document.querySelectorAll(".signorini-map")) window.signorini.maps.mount(map);
})();
