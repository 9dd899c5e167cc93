// The part of a report: its section at any moment. In: the columns of the run's `part` and the typed path.
//
// A section is a list of slabs along Z, {from, to, rings}; a ring is [floor, roof], from the axis outwards; an edge is
// {z, x, s}, a line through a place with its slope, or {z, x, r}, the upper half of a circle (r > 0) or its lower one.
// Slabs and edges are never changed once they are made, only lists are. The moments are exact; what a move has cut half
// way between two of them is worked out here, with the tool's arcs as chords.
// Coordinates are millimetres, X as a radius; angles turn from Z towards X.
"use strict";
const edgeAt = (edge, z) => {
  if (edge.r === undefined) return edge.x + edge.s * (z - edge.z);
  const off = z - edge.z, high = Math.sqrt(Math.max(0, (edge.r - off) * (edge.r + off)));
  return edge.r > 0 ? edge.x + high : edge.x - high;
};
// Places along an edge from one Z to another, both ends too; arcs in chords that stay within the tolerance.
const edgePlaces = (edge, from, to, tolerance) => {
  if (edge.r === undefined) return [[from, edgeAt(edge, from)], [to, edgeAt(edge, to)]];
  const r = Math.abs(edge.r), side = Math.sign(edge.r);
  const angle = (z) => Math.acos(Math.max(-1, Math.min(1, (z - edge.z) / r)));
  const a = angle(from), b = angle(to);
  const chord = 2 * Math.acos(Math.max(0, 1 - tolerance / r));
  const count = Math.max(1, Math.min(90, Math.ceil(Math.abs(b - a) / Math.max(chord, 1e-3))));
  return Array.from({ length: count + 1 }, (_, n) => {
    const at = a + (b - a) * n / count;
    return [n === 0 ? from : n === count ? to : edge.z + r * Math.cos(at), edge.x + side * r * Math.sin(at)];
  });
};
// An outline as corners [z, x]; its arcs in chords.
const outlinePlaces = (outline, tolerance) => outline.flatMap(([z, x, cz, cx, sweep]) => {
  if (sweep === undefined) return [[z, x]];
  const r = Math.hypot(z - cz, x - cx), start = Math.atan2(x - cx, z - cz);
  const chord = 2 * Math.acos(Math.max(0, 1 - tolerance / r));
  const count = Math.max(1, Math.min(90, Math.ceil(Math.abs(sweep) / Math.max(chord, 1e-3))));
  return Array.from({ length: count }, (_, n) => [cz + r * Math.cos(start + sweep * n / count), cx + r * Math.sin(start + sweep * n / count)]);
});
const isConvex = (places) => {
  let turn = 0;
  for (let i = 0; i < places.length; i++) {
    const [a, b, c] = [places[i], places[(i + 1) % places.length], places[(i + 2) % places.length]];
    const cross = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
    if (Math.abs(cross) < 1e-9) continue;
    if (turn !== 0 && Math.sign(cross) !== turn) return false;
    turn = Math.sign(cross);
  }
  return true;
};

// The lower and the upper side of the hull round places, each a list of lines along Z.
const hullOf = (places) => {
  const sorted = [...places].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const side = (sign) => {
    const chain = [];
    for (const place of sorted) {
      while (chain.length > 1) {
        const [a, b] = chain.slice(-2);
        if (sign * ((b[0] - a[0]) * (place[1] - b[1]) - (b[1] - a[1]) * (place[0] - b[0])) > 0) break;
        chain.pop();
      }
      chain.push(place);
    }
    return chain.slice(1).map((b, n) => ({ a: chain[n], b })).filter(({ a, b }) => b[0] - a[0] > 1e-9)
      .map(({ a, b }) => ({ from: a[0], to: b[0], edge: { z: a[0], x: a[1], s: (b[1] - a[1]) / (b[0] - a[0]) } }));
  };
  return { lower: side(1), upper: side(-1), least: Math.min(...places.map((place) => place[1])) };
};
const mirrored = ({ lower, upper }) => {
  const turn = (chain) => chain.map(({ from, to, edge }) => ({ from, to, edge: { z: edge.z, x: -edge.x, s: -edge.s } }));
  return { lower: turn(upper), upper: turn(lower), least: 0 };
};

