// The tables and lists of a report. In: the run, the words, and what makes elements and leads to lines and places.
"use strict";
const reportTables = ({ run, byId, element, word, inLanguage, number, seconds, lineButton, placeButton, SIGNS, kind, KINDS, LOOK, model, marks, hasSolid }) => {
  const cell = (text, quantity) => element("td", quantity ? { class: "quantity" } : {}, text);
  const headOf = (columns) => element("thead", {}, element("tr", {}, ...columns.map(([key, quantity]) =>
    element("th", { scope: "col", class: quantity ? "quantity" : undefined }, key ? word(key) : ""))));

  const makeOperations = () => {
    const head = [["", 0], ["tool", 0], ["operation", 0], ["code", 0], ["lines", 0], ["passes", 1], ["cutting-mm", 1], ["rapid-mm", 1], ["time", 1]];
    const total = (field) => run.operations.reduce((sum, row) => sum + row[field], 0);
    byId("operations").replaceChildren(headOf(head),
      element("tbody", {}, ...run.operations.map((row) => element("tr", {},
        cell(String(row.index)), cell(row.tool === null ? "" : "T" + row.tool),
        element("td", {}, lineButton(inLanguage(row.name), row.first, row.last)), cell(row.code),
        cell(row.first === row.last ? String(row.first) : `${row.first}–${row.last}`), cell(row.passes > 0 ? String(row.passes) : "", 1),
        cell(number(row.cutting_mm, 1), 1), cell(number(row.rapid_mm, 1), 1), cell(seconds(row.seconds), 1)))),
      element("tfoot", {}, element("tr", {}, cell(""), cell(""), cell(word("total")), cell(""), cell(""), cell(""),
        cell(number(total("cutting_mm"), 1), 1), cell(number(total("rapid_mm"), 1), 1), cell(seconds(total("seconds")), 1))));
    byId("operations").closest("section").hidden = run.operations.length === 0;
    byId("note").textContent = inLanguage(run.note);
  };

  const makeDiagnostics = () => {
    const detail = (key, text) => (text ? [element("p", { class: "detail" }, word(key, { text }))] : []);
    byId("diagnostics").replaceChildren(...(run.diagnostics.length === 0 ? [word("none-found")] : run.diagnostics.map((found, at) =>
      element("div", { class: "found " + found.severity, id: "found-" + at },
        element("p", { class: "head" }, element("span", { class: found.severity }, `${SIGNS[found.severity]} ${word("severity-" + found.severity)} ${found.id} `),
          ...(found.line > 0 ? [lineButton(word("line", { n: found.line }), found.line, found.line)] : []),
          ...(found.mark ? [" · ", placeButton(word("mark-show"), at)] : [])),
        element("p", {}, inLanguage(found.message)), ...detail("cause", inLanguage(found.cause)), ...detail("remedy", inLanguage(found.remedy))))));
  };

  const makeFacts = () => {
    byId("facts").replaceChildren(...run.facts.map((fact) =>
      element("tr", {}, element("th", { scope: "row" }, inLanguage(fact.label)), element("td", {}, fact.value))));
    byId("facts").closest("section").hidden = run.facts.length === 0;
  };

  const makeAssumptions = () => {
    byId("assumptions").replaceChildren(...run.assumptions.map(({ line, text }) => element("li", {}, inLanguage(text),
      ...(line > 0 ? [" ", lineButton(word("line", { n: line }), line, line)] : []))));
    byId("assumptions").closest("section").hidden = run.assumptions.length === 0;
  };

  // The part's sizes: what a machinist measures.
  const makeSizes = () => {
    byId("sizes").closest("section").hidden = !run.part;
    if (!run.part) return;
    const { whole, rows } = run.part.sizes, place = ([from, to]) => (from === to ? number(from, 3) : `${number(from, 3)} … ${number(to, 3)}`);
    const row = (what, size, z) => element("tr", {}, element("th", { scope: "row" }, what), cell(size, 1), cell(z, 1));
    byId("sizes").replaceChildren(headOf([["size-what", 0], ["size", 1], ["size-z", 1]]),
      element("tbody", {},
        row(word("size-whole"), `⌀${number(whole.diameter, 3)} × ${number(whole.length, 3)}`, place(whole.z)),
        row(word("size-volume"), `${number(whole.volume / 1000, 3)} cm³`, ""),
        ...rows.map(({ kind, diameter, text, z }) => row(word("size-" + kind), text ?? (diameter === undefined ? "" : `⌀${number(diameter, 3)}`), place(z)))));
  };

  const makeLegend = () => {
    const stroke = (look) => {
      const span = element("span");
      span.innerHTML = `<svg viewBox="0 0 34 8" aria-hidden="true"><line x1="1" y1="4" x2="33" y2="4" ${look}/></svg>`;
      return span.firstChild;
    };
    const used = new Set(kind);
    const entries = KINDS.filter((_, k) => used.has(k)).map((name) =>
      [word("picture-" + name), `stroke="var(--${name})" stroke-width="${LOOK[name][0] + 0.4}" stroke-dasharray="${LOOK[name][1].join(" ")}"`]);
    entries.push([word("picture-centre-line"), `stroke="var(--centre)" stroke-dasharray="14 4 2 4"`]);
    if (model) entries.push([word("picture-stock"), `stroke="var(--faint-ink)" stroke-dasharray="10 3 2 3 2 3"`]);
    if (marks.length > 0) entries.push([word("picture-finding"), `stroke="var(--error)" stroke-width="2" stroke-dasharray="4 3"`]);
    byId("legend").replaceChildren(...entries.map(([text, look]) => element("li", {}, stroke(look), text)));
  };
  const KEYS = [["→ ←", "key-step"], ["PgDn PgUp", "key-block"], ["Home End", "key-ends"], ["Space", "key-play"], ["↓ ↑", "key-line"], ["Enter", "key-enter"],
    ["+ −", "key-zoom"], ["Shift+↑ ↓ ← →", "key-pan"], ["0 F", "key-fit"], ...(model ? [["P", "key-path"]] : []), ...(hasSolid ? [["S", "key-view"], ["C", "key-quarter"]] : []), ["L", "key-language"], ["Esc", "key-escape"], ["?", "key-help"]];
  const makeKeys = () => byId("key-list").replaceChildren(...KEYS.flatMap(([keys, key]) => [
    element("dt", {}, ...keys.split(" ").flatMap((one) => [element("kbd", {}, one), " "])), element("dd", {}, word(key))]));

  return () => { makeOperations(); makeDiagnostics(); makeFacts(); makeAssumptions(); makeSizes(); makeLegend(); makeKeys(); };
};
