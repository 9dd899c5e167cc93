// The report's behaviour, behind the other scripts. In: the run and the texts, embedded as JSON. Nothing is fetched,
// nothing is stored.
// Coordinates are millimetres, X as a radius until it is shown; angles turn from Z towards X.
"use strict";
(() => {
  const run = JSON.parse(document.getElementById("turnwright-run").textContent);
  const texts = JSON.parse(document.getElementById("turnwright-texts").textContent);
  const byId = (id) => document.getElementById(id);
  const KINDS = ["rapid", "feed", "thread"];
  const SIGNS = { alarm: "■", error: "■", warning: "▲", note: "●" };
  const RANKS = ["note", "warning", "error", "alarm"];

  // ---- words -------------------------------------------------------------------------------------------
  let language = run.language;
  const word = (key, values = {}) =>
    (texts[key]?.[language] ?? key).replace(/\{(\w+)\}/g, (all, name) => values[name] ?? all);
  const inLanguage = (both) => both[language] || both.en || both.zh;
  const number = (value, places) => {
    const text = (Math.round(value * 10 ** places) / 10 ** places || 0).toFixed(places);
    return (places > 0 ? text.replace(/\.?0+$/, "") : text).replace("-", "−");
  };
  const seconds = (value) => {
    if (value < 60) return word("time-s", { s: number(value, 1) });
    const s = Math.round(value);
    if (s < 3600) return word("time-min", { m: Math.floor(s / 60), s: s % 60 });
    return word("time-h", { h: Math.floor(s / 3600), m: Math.round((s % 3600) / 60) });
  };
  const element = (name, attributes = {}, ...children) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
      if (key === "onclick") made.addEventListener("click", value);
      else if (value !== undefined && value !== null) made.setAttribute(key, value);
    }
    made.append(...children);
    return made;
  };

  // ---- the path ----------------------------------------------------------------------------------------
  const path = readPath(run.path);
  const {
    segments, steps, startX, startZ, endX, endZ, kind, sweep, centreX, centreZ, moveOf, box,
    segmentEnd, arcRadius, along, lengthOf, grid, distance,
  } = typedPath(path);

  const moveLength = (move) => {
    let length = 0;
    for (let i = path.first[move]; i < segmentEnd(move); i++) length += lengthOf(i);
    return length;
  };
  // Where a move is after a share of it: X, Z.
  const placeOn = (move, share) => {
    let left = moveLength(move) * share;
    for (let i = path.first[move]; i < segmentEnd(move); i++) {
      const length = lengthOf(i);
      if (left <= length) return along(i, length > 0 ? left / length : 0);
      left -= length;
    }
    return along(segmentEnd(move) - 1, 1);
  };
  const hasSolid = Boolean(run.part && byId("turnwright-three"));
  const model = run.part ? partModel(run.part, path, {
    segmentEnd, along, lengthOf, sweep, arcRadius, startZ, moveLength, placeOn,
  }) : null;

  // Times: when a move ends, and when it begins after what the tool waits for. Without times four moves a second.
  const timed = steps > 0 && path.elapsed[steps - 1] > 0;
  const waits = new Map();
  for (let j = 0; j < path.waits.length; j += 2) waits.set(path.waits[j], path.waits[j + 1]);
  const endTime = (move) => (move < 0 ? 0 : timed ? path.elapsed[move] : (move + 1) / 4);
  const startTime = (move) => endTime(move - 1) + (timed ? waits.get(move) ?? 0 : 0);
  const totalTime = endTime(steps - 1);

  // Moves by the line that ran them and by the figure line that shaped them.
  const movesOfLine = indexByLine((remember) => {
    for (let move = 0; move < steps; move++) {
      const line = path.line[move], last = path.lastLine[move], figure = path.figure[move];
      for (let one = line; one > 0 && one <= last; one++) remember(one, move);
      if (figure > 0 && figure !== line) remember(figure, move);
    }
  });

  // Cycles are runs of moves; a pass is those of its number.
  const cycles = run.cycles;
  const movesOfPass = ([at, row]) => {
    const { first, end, passes } = cycles[at], all = [];
    for (let move = first; move < Math.min(end, steps); move++) if (path.pass[move] === passes[row].number) all.push(move);
    return all;
  };
  const passOfMove = (move) => {
    const at = cycles.findIndex(({ first, end }) => move >= first && move < end);
    const row = at < 0 ? -1 : cycles[at].passes.findIndex(({ number }) => number === path.pass[move]);
    return row < 0 ? null : [at, row];
  };

  // ---- the state ---------------------------------------------------------------------------------------
  let selectedFrom = 0, selectedTo = 0;   // lines, 0 for none
  let pickedMove = -1;                    // the move chosen in the picture
  let pickedPass = null;                  // the pass chosen: numbers of its cycle and of its row
  let linesLast = false;                  // whether lines were chosen after the last step
  let step = steps;                       // moves done
  let part = 0;                           // how much of the next move is done, while playing
  let lit = new Uint32Array(0);           // highlighted segments
  const view = { pxPerMm: 1, x: 0, z: 0 };// what lies in the middle of the plot
  let fitted = true;
  // A very long path hides the part, and costs time: it is shown when it is asked for.
  const LONG_PATH = 20000, MOVES_AT_ONCE = 12;
  let pathShown = !model || segments <= LONG_PATH;
  let solid = null, solidShown = false;   // the part in space, made when it is asked for

  // ---- the picture -------------------------------------------------------------------------------------
  const picture = byId("picture");
  const layers = ["layer-stage", "layer-stock", "layer-path", "layer-done", "layer-marks"].map((id) => byId(id).getContext("2d"));
  const [stageLayer, stockLayer, pathLayer, doneLayer, marksLayer] = layers;
  const LEFT = 62, BOTTOM = 26, CHUCK = 38, PAD = 26;
  let width = 0, height = 0, doneSegments = 0;
  const colours = {};
  const readColours = () => {
    const style = getComputedStyle(document.documentElement);
    for (const name of ["paper", "ink", "faint-ink", "rule", "rapid", "feed", "thread", "grid", "centre", "tool", "lit", "lit-core", "stock", "stock-edge", "fallen", "holder", "insert", "steel", "cut", "fallen-steel", "error", "warning", "note"])
      colours[name] = style.getPropertyValue("--" + name).trim();
  };
  const plotMiddleX = () => LEFT + (width - LEFT) / 2, plotMiddleY = () => (height - BOTTOM) / 2;
  const toPxX = (z) => plotMiddleX() + (z - view.z) * view.pxPerMm;
  const toPxY = (x) => plotMiddleY() - (x - view.x) * view.pxPerMm;
  const toZ = (px) => view.z + (px - plotMiddleX()) / view.pxPerMm;
  const toX = (py) => view.x - (py - plotMiddleY()) / view.pxPerMm;
  const LOOK = { rapid: [1.1, [6, 4]], feed: [1.6, []], thread: [1.8, []] };

  const trace = (c, i) => {
    const r = arcRadius(i) * view.pxPerMm;
    if (sweep[i] === 0 || r < 0.3) {
      c.lineTo(toPxX(endZ[i]), toPxY(endX[i]));
    } else {
      const start = Math.atan2(startX[i] - centreX[i], startZ[i] - centreZ[i]);
      c.arc(toPxX(centreZ[i]), toPxY(centreX[i]), r, -start, -(start + sweep[i]), sweep[i] > 0);
    }
  };
  // A colour of the picture, thinned with the paper; transparent strokes would add up where they cross.
  const thinned = (colour, share) => {
    const parts = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
    const [ink, paper] = [parts(colour), parts(colours.paper)];
    return `rgb(${ink.map((one, at) => Math.round(one * share + paper[at] * (1 - share))).join(" ")})`;
  };
  // Strokes the segments from..to, or those that `pick` names, kind by kind, without what is outside the plot.
  // Some hundred segments a stroke: browsers are slow with one path of very many crossing lines.
  // In a long path strokes that fall on the same pixels are drawn once.
  const STROKE_SEGMENTS = 20, MANY_SEGMENTS = 5000;
  const pixels = (i) => {
    const side = (px, limit) => Math.max(0, Math.min(8191, Math.round(px) + (8192 - limit) / 2));
    const at = (x, z) => side(toPxX(z), width) * 8192 + side(toPxY(x), height);
    const [a, b] = [at(startX[i], startZ[i]), at(endX[i], endZ[i])];
    return Math.min(a, b) * 67108864 + Math.max(a, b);
  };
  const strokeSegments = (c, from, to, pick, look) => {
    const z0 = toZ(0), z1 = toZ(width), x0 = toX(height), x1 = toX(0);
    const seen = to - from > MANY_SEGMENTS ? new Set() : null;
    c.lineJoin = seen ? "bevel" : "round";
    c.lineCap = seen ? "butt" : "round";
    for (let k = 0; k < KINDS.length; k++) {
      const [lineWidth, dash] = LOOK[KINDS[k]];
      c.lineWidth = look?.width ?? lineWidth + (look?.wider ?? 0);
      c.setLineDash(look?.solid ? [] : dash);
      c.strokeStyle = thinned(look?.colour ?? colours[KINDS[k]], look?.share ?? 1);
      c.beginPath();
      seen?.clear();
      let penX = NaN, penZ = NaN, waiting = 0;
      for (let at = from; at < to; at++) {
        const i = pick ? pick[at] : at;
        if (kind[i] !== k) continue;
        if (box[4 * i] > z1 || box[4 * i + 2] < z0 || box[4 * i + 1] > x1 || box[4 * i + 3] < x0) continue;
        if (seen && sweep[i] === 0) {
          const spot = pixels(i);
          if (seen.has(spot)) continue;
          seen.add(spot);
        }
        if (waiting >= STROKE_SEGMENTS) {
          c.stroke();
          c.beginPath();
          penX = NaN;
          waiting = 0;
        }
        if (penX !== startX[i] || penZ !== startZ[i]) c.moveTo(toPxX(startZ[i]), toPxY(startX[i]));
        trace(c, i);
        penX = endX[i];
        penZ = endZ[i];
        waiting++;
      }
      if (waiting > 0) c.stroke();
    }
    c.setLineDash([]);
  };
  const inPlot = (c, draw) => {
    c.save();
    c.beginPath();
    c.rect(LEFT, 0, width - LEFT, height - BOTTOM);
    c.clip();
    draw();
    c.restore();
  };
  const frame = {
    toPxX, toPxY, toZ, toX, LEFT, BOTTOM, view, colours, number, word, inPlot, get width() { return width; }, get height() { return height; },
  };
  const stage = stageDrawing(frame), drawing = partDrawing(frame, model);
  let drawnView = null;
  const drawPath = () => {
    const c = pathLayer;
    drawnView = { ...view };
    for (const { canvas } of layers) canvas.style.transform = "";
    c.clearRect(0, 0, width, height);
    stageLayer.clearRect(0, 0, width, height);
    stage.axes(stageLayer);
    inPlot(c, () => {
      if (!model?.obstacles.length) stage.chuck(c);
      c.strokeStyle = colours.centre;
      c.lineWidth = 1;
      c.setLineDash([14, 4, 2, 4]);
      c.beginPath(); c.moveTo(LEFT, toPxY(0)); c.lineTo(width, toPxY(0)); c.stroke();
      c.setLineDash([]);
      if (pathShown) strokeSegments(c, 0, segments, null, step < steps ? { share: 0.3 } : null);
      stage.zero(c);
      if (segments === 0) {
        c.fillStyle = colours["faint-ink"];
        c.font = "15px system-ui, sans-serif";
        c.textAlign = "center";
        c.fillText(word("picture-no-moves"), plotMiddleX(), plotMiddleY() - 40);
      }
    });
    doneSegments = 0;
    doneLayer.clearRect(0, 0, width, height);
    drawStock();
    drawDone();
    drawMarks();
  };
  const showSolid = (section = sectionSoon(() => showSolid(model.sectionAt(step, part)))) => {
    const tool = step < steps && segments > 0 ? model.toolOf(currentMove()) : null;
    solid.show({
      section, fallen: model.fallenAt(step), tool, place: toolPosition(), pathShown,
      segments: step < steps ? path.first[step] : segments,
    });
    const note = byId("solid-note");
    note.hidden = !solid.noteKey;
    if (solid.noteKey) note.textContent = word(note.dataset.text = solid.noteKey);
  };
  // In a long program the moves since the last moment are cut when the hand rests.
  let cutting = 0;
  const sectionSoon = (show) => {
    clearTimeout(cutting);
    const section = model.sectionAt(step, part, MOVES_AT_ONCE);
    if (section.isEarly) cutting = setTimeout(show, REST_MS);
    return section;
  };
  const drawStock = () => { if (model) drawing.stock(stockLayer, sectionSoon(drawStockNow), model.fallenAt(step)); };
  const drawStockNow = () => drawing.stock(stockLayer, model.sectionAt(step, part), model.fallenAt(step));
  // What is done so far, drawn on; going back starts anew.
  const DONE_AT_ONCE = 4000;
  let waiting = 0;
  const drawDone = (atOnce = false) => {
    const target = step < steps ? path.first[step] : 0;
    // Much at once, or all anew, waits until the hand rests.
    if (!atOnce && segments > LONG_PATH && (target < doneSegments || target - doneSegments > DONE_AT_ONCE)) {
      clearTimeout(waiting);
      waiting = setTimeout(() => drawDone(true), REST_MS);
      return;
    }
    if (target < doneSegments) {
      doneLayer.clearRect(0, 0, width, height);
      doneSegments = 0;
    }
    if (target > doneSegments && pathShown) {
      inPlot(doneLayer, () => strokeSegments(doneLayer, doneSegments, target, null, { wider: 0.9 }));
      doneSegments = target;
    }
  };
  // The numbers of the passes that the selection is about, each where its pass begins, as far as there is room.
  const numberedPasses = () => {
    if (pickedPass) return [cycles[pickedPass[0]].passes[pickedPass[1]]];
    if (selectedFrom === 0) return [];
    return cycles.flatMap(({ passes }) => passes.filter(({ line }) => line >= selectedFrom && line <= selectedTo));
  };
  let numbersDrawn = [];
  const drawMarks = () => {
    const c = marksLayer;
    c.clearRect(0, 0, width, height);
    inPlot(c, () => {
      if (lit.length > 0) {
        strokeSegments(c, 0, lit.length, lit, { colour: colours.lit, wider: 5, share: 0.5, solid: true });
        strokeSegments(c, 0, lit.length, lit, { colour: colours["lit-core"], wider: 0.6 });
      }
      if (pickedMove >= 0) {
        strokeSegments(c, path.first[pickedMove], segmentEnd(pickedMove), null, { width: 4.5, colour: colours["lit-core"] });
        const end = segmentEnd(pickedMove) - 1;
        c.beginPath(); c.arc(toPxX(endZ[end]), toPxY(endX[end]), 4, 0, 2 * Math.PI);
        c.fillStyle = colours["lit-core"]; c.fill();
      }
      numbersDrawn = stage.passNumbers(c, numberedPasses());
      drawing.findings(c, marks);
      const tool = toolPosition();
      if (tool && step < steps) {
        const shape = model?.toolOf(currentMove());
        if (shape) drawing.tool(c, shape, tool);
        c.beginPath(); c.arc(toPxX(tool[1]), toPxY(tool[0]), model ? 3 : 6, 0, 2 * Math.PI);
        c.fillStyle = colours.tool; c.fill();
        c.lineWidth = model ? 1 : 2; c.strokeStyle = colours.paper; c.stroke();
      }
    });
  };
  // Where the tool is: the end of what is done, or on the way along the next move.
  const toolPosition = () => {
    if (segments === 0) return null;
    return step < steps ? placeOn(step, part) : [endX[segments - 1], endZ[segments - 1]];
  };
  const currentMove = () => (part > 0 || step === 0 ? step : step - 1);
  // Crashes and other findings that have a place in the section.
  const marks = run.diagnostics.flatMap((found, at) => (found.mark ? [{ ...found.mark, found, at }] : []));
  // What is hit takes this share of the view then, which shows no less than this, mm.
  const NEAR_SHARE = 0.22, NEAR_MM = 8;
  const markAt = (px, py) => marks.find(({ x, z }) => Math.hypot(toPxX(z) - px, toPxY(x) - py) <= 11);
  const showMark = (mark, isNear = false) => {
    setPlaying(false);
    if (solidShown) setSolid(false);
    // On its way the tool is at the place.
    const move = mark.step - 1;
    if (move >= 0) {
      let share = 1, least = Infinity;
      for (let n = 0; n <= 400; n++) {
        const [x, z] = placeOn(move, n / 400), away = Math.hypot(x - mark.x, z - mark.z);
        if (away < least) { least = away; share = n / 400; }
      }
      if (share < 1) goTo(move, share); else goTo(move + 1);
    }
    select(mark.found.line);
    linesLast = true;
    readout();
    // From close by, as its picture of its own shows it; a click on the mark leaves the view as it is.
    if (isNear) {
      const [x0, z0, x1, z1] = mark.bounds ?? [mark.x, mark.z, mark.x, mark.z], { roomZ, roomX } = room();
      const mmPerPx = Math.max((z1 - z0) / roomZ / NEAR_SHARE, (x1 - x0) / roomX / NEAR_SHARE, NEAR_MM / Math.min(roomZ, roomX));
      Object.assign(view, { pxPerMm: 1 / mmPerPx, z: (z0 + z1) / 2, x: (x0 + x1) / 2 });
      fitted = false;
      return redraw();
    }
    const px = toPxX(mark.z), py = toPxY(mark.x);
    if (px < LEFT + 20 || px > width - 60 || py < 20 || py > height - BOTTOM - 20) { view.z = mark.z; view.x = mark.x; fitted = false; redraw(); }
  };
  // After a change of the view. A long path is first moved as a picture and drawn anew when the hand rests.
  const REST_MS = 140;
  let queued = false, resting = 0;
  const redraw = () => {
    if (segments > LONG_PATH && drawnView) {
      const grown = view.pxPerMm / drawnView.pxPerMm;
      const right = (drawnView.z - view.z) * view.pxPerMm, down = (view.x - drawnView.x) * view.pxPerMm;
      for (const { canvas } of layers) {
        canvas.style.transformOrigin = `${plotMiddleX()}px ${plotMiddleY()}px`;
        canvas.style.transform = `translate(${right}px, ${down}px) scale(${grown})`;
      }
      clearTimeout(resting);
      resting = setTimeout(drawPath, REST_MS);
      return;
    }
    if (queued) return;
    queued = true;
    requestAnimationFrame(() => { queued = false; drawPath(); });
  };

  // ---- the view ----------------------------------------------------------------------------------------
  const room = () => ({ roomZ: Math.max(40, width - LEFT - CHUCK - 2 * PAD), roomX: Math.max(40, height - BOTTOM - 2 * PAD) });
  const fit = () => {
    if (solidShown) { solid.fit(); return; }
    let [x0, x1, z0, z1] = path.view;
    if (model) { z0 = Math.min(z0, model.bounds.z0); z1 = Math.max(z1, model.bounds.z1); x1 = Math.max(x1, model.bounds.x1); }
    const { roomZ, roomX } = room();
    view.pxPerMm = Math.min(roomZ / Math.max(z1 - z0, 0.1), roomX / Math.max(x1 - x0, 0.1));
    // The half below the axis too, as far as there is room.
    if (model) x0 = Math.min(x0, Math.max(-x1, x1 - roomX / view.pxPerMm));
    view.x = (x0 + x1) / 2;
    view.z = (z0 + z1) / 2 - CHUCK / 2 / view.pxPerMm;
    fitted = true;
    redraw();
  };
  const zoom = (factor, px = plotMiddleX(), py = plotMiddleY()) => {
    if (solidShown) { solid.zoom(factor); return; }
    const z = toZ(px), x = toX(py);
    view.pxPerMm = Math.max(1e-3, Math.min(1e5, view.pxPerMm * factor));
    view.z = z - (px - plotMiddleX()) / view.pxPerMm;
    view.x = x + (py - plotMiddleY()) / view.pxPerMm;
    fitted = false;
    redraw();
  };
  const pan = (dx, dy) => {
    view.z -= dx / view.pxPerMm;
    view.x += dy / view.pxPerMm;
    fitted = false;
    redraw();
  };
  const resize = () => {
    if (picture.clientWidth === 0) return;
    const ratio = window.devicePixelRatio || 1;
    width = picture.clientWidth;
    height = picture.clientHeight;
    for (const layer of layers) {
      layer.canvas.width = Math.round(width * ratio);
      layer.canvas.height = Math.round(height * ratio);
      layer.setTransform(ratio, 0, 0, ratio, 0, 0);
    }
    drawing.forget();
    if (fitted) fit();
    drawPath();
  };
  const findAt = (px, py) => {
    const REACH_PX = 9, x = toX(py), z = toZ(px), reach = REACH_PX / view.pxPerMm;
    let best = -1, least = Infinity;
    for (const i of grid.near(x, z, reach)) {
      const away = distance(i, x, z);
      // Among equals the cut wins over the rapid, and the later over the earlier.
      const price = away + (kind[i] === 0 ? 2 / view.pxPerMm : 0);
      if (away <= reach && price <= least) { least = price; best = i; }
    }
    return best;
  };

  // ---- the program -------------------------------------------------------------------------------------
  const list = byId("program"), rows = byId("rows");
  const ROW_PX = 20, ROWS_PLAIN = 20000, ROWS_AROUND = 60;
  let rowsFrom = 1, rowsTo = 0;
  const foundAt = new Map();
  run.diagnostics.forEach((found) => {
    if (found.line === 0) return;
    if (!foundAt.has(found.line)) foundAt.set(found.line, []);
    foundAt.get(found.line).push(found);
  });
  const makeRow = (line) => {
    const text = run.program[line - 1], found = foundAt.get(line) ?? [];
    const code = element("code");
    let at = 0;
    for (const one of [...found].sort((a, b) => a.from - b.from)) {
      if (one.from < at || one.to <= one.from || one.from >= text.length) continue;
      code.append(text.slice(at, one.from), element("mark", { class: one.severity }, text.slice(one.from, one.to)));
      at = one.to;
    }
    code.append(text.slice(at));
    const worst = found.reduce((a, b) => (RANKS.indexOf(b.severity) > RANKS.indexOf(a ?? "") ? b.severity : a), null);
    const row = element("div", { class: "row", role: "option", id: "line-" + line, "data-line": line, "aria-selected": "false" },
      element("span", { class: "number" }, String(line)),
      element("span", { class: "sign " + (worst ?? ""), title: worst ? found.map((f) => inLanguage(f.message)).join("\n") : undefined,
        "aria-label": worst ? word("severity-" + worst) : undefined }, worst ? SIGNS[worst] : ""),
      code);
    if (movesOfLine(line).length > 0) row.classList.add("moves");
    return row;
  };
  const makeRows = (from, to) => {
    rowsFrom = from;
    rowsTo = to;
    const all = document.createDocumentFragment();
    for (let line = from; line <= to; line++) all.append(makeRow(line));
    rows.replaceChildren(all);
    rows.style.paddingTop = 4 + (from - 1) * ROW_PX + "px";
    rows.style.paddingBottom = 4 + (run.program.length - to) * ROW_PX + "px";
    markRows();
  };
  const showRows = (again) => {
    const all = run.program.length;
    if (all <= ROWS_PLAIN) { if (again) makeRows(1, all); return; }
    const top = Math.floor(list.scrollTop / ROW_PX), seen = Math.ceil(list.clientHeight / ROW_PX);
    if (!again && top >= rowsFrom + 20 - 1 && top + seen <= rowsTo - 20) return;
    if (!again && ((rowsFrom === 1 && top < 20) || (rowsTo === all && top + seen > all - 20))) {
      if (top + 1 >= rowsFrom && top + seen <= rowsTo) return;
    }
    makeRows(Math.max(1, top - ROWS_AROUND), Math.min(all, top + seen + ROWS_AROUND));
  };
  const rowOf = (line) => (line >= rowsFrom && line <= rowsTo ? rows.children[line - rowsFrom] : null);
  const isOnTheWay = () => step < steps && (step > 0 || part > 0);
  const isMoveSelected = () => pickedMove >= 0;
  let marked = [];
  const markRows = () => {
    for (const row of marked) { row.classList.remove("selected", "current", "shaped"); row.setAttribute("aria-selected", "false"); }
    marked = [];
    const mark = (line, name) => {
      const row = rowOf(line);
      if (!row) return;
      row.classList.add(name);
      if (name === "selected") row.setAttribute("aria-selected", "true");
      marked.push(row);
    };
    for (let line = Math.max(selectedFrom, rowsFrom); selectedFrom > 0 && line <= Math.min(selectedTo, rowsTo); line++) mark(line, "selected");
    if (isMoveSelected()) mark(path.figure[pickedMove], "shaped");
    if (isOnTheWay()) {
      mark(path.line[currentMove()], "current");
      mark(path.figure[currentMove()], "shaped");
    }
    if (selectedFrom > 0) list.setAttribute("aria-activedescendant", "line-" + selectedFrom);
    else list.removeAttribute("aria-activedescendant");
  };
  const scrollTo = (line) => {
    if (line < 1) return;
    const top = 4 + (line - 1) * ROW_PX;
    if (top < list.scrollTop + ROW_PX || top > list.scrollTop + list.clientHeight - 3 * ROW_PX)
      list.scrollTop = Math.max(0, top - list.clientHeight / 2);
    showRows(false);
  };

  // ---- selecting and stepping --------------------------------------------------------------------------
  const describe = (move) => {
    const end = segmentEnd(move) - 1, parts = [];
    const line = path.line[move], figure = path.figure[move];
    parts.push(`X⌀ ${number(2 * endX[end], 3)}  Z ${number(endZ[end], 3)}`);
    const last = path.lastLine[move];
    parts.push(line === 0 ? word("other-program") : last > line ? word("lines-of", { a: line, b: last }) : word("line", { n: line }));
    if (figure > 0 && figure !== line) parts.push(word("figure-line", { n: figure }));
    if (path.cycle[move] > 0) parts.push(path.cycles[path.cycle[move] - 1]);
    if (path.pass[move] > 0) parts.push(word("pass", { n: path.pass[move] }));
    if (path.phase[move] > 0) parts.push(word("phase-" + path.phases[path.phase[move] - 1]));
    const kindWord = word("kind-" + KINDS[path.kind[move]]);
    if (path.unit[move] === 0) parts.push(kindWord);
    else {
      const unit = ["", "mm-per-rev", "mm-per-min", "mm-per-rev"][path.unit[move]];
      parts.push(`${path.unit[move] === 3 ? word("lead") : word("feed")} ${number(path.advance[move], 4)} ${word(unit)}`);
    }
    if (path.tool[move] > 0) parts.push(word("tool-number", { n: path.tool[move] }));
    parts.push(word("time-at", { n: seconds(path.elapsed[move]) }));
    return parts;
  };
  const causeText = ({ key, ...values }) => word(key, values);
  const causesText = (pass) => pass.causes.map(causeText).join(word("pass-cause-separator"));
  const describePass = () => {
    if (!pickedPass) return [];
    const pass = cycles[pickedPass[0]].passes[pickedPass[1]];
    return [word("depth-of", { n: number(pass.depth, 4) }), ...(pass.causes.length > 0 ? [causesText(pass)] : [])];
  };
  const readout = () => {
    const spans = (parts) => parts.map((text, at) => element("span", {}, at === 0 ? element("b", {}, text) : text));
    const target = byId("readout");
    if (pickedMove >= 0) target.replaceChildren(...spans([...describe(pickedMove), ...describePass()]));
    else if (pickedPass) target.replaceChildren(...spans([
      `${cycles[pickedPass[0]].code} ${inLanguage(cycles[pickedPass[0]].name)}`,
      word("pass", { n: cycles[pickedPass[0]].passes[pickedPass[1]].number }), ...describePass()]));
    else if (!linesLast && isOnTheWay()) target.replaceChildren(...spans(describe(currentMove())));
    else if (!linesLast && step === 0 && steps > 0) target.replaceChildren(...spans([word("readout-start")]));
    else if (selectedFrom > 0) {
      const count = new Set(movesOfSelection()).size;
      target.replaceChildren(...spans([
        selectedTo > selectedFrom ? word("lines-of", { a: selectedFrom, b: selectedTo }) : word("line", { n: selectedFrom }),
        count === 0 ? word("no-moves-of-line") : count === 1 ? word("move-of") : word("moves-of", { n: count }),
        ...(foundAt.get(selectedFrom) ?? []).map((found) => inLanguage(found.message)),
        ...(count === 1 && selectedTo === selectedFrom ? describe(movesOfSelection()[0]) : []),
      ]));
    } else target.replaceChildren(word("readout-none"));
    showTime();
  };
  const showTime = () => {
    const steps_ = word("step-of", { n: step, of: steps });
    byId("count").textContent = timed ? `${clockFace(now())} / ${clockFace(totalTime)} · ${steps_}` : steps_;
    byId("position").value = now();
    plots.show(now());
  };
  function movesOfSelection() {
    const all = [];
    for (let line = selectedFrom; line > 0 && line <= selectedTo; line++) for (const move of movesOfLine(line)) all.push(move);
    return all;
  }
  const select = (from, to = from, move = -1, pass = null) => {
    selectedFrom = from;
    selectedTo = to;
    pickedMove = move;
    pickedPass = pass ?? (move >= 0 ? passOfMove(move) : null);
    linesLast = from > 0;
    const all = new Set();
    const light = (one) => { for (let i = path.first[one]; i < segmentEnd(one); i++) all.add(i); };
    (pass ? movesOfPass(pass) : movesOfSelection()).forEach(light);
    markPass();
    lit = Uint32Array.from(all).sort();
    if (from > 0) scrollTo(from);
    markRows();
    readout();
    drawMarks();
  };
  const goTo = (to, partDone = 0) => {
    const before = step, current = currentMove();
    step = Math.max(0, Math.min(steps, to));
    part = step < steps ? partDone : 0;
    if (part === 0 && waited > 0 && step !== before) waited = 0;
    const isOther = before !== step || current !== currentMove();
    if (isOther) {
      pickedMove = -1;
      pickedPass = null;
      linesLast = false;
    }
    // The whole path is drawn strongly when all is done, faintly else.
    if (solidShown) showSolid();
    else if ((before === steps) !== (step === steps)) drawPath();
    else { drawStock(); drawDone(); drawMarks(); }
    if (!isOther) showTime();
    else {
      markPass();
      followInList();
      markRows();
      readout();
    }
  };
  // The list goes along with the moment that is shown: a few times a second while it plays, and in a list too long to be
  // all there when the hand rests, for making its rows and finding where it stands takes longer than all the rest of a step.
  const FOLLOW_MS = 200;
  let following = 0;
  const followInList = () => {
    clearTimeout(following);
    if (!isOnTheWay()) return;
    const follow = () => {
      if (!isOnTheWay()) return;
      scrollTo(path.line[currentMove()]);
      scrolledAt = performance.now();
    };
    const waits = playing ? scrolledAt > performance.now() - FOLLOW_MS : run.program.length > ROWS_PLAIN;
    if (waits) following = setTimeout(() => { follow(); markRows(); }, FOLLOW_MS);
    else follow();
  };
  const clearSelection = () => { select(0); };
  // The time of what is shown; the tool may stand and wait at the beginning of a move.
  let waited = 0;
  const now = () => (step >= steps ? totalTime
    : part > 0 ? startTime(step) + part * (endTime(step) - startTime(step)) : endTime(step - 1) + waited);
  const goToTime = (time) => {
    let low = 0, high = steps;
    while (low < high) { const middle = (low + high) >> 1; if (endTime(middle) > time) high = middle; else low = middle + 1; }
    const begin = low < steps ? startTime(low) : 0;
    waited = low < steps ? Math.max(0, Math.min(time, begin) - endTime(low - 1)) : 0;
    const still = waited;
    goTo(low, low < steps && time > begin ? Math.min(1, (time - begin) / (endTime(low) - begin)) : 0);
    waited = still;
    showTime();
  };
  const clockFace = (value) => {
    const whole = Math.floor(value + 1e-6), two = (n) => String(n).padStart(2, "0");
    return whole < 3600 ? `${Math.floor(whole / 60)}:${two(whole % 60)}` : `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
  };

  // ---- playing -----------------------------------------------------------------------------------------
  let playing = false, scrolledAt = 0, clock = 0, lastFrame = 0;
  const setPlaying = (on) => {
    if (playing === on) return;
    playing = on && steps > 0;
    byId("play").classList.toggle("playing", playing);
    labelPlay();
    if (!playing) { if (isOnTheWay()) { scrollTo(path.line[currentMove()]); markRows(); } return; }
    if (step >= steps) goTo(0);
    clock = now();
    lastFrame = performance.now();
    requestAnimationFrame(playOn);
  };
  const playOn = (at) => {
    if (!playing) return;
    clock += (Math.max(0, at - lastFrame) / 1000) * Number(byId("speed").value);
    lastFrame = at;
    goToTime(clock);
    if (step >= steps) setPlaying(false);
    else requestAnimationFrame(playOn);
  };
  const stepBy = (by) => { setPlaying(false); goTo(step + by + (by < 0 && part > 0 ? 1 : 0)); };
  const stepBlock = (by) => { setPlaying(false); goTo(blockEnd(path.line, step, part, by)); };

  // ---- tables ------------------------------------------------------------------------------------------
  const lineButton = (text, from, to) => element("button", { type: "button", class: "link", onclick: () => { select(from, to); list.focus({ preventScroll: true }); document.querySelector("main").scrollIntoView({ block: "nearest" }); } }, text);
  const placeButton = (text, at) => element("button", { type: "button", class: "link", onclick: () => {
    showMark(marks.find((mark) => mark.at === at), true);
    document.querySelector("main").scrollIntoView({ block: "nearest" });
  } }, text);
  const makeTables = reportTables({ run, byId, element, word, inLanguage, number, seconds, lineButton, placeButton, SIGNS, kind, KINDS, LOOK, model, marks, hasSolid });
  const plots = timePlots(run.plots, { byId, element, word, inLanguage, number, clockFace, lineButton, goToTime, setPlaying });
  const { makeCycles, markPass } = cycleTables({
    cycles, byId, element, word, inLanguage, number, lineButton, causeText, causesText, select, pickedPass: () => pickedPass,
  });
  // ---- language ----------------------------------------------------------------------------------------
  const labelPlay = () => {
    const text = word(playing ? "pause" : "play");
    byId("play").setAttribute("aria-label", text);
    byId("play").title = text;
  };
  const setLanguage = (to) => {
    language = to;
    document.documentElement.lang = to === "zh" ? "zh-CN" : "en";
    document.querySelectorAll("[data-text]").forEach((one) => { one.textContent = word(one.dataset.text); });
    document.querySelectorAll("[data-title]").forEach((one) => { one.title = word(one.dataset.title); });
    document.querySelectorAll("[data-label]").forEach((one) => {
      one.setAttribute("aria-label", word(one.dataset.label));
      if (one.tagName === "BUTTON" || one.tagName === "SELECT") one.title = word(one.dataset.label);
    });
    byId("joined").textContent = word("path-joined", { mm: byId("joined").dataset.mm });
    labelPlay();
    makeTables();
    makeCycles();
    plots.relabel();
    showRows(true);
    readout();
    redraw();
  };
  const toggleLanguage = () => setLanguage(language === "en" ? "zh" : "en");

  // ---- hands -------------------------------------------------------------------------------------------
  const keys = byId("keys");
  const help = () => (keys.open ? keys.close() : keys.showModal());
  for (const [id, act] of Object.entries({
    first: () => { setPlaying(false); goTo(0); }, back: () => stepBy(-1), play: () => setPlaying(!playing), forward: () => stepBy(1),
    last: () => { setPlaying(false); goTo(steps); }, "zoom-in": () => zoom(1.5), "zoom-out": () => zoom(1 / 1.5), fit, language: toggleLanguage, help,
  })) byId(id).addEventListener("click", act);
  byId("views").hidden = !model;
  byId("path-shown").setAttribute("aria-pressed", pathShown);
  byId("path-shown").addEventListener("click", () => togglePath());
  byId("solid-shown").hidden = !hasSolid;
  byId("solid-shown").addEventListener("click", () => toggleSolid());
  byId("quarter").addEventListener("click", () => toggleQuarter());
  byId("position").max = totalTime;
  byId("position").addEventListener("input", (event) => { setPlaying(false); goToTime(Number(event.target.value)); });
  const goToSelection = () => { const [first] = movesOfSelection(); if (first !== undefined) { setPlaying(false); goTo(first + 1); } };
  // A line is chosen, and its first move is shown done.
  list.addEventListener("click", (event) => {
    const row = event.target.closest(".row");
    if (!row) return;
    select(Number(row.dataset.line));
    goToSelection();
    linesLast = true;
    readout();
  });
  list.addEventListener("scroll", () => showRows(false));

  let drag = null;
  const at = (event) => { const r = picture.getBoundingClientRect(); return [event.clientX - r.left - picture.clientLeft, event.clientY - r.top - picture.clientTop]; };
  const fingers = new Map();
  picture.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    picture.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, at(event));
    drag = { from: at(event), last: at(event), moved: fingers.size > 1 };
  });
  picture.addEventListener("pointermove", (event) => {
    const [px, py] = at(event);
    if (fingers.size === 2 && fingers.has(event.pointerId)) {
      const spread = () => { const [a, b] = [...fingers.values()]; return [Math.hypot(a[0] - b[0], a[1] - b[1]), (a[0] + b[0]) / 2, (a[1] + b[1]) / 2]; };
      const [before, x0, y0] = spread();
      fingers.set(event.pointerId, [px, py]);
      const [after, x1, y1] = spread();
      pan(x1 - x0, y1 - y0);
      if (before > 0) zoom(after / before, x1, y1);
      return;
    }
    if (drag && fingers.has(event.pointerId)) {
      if (!drag.moved && Math.hypot(px - drag.from[0], py - drag.from[1]) > 4) { drag.moved = true; picture.classList.add("dragging"); }
      if (drag.moved) pan(px - drag.last[0], py - drag.last[1]);
      drag.last = [px, py];
      fingers.set(event.pointerId, [px, py]);
      return;
    }
    const near = findAt(px, py), mark = markAt(px, py);
    const place = `X⌀ ${number(2 * toX(py), 2)}  Z ${number(toZ(px), 2)}`;
    if (mark) {
      byId("hover").textContent = `${mark.found.id} ${inLanguage(mark.found.message)}`;
      picture.style.cursor = "pointer";
      return;
    }
    byId("hover").textContent = near < 0 ? place : [place, ...describe(moveOf[near]).slice(1, -1)].join(" · ");
    picture.style.cursor = near < 0 ? "" : "pointer";
  });
  const release = (event) => {
    if (fingers.delete(event.pointerId) && drag && !drag.moved && event.type === "pointerup") {
      const near = findAt(...at(event)), mark = markAt(...at(event));
      if (mark) {
        showMark(mark);
        byId("found-" + mark.at)?.scrollIntoView({ block: "nearest" });
      } else if (near >= 0) select(path.line[moveOf[near]], path.line[moveOf[near]], moveOf[near]);
      else clearSelection();
    }
    if (fingers.size === 0) drag = null;
    picture.classList.remove("dragging");
  };
  picture.addEventListener("pointerup", release);
  picture.addEventListener("pointercancel", release);
  picture.addEventListener("pointerleave", () => { byId("hover").textContent = ""; });
  picture.addEventListener("dblclick", fit);
  picture.addEventListener("wheel", (event) => {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    zoom(Math.exp(-Math.max(-300, Math.min(300, event.deltaY * lines)) * 0.0018), ...at(event));
  }, { passive: false });

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || keys.open) return;
    const target = event.target, own = target.closest?.("input, select");
    // A slider uses keys like the arrows itself, but no letters.
    if (own && !(own.type === "range" && event.key.length === 1)) return;
    const onButton = target.closest?.("button") && (event.key === " " || event.key === "Enter");
    if (onButton) return;
    const lines = run.program.length;
    const acts = {
      ArrowRight: () => stepBy(1), ArrowLeft: () => stepBy(-1),
      PageDown: () => stepBlock(1), PageUp: () => stepBlock(-1), ...(model ? { p: togglePath } : {}), ...(hasSolid ? { s: toggleSolid, c: toggleQuarter } : {}),
      Home: () => { setPlaying(false); goTo(0); }, End: () => { setPlaying(false); goTo(steps); },
      ArrowDown: () => select(Math.min(lines, selectedTo + 1)), ArrowUp: () => select(Math.max(1, selectedFrom - 1)),
      Enter: goToSelection, " ": () => setPlaying(!playing), "+": () => zoom(1.25), "=": () => zoom(1.25), "-": () => zoom(0.8),
      0: fit, f: fit, l: toggleLanguage, "?": help, Escape: clearSelection,
    };
    const pans = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] };
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const act = event.shiftKey && pans[key] ? () => pan(...pans[key]) : acts[key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  keys.addEventListener("keydown", (event) => { if (event.key === "?") { event.preventDefault(); event.stopPropagation(); keys.close(); } });

  const togglePath = () => {
    pathShown = !pathShown;
    byId("path-shown").setAttribute("aria-pressed", pathShown);
    if (solidShown) showSolid(); else drawPath();
  };
  const noSolid = () => {
    solid = null;
    setSolid(false);
    byId("solid-shown").disabled = true;
    byId("incomplete").hidden = false;
    byId("incomplete").dataset.text = "solid-missing";
    byId("incomplete").textContent = word("solid-missing");
  };
  const makeSolid = () => {
    try {
      const script = element("script");
      script.textContent = byId("turnwright-three").textContent;
      document.head.append(script);
      return solidView(window.THREE, byId("solid"), { model, typed: { segments, kind, along, sweep }, colours, onFault: noSolid });
    } catch {
      return null;
    }
  };
  const setSolid = (on) => {
    solidShown = on;
    picture.hidden = on;
    byId("solid").hidden = !on;
    byId("quarter").hidden = !on;
    byId("solid-shown").setAttribute("aria-pressed", on);
    if (!on) { resize(); return; }
    solid ??= makeSolid();
    if (solid) showSolid(); else noSolid();
  };
  const toggleSolid = () => { if (!byId("solid-shown").disabled) setSolid(!solidShown); };
  const toggleQuarter = () => {
    if (!solidShown) return;
    solid.open(!solid.isOpen);
    byId("quarter").setAttribute("aria-pressed", solid.isOpen);
  };
  const recolour = () => { readColours(); drawPath(); if (solid) { solid.recolour(); if (solidShown) showSolid(); } };
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
  window.addEventListener("beforeprint", () => { document.documentElement.classList.add("printing"); recolour(); });
  window.addEventListener("afterprint", () => { document.documentElement.classList.remove("printing"); recolour(); });

  // ---- begin -------------------------------------------------------------------------------------------
  if (path.joined_mm > 0) {
    byId("joined").hidden = false;
    byId("joined").dataset.mm = path.joined_mm;
  }
  byId("incomplete").hidden = !path.incomplete;
  readColours();
  setLanguage(language);
  new ResizeObserver(resize).observe(picture);
  resize();

  // For scripts and tests.
  window.turnwright = {
    get selectedLine() { return selectedFrom; },
    get selectedMove() { return pickedMove; },
    get step() { return step; },
    get steps() { return steps; },
    get playing() { return playing; },
    get language() { return language; },
    get view() { return { ...view }; },
    get toolPosition() { const tool = toolPosition(); return tool && { diameter: 2 * tool[0], z: tool[1] }; },
    get selectedPass() { return pickedPass && [...pickedPass]; },
    highlightedSegments: () => [...lit],
    passNumbersDrawn: () => [...numbersDrawn],
    passOfSegment: (i) => passOfMove(moveOf[i]),
    // Where the middle of a segment is on the page.
    placeOf: (i) => {
      const [x, z] = along(i, 0.5), r = picture.getBoundingClientRect();
      return { x: r.left + picture.clientLeft + toPxX(z), y: r.top + picture.clientTop + toPxY(x) };
    },
    get time() { return now(); },
    get totalTime() { return totalTime; },
    get currentLine() { return isOnTheWay() ? path.line[currentMove()] : 0; },
    // The section that is shown: mm², and its rings at a Z as diameters.
    get sectionArea() { return model && sectionArea(model.sectionAt(step, part).slabs); },
    diametersAt: (z) => model && ringsAt(model.sectionAt(step, part).slabs, z).map((ring) => ring.map((x) => 2 * x)),
    get moments() { return model?.moments.length ?? 0; },
    get work() { return { ...sectionWork }; }, get rings() { return model ? model.sectionAt(step, part).slabs.reduce((sum, { rings }) => sum + rings.length, 0) : 0; },
    marks: () => marks.map(({ x, z, at }) => {
      const r = picture.getBoundingClientRect();
      return { finding: at, x: r.left + picture.clientLeft + toPxX(z), y: r.top + picture.clientTop + toPxY(x) };
    }),
    pixelsOfZ: (...all) => all.map(toPxX), get solid() { return solidShown ? { walls: solid.walls, painted: solid.painted(), isOpen: solid.isOpen, isWound: solid.isWound } : null; },
    linesOfMoves: () => Array.from(path.line),
    goToTime, plots,
    lineOf: (i) => path.line[moveOf[i]],
    selectLine: (line) => select(line), goTo, fit, setLanguage,
  };
})();