const firstBehind = (slabs, z) => {
  let low = 0, high = slabs.length;
  while (low < high) { const middle = (low + high) >> 1; if (slabs[middle].to > z) high = middle; else low = middle + 1; }
  return low;
};
const cutBy = (slabs, from, to, items) => {
  const a = firstBehind(slabs, from);
  let b = a;
  while (b < slabs.length && slabs[b].from < to) b++;
  const all = [];
  if (a < b && slabs[a].from < from) all.push({ ...slabs[a], to: from });
  for (const item of items) all.push(item);
  if (a < b && slabs[b - 1].to > to) all.push({ ...slabs[b - 1], from: to });
  if (all.length < 1000) { slabs.splice(a, b - a, ...all); return; }
  const behind = slabs.slice(b);
  slabs.length = a;
  for (const slab of all) slabs.push(slab);
  for (const slab of behind) slabs.push(slab);
};
// Where a line crosses an edge, as Z.
const crossings = (line, edge) => {
  if (edge.r === undefined) {
    const s = line.s - edge.s;
    return s === 0 ? [] : [edge.z + (edgeAt(edge, edge.z) - edgeAt(line, edge.z)) / s];
  }
  const stretch = Math.hypot(1, line.s), off = (edgeAt(line, edge.z) - edge.x) / stretch;
  const square = edge.r * edge.r - off * off;
  if (square < 0) return [];
  const foot = edge.z - line.s / stretch * off, half = Math.sqrt(square) / stretch;
  return [foot - half, foot + half];
};
// Takes a convex shape out of a section.
const takeOut = (slabs, { lower, upper }) => {
  if (lower.length === 0 || upper.length === 0) return;
  const z0 = lower[0].from, z1 = lower.at(-1).to, out = [];
  const lineAt = (chain, z) => chain.find(({ to }) => z <= to) ?? chain.at(-1);
  // The lower side falls to its lowest place and rises behind it: how deep it comes in a stretch is soon told.
  let deepest = lower[0].from;
  for (const { to, edge } of lower) if (edge.s < 0) deepest = to;
  const isClear = ({ from, to, rings }) => {
    const [a, b] = [Math.max(from, z0), Math.min(to, z1)];
    const low = edgeAt(lineAt(lower, Math.max(a, Math.min(b, deepest))).edge, Math.max(a, Math.min(b, deepest)));
    return rings.every(([, roof]) => low >= (roof.r === undefined ? Math.max(edgeAt(roof, a), edgeAt(roof, b)) : roof.x + Math.max(roof.r, 0)));
  };
  let touched = false;
  let a = firstBehind(slabs, z0);
  for (let i = a; i < slabs.length && slabs[i].from < z1; i++) {
    if (isClear(slabs[i])) {
      const one = slabs[i];
      out.push(one.from >= z0 && one.to <= z1 ? one : { from: Math.max(one.from, z0), to: Math.min(one.to, z1), rings: one.rings });
      continue;
    }
    const { from, to, rings } = slabs[i], stops = [Math.max(from, z0), Math.min(to, z1)];
    const add = (z) => { if (z > stops[0] && z < stops[1]) stops.push(z); };
    for (const chain of [lower, upper]) for (const one of chain) {
      add(one.from);
      if (one.to < from || one.from > to) continue;
      for (const ring of rings) for (const edge of ring) for (const z of crossings(one.edge, edge)) if (z >= one.from && z <= one.to) add(z);
    }
    stops.sort((p, q) => p - q);
    for (let n = 1; n < stops.length; n++) {
      const [p, q] = [stops[n - 1], stops[n]];
      if (q - p < 1e-9) continue;
      const middle = (p + q) / 2, under = lineAt(lower, middle).edge, over = lineAt(upper, middle).edge;
      const low = edgeAt(under, middle), high = edgeAt(over, middle), left = [];
      for (const ring of rings) {
        const floor = edgeAt(ring[0], middle), roof = edgeAt(ring[1], middle);
        if (high <= floor || low >= roof) { left.push(ring); continue; }
        touched = true;
        if (low > floor) left.push([ring[0], under]);
        if (high < roof) left.push([over, ring[1]]);
      }
      const last = out.at(-1);
      const same = last && last.to === p && last.rings.length === left.length
        && left.every((ring, k) => ring[0] === last.rings[k][0] && ring[1] === last.rings[k][1]);
      if (same) out[out.length - 1] = { ...last, to: q };
      else if (left.length > 0) out.push({ from: p, to: q, rings: left });
    }
  }
  if (touched) cutBy(slabs, z0, z1, out);
};

