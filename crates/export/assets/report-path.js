// The path of a report as typed arrays, and what is asked of its geometry. In: the columns of the run's `path`.
// Coordinates are millimetres, X as a radius; angles turn from Z towards X.
"use strict";
// The columns as they were written: ends and times add up, the others are runs of how many and which value.
const readPath = (written) => {
  const { moves } = written;
  const runs = (numbers, Kind = Uint32Array) => {
    const column = new Kind(moves);
    for (let j = 0, at = 0; j < numbers.length; at += numbers[j], j += 2) column.fill(numbers[j + 1], at, at + numbers[j]);
    return column;
  };
  const addUp = (column) => { for (let i = 1; i < column.length; i++) column[i] += column[i - 1]; return column; };
  const ends = new Float64Array(written.ends);
  for (let i = 2; i < ends.length; i++) ends[i] += ends[i - 2];
  for (let i = 0; i < ends.length; i++) ends[i] /= 1e4;
  const elapsed = addUp(new Float64Array(written.elapsed));
  for (let i = 0; i < moves; i++) elapsed[i] /= 1e3;
  const advance = runs(written.advance, Float64Array);
  for (let i = 0; i < moves; i++) advance[i] /= 1e5;
  const [kind, phase, unit] = ["kind", "phase", "unit"].map((name) => runs(written[name], Uint8Array));
  const [figure, cycle, pass, tool] = ["figure", "cycle", "pass", "tool"].map((name) => runs(written[name]));
  const [first, line] = ["first", "line"].map((name) => Uint32Array.from(addUp(runs(written[name], Float64Array))));
  // The last line of each move, which is another one where several moves are shown as one.
  const lastLine = Uint32Array.from(line);
  for (let j = 0; j < written.joined.length; j += 2) lastLine[written.joined[j]] = written.joined[j + 1];
  return { ...written, ends, elapsed, advance, kind, phase, unit, figure, cycle, pass, tool, first, line, lastLine };
};

// Moves by line, in the order of the moves. `each` is called with what takes a line and a move.
const indexByLine = (each) => {
  let lines = 0, all = 0;
  each((line) => { lines = Math.max(lines, line); all++; });
  const starts = new Uint32Array(lines + 2), moves = new Uint32Array(all);
  each((line) => { starts[line + 1]++; });
  for (let line = 1; line < starts.length; line++) starts[line] += starts[line - 1];
  const filled = starts.slice();
  each((line, move) => { moves[filled[line]++] = move; });
  return (line) => (line > 0 && line <= lines ? moves.subarray(starts[line], starts[line + 1]) : moves.subarray(0, 0));
};

