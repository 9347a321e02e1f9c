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

  // Fields and states of a map for paper: those with the largest and the smallest value, and of pressures some combinations.
  const LEAST = 0.2, MOST = 6, NUMBERED = ["deflection", "pressure"];  // fields that show reactions on paper
  const chosen = ({ states, fields, plates }) => plates.flatMap((_, plate) => fields.flatMap(({ name: field }) => {
    const known = states.flatMap((one, state) => {
      const about = one.plates[plate].fields[field];
      return about ? [{ kind: one.kind, group: one.name, state, low: about.range[0], high: about.range[1] }] : [];
    });
    const single = known.filter((one) => one.kind === "combination");
    const whole = known.filter((one) => !one.group && one.kind !== "combination");
    const high = whole.find((one) => one.kind === "largest") || single.toSorted((a, b) => b.high - a.high)[0];
    const low = whole.find((one) => one.kind === "smallest") || single.toSorted((a, b) => a.low - b.low)[0];
    if (!high) return [];
    const least = LEAST * Math.max(Math.abs(high.high), Math.abs(low?.low ?? 0));
    const sides = [...(high.high > least || !low ? [high] : []), ...(low && low.low < -least ? [low] : [])];
    const kept = [...sides.length ? sides : [high], ...(field === "pressure" ? single.slice(0, MOST) : [])];
    return [...new Set(kept.map((one) => one.state))].map((state) => ({ state, field, plate }));
  }));

  // Pictures of a map's fields, drawn in a copy of the map outside the window, one after the other.
  const picture = async (map, copy, pause) => {
    const { mount, viewers } = window.signorini.maps, stage = document.createElement("div"), shown = document.createElement("div");
    stage.className = "offstage";
    stage.append(copy);
    document.body.append(stage);
    shown.className = "prints";
    const viewer = mount(copy);
    await viewer.ready;
    for (const wanted of chosen(viewer.data)) {
      await pause();
      viewer.with.numbers = NUMBERED.includes(wanted.field);
      await viewer.show(wanted);
      viewer.paint(1.6);
      const figure = document.createElement("figure"), image = document.createElement("img");
      const legend = viewer.legend.cloneNode(true);
      image.src = viewer.canvas.toDataURL("image/png");
      image.alt = legend.querySelector(".title").textContent;
      figure.className = "signorini-map";
      figure.append(legend, image);
      shown.append(figure);
    }
    viewers.delete(viewer);
    stage.remove();
    if (!shown.childElementCount) return;
    map.after(shown);
    map.classList.add("printed");
  };

  const maps = [...document.querySelectorAll(".signorini-map")];
  const copies = maps.map((map) => map.cloneNode(true));
  for (const copy of copies) copy.removeAttribute("id");
  for (const map of maps) window.signorini.maps.mount(map);
  const atOnce = location.hash === "#print";
  const pause = () => new Promise((done) => (atOnce ? done() : (window.requestIdleCallback || setTimeout)(done)));
  const all = async () => {
    for (const [at, map] of maps.entries()) await picture(map, copies[at], pause);
    document.documentElement.dataset.pictures = "ready";
  };
  setTimeout(all, atOnce ? 0 : 1500);
})();