const partModel = (part, path, geometry) => {
  const CHORD_MM = 0.005;
  // ---- the columns ---------------------------------------------------------------------------------------
  const column = (numbers) => { let at = 0; return { next: () => numbers[at++], more: () => at < numbers.length }; };
  const readEdge = (from, to, next) => {
    const form = next();
    if (form === 0) return { z: 0, x: next(), s: 0 };
    if (form === 1) { const x = next(); return { z: from, x, s: (next() - x) / (to - from) }; }
    return { z: next(), x: next(), r: next() };
  };
  const readSlabs = (next) => {
    const slabs = [];
    for (let n = next(); n > 0; n--) {
      const from = next(), to = next(), rings = [];
      for (let k = next(); k > 0; k--) rings.push([readEdge(from, to, next), readEdge(from, to, next)]);
      if (to - from > 1e-9) slabs.push({ from, to, rings });
    }
    return slabs;
  };
  const readAll = (numbers, read) => { const c = column(numbers), all = []; while (c.more()) all.push(read(c.next)); return all; };
  const [stock] = readAll(part.stock, readSlabs);
  const moments = readAll(part.changes, (next) => {
    const step = next(), windows = [];
    for (let n = next(); n > 0; n--) { const from = next(), to = next(); windows.push({ from, to, slabs: readSlabs(next) }); }
    return { step, windows };
  });
  // The finished part all round, threads and all: of each shell its profiles, places [z, x], and for each triangle to the
  // next profile whether its base is in this one.
  const readWound = ({ step, shells }) => ({
    step,
    shells: shells.map(({ closed, corners, joints }) => {
      const c = column(corners), profiles = [];
      while (c.more()) {
        let z = 0, x = 0;
        const places = Array.from({ length: c.next() }, () => [(z += c.next()) / 1000, (x += c.next()) / 1000]);
        if (closed) places.push(places[0]);
        profiles.push(places);
      }
      return { profiles, joints: joints.map((digits) => Array.from(digits).flatMap((one) => [8, 4, 2, 1].map((bit) => (parseInt(one, 16) & bit) > 0))) };
    }),
  });
  const wound = part.wound ? readWound(part.wound) : null;
  const fallen = readAll(part.fallen, (next) => ({ step: next(), slabs: readSlabs(next) }));
  const tools = new Map(Object.entries(part.tools).map(([station, { cutting, body }]) => {
    const places = outlinePlaces(cutting, CHORD_MM);
    return [Number(station), { cutting, body, places, convex: isConvex(places) }];
  }));
  const toolOf = (move) => tools.get(path.tool[move]);

  // ---- a section on the way ------------------------------------------------------------------------------
  const KEPT = 16;
  const kept = [stock];   // the section after 0, 16, 32… moments
  let slabs = [...stock], count = 0, done = 0, version = 0;
  const apply = () => {
    for (const { from, to, slabs: fresh } of moments[count].windows) cutBy(slabs, from, to, fresh);
    done = Math.max(done, moments[count].step);
    count++;
    version++;
    if (count % KEPT === 0) kept[count / KEPT] ??= [...slabs];
  };
  const back = (to) => {
    const key = Math.min(Math.floor(to / KEPT), kept.length - 1);
    slabs = [...kept[key]];
    count = key * KEPT;
    done = count > 0 ? moments[count - 1].step : 0;
    version++;
  };
  const momentsUpTo = (step) => {
    let low = 0, high = moments.length;
    while (low < high) { const middle = (low + high) >> 1; if (moments[middle].step <= step) low = middle + 1; else high = middle; }
    return low;
  };
  // Cuts along a straight way.
  const cutStraight = (from, { places }, [x, z], [toX, toZ]) => {
    const hull = hullOf([...places.map(([pz, px]) => [pz + z, px + x]), ...places.map(([pz, px]) => [pz + toZ, px + toX])]);
    takeOut(from, hull);
    if (hull.least < 0) takeOut(from, mirrored(hull));
  };
  // How far the straight cuts from a move on are one within the tolerance: the first move that is not.
  const straightTo = (move, limit) => {
    const isPlain = (one) => path.kind[one] === 1 && path.tool[one] === path.tool[move]
      && geometry.segmentEnd(one) === path.first[one] + 1 && geometry.sweep[path.first[one]] === 0;
    if (!isPlain(move) || !toolOf(move)?.convex) return move + 1;
    const start = geometry.along(path.first[move], 0), through = [];
    let to = move + 1, [x, z] = geometry.along(path.first[move], 1);
    for (; to < limit && to - move < 32 && isPlain(to); to++) {
      const [fromX, fromZ] = geometry.along(path.first[to], 0), end = geometry.along(path.first[to], 1);
      if (fromX !== x || fromZ !== z) break;
      through.push([x, z]);
      const [wayX, wayZ] = [end[0] - start[0], end[1] - start[1]], square = wayX * wayX + wayZ * wayZ;
      const isNear = ([px, pz]) => {
        const t = square > 0 ? Math.max(0, Math.min(1, ((px - start[0]) * wayX + (pz - start[1]) * wayZ) / square)) : 0;
        return Math.hypot(px - start[0] - wayX * t, pz - start[1] - wayZ * t) <= CHORD_MM;
      };
      if (!through.every(isNear)) break;
      [x, z] = end;
    }
    return to;
  };
  // Cuts a share of a move; of a thread what the next moment shows of the stretch that it has gone.
  const cutMove = (from, move, share) => {
    if (path.kind[move] === 2) {
      const next = moments[momentsUpTo(move)];
      if (next?.step !== move + 1 || geometry.segmentEnd(move) <= path.first[move]) return;
      const first = path.first[move], here = geometry.placeOn(move, share);
      const [z0, z1] = [geometry.startZ[first], here[1]].sort((a, b) => a - b);
      for (const window of next.windows) {
        const a = Math.max(z0, window.from), b = Math.min(z1, window.to);
        if (b - a < 1e-9) continue;
        const clipped = window.slabs.filter(({ from, to }) => to > a && from < b)
          .map((one) => ({ ...one, from: Math.max(one.from, a), to: Math.min(one.to, b) }));
        cutBy(from, a, b, clipped);
      }
      return;
    }
    const tool = toolOf(move);
    // A rapid takes something only where it crashes.
    const cuts = path.kind[move] === 1 || moments[momentsUpTo(move)]?.step === move + 1;
    if (!cuts || !tool?.convex) return;
    let left = share * geometry.moveLength(move);
    for (let i = path.first[move]; i < geometry.segmentEnd(move) && left >= 0; i++) {
      const length = geometry.lengthOf(i), part = length > 0 ? Math.min(1, left / length) : 1;
      const r = geometry.sweep[i] !== 0 ? geometry.arcRadius(i) : 0;
      const chord = r > 0 ? 2 * Math.acos(Math.max(0, 1 - CHORD_MM / r)) : 1;
      const chords = r > 0 ? Math.max(1, Math.min(90, Math.ceil(Math.abs(geometry.sweep[i]) * part / Math.max(chord, 1e-3)))) : 1;
      let [x, z] = geometry.along(i, 0);
      for (let n = 1; n <= chords; n++) {
        const [toX, toZ] = geometry.along(i, part * n / chords);
        cutStraight(from, tool, [x, z], [toX, toZ]);
        [x, z] = [toX, toZ];
      }
      left -= length;
    }
  };
  // The section after so many moves and a share of the next; its version changes whenever the section does. When more
  // moves than `most` would have to be cut for it, it is that of the last moment, and says so.
  const sectionAt = (step, share, most = Infinity) => {
    const wanted = momentsUpTo(step);
    if (wanted < count || (wanted === count && step < done)) back(wanted);
    while (count < wanted) apply();
    if (count === moments.length) return { slabs, version: `${version}`, isLast: true };
    if (step - done > most) return { slabs, version: `${version}`, isEarly: true };
    for (let move = done; move < step; version++) {
      const to = straightTo(move, step);
      if (to === move + 1) cutMove(slabs, move, 1);
      else cutStraight(slabs, toolOf(move), geometry.along(path.first[move], 0), geometry.along(path.first[to - 1], 1));
      move = to;
    }
    done = Math.max(done, step);
    if (share === 0) return { slabs, version: `${version}` };
    const way = [...slabs];
    cutMove(way, step, share);
    return { slabs: way, version: `${version}+${share}` };
  };
  const fallenAt = (step) => fallen.filter((piece) => piece.step <= step);

  const bounds = { z0: Infinity, z1: -Infinity, x1: 0 };
  for (const [z, x] of outlinePlaces(part.outline, 0.1)) {
    bounds.z0 = Math.min(bounds.z0, z); bounds.z1 = Math.max(bounds.z1, z); bounds.x1 = Math.max(bounds.x1, x);
  }
  return { stock, wound, moments, sectionAt, fallenAt, tools, toolOf, bounds, obstacles: part.obstacles, outline: part.outline, sizes: part.sizes };
};

