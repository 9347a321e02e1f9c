"use strict";
(() => {
  const FILTERED = 8;  // smallest number of rows of a table with a filter
  const words = document.body.dataset, { make, mount, viewers } = window.signorini.maps;

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
    table.tBodies[0].append(...keyed.sort((a, b) => sign * compare(a[0], b[0])).map((pair) => pair[1]));
  };

  const filter = (table, text) => {
    const parts = text.toLowerCase().split(/\s+/).filter(Boolean);
    for (const row of table.tBodies[0].rows) {
      row.hidden = !parts.every((part) => row.textContent.toLowerCase().includes(part));
    }
  };

  for (const table of document.querySelectorAll("table.data")) {
    for (const header of table.tHead.rows[0].cells) {
      if (!header.textContent.trim()) continue;
      header.append(make("button", { type: "button", title: words.sort, onclick: () => sort(table, header) }, ...header.childNodes));
    }
    if (table.tBodies[0].rows.length >= FILTERED) {
      const input = make("input", { type: "search", placeholder: words.filter, "aria-label": `${words.filter}: ${table.caption.textContent}` });
      input.oninput = () => filter(table, input.value);
      table.caption.append(input);
    }
  }

  // Diagrams: the values at a station under the pointer or, by the arrow keys, at the next one or in the next panel.
  for (const stage of document.querySelectorAll(".diagram .stage")) {
    const svg = stage.querySelector("svg"), { x, at, unit, panels } = JSON.parse(stage.querySelector("script").textContent);
    const rule = document.createElementNS(svg.namespaceURI, "path"), told = make("output", { className: "tip" });
    let station = 0, panel = 0;
    const hide = () => { rule.remove(); told.remove(); };
    const show = (nextStation, nextPanel) => {
      station = Math.min(Math.max(nextStation, 0), x.length - 1);
      panel = Math.min(Math.max(nextPanel, 0), panels.length - 1);
      const [title, top, curves] = panels[panel], { width, height } = svg.viewBox.baseVal;
      const dots = curves.map(([, , y]) => (y[station] === null ? "" : `M${x[station] - 4} ${y[station]}h8`));
      rule.setAttribute("d", `M${x[station]} 0V${height}${dots.join("")}`);
      rule.setAttribute("class", "rule");
      const lines = curves.flatMap(([name, texts], i) => (texts[station] ? [make("span", { className: `c${i}` }, `${name} ${texts[station]}`)] : []));
      told.replaceChildren(make("b", {}, `${at[station]}${unit}: ${title}`), ...lines);
      svg.append(rule);
      stage.append(told);
      const scale = svg.clientWidth / width, left = x[station] * scale + 12;
      const before = left + told.offsetWidth > stage.clientWidth;
      told.style.transform = `translate(${before ? Math.max(left - told.offsetWidth - 24, 0) : left}px, ${top * scale}px)`;
      stage.setAttribute("aria-valuenow", station);
      stage.setAttribute("aria-valuetext", told.innerText);
    };
    stage.setAttribute("aria-valuemax", x.length - 1);
    stage.addEventListener("pointermove", (event) => {
      const box = svg.getBoundingClientRect(), scale = svg.viewBox.baseVal.width / box.width;
      const px = (event.clientX - box.left) * scale, py = (event.clientY - box.top) * scale;
      const nearest = x.reduce((best, one, i) => (Math.abs(one - px) < Math.abs(x[best] - px) ? i : best), 0);
      show(nearest, panels.filter(([, top]) => top <= py).length - 1);
    });
    stage.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      show(station + (told.isConnected ? step[0] : 0), panel + step[1]);
    });
    for (const name of ["pointerleave", "blur"]) stage.addEventListener(name, hide);
  }

  // Folded tables must be on paper too.
  const closed = [];
  window.addEventListener("beforeprint", () => {
    closed.push(...document.querySelectorAll("details:not([open])"));
    for (const one of closed) one.open = true;
  });
  window.addEventListener("afterprint", () => { for (const one of closed.splice(0)) one.open = false; });

  // Fields and states of a map for paper: those with the largest and the smallest value, and of pressures some combinations.
  // Deflections and pressures are shown for each group of combinations, a load path at one of its stops.
  const LEAST = 0.2, MOST = 6, NUMBERED = ["deflection", "pressure"];  // fields that show reactions on paper
  // The envelopes of largest and smallest values or, without envelopes, the single states with these values.
  const ends = (envelopes, single) => {
    const high = envelopes.find((one) => one.kind === "largest") || single.toSorted((a, b) => b.high - a.high)[0];
    const low = envelopes.find((one) => one.kind === "smallest") || single.toSorted((a, b) => a.low - b.low)[0];
    if (!high) return [];
    const least = LEAST * Math.max(Math.abs(high.high), Math.abs(low?.low ?? 0));
    const sides = [...(high.high > least || !low ? [high] : []), ...(low && low.low < -least ? [low] : [])];
    return sides.length ? sides : [high];
  };
  const chosen = ({ states, fields, plates }) => plates.flatMap((_, plate) => fields.flatMap(({ name: field }) => {
    const known = states.flatMap((one, state) => {
      const about = one.plates[plate].fields[field];
      const { kind, name, group = name, mixed, printed } = one;
      return about ? [{ kind, group, mixed, printed, state, low: about.range[0], high: about.range[1] }] : [];
    });
    const single = known.filter((one) => one.kind === "combination"), stops = known.filter((one) => one.printed);
    const envelopes = known.filter((one) => ["largest", "smallest"].includes(one.kind) && (NUMBERED.includes(field) ? !one.mixed : !one.group));
    const groups = [...new Set(single.map((one) => one.group))];
    const kept = stops.length ? stops : [
      ...[...new Set(envelopes.map((one) => one.group)), ...(envelopes.length ? [] : [""])].flatMap((group) =>
        ends(envelopes.filter((one) => one.group === group), single)),
      ...(field === "pressure" ? groups.flatMap((group) =>
        single.filter((one) => one.group === group).slice(0, Math.ceil(MOST / groups.length))) : [])];
    return [...new Set(kept.map((one) => one.state))].map((state) => ({ state, field, plate }));
  }));

  const DOTS = 1.4, QUALITY = 0.82;  // pixels per CSS pixel, and quality of JPEG, which browsers copy to a PDF as it is
  // Pictures of a map's fields, drawn in a copy of the map outside the window, one after the other.
  const picture = async (map, copy, pause) => {
    const stage = make("div", { className: "offstage" }, copy), shown = make("div", { className: "prints" });
    document.body.append(stage);
    const viewer = mount(copy);
    await viewer.ready;
    for (const wanted of chosen(viewer.data)) {
      await pause();
      viewer.with.numbers = NUMBERED.includes(wanted.field);
      await viewer.show(wanted);
      viewer.paint(DOTS);
      const legend = viewer.legend.cloneNode(true), alt = legend.querySelector(".title").textContent;
      const image = make("img", { src: viewer.canvas.toDataURL("image/jpeg", QUALITY), alt });
      shown.append(make("figure", { className: "signorini-map" }, legend, image));
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
  maps.forEach(mount);
  const atOnce = location.hash === "#print";
  const pause = () => new Promise((done) => (atOnce ? done() : (window.requestIdleCallback || setTimeout)(done)));
  const all = async () => {
    for (const [at, map] of maps.entries()) await picture(map, copies[at], pause);
    document.documentElement.dataset.pictures = "ready";
  };
  setTimeout(all, atOnce ? 0 : 1500);
})();
