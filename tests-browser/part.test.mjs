// The part in the report, in a real headless Chromium: the stock along the time slider, the marks of what was found, the
// sizes and the assumptions, the view in space.
//
// TURNWRIGHT           path of the program to make the reports with; without it cargo runs it
// TURNWRIGHT_CHROMIUM  path of the browser, /usr/bin/chromium without it
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, afterEach, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const ROOT = path.join(path.dirname(fileURLToPath(import.meta.url)), "..");
const BROWSER = process.env.TURNWRIGHT_CHROMIUM ?? "/usr/bin/chromium";
const ARGUMENTS = ["--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
  "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

// A bar of 50 is turned to a drawing of 20, a cone, an arc and 40; then a rapid goes 5 mm into the shoulder (line 20), and
// the part is cut off at Z-50 with a blade of 3.
const DRAWN = `O7001
(CONTROL fanuc-0i-tf)
(SETUP STOCK D50 L80)
(SETUP TOOL 1 CNMG120404 PCLNR2525M12)
(SETUP TOOL 2 CUT-OFF W3)
(SETUP CHUCK D160)
T0101
G97 S800 M3
G0 X52. Z2.
G71 U2. R0.5
G71 P10 Q20 U0.4 W0.1 F0.25
N10 G0 X20.
G1 Z-20. F0.15
X30. Z-30.
G2 X40. Z-35. R5.
G1 Z-45.
N20 X52.
G70 P10 Q20
G0 X30. Z-20.
Z-40.
X100.
Z50.
T0202
G0 X54. Z-50.
G75 R0.3
G75 X-1. P2000 F0.08
G0 X100. Z50.
M30
`;
// Nothing is said of stock and tools.
const BARE = DRAWN.split("\n").filter((line) => !line.startsWith("(SETUP")).join("\n");

let folder, browser, page;
let complaints = [], requests = [];

const reportOf = (name, text, ...options) => {
  const file = path.join(folder, `${name}.nc`), out = path.join(folder, name);
  writeFileSync(file, text);
  const program = process.env.TURNWRIGHT
    ? [process.env.TURNWRIGHT] : [process.env.CARGO ?? "cargo", "run", "--quiet", "-p", "turnwright", "--"];
  try {
    execFileSync(program[0], [...program.slice(1), "run", file, "--out", out, ...options], { cwd: ROOT, stdio: ["ignore", "ignore", "pipe"] });
  } catch (error) {
    // 1 says that something was found, which is what is wanted.
    if (error.status !== 1) throw error;
  }
  return path.join(out, "report.html");
};

const open = async (report, options = {}) => {
  const context = await browser.newContext({ viewport: { width: 1300, height: 900 }, colorScheme: "light", ...options });
  complaints = [];
  requests = [];
  page = await context.newPage();
  page.on("console", (message) => complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.stack));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(pathToFileURL(report).href);
};