// Cross-section and greatest radius of a section, for tests and for what is told of it.
const sectionArea = (slabs) => {
  let area = 0;
  for (const { from, to, rings } of slabs) for (const [floor, roof] of rings) for (const [edge, sign] of [[floor, -1], [roof, 1]]) {
    const places = edgePlaces(edge, from, to, 1e-5);
    for (let n = 1; n < places.length; n++) area += sign * (places[n][0] - places[n - 1][0]) * (places[n][1] + places[n - 1][1]) / 2;
  }
  return area;
};
// The material at a Z: inner and outer radius of each ring.
const ringsAt = (slabs, z) => {
  const slab = slabs.find(({ from, to }) => from <= z && z <= to);
  return slab ? slab.rings.map(([floor, roof]) => [edgeAt(floor, z), edgeAt(roof, z)]) : [];
};

// What drawing a section has cost, in steps that do not depend on the machine; for tests.
const sectionWork = { stops: 0, corners: 0 };

// Upright faces: where material is on one side of a Z only. Of each its Z, from and to along X, and where its air is: 1
// towards higher Z, -1 towards lower. Both sides are walked along together, from the axis outwards: behind an odd number
// of stops, floors and roofs in turn, there is material.
const uprightFaces = (slabs, each) => {
  const LEAST_MM = 1e-6;
  const left = [], right = [];
  const readStops = (stops, { rings }, z) => {
    stops.length = 0;
    for (const [floor, roof] of rings) stops.push(edgeAt(floor, z), edgeAt(roof, z));
  };
  const between = (z, before, behind) => {
    readStops(left, before, z);
    readStops(right, behind, z);
    if (left.length === right.length && left.every((x, n) => Math.abs(x - right[n]) < LEAST_MM)) return;
    let i = 0, j = 0, a = Infinity;
    while (i < left.length || j < right.length) {
      const b = j >= right.length || left[i] <= right[j] ? left[i] : right[j];
      if (b - a >= LEAST_MM && i % 2 !== j % 2) each(z, a, b, i % 2 === 1 ? 1 : -1);
      while (left[i] <= b) i++;
      while (right[j] <= b) j++;
      a = b;
      sectionWork.stops++;
    }
  };
  const AIR = { rings: [] };
  let before = null;
  for (const slab of slabs) {
    if (before && Math.abs(before.to - slab.from) < 1e-9) between(slab.from, before, slab);
    else {
      if (before) between(before.to, before, AIR);
      between(slab.from, AIR, slab);
    }
    before = slab;
  }
  if (before) between(before.to, before, AIR);
};

