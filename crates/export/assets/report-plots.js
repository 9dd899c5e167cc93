// The lanes over time in a report: places, speed, spindle and the cutting data, one above the other over the same seconds.
// In: the run's `plots`, columns of equal length; the words. Out: SVG that is as wide as its place, a line through all of it
// at the moment that is shown, and the peaks with their lines. A press on it leads to its moment.
"use strict";
const plotTicks = (low, high, wanted) => {
  const rough = (high - low) / wanted, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((value) => value >= rough * (1 - 1e-9));
  const all = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high * (1 + 1e-9) && all.length < 20; n++) all.push(n * step);
  return all;
};

const timePlots = (plots, { byId, element, word, inLanguage, number, clockFace, lineButton, goToTime, setPlaying }) => {
  const host = byId("plots"), section = byId("plots-section"), peaks = byId("peaks");
  section.hidden = !plots;
  if (!plots) return { show() {}, relabel() {} };
  const SPEED_MIN = 10, TOP = 34, LANE = 62, HEADING = 20, GAP = 10, LEFT = 52, RIGHT = 10;
  const { seconds, shares, tools } = plots, count = shares.length, total = Math.max(plots.duration, 1e-6);
  const vocabulary = byId("first").firstElementChild.namespaceURI;   // that of SVG, as the button's picture has it
  const made = (name, attributes = {}, ...children) => {
    const one = document.createElementNS(vocabulary, name);
    for (const [key, value] of Object.entries(attributes)) one.setAttribute(key, value);
    one.append(...children);
    return one;
  };
  const nameOf = (lane) => (lane.key ? word(lane.key) : inLanguage(lane.name));

  // ---- scales ------------------------------------------------------------------------------------------
  const isCut = (column) => shares[column][0] > 0;
  const hasCuts = shares.some((share) => share[0] > 0);
  const scaleOf = (lane) => {
    let low = Infinity, high = -Infinity;
    lane.high.forEach((top, column) => {
      // Where the cuts are is what is looked at; a far home position leaves the lane.
      if (top === null || (lane.scale === "fitted" && hasCuts && !isCut(column))) return;
      low = Math.min(low, lane.low ? lane.low[column] : 0);
      high = Math.max(high, top);
    });
    if (lane.peak !== undefined) high = Math.max(high, lane.peak);
    if (low > high) [low, high] = [0, 1];
    if (lane.scale === "fitted") {
      const room = Math.max((high - low) * 0.05, 1);
      return { low: low - room, high: high + room, part: (value) => value };
    }
    if (lane.scale === "from-zero") return { low: 0, high: high > 0 ? high * 1.08 : 1, part: (value) => value };
    const part = (value) => Math.log10(Math.max(value, SPEED_MIN));
    return { low: Math.log10(SPEED_MIN), high: part(Math.max(high, 10 * SPEED_MIN) * 1.2), part, isLog: true };
  };
  const lanes = plots.lanes.map((lane, at) => ({ ...lane, axis: scaleOf(lane), look: `lane-${at % 6}` }));
  const atPeak = (lane) => {
    const greatest = lane.high.reduce((best, value, column) => (value !== null && value > (lane.high[best] ?? -Infinity) ? column : best), 0);
    return (greatest + 0.5) * seconds;
  };
  const valueAt = (lane, column) => {
    const high = lane.high[column] ?? null, low = lane.low ? lane.low[column] : high;
    if (high === null) return "–";
    const places = lane.decimals ?? (Math.abs(high) < 100 ? 2 : 0), texts = [number(low, places), number(high, places)];
    const span = lane.low && texts[0] !== texts[1] ? `${texts[0]} … ${texts[1]}` : texts[1];
    return lane.unit ? `${span} ${lane.unit}` : span;
  };

  // ---- the picture -------------------------------------------------------------------------------------
  let width = 0, cursor = null, values = [], now = 0;
  const right = () => width - RIGHT;
  const toPx = (s) => LEFT + (Math.min(s, total) / total) * (right() - LEFT);
  const topOf = (at) => TOP + HEADING + at * (HEADING + LANE + GAP), foot = topOf(lanes.length - 1) + LANE, height = foot + 24;
  // A value as a band of columns; several columns in one pixel are one.
  const band = (lane, top) => {
    const { low, high, part } = lane.axis;
    const y = (value) => top + LANE * (1 - Math.max(0, Math.min(1, (part(value) - low) / (high - low))));
    const joined = Math.max(1, Math.ceil(count / Math.max(50, right() - LEFT)));
    let path = "", last = null;
    for (let from = 0; from < count; from += joined) {
      let top_ = null, foot = null;
      for (let column = from; column < Math.min(count, from + joined); column++) {
        if (lane.high[column] === null) continue;
        top_ = Math.max(top_ ?? -Infinity, lane.high[column]);
        foot = Math.min(foot ?? Infinity, lane.low ? lane.low[column] : 0);
      }
      if (top_ === null) { last = null; continue; }
      let a = y(top_), b = y(foot);
      const own = [a, b];
      // Lines have a breadth, and hang together where a value leaps.
      if (lane.low && last) { a = Math.min(a, last[1]); b = Math.max(b, last[0]); }
      last = own;
      b = Math.max(b, a + 1.4);
      path += `M${toPx(from * seconds).toFixed(1)} ${a.toFixed(1)}H${Math.max(toPx((from + joined) * seconds), toPx(from * seconds) + 1).toFixed(1)}V${b.toFixed(1)}H${toPx(from * seconds).toFixed(1)}z`;
    }
    return path;
  };
  const drawShares = (svg) => {
    ["time-share-cutting", "time-share-rapid", "time-share-other"].forEach((key, n) => {
      let path = "";
      shares.forEach((share, column) => {
        const all = share[0] + share[1] + share[2];
        if (share[n] <= 0) return;
        const before = share.slice(0, n).reduce((sum, one) => sum + one, 0), x = toPx(column * seconds).toFixed(1);
        path += `M${x} ${(TOP - 18 + 10 * before / all).toFixed(2)}H${toPx((column + 1) * seconds).toFixed(1)}v${(10 * share[n] / all).toFixed(2)}H${x}z`;
      });
      svg.append(made("path", { class: key, d: path }, made("title", {}, word(key))));
    });
  };
  const TIME_STEPS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 14400, 43200];
  const drawSeconds = (svg) => {
    const pxPerS = (right() - LEFT) / total;
    const step = TIME_STEPS.find((one) => one * pxPerS >= 64) ?? 86400 * Math.ceil(64 / pxPerS / 86400);
    let path = "";
    for (let n = 0; n * step <= total; n++) {
      const x = toPx(n * step);
      path += `M${x.toFixed(1)} ${TOP}V${foot}`;
      const label = step >= 1 ? clockFace(n * step) : `${number(n * step, 2)} s`;
      svg.append(made("text", { x: x.toFixed(1), y: foot + 16, class: "tick", "text-anchor": n === 0 ? "start" : x > right() - 20 ? "end" : "middle" }, label));
    }
    svg.append(made("path", { class: "plot-grid", d: path }));
  };
  const draw = () => {
    width = host.clientWidth;
    if (width === 0) return;
    const headings = [], svg = made("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": word("plots-help") });
    drawShares(svg);
    drawSeconds(svg);
    values = lanes.map((lane, at) => {
      const top = topOf(at), { low, high, part, isLog } = lane.axis;
      const y = (value) => top + LANE * (1 - (part(value) - low) / (high - low));
      const ticks = isLog ? plotTicks(low, high, 3).filter(Number.isInteger).map((power) => 10 ** power) : plotTicks(low, high, 3);
      const step = ticks.length > 1 ? Math.abs(ticks[1] - ticks[0]) : 1;
      svg.append(made("rect", { class: "plot-frame", x: LEFT, y: top, width: right() - LEFT, height: LANE }));
      for (const tick of ticks) {
        svg.append(made("path", { class: "plot-grid", d: `M${LEFT} ${y(tick).toFixed(1)}H${right()}` }),
          made("text", { class: "tick", x: LEFT - 5, y: (y(tick) + 4).toFixed(1), "text-anchor": "end" }, number(tick, isLog ? 0 : Math.max(0, -Math.floor(Math.log10(step) + 1e-9)))));
      }
      svg.append(made("path", { class: `course ${lane.look}`, d: band(lane, top) }));
      if (lane.peak !== undefined) svg.append(made("circle", { class: `peak ${lane.look}`, cx: toPx(atPeak(lane)).toFixed(1), cy: y(lane.peak).toFixed(1), r: 4 }));
      const value = element("b");
      headings.push(element("p", { class: "lane", style: `left: ${LEFT}px; top: ${top - HEADING + 2}px` }, nameOf(lane), " ", value));
      return value;
    });
    let free = 0;
    for (const [at, tool] of tools) {
      const x = toPx(at);
      svg.append(made("path", { class: "plot-tool", d: `M${x.toFixed(1)} ${TOP - 20}V${foot}` }));
      if (x < free) continue;
      svg.append(made("text", { class: "tool", x: (x + 3).toFixed(1), y: TOP - 22 }, `T${tool}`));
      free = x + 34;
    }
    // What changes with the time lies above the picture, which is drawn once.
    cursor = element("div", { class: "plot-cursor", style: `top: ${TOP - 20}px; height: ${foot - TOP + 20}px` });
    host.replaceChildren(svg, ...headings, cursor);
    show(now);
  };
  const show = (time) => {
    now = time;
    if (!cursor) return;
    cursor.style.transform = `translateX(${toPx(time).toFixed(2)}px)`;
    // The end of a column belongs to it: what is shown is what was done last.
    const column = Math.max(0, Math.min(count - 1, Math.ceil(time / seconds - 1e-6) - 1));
    values.forEach((value, at) => { value.textContent = valueAt(lanes[at], column); });
  };

  // ---- peaks and hands ---------------------------------------------------------------------------------
  const makePeaks = () => {
    const found = lanes.filter((lane) => lane.peak !== undefined);
    byId("peaks-heading").hidden = peaks.hidden = found.length === 0;
    byId("peaks-note").textContent = plots.note ? inLanguage(plots.note) : "";
    peaks.replaceChildren(...found.map((lane) => element("li", {}, inLanguage(lane.label), " ",
      element("button", { type: "button", class: "link", onclick: () => { setPlaying(false); goToTime(atPeak(lane)); } }, word("peak-show")),
      ...(lane.line > 0 ? [" ", lineButton(word("line", { n: lane.line }), lane.line, lane.line)] : []))));
  };
  const timeAt = (event) => {
    const place = host.getBoundingClientRect();
    return Math.max(0, Math.min(1, (event.clientX - place.left - LEFT) / (right() - LEFT))) * total;
  };
  host.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || width === 0) return;
    host.setPointerCapture(event.pointerId);
    setPlaying(false);
    goToTime(timeAt(event));
  });
  host.addEventListener("pointermove", (event) => { if (host.hasPointerCapture(event.pointerId)) goToTime(timeAt(event)); });
  new ResizeObserver(() => { if (host.clientWidth !== width) draw(); }).observe(host);
  return { show, relabel() { makePeaks(); draw(); }, lanes: () => lanes.map(nameOf), timeOfPeak: (at) => atPeak(lanes[at]) };
};