let drawn, bare;
before(async () => {
  folder = mkdtempSync(path.join(tmpdir(), "turnwright-part-"));
  drawn = reportOf("drawn", DRAWN);
  bare = reportOf("bare", BARE);
  browser = await chromium.launch({ executablePath: BROWSER, args: ARGUMENTS });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

afterEach(async () => {
  assert.deepEqual(complaints.filter((text) => !/GPU stall|Automatic fallback/.test(text)), [], "the page complains of nothing");
  assert.equal(requests.filter((url) => !url.startsWith("data:")).length, requests.length > 0 ? 1 : 0, "one file, nothing beside it");
  await page?.context().close();
  page = undefined;
});

const at = (z) => page.evaluate((z) => turnwright.diametersAt(z), z);
const near = (found, wanted, what, slack = 1e-4) => {
  assert.equal(found.length, wanted.length, `${what}: ${JSON.stringify(found)}`);
  wanted.forEach((ring, n) => ring.forEach((size, side) => assert.ok(Math.abs(found[n][side] - size) < slack, `${what}: ${JSON.stringify(found)}`)));
};
const settle = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
const painted = (layer) => page.evaluate((id) => {
  const canvas = document.getElementById(id);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 3; i < data.length; i += 4) if (data[i] > 0) count++;
  return count;
}, layer);

test("the slider leads from the bar to the part of the drawing", async () => {
  await open(drawn);
  await page.fill("#position", "0");
  for (const z of [-1, -25, -44, -79]) near(await at(z), [[0, 50]], `the bar at Z${z}`);
  const bar = await page.evaluate(() => turnwright.sectionArea);
  assert.ok(Math.abs(bar - 25 * 80) < 1e-6, `${bar}`);
  // After finishing, line 18: the drawing, but for what the nose leaves in corners.
  const done = await page.evaluate(() => { const all = turnwright.linesOfMoves(); return all.lastIndexOf(18) + 1; });
  await page.evaluate((step) => turnwright.goTo(step), done);
  near(await at(-10), [[0, 20]], "the pin");
  near(await at(-25), [[0, 25]], "the cone", 0.5);
  near(await at(-40), [[0, 40]], "the shoulder");
  near(await at(-60), [[0, 50]], "the bar");
  const text = await page.textContent("#sizes");
  assert.match(text, /⌀20/);
  assert.match(text, /⌀50 × 47/);
});

test("on the way a cut is taken away as far as the tool has come", async () => {
  await open(drawn);
  // The first roughing pass along Z: halfway its front half is done.
  const [start, end] = await page.evaluate(() => {
    const all = turnwright.linesOfMoves();
    for (let step = all.indexOf(11); ; step++) {
      turnwright.goTo(step);
      const before = turnwright.sectionArea;
      turnwright.goTo(step + 1);
      if (turnwright.sectionArea < before - 10) { const end = turnwright.time; turnwright.goTo(step); return [turnwright.time, end]; }
    }
  });
  const area = (time) => page.evaluate((time) => { turnwright.goToTime(time); return turnwright.sectionArea; }, time);
  const areas = [await area(start)];
  for (const share of [0.25, 0.5, 0.75, 0.999999]) areas.push(await area(start + share * (end - start)));
  areas.push(await area(end));
  for (let n = 1; n < areas.length; n++) assert.ok(areas[n] <= areas[n - 1] + 1e-9, `ever less: ${areas}`);
  const share = (areas[0] - areas[2]) / (areas[0] - areas[5]);
  assert.ok(share > 0.4 && share < 0.6, `half the time, half the chips: ${areas}`);
  assert.ok(Math.abs(areas[4] - areas[5]) < 0.2, `nothing jumps at the end: ${areas}`);
  // Back and forth makes no difference.
  assert.ok(Math.abs((await area(start)) - areas[0]) < 1e-9);
  assert.ok(Math.abs((await area(end)) - areas[5]) < 1e-9);
});

test("the block that runs is lit, and a click on a block goes to its moment", async () => {
  await open(drawn);
  const moments = await page.evaluate(() => [0.1, 0.3, 0.5, 0.7, 0.9].map((share) => {
    turnwright.goToTime(share * turnwright.totalTime);
    return { line: turnwright.currentLine, row: Number(document.querySelector(".row.current")?.dataset.line) };
  }));
  for (const { line, row } of moments) assert.equal(row, line);
  assert.ok(new Set(moments.map(({ line }) => line)).size > 1);
  await page.click("#line-24");
  assert.equal(await page.evaluate(() => turnwright.currentLine), 24);
  near(await at(-10), [[0, 20]], "the pin is turned by then");
});

test("playing takes the stock away and ends with the part", async () => {
  await open(drawn);
  await page.selectOption("#speed", "100");
  await page.focus("#picture");
  await page.keyboard.press("Home");
  const before = await page.evaluate(() => turnwright.sectionArea);
  await page.keyboard.press("Space");
  await page.waitForFunction(() => turnwright.time > 30);
  await page.keyboard.press("Space");
  const paused = await page.evaluate(() => [turnwright.playing, turnwright.time, turnwright.sectionArea]);
  assert.equal(paused[0], false);
  assert.ok(paused[2] < before);
  await settle();
  assert.equal(await page.evaluate(() => turnwright.time), paused[1], "a pause stays where it is");
  await page.selectOption("#speed", "1000");
  await page.focus("#picture");
  await page.keyboard.press("Space");
  await page.waitForFunction(() => turnwright.step === turnwright.steps && !turnwright.playing);
});

test("a crash is marked in the picture, and its mark leads to the finding", async () => {
  await open(drawn);
  const finding = page.locator("#diagnostics .found.error", { hasText: "T350" });
  assert.match(await finding.textContent(), /into the stock at rapid, at X[\d.]+ Z-/);
  const before = await painted("layer-marks");
  assert.ok(before > 200, "marks are drawn at the end too");
  await finding.locator(".link", { hasText: "show the place" }).click();
  assert.equal(await page.evaluate(() => turnwright.currentLine), 20);
  // From close by: what is hit, 10 mm wide, takes a good part of the view.
  const [left, right] = await page.evaluate(() => turnwright.pixelsOfZ(-30, -40));
  assert.ok(Math.abs(right - left) > 120, `${right - left}`);
  await page.click("#fit");
  const index = await page.locator("#diagnostics .found")
    .evaluateAll((all) => all.findIndex((one) => one.textContent.includes("T350")));
  await page.keyboard.press("End");
  await page.evaluate(() => scrollTo(0, 0));
  const { x, y } = (await page.evaluate(() => turnwright.marks())).find((one) => one.finding === index);
  await page.mouse.move(x, y);
  assert.match(await page.textContent("#hover"), /T350/);
  await page.mouse.click(x, y);
  assert.equal(await page.evaluate(() => turnwright.currentLine), 20, "a click on the mark goes there too");
});

test("a rapid into the stock takes it away as it goes", async () => {
  await open(drawn);
  const areas = await page.evaluate(() => {
    const move = turnwright.linesOfMoves().indexOf(20);
    return [0, 0.25, 0.5, 0.75, 0.999999].map((share) => { turnwright.goTo(move, share); return turnwright.sectionArea; })
      .concat([(turnwright.goTo(move + 1), turnwright.sectionArea)]);
  });
  for (let n = 1; n < areas.length; n++) assert.ok(areas[n] <= areas[n - 1] + 1e-9, `${areas}`);
  assert.ok(areas[0] - areas[5] > 5, "it crashes");
  assert.ok(areas[4] - areas[5] < 0.2, `nothing jumps at the end: ${areas}`);
});

test("the piece that is cut off stays in the picture, and is no material any more", async () => {
  await open(drawn);
  await page.keyboard.press("End");
  near(await at(-10), [], "the part has fallen");
  near(await at(-60), [[0, 50]], "the stub is held");
  const all = await painted("layer-stock");
  assert.match(await page.textContent("#diagnostics"), /comes off/);
  assert.ok(all > 10000);
});

test("without a setup the stock is inferred, and every assumption is told", async () => {
  await open(bare);
  const told = await page.$$eval("#assumptions li", (all) => all.map((one) => one.textContent));
  assert.ok(told.length >= 4, told.join("|"));
  assert.ok(told.some((text) => /Stock: 5[024] mm/.test(text)), told.join("|"));
  await page.click("#assumptions .link");
  assert.ok((await page.evaluate(() => turnwright.selectedLine)) > 0);
  await page.fill("#position", "0");
  assert.equal((await at(-10)).length, 1, "there is a bar");
  assert.equal(await page.locator("#diagnostics .found.error").count(), 0, "of an assumed bar no crash is told");
});

test("the page in Chinese: nothing of the part stays English", async () => {
  await open(drawn);
  const texts = () => page.$$eval("#sizes th, #views button, #assumptions li, .legend li, .found .link, .found p", (all) => all.map((one) => one.textContent).filter((text) => text));
  const english = await texts();
  await page.keyboard.press("l");
  const chinese = await texts();
  assert.equal(chinese.length, english.length);
  assert.deepEqual(chinese.filter((text, n) => text === english[n]), []);
  assert.match(await page.textContent("#sizes"), /外圆/);
});

test("in space the part is drawn, is cut open, and changes with the time", async () => {
  await open(drawn);
  await page.click("#solid-shown");
  await settle();
  const seen = () => page.evaluate(() => turnwright.solid);
  const done = await seen();
  assert.ok(done.painted > 20000, `the canvas is not empty: ${done.painted}`);
  assert.equal(await page.locator("#picture").isVisible(), false);
  await page.fill("#position", "0");
  const bar = await seen();
  // A bar: its cylinder and two faces.
  assert.equal(bar.walls, 3);
  await page.evaluate(() => turnwright.goToTime(0.8 * turnwright.totalTime));
  assert.ok((await seen()).walls > 6);
  await page.keyboard.press("c");
  assert.equal((await seen()).isOpen, false);
  assert.equal(await page.getAttribute("#quarter", "aria-pressed"), "false");
  // Turning it by hand changes the picture, and Fit brings it back.
  const before = (await seen()).painted, box = await page.locator("#solid").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 120, box.y + box.height / 2 + 60, { steps: 4 });
  await page.mouse.up();
  assert.notEqual((await seen()).painted, before);
  await page.click("#fit");
  assert.equal((await seen()).painted, before);
  await page.keyboard.press("s");
  assert.ok(await page.locator("#picture").isVisible());
  assert.equal(await seen(), null);
});