// A section as two paths of the canvas: what is filled, and its edges. `toPxX` puts Z on the canvas, `toPxY` a radius.
const sectionPaths = (slabs, pxPerMm, toPxX, toPxY) => {
  const fill = new Path2D(), edges = new Path2D(), tolerance = 0.15 / pxPerMm, near = 0.3;
  let chains = [], before = null;
  // The sides of a chain are corners, three numbers each: across, down, and whether an edge leads there.
  const close = () => {
    for (const { floor, roof } of chains) {
      // Both sides one corner each: nothing to be seen.
      if (floor.length === 3 && roof.length === 3) continue;
      sectionWork.corners += (floor.length + roof.length) / 3;
      fill.moveTo(floor[0], floor[1]);
      for (let n = 3; n < floor.length; n += 3) fill.lineTo(floor[n], floor[n + 1]);
      for (let n = roof.length - 3; n >= 0; n -= 3) fill.lineTo(roof[n], roof[n + 1]);
      fill.closePath();
      for (const side of [floor, roof]) for (let n = 0; n < side.length; n += 3)
        side[n + 2] ? edges.lineTo(side[n], side[n + 1]) : edges.moveTo(side[n], side[n + 1]);
    }
    chains = [];
  };
  // Adds a corner to a side of a chain, unless it is too near the last one to be seen.
  const put = (side, z, radius, drawn) => {
    const x = toPxX(z), y = toPxY(radius), last = side.length - 3;
    if (last < 0 || Math.abs(side[last] - x) + Math.abs(side[last + 1] - y) > near) side.push(x, y, drawn);
  };
  // Adds an edge to a side of a chain; edges on the axis are none.
  const follow = (side, edge, from, to) => {
    const a = edgeAt(edge, from), b = edgeAt(edge, to), isLine = edge.r === undefined;
    // A short stretch of an arc is its chord: the commonest edge of all, told without its angles.
    if (isLine || (to - from) ** 2 + (b - a) ** 2 <= 4 * tolerance * (2 * Math.abs(edge.r) - tolerance)) {
      put(side, from, a, 0);
      put(side, to, b, isLine && edge.s === 0 && edge.x < 1e-9 ? 0 : 1);
    } else edgePlaces(edge, from, to, tolerance).forEach(([z, radius], n) => put(side, z, radius, n > 0 ? 1 : 0));
  };
  for (const slab of slabs) {
    const touches = before && Math.abs(before.to - slab.from) < 1e-9;
    if (!touches || before.rings.length !== slab.rings.length) close();
    for (let k = 0; k < slab.rings.length; k++) {
      const chain = (chains[k] ??= { floor: [], roof: [] });
      follow(chain.floor, slab.rings[k][0], slab.from, slab.to);
      follow(chain.roof, slab.rings[k][1], slab.from, slab.to);
    }
    before = slab;
  }
  close();
  // Faces that meet are one.
  let atZ = NaN, top = NaN;
  uprightFaces(slabs, (z, a, b) => {
    if ((b - a) * pxPerMm < 0.05) return;
    if (z !== atZ || a !== top) edges.moveTo(toPxX(z), toPxY(a));
    edges.lineTo(toPxX(z), toPxY(b));
    atZ = z;
    top = b;
  });
  return { fill, edges };
};
