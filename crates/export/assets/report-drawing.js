// What the picture of a report shows beside the path. In: the frame, which knows where a place in millimetres is on the
// canvas. Each function draws on the context it is given.
"use strict";
const stageDrawing = (frame) => {
  const { toPxX, toPxY, toZ, toX, LEFT, BOTTOM, view, colours, number, word } = frame;
  const tickStep = (pxPerMm, roomPx) => {
    const least = roomPx / pxPerMm, power = 10 ** Math.floor(Math.log10(least));
    return [1, 2, 5, 10].map((digit) => digit * power).find((value) => value >= least * (1 - 1e-9));
  };
  const tickLabel = (value, stepMm) => number(value, Math.max(0, -Math.floor(Math.log10(stepMm) + 1e-9)));

  const axes = (c) => {
    c.font = "12px system-ui, sans-serif";
    c.lineWidth = 1;
    const widest = Math.max(...[toZ(LEFT), toZ(frame.width)].map((z) => c.measureText(number(z, 2)).width));
    const stepZ = tickStep(view.pxPerMm, Math.max(56, widest + 22)), stepX = tickStep(view.pxPerMm / 2, 34);
    c.strokeStyle = colours.grid;
    c.fillStyle = colours["faint-ink"];
    c.textAlign = "center";
    c.textBaseline = "alphabetic";
    for (let n = Math.ceil(toZ(LEFT) / stepZ); n * stepZ <= toZ(frame.width); n++) {
      const px = Math.round(toPxX(n * stepZ)) + 0.5;
      c.beginPath(); c.moveTo(px, 0); c.lineTo(px, frame.height - BOTTOM); c.stroke();
      const label = tickLabel(n * stepZ, stepZ), half = c.measureText(label).width / 2;
      if (px - half > LEFT - 8 && px + half < frame.width - 56) c.fillText(label, px, frame.height - 9);
    }
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (let n = Math.ceil(2 * toX(frame.height - BOTTOM) / stepX); n * stepX <= 2 * toX(0); n++) {
      const py = Math.round(toPxY(n * stepX / 2)) + 0.5;
      c.beginPath(); c.moveTo(LEFT, py); c.lineTo(frame.width, py); c.stroke();
      if (py > 32 && py < frame.height - BOTTOM - 6) c.fillText(tickLabel(n * stepX, stepX), LEFT - 7, py);
    }
    c.strokeStyle = colours.rule;
    c.strokeRect(LEFT + 0.5, -1, frame.width, frame.height - BOTTOM + 0.5);
    c.fillStyle = colours.ink;
    c.font = "bold 12px system-ui, sans-serif";
    c.textAlign = "left";
    c.textBaseline = "alphabetic";
    c.fillText(word("picture-axis-x"), 6, 17);
    c.textAlign = "right";
    c.fillText(word("picture-axis-z"), frame.width - 8, frame.height - 9);
  };
  const chuck = (c) => {
    const centre = toPxY(0), seen = centre > 0 && centre < frame.height - BOTTOM;
    const middle = seen ? centre : (frame.height - BOTTOM) / 2;
    const top = Math.max(6, middle - 80), bottom = Math.min(frame.height - BOTTOM - 2, middle + 80);
    c.save();
    c.beginPath(); c.rect(LEFT, top, 15, bottom - top); c.clip();
    c.strokeStyle = colours["faint-ink"];
    c.lineWidth = 1.5;
    for (let y = top - 20; y < bottom + 20; y += 7) { c.beginPath(); c.moveTo(LEFT, y + 15); c.lineTo(LEFT + 15, y); c.stroke(); }
    c.restore();
    c.strokeStyle = colours["faint-ink"];
    c.lineWidth = 1;
    c.strokeRect(LEFT + 0.5, top, 15, bottom - top);
    c.save();
    c.font = "11px system-ui, sans-serif";
    // Beside the centre line, not across it.
    const half = c.measureText(word("picture-chuck-side")).width / 2 + 8;
    c.translate(LEFT + 29, !seen ? middle : centre > 2 * half + 8 ? centre - half : centre + half);
    c.rotate(-Math.PI / 2);
    c.textAlign = "center";
    c.fillStyle = colours["faint-ink"];
    c.fillText(word("picture-chuck-side"), 0, 0);
    c.restore();
  };
  const zero = (c) => {
    const x = toPxX(0), y = toPxY(0);
    c.beginPath(); c.arc(x, y, 6, 0, 2 * Math.PI);
    c.fillStyle = colours.paper; c.fill();
    c.fillStyle = c.strokeStyle = colours.ink;
    c.lineWidth = 1; c.stroke();
    for (const start of [-Math.PI / 2, Math.PI / 2]) { c.beginPath(); c.moveTo(x, y); c.arc(x, y, 6, start, start + Math.PI / 2); c.fill(); }
  };
  // The number of each pass where it begins, as far as there is room; gives those that are drawn.
  const passNumbers = (c, passes) => {
    if (passes.length === 0) return [];
    const taken = [], GAP = 6, HIGH = 12;
    c.font = "bold 12px system-ui, sans-serif";
    c.textAlign = "center";
    c.textBaseline = "middle";
    const drawn = [];
    for (const { number: n, from } of passes) {
      const x = toPxX(from[1]), y = toPxY(from[0] / 2), text = String(n), wide = c.measureText(text).width;
      if (x < LEFT || x > frame.width || y < 0 || y > frame.height - BOTTOM) continue;
      c.beginPath(); c.arc(x, y, 2.5, 0, 2 * Math.PI);
      c.fillStyle = colours["lit-core"]; c.fill();
      if (drawn.length >= 500) continue;
      const room = [[GAP + wide / 2, 0], [-GAP - wide / 2, 0], [0, -GAP - HIGH / 2], [0, GAP + HIGH / 2]]
        .map(([dx, dy]) => [x + dx - wide / 2 - 1, y + dy - HIGH / 2, x + dx + wide / 2 + 1, y + dy + HIGH / 2])
        .find(([x0, y0, x1, y1]) => x0 > LEFT && x1 < frame.width && y0 > 0 && y1 < frame.height - BOTTOM
          && !taken.some(([a0, b0, a1, b1]) => x0 < a1 && a0 < x1 && y0 < b1 && b0 < y1));
      if (!room) continue;
      taken.push(room);
      drawn.push(n);
      c.lineWidth = 3; c.lineJoin = "round"; c.strokeStyle = colours.paper;
      c.strokeText(text, (room[0] + room[2]) / 2, (room[1] + room[3]) / 2);
      c.fillText(text, (room[0] + room[2]) / 2, (room[1] + room[3]) / 2);
    }
    return drawn;
  };
  return { axes, chuck, zero, passNumbers };
};