// A thread before the part comes off (held, and in the piece that fell), and one that is the last thing.
const THREADED = `O7002
(CONTROL fanuc-0i-tf)
(SETUP STOCK D40 L60)
(SETUP TOOL 3 THREADING)
(SETUP TOOL 2 CUT-OFF W3)
T0303
G97 S500 M3
G0 X44. Z5.
G92 X39. Z-15. F2.
X38.
X37.6
G0 X100. Z50.
M30
`;
test("in space the threads of the finished part wind, and before that the page says that they are rings", async () => {
  const note = () => page.evaluate(() => { const one = document.getElementById("solid-note"); return one.hidden ? "" : one.textContent; });
  await open(reportOf("threaded", THREADED));
  await page.click("#solid-shown");
  await settle();
  const seen = () => page.evaluate(() => turnwright.solid);
  assert.deepEqual([(await seen()).isWound, await note()], [true, ""]);
  const isOpen = (await seen()).painted;
  assert.ok(isOpen > 20000, `${isOpen}`);
  await page.keyboard.press("c");
  assert.notEqual((await seen()).painted, isOpen, "closed it looks another way");
  await page.fill("#position", "0");
  assert.equal((await seen()).isWound, false);
  assert.match(await note(), /rings until the part is finished/);
  await page.keyboard.press("l");
  assert.match(await note(), /圆环/);
  // Off it comes, and winds where it fell.
  const off = THREADED.replace("M30", "T0202\nG0 X44. Z-30.\nG1 X-1. F0.1\nG0 X44.\nX100. Z50.\nM30");
  await page.context().close();
  await open(reportOf("threaded-off", off));
  await page.click("#solid-shown");
  await settle();
  assert.equal((await seen()).isWound, true);
  const move = await page.evaluate(() => turnwright.linesOfMoves().indexOf(15));
  await page.evaluate((step) => turnwright.goTo(step), move);
  assert.equal((await seen()).isWound, false);
  await page.evaluate((step) => turnwright.goTo(step), move + 1);
  assert.equal((await seen()).isWound, true);
  // Without threads nothing is said of them.
  await page.context().close();
  await open(drawn);
  await page.click("#solid-shown");
  await settle();
  assert.deepEqual([(await seen()).isWound, await note()], [false, ""]);
});

