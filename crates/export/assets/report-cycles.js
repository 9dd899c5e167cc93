// The tables of the passes of each cycle in a report. In: the cycles, the words, what makes elements and leads to lines, and
// which pass is chosen.
"use strict";
const cycleTables = ({ cycles, byId, element, word, inLanguage, number, lineButton, causeText, causesText, select, pickedPass }) => {
  const passRow = (at, row) => byId(`pass-${at}-${row}`);
  const selectPass = (at, row) => {
    select(cycles[at].passes[row].line, cycles[at].passes[row].line, -1, [at, row]);
    document.querySelector("main").scrollIntoView({ block: "nearest" });
  };
  // A table is made when it is opened: a long program has thousands of passes.
  const fillCycle = (details) => {
    if (details.childElementCount > 1) return;
    const at = Number(details.dataset.cycle), { settings, passes } = cycles[at];
    const cell = (text, kind) => element("td", { class: kind }, text);
    const place = ([x, z]) => `${number(x, 4)}, ${number(z, 4)}`;
    const head = [["number", 1], ["phase", 0], ["depth", 1], ["from", 1], ["to", 1], ["cause", 0]];
    details.append(
      element("p", { class: "settings" }, ...settings.map((one) =>
        element("span", {}, `${inLanguage(one.name)} ${number(one.value, 4)} (${causeText(one.cause)})`))),
      element("div", { class: "scroll" }, element("table", {},
        element("thead", {}, element("tr", {}, ...head.map(([key, quantity]) =>
          element("th", { scope: "col", class: quantity ? "quantity" : undefined }, word("pass-" + key))))),
        element("tbody", {}, ...passes.map((pass, row) => element("tr", { id: `pass-${at}-${row}` },
          element("td", { class: "quantity" }, element("button", { type: "button", class: "link", onclick: () => selectPass(at, row) }, String(pass.number))),
          cell(word("phase-" + pass.phase)), cell(number(pass.depth, 4), "quantity"),
          cell(place(pass.from), "quantity"), cell(place(pass.to), "quantity"), cell(causesText(pass), "cause")))))));
  };
  const CYCLE_PASSES_OPEN = 200;
  const makeCycles = () => {
    const open = new Set([...document.querySelectorAll("#cycles details[open]")].map((one) => Number(one.dataset.cycle)));
    const isFirst = byId("cycles").childElementCount === 0;
    const few = cycles.reduce((sum, { passes }) => sum + passes.length, 0) <= CYCLE_PASSES_OPEN;
    byId("cycles").replaceChildren(...cycles.map(({ code, name, line, passes }, at) => {
      const details = element("details", { "data-cycle": at },
        element("summary", {}, word(passes.length === 1 ? "cycle-summary-one" : "cycle-summary", { code, name: inLanguage(name), n: passes.length }),
          ...(line > 0 ? [lineButton(word("line", { n: line }), line, line)] : [])));
      if (isFirst ? few : open.has(at)) { details.open = true; fillCycle(details); }
      details.addEventListener("toggle", () => { if (details.open) { fillCycle(details); markPass(); } });
      return details;
    }));
    byId("cycles").closest("section").hidden = cycles.length === 0;
    markPass();
  };
  const markPass = () => {
    document.querySelectorAll("#cycles tr[aria-current]").forEach((row) => row.removeAttribute("aria-current"));
    const picked = pickedPass();
    if (!picked) return;
    const details = document.querySelector(`#cycles details[data-cycle="${picked[0]}"]`);
    if (details && !details.open) { details.open = true; fillCycle(details); }
    passRow(...picked)?.setAttribute("aria-current", "true");
  };
  return { makeCycles, markPass };
};