// The part, the tool and what was found about them.
const partDrawing = (frame, model) => {
  const { toPxX, toPxY, toZ, view, colours } = frame;
  // The stock as it is now, with what stands around it and what came off; the half below the axis is the mirror image.
  let stockDrawn = "";
  const forget = () => { stockDrawn = ""; };
  // An outline at a place; closed for filling, or its edges without those on the axis.
  const outlinePath = (outline, x = 0, z = 0, closed = true) => {
    const drawn = new Path2D(), places = outlinePlaces(outline, 0.1 / view.pxPerMm);
    places.concat([places[0]]).forEach(([pz, px], n) => {
      const isFree = n === 0 || (!closed && Math.max(px, places[n - 1][1]) < 1e-6);
      if (isFree) drawn.moveTo(toPxX(pz + z), toPxY(px + x)); else drawn.lineTo(toPxX(pz + z), toPxY(px + x));
    });
    if (closed) drawn.closePath();
    return drawn;
  };
  const bothHalves = (half) => {
    const both = new Path2D(half);
    both.addPath(half, new DOMMatrix([1, 0, 0, -1, 0, 2 * toPxY(0)]));
    return both;
  };
  const stock = (c, { slabs, version }, pieces) => {
    const wanted = [version, pieces.length, view.x, view.z, view.pxPerMm, frame.width, frame.height, colours.paper].join();
    if (wanted === stockDrawn) return;
    stockDrawn = wanted;
    const z0 = toZ(0), z1 = toZ(frame.width);
    const seen = (all) => all.filter(({ from, to }) => to > z0 && from < z1);
    const paint = (all, fillColour, edgeColour, dash) => {
      const { fill, edges } = sectionPaths(seen(all), view.pxPerMm, toPxX, toPxY);
      c.fillStyle = fillColour;
      c.fill(bothHalves(fill));
      c.strokeStyle = edgeColour;
      c.setLineDash(dash);
      c.stroke(bothHalves(edges));
      c.setLineDash([]);
    };
    c.clearRect(0, 0, frame.width, frame.height);
    frame.inPlot(c, () => {
      c.lineJoin = c.lineCap = "round";
      c.lineWidth = 1;
      for (const { outline } of model.obstacles) {
        const drawn = bothHalves(outlinePath(outline));
        c.fillStyle = colours.holder;
        c.fill(drawn);
        c.strokeStyle = colours["faint-ink"];
        c.stroke(drawn);
      }
      c.lineWidth = 1.2;
      for (const piece of pieces) paint(piece.slabs, colours.fallen, colours["stock-edge"], [5, 3]);
      c.lineWidth = 1.5;
      paint(slabs, colours.stock, colours["stock-edge"], []);
      c.lineWidth = 1;
      c.strokeStyle = colours["faint-ink"];
      c.setLineDash([10, 3, 2, 3, 2, 3]);
      c.stroke(bothHalves(outlinePath(model.outline, 0, 0, false)));
      c.setLineDash([]);
    });
  };
  const tool = (c, { body, cutting }, [x, z]) => {
    c.lineJoin = "round";
    for (const [outline, fill, edge] of [[body, colours.holder, colours["faint-ink"]], [cutting, colours.insert, colours.ink]]) {
      if (!outline) continue;
      const drawn = outlinePath(outline, x, z);
      c.globalAlpha = 0.85;
      c.fillStyle = fill; c.fill(drawn);
      c.globalAlpha = 1;
      c.lineWidth = 1.2; c.strokeStyle = edge; c.stroke(drawn);
    }
  };
  const findings = (c, marks) => {
    for (const { x, z, bounds, found } of marks) {
      const colour = colours[found.severity === "alarm" ? "error" : found.severity];
      const px = toPxX(z), py = toPxY(x);
      c.strokeStyle = colour;
      if (bounds && found.severity !== "note") {
        c.lineWidth = 1.5;
        c.setLineDash([4, 3]);
        c.strokeRect(toPxX(bounds[1]), toPxY(bounds[2]), (bounds[3] - bounds[1]) * view.pxPerMm, (bounds[2] - bounds[0]) * view.pxPerMm);
        c.setLineDash([]);
      }
      for (const [wide, ink] of [[6, colours.paper], [2.5, colour]]) {
        c.lineWidth = wide; c.strokeStyle = ink;
        c.beginPath(); c.arc(px, py, 8, 0, 2 * Math.PI);
        c.moveTo(px - 4, py - 4); c.lineTo(px + 4, py + 4); c.moveTo(px + 4, py - 4); c.lineTo(px - 4, py + 4);
        c.stroke();
      }
      c.font = "bold 12px system-ui, sans-serif";
      c.textAlign = "left"; c.textBaseline = "middle";
      c.lineWidth = 3; c.strokeStyle = colours.paper; c.strokeText(found.id, px + 12, py);
      c.fillStyle = colour; c.fillText(found.id, px + 12, py);
    }
  };
  return { stock, tool, findings, forget };
};