// Where the line of the plots is, as a share of the slider's time; the plots have a margin at both sides.
const cursorShare = () => page.evaluate(() => {
  const [host, line] = ["#plots", ".plot-cursor"].map((one) => document.querySelector(one).getBoundingClientRect());
  return (line.left + line.width / 2 - host.left - 52) / (host.width - 62);
});

test("the lanes over time show the moment of the slider, and a press on them leads to it", async () => {
  await open(drawn);
  const lanes = await page.evaluate(() => turnwright.plots.lanes());
  assert.deepEqual(lanes, ["X ⌀ mm", "Z mm", "speed mm/min", "spindle rpm", "depth of cut", "chip thickness", "surface speed",
    "removal rate", "theoretical roughness Rz"]);
  for (const share of [0, 0.25, 0.9]) {
    await page.evaluate((share) => turnwright.goToTime(share * turnwright.totalTime), share);
    assert.ok(Math.abs((await cursorShare()) - share) < 0.01, `${share}: ${await cursorShare()}`);
  }
  // The values of the lanes are those of the moment: at the end the tool stands at X100 Z50.
  await page.keyboard.press("End");
  assert.match(await page.textContent("#plots .lane"), /X ⌀ mm .*100/);
  await page.locator("#plots").scrollIntoViewIfNeeded();
  const box = await page.locator("#plots").boundingBox();
  const press = (share) => [box.x + 52 + share * (box.width - 62), box.y + 300];
  await page.mouse.click(...press(0.4));
  const [time, line, row] = await page.evaluate(() => [turnwright.time / turnwright.totalTime, turnwright.currentLine, Number(document.querySelector(".row.current")?.dataset.line)]);
  assert.ok(Math.abs(time - 0.4) < 0.01, `${time}`);
  assert.ok(line > 0 && row === line, "the block of the moment is lit");
  assert.ok(Math.abs(Number(await page.inputValue("#position")) - 0.4 * (await page.evaluate(() => turnwright.totalTime))) < 2);
  // The line follows a finger.
  await page.mouse.move(...press(0.4));
  await page.mouse.down();
  await page.mouse.move(...press(0.7), { steps: 3 });
  await page.mouse.up();
  assert.ok(Math.abs((await page.evaluate(() => turnwright.time / turnwright.totalTime)) - 0.7) < 0.01);
  await page.mouse.move(...press(0.1));
  assert.ok(Math.abs((await cursorShare()) - 0.7) < 0.01, "without a press nothing moves");
});