const typedPath = (path) => {
  const segments = path.ends.length / 2;
  const steps = path.moves;
  const startX = new Float32Array(segments), startZ = new Float32Array(segments);
  const endX = new Float32Array(segments), endZ = new Float32Array(segments);
  const kind = new Uint8Array(segments);
  const sweep = new Float32Array(segments), centreX = new Float32Array(segments), centreZ = new Float32Array(segments);
  const moveOf = new Uint32Array(segments);
  const segmentEnd = (move) => (move + 1 < steps ? path.first[move + 1] : segments);
  for (let i = 0; i < segments; i++) {
    endX[i] = path.ends[2 * i];
    endZ[i] = path.ends[2 * i + 1];
    if (i > 0) { startX[i] = endX[i - 1]; startZ[i] = endZ[i - 1]; }
  }
  for (let j = 0; j < path.jumps.length; j += 3) {
    startX[path.jumps[j]] = path.jumps[j + 1];
    startZ[path.jumps[j]] = path.jumps[j + 2];
  }
  for (let j = 0; j < path.arcs.length; j += 4) {
    const i = path.arcs[j];
    centreX[i] = path.arcs[j + 1];
    centreZ[i] = path.arcs[j + 2];
    sweep[i] = path.arcs[j + 3];
  }
  for (let move = 0; move < steps; move++) {
    for (let i = path.first[move]; i < segmentEnd(move); i++) { moveOf[i] = move; kind[i] = path.kind[move]; }
  }
  const arcRadius = (i) => Math.hypot(startX[i] - centreX[i], startZ[i] - centreZ[i]);
  // Rectangle of each segment; for an arc the whole circle, which is enough to leave out what is not seen.
  const box = new Float32Array(4 * segments);
  for (let i = 0; i < segments; i++) {
    const r = arcRadius(i), bow = sweep[i] !== 0;
    box[4 * i] = bow ? centreZ[i] - r : Math.min(startZ[i], endZ[i]);
    box[4 * i + 1] = bow ? centreX[i] - r : Math.min(startX[i], endX[i]);
    box[4 * i + 2] = bow ? centreZ[i] + r : Math.max(startZ[i], endZ[i]);
    box[4 * i + 3] = bow ? centreX[i] + r : Math.max(startX[i], endX[i]);
  }
  // The place on segment i after the part `t` (0 to 1) of it.
  const along = (i, t) => {
    if (sweep[i] === 0) return [startX[i] + (endX[i] - startX[i]) * t, startZ[i] + (endZ[i] - startZ[i]) * t];
    const r = arcRadius(i), angle = Math.atan2(startX[i] - centreX[i], startZ[i] - centreZ[i]) + sweep[i] * t;
    return [centreX[i] + r * Math.sin(angle), centreZ[i] + r * Math.cos(angle)];
  };
  const lengthOf = (i) =>
    sweep[i] !== 0 ? arcRadius(i) * Math.abs(sweep[i]) : Math.hypot(endX[i] - startX[i], endZ[i] - startZ[i]);

  // A grid over the path for finding what is near the pointer; long segments are in a list of their own.
  const makeGrid = () => {
    const SIDE = 96, LONG = 400;
    const space = path.view;
    const cellZ = Math.max((space[3] - space[2]) / SIDE, 1e-6), cellX = Math.max((space[1] - space[0]) / SIDE, 1e-6);
    const clampCell = (value) => Math.max(0, Math.min(SIDE - 1, Math.floor(value)));
    const column = (z) => clampCell((z - space[2]) / cellZ), row = (x) => clampCell((x - space[0]) / cellX);
    const cells = new Map(), long = [];
    for (let i = 0; i < segments; i++) {
      const c0 = column(box[4 * i]), c1 = column(box[4 * i + 2]), r0 = row(box[4 * i + 1]), r1 = row(box[4 * i + 3]);
      if ((c1 - c0 + 1) * (r1 - r0 + 1) > LONG) { long.push(i); continue; }
      for (let c = c0; c <= c1; c++) for (let r = r0; r <= r1; r++) {
        const cell = c * SIDE + r;
        if (!cells.has(cell)) cells.set(cell, []);
        cells.get(cell).push(i);
      }
    }
    return {
      * near(x, z, reach) {
        yield* long;
        for (let c = column(z - reach); c <= column(z + reach); c++)
          for (let r = row(x - reach); r <= row(x + reach); r++) yield* cells.get(c * SIDE + r) ?? [];
      },
    };
  };
  // Made when a pointer comes near: that takes a while for a long path.
  let made = null;
  const grid = { near: (...place) => (made ??= makeGrid()).near(...place) };
  const distance = (i, x, z) => {
    if (sweep[i] !== 0) {
      const r = arcRadius(i), turn = Math.sign(sweep[i]), full = 2 * Math.PI;
      const start = Math.atan2(startX[i] - centreX[i], startZ[i] - centreZ[i]);
      const at = (((Math.atan2(x - centreX[i], z - centreZ[i]) - start) * turn) % full + full) % full;
      if (at <= Math.abs(sweep[i])) return Math.abs(Math.hypot(x - centreX[i], z - centreZ[i]) - r);
      return Math.min(Math.hypot(x - startX[i], z - startZ[i]), Math.hypot(x - endX[i], z - endZ[i]));
    }
    const dx = endX[i] - startX[i], dz = endZ[i] - startZ[i], square = dx * dx + dz * dz;
    const t = square > 0 ? Math.max(0, Math.min(1, ((x - startX[i]) * dx + (z - startZ[i]) * dz) / square)) : 0;
    return Math.hypot(x - startX[i] - dx * t, z - startZ[i] - dz * t);
  };

  return {
    segments, steps, startX, startZ, endX, endZ, kind, sweep, centreX, centreZ, moveOf, box,
    segmentEnd, arcRadius, along, lengthOf, grid, distance,
  };
};

// How many moves are done at the end of the block before (by < 0) or behind (by > 0): where another line begins. `lines` are
// those of the moves, `part` is the share of the next move that is done.
const blockEnd = (lines, step, part, by) => {
  const steps = lines.length, lineOf = (move) => lines[Math.max(0, Math.min(steps - 1, move))];
  let to = part > 0 ? step : step - 1;
  const line = lineOf(to);
  if (by < 0) {
    while (to >= 0 && lineOf(to) === line) to--;
    return to + 1;
  }
  if (step === 0 && part === 0) to = 0;
  else while (to < steps && lineOf(to) === line) to++;
  const next = lineOf(to);
  while (to + 1 < steps && lineOf(to + 1) === next) to++;
  return Math.min(steps, to + 1);
};