test("the peaks of the cutting data lead to their lines and moments", async () => {
  await open(drawn);
  const peaks = await page.$$eval("#peaks li", (all) => all.map((one) => one.textContent));
  assert.equal(peaks.length, 5);
  assert.match(peaks[0], /depth of cut up to 3\.000 mm \(line 26, tool 2\)/);
  assert.match(await page.textContent("#peaks-note"), /names the material/);
  const first = page.locator("#peaks li").first();
  await first.locator(".link", { hasText: "line 26" }).click();
  assert.equal(await page.evaluate(() => turnwright.selectedLine), 26);
  await first.locator(".link", { hasText: "show the moment" }).click();
  assert.equal(await page.evaluate(() => turnwright.currentLine), 26);
  await page.keyboard.press("l");
  assert.match(await page.textContent("#peaks li"), /切削深度/);
  assert.match(await page.textContent("#plots"), /主轴/);
});

test("on a phone the lanes are as wide as the page, and no wider", async () => {
  await open(drawn, { viewport: { width: 390, height: 844 } });
  const [page_, plots] = await page.evaluate(() => [document.documentElement.scrollWidth, document.querySelector("#plots svg").getBoundingClientRect().width]);
  assert.ok(page_ <= 390 && plots > 330, `${page_} ${plots}`);
  await page.setViewportSize({ width: 800, height: 600 });
  await settle();
  assert.ok((await page.locator("#plots svg").boundingBox()).width > 700, "turned to the side they grow");
});

test("where several cuts are shown as one the page says so, and each of their lines leads there", async () => {
  // As if the move of line 14 were those of lines 14 and 15, which is shaped by another one.
  const joined = path.join(folder, "joined.html"), text = readFileSync(drawn, "utf8");
  await open(drawn);
  assert.equal(await page.locator("#joined").isVisible(), false);
  const move = await page.evaluate(() => turnwright.linesOfMoves().indexOf(21));
  assert.ok(text.includes(`"joined_mm":0,`));
  writeFileSync(joined, text.replace('"joined_mm":0,', '"joined_mm":0.004,').replace('"joined":[]', `"joined":[${move},25]`));
  await page.context().close();
  await open(joined);
  assert.match(await page.textContent("#joined"), /within 0\.004 mm/);
  await page.click("#line-25");
  assert.equal(await page.evaluate(() => turnwright.currentLine), 21);
  await page.evaluate((move) => turnwright.goTo(move + 1), move);
  assert.match(await page.textContent("#readout"), /lines 21 to 25/);
  await page.keyboard.press("l");
  assert.match(await page.textContent("#joined"), /0\.004/);
});

test("a long program: the section follows at once as far as it is known, and exactly when the hand rests", async () => {
  const waves = Array.from({ length: 12 }, (_, pass) => ["G0 X52. Z1.", `G1 X${48 - pass} F0.2`,
    ...Array.from({ length: 1700 }, (_, n) => `X${(48 - pass + 0.5 * Math.sin(n / 30)).toFixed(3)} Z${(-n / 50).toFixed(3)}`), "G0 X60."].join("\n"));
  const long = reportOf("long", DRAWN.replace(/G0 X52[^]*M30/, `${waves.join("\n")}\nM30`));
  await open(long);
  assert.ok((await page.evaluate(() => turnwright.steps)) > 20000);
  // Between two moments, far from both.
  const shown = () => page.evaluate(() => document.getElementById("layer-stock").toDataURL());
  await page.evaluate(() => turnwright.goTo(9000));
  await page.evaluate(() => new Promise((done) => setTimeout(done, 400)));
  const [exact, area] = [await shown(), await page.evaluate(() => turnwright.sectionArea)];
  for (const step of [9010, 100, 17000, 9000]) await page.evaluate((step) => turnwright.goTo(step), step);
  await page.waitForFunction((exact) => document.getElementById("layer-stock").toDataURL() === exact, exact);
  // The list of the program, too long to be all there, comes to the row when the hand rests.
  const { line, isThere } = await page.evaluate(() => {
    for (let step = 5000; step <= 9900; step += 100) turnwright.goTo(step);
    const line = turnwright.currentLine;
    return { line, isThere: document.querySelector(`.row[data-line="${line}"]`) !== null };
  });
  assert.equal(isThere, false);
  await page.waitForFunction((line) => document.querySelector(".row.current")?.dataset.line === String(line), line);
  await page.evaluate(() => turnwright.goTo(9000));
  // Cuts in the same direction are taken away together where that is as exact: the last moment agrees.
  const areas = await page.evaluate(() => [8999, 9000, 9001].map((step) => (turnwright.goTo(step), turnwright.sectionArea)));
  assert.ok(areas[0] >= areas[1] && areas[1] >= areas[2] && Math.abs(areas[1] - area) < 0.02, `${areas} ${area}`);
});

test("a step of the slider costs as many comparisons as the section has stops, not their square", async () => {
  // Fine waves crossed by passes of another phase leave rings upon rings in thin slabs.
  const waves = Array.from({ length: 40 }, (_, pass) => [`G0 X${52 + pass % 2} Z1.`, `G1 X${(48 - 0.1 * pass).toFixed(3)} F0.2`,
    ...Array.from({ length: 50 }, (_, n) => `X${(48 - 0.1 * pass + 0.4 * Math.sin(n / 2 + pass)).toFixed(3)} Z${(-n / 2).toFixed(3)}`), "G0 X60."].join("\n"));
  await open(reportOf("waves", DRAWN.replace(/G0 X52[^]*M30/, `${waves.join("\n")}\nM30`)));
  const found = await page.evaluate(async () => {
    const all = [];
    for (let share = 0.05; share < 1; share += 0.05) {
      const before = turnwright.work;
      turnwright.goTo(Math.floor(share * turnwright.steps));
      const now = turnwright.work;
      all.push({ stops: now.stops - before.stops, corners: now.corners - before.corners, rings: turnwright.rings });
    }
    return all;
  });
  for (const { stops, corners, rings } of found) {
    assert.ok(stops > 0 && corners > 0, "each step draws the section anew");
    // A ring has two stops at both its ends; the same section is drawn once a step.
    assert.ok(stops <= 4 * rings, `${stops} stops of ${rings} rings`);
    assert.ok(corners <= 4 * rings, `${corners} corners of ${rings} rings`);
  }
  const { rings } = found.at(-1);
  assert.ok(rings > 20, `${rings} rings`);
  // The same moment again is not drawn again.
  const again = await page.evaluate(() => { const before = turnwright.work; turnwright.goTo(turnwright.step); return [before, turnwright.work]; });
  assert.deepEqual(again[1], again[0]);
});

test("faces of many rings upon one another are those of the plain rule, and each stop is passed once", async () => {
  await open(drawn);
  const differences = await page.evaluate(() => {
    const edge = (x) => ({ z: 0, x, s: 0 });
    let seed = 1;
    const die = () => { seed = (seed * 48271) % 2147483647; return seed / 2147483647; };
    const column = () => { const all = []; let x = 0; for (let n = Math.floor(die() * 8); n > 0; n--) { const floor = x + Math.floor(die() * 3), roof = floor + 1 + Math.floor(die() * 3); all.push([floor, roof]); x = roof; } return all; };
    const isIn = (rings, x) => rings.some(([floor, roof]) => floor < x && x < roof);
    let wrong = 0, faces = 0;
    for (let n = 0; n < 2000; n++) {
      const sides = [column(), column()], found = new Map();
      const slabs = sides.map((rings, at) => ({ from: at, to: at + 1, rings: rings.map(([a, b]) => [edge(a), edge(b)]) }));
      uprightFaces(slabs, (z, a, b, way) => { if (z === 1) for (let x = a; x < b; x++) found.set(x, way); faces++; });
      for (let x = 0; x < 50; x++) {
        const [before, behind] = sides.map((rings) => isIn(rings, x + 0.5));
        if ((found.get(x) ?? 0) !== (before === behind ? 0 : before ? 1 : -1)) wrong++;
      }
    }
    // Two thousand rings against two thousand that lie half a ring higher.
    const slabs = [0, 0.5].map((off, at) => ({ from: at, to: at + 1, rings: Array.from({ length: 2000 }, (_, n) => [edge(2 * n + off), edge(2 * n + 1 + off)]) }));
    const before = turnwright.work.stops;
    uprightFaces(slabs, () => {});
    return { wrong, faces, stops: turnwright.work.stops - before };
  });
  assert.equal(differences.wrong, 0);
  assert.ok(differences.faces > 5000);
  // All of one slab where it begins, of both where they meet, of the other where it ends.
  assert.equal(differences.stops, 4000 + 8000 + 4000);
});

test("--no-3d leaves three.js out, and the button with it", async () => {
  const small = reportOf("small", DRAWN, "--no-3d");
  const saved = statSync(drawn).size - statSync(small).size;
  assert.ok(saved > 500_000, `${saved} bytes less`);
  await open(small);
  assert.equal(await page.locator("#solid-shown").isVisible(), false);
  assert.ok(await page.locator("#plots svg").isVisible(), "the lanes stay");
  await page.keyboard.press("s");
  assert.ok(await page.locator("#picture").isVisible());
});

test("without WebGL the page says so and stays at the section", async () => {
  await open(drawn);
  await page.evaluate(() => { HTMLCanvasElement.prototype.getContext = ((get) => function (kind, ...rest) { return kind.startsWith("webgl") ? null : get.call(this, kind, ...rest); })(HTMLCanvasElement.prototype.getContext); });
  await page.click("#solid-shown");
  assert.ok(await page.locator("#picture").isVisible());
  assert.match(await page.textContent("#incomplete"), /no WebGL/);
  assert.ok(await page.locator("#solid-shown").isDisabled());
  complaints = complaints.filter((text) => !/WebGL/.test(text));
});

test("without scripts the page shows the finished part and says what is missing", async () => {
  await open(drawn, { javaScriptEnabled: false });
  assert.match(await page.textContent("noscript"), /needs scripts/);
  assert.ok((await page.locator("noscript svg").boundingBox()).width > 300);
});
