// The report in a real headless Chromium: what a user does with hands and keys, and what must come of it.
//
// TURNWRIGHT_REPORT    path of a report to test; without it one is made by the demo_report example
// TURNWRIGHT_CHROMIUM  path of the browser, /usr/bin/chromium without it
//
// The checks ask the report for its own path and lines, so that they hold for any report with some moves;
// those that need the demo's program run only on the demo.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, beforeEach, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const ROOT = path.join(path.dirname(fileURLToPath(import.meta.url)), "..");
const BROWSER = process.env.TURNWRIGHT_CHROMIUM ?? "/usr/bin/chromium";
const ARGUMENTS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const isDemo = !process.env.TURNWRIGHT_REPORT;

let folder, report, browser, context, page;
let complaints = [], requests = [];

before(async () => {
  folder = mkdtempSync(path.join(tmpdir(), "turnwright-report-"));
  report = process.env.TURNWRIGHT_REPORT ?? path.join(folder, "report.html");
  if (isDemo) {
    const make = ["run", "--quiet", "-p", "turnwright-export", "--example", "demo_report", "--", report];
    execFileSync(process.env.CARGO ?? "cargo", make, { cwd: ROOT, stdio: ["ignore", "inherit", "inherit"] });
  }
  browser = await chromium.launch({ executablePath: BROWSER, args: ARGUMENTS });
  context = await browser.newContext({ viewport: { width: 1300, height: 900 }, colorScheme: "light" });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

beforeEach(async () => {
  await page?.close();
  complaints = [];
  requests = [];
  page = await context.newPage();
  page.on("console", (message) => complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.stack));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(pathToFileURL(path.resolve(report)).href);
});

const state = () => page.evaluate(() => ({
  selectedLine: turnwright.selectedLine, selectedMove: turnwright.selectedMove, step: turnwright.step,
  steps: turnwright.steps, view: turnwright.view, language: turnwright.language, lit: turnwright.highlightedSegments(),
}));
const boldLines = () => page.$$eval(".row.moves", (rows) => rows.map((row) => Number(row.dataset.line)));
const readout = () => page.textContent("#readout");
// The first segment of the program whose middle is well inside the frame.
const segmentInFrame = () => page.evaluate(() => {
  const frame = document.getElementById("picture").getBoundingClientRect();
  for (let i = 0; ; i++) {
    const { x, y } = turnwright.placeOf(i);
    if (Number.isNaN(x)) return -1;
    const inside = x > frame.left + 80 && x < frame.right - 20 && y > frame.top + 40 && y < frame.bottom - 60;
    if (inside && turnwright.lineOf(i) > 0) return i;
  }
});
// What a layer shows: the number of its pixels that are not empty.
const painted = (layer) => page.evaluate((id) => {
  const canvas = document.getElementById(id);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 3; i < data.length; i += 4) if (data[i] > 0) count++;
  return count;
}, layer);
const settle = () => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

test("it opens without a complaint and asks the network for nothing", async () => {
  await settle();
  assert.deepEqual(complaints, []);
  assert.deepEqual(requests.filter((url) => !url.startsWith("file:") && !url.startsWith("data:")), []);
  assert.equal(requests.filter((url) => url.startsWith("file:")).length, 1, "one file, nothing beside it");
  assert.ok((await painted("layer-path")) > 1000, "there is a picture");
});

test("a click on a line lights its moves, Escape puts them out", async () => {
  const segment = await segmentInFrame();
  const line = await page.evaluate((i) => turnwright.lineOf(i), segment);
  await page.click(`#line-${line}`);
  const now = await state();
  assert.equal(now.selectedLine, line);
  assert.ok(now.lit.includes(segment));
  assert.ok(now.lit.length > 0);
  assert.ok((await painted("layer-marks")) > 0);
  assert.equal(await page.getAttribute(`#line-${line}`, "aria-selected"), "true");
  assert.equal(await page.evaluate(() => turnwright.currentLine), now.step === now.steps ? 0 : line, "its first move is shown done");
  const marked = await painted("layer-marks");
  await page.keyboard.press("Escape");
  const then = await state();
  assert.equal(then.selectedLine, 0);
  assert.equal(then.step, now.step, "the moment stays");
  assert.deepEqual(then.lit, []);
  assert.ok((await painted("layer-marks")) < marked);
  await page.keyboard.press("End");
  assert.equal(await painted("layer-marks"), 0);
});

test("a click on the picture selects the line of the move and scrolls to it", async () => {
  const { view } = await state();
  const segment = await segmentInFrame();
  assert.ok(segment >= 0, "a segment in the frame");
  const place = await page.evaluate((i) => turnwright.placeOf(i), segment);
  await page.mouse.move(place.x, place.y);
  assert.match(await page.textContent("#hover"), /X⌀.*Z/);
  await page.mouse.click(place.x, place.y);
  const now = await state();
  assert.ok(now.selectedMove >= 0 && now.selectedLine > 0);
  assert.ok(now.lit.length > 0);
  assert.deepEqual(now.view, view, "a click does not move the view");
  assert.match(await readout(), /X⌀ [−\d.]+\s+Z [−\d.]+.*line \d+/);
  const [row, list] = [await page.locator(`#line-${now.selectedLine}`).boundingBox(), await page.locator("#program").boundingBox()];
  assert.ok(row.y >= list.y - 1 && row.y + row.height <= list.y + list.height + 1, "the line is in sight");
});

test("the wheel zooms about the pointer, dragging pans, fit restores", async () => {
  const before = (await state()).view;
  const place = await page.evaluate(() => turnwright.placeOf(2));
  const box = await page.locator("#picture").boundingBox();
  const at = { x: Math.round(box.x + box.width * 0.7), y: Math.round(box.y + box.height * 0.4) };
  await page.mouse.move(at.x, at.y);
  // The numbers in the corner: X and Z under the pointer.
  const pointed = async () => (await page.textContent("#hover")).replaceAll("−", "-").match(/-?\d+(\.\d+)?/g).slice(0, 2).map(Number);
  const under = await pointed();
  await page.mouse.wheel(0, -300);
  await settle();
  const zoomed = (await state()).view;
  assert.ok(zoomed.pxPerMm > before.pxPerMm * 1.3, "nearer");
  assert.notDeepEqual(await page.evaluate(() => turnwright.placeOf(2)), place);
  await page.mouse.move(at.x + 1, at.y);
  await page.mouse.move(at.x, at.y);
  const still = await pointed();
  assert.ok(Math.hypot(still[0] - under[0], still[1] - under[1]) < 0.05, `${under} stays under the pointer: ${still}`);
  await page.mouse.down();
  await page.mouse.move(at.x - 120, at.y + 40, { steps: 4 });
  await page.mouse.up();
  const panned = (await state()).view;
  assert.ok(Math.abs((panned.z - zoomed.z) * zoomed.pxPerMm - 120) < 2, "panned along Z");
  assert.ok(Math.abs((panned.x - zoomed.x) * zoomed.pxPerMm - 40) < 2, "panned along X");
  assert.equal((await state()).selectedLine, 0, "a drag selects nothing");
  for (const restore of [() => page.click("#fit"), () => page.keyboard.press("0"), () => page.keyboard.press("f"), () => page.dblclick("#picture", { position: { x: 90, y: 60 } })]) {
    await page.click("#zoom-in");
    assert.ok((await state()).view.pxPerMm > before.pxPerMm * 1.2);
    await restore();
    assert.deepEqual((await state()).view, before);
  }
});

test("steps go forwards and backwards, by buttons, keys and the slider", async () => {
  const { steps } = await state();
  assert.ok(steps > 2);
  assert.equal((await state()).step, steps, "at first everything is done");
  await page.click("#first");
  assert.equal((await state()).step, 0);
  await page.click("#forward");
  await page.click("#forward");
  assert.equal((await state()).step, 2);
  assert.match(await readout(), /X⌀/);
  assert.equal(await page.locator(".row.current").count(), 1);
  await page.evaluate(() => turnwright.selectLine(1));
  assert.match(await readout(), /^line 1/, "what was chosen last is described");
  assert.ok((await painted("layer-marks")) > 0, "the tool is shown");
  await page.click("#back");
  assert.equal((await state()).step, 1);
  await page.focus("#picture");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  assert.equal((await state()).step, 3);
  await page.keyboard.press("ArrowLeft");
  assert.equal((await state()).step, 2);
  await page.keyboard.press("End");
  assert.equal((await state()).step, steps);
  await page.keyboard.press("ArrowRight");
  assert.equal((await state()).step, steps, "behind the end there is nothing");
  await page.keyboard.press("Home");
  await page.keyboard.press("ArrowLeft");
  assert.equal((await state()).step, 0);
  const time = await page.evaluate(() => { turnwright.goTo(2); return turnwright.time; });
  await page.evaluate(() => turnwright.goTo(0));
  await page.fill("#position", String(time));
  assert.equal((await state()).step, 2, "the slider is the time");
  await page.fill("#position", String(time - 1e-3));
  assert.equal((await state()).step, 1, "on the way");
});

test("Page Down and Page Up go from block to block", async () => {
  const { steps } = await state();
  await page.click("#first");
  await page.focus("#picture");
  const lines = [], all = await page.evaluate(() => turnwright.linesOfMoves());
  for (let i = 0; i < 1000 && (await state()).step < steps; i++) {
    await page.keyboard.press("PageDown");
    const { step } = await state();
    lines.push(all[step - 1]);
    assert.ok(step === steps || all[step] !== all[step - 1], "at the end of a block");
  }
  assert.deepEqual(lines, all.filter((line, at) => line !== all[at + 1]));
  for (let i = 0; i < lines.length; i++) await page.keyboard.press("PageUp");
  assert.equal((await state()).step, 0);
});

test("the part that is done is drawn over the rest, and taken away again", async () => {
  const { steps } = await state();
  await page.evaluate((to) => turnwright.goTo(to), Math.floor(steps / 2));
  const half = await painted("layer-done");
  await page.evaluate((to) => turnwright.goTo(to), steps - 1);
  const nearlyAll = await painted("layer-done");
  assert.ok(nearlyAll > half && half > 0);
  await page.evaluate((to) => turnwright.goTo(to), Math.floor(steps / 2));
  const again = await painted("layer-done");
  assert.ok(Math.abs(again - half) <= half * 0.01, "the same forwards and back");
});

test("Space plays to the end and pauses", async () => {
  await page.selectOption("#speed", "5");
  await page.focus("#picture");
  await page.keyboard.press("Home");
  await page.keyboard.press("Space");
  assert.equal(await page.evaluate(() => turnwright.playing), true);
  assert.equal(await page.getAttribute("#play", "aria-label"), "Pause");
  await page.keyboard.press("Space");
  assert.equal(await page.evaluate(() => turnwright.playing), false);
  await page.selectOption("#speed", "1000");
  await page.focus("#picture");
  await page.keyboard.press("Space");
  await page.waitForFunction(() => turnwright.step === turnwright.steps && !turnwright.playing);
});

test("lines are chosen by keys, Enter goes to the first move", async () => {
  const [line] = await boldLines();
  await page.focus("#program");
  for (let i = 0; i < line; i++) await page.keyboard.press("ArrowDown");
  assert.equal((await state()).selectedLine, line);
  assert.equal(await page.getAttribute("#program", "aria-activedescendant"), `line-${line}`);
  await page.keyboard.press("ArrowUp");
  assert.equal((await state()).selectedLine, Math.max(1, line - 1));
  await page.click(`#line-${line}`);
  await page.keyboard.press("Enter");
  const { step } = await state();
  assert.ok(step > 0);
  assert.equal(await page.locator(".row.current").getAttribute("data-line"), String(line));
});

test("the language changes every text and back", async () => {
  const texts = () => page.$$eval("[data-text], th, #readout, .legend li, .found .detail", (all) => all.map((one) => one.textContent).filter((text) => text));
  const english = await texts();
  await page.click("#language");
  assert.equal((await state()).language, "zh");
  assert.equal(await page.getAttribute("html", "lang"), "zh-CN");
  const chinese = await texts();
  assert.equal(chinese.length, english.length);
  assert.ok(chinese.includes("程序") && chinese.includes("刀具路径"));
  const same = chinese.filter((text, at) => text === english[at]);
  assert.deepEqual(same, [], "nothing stays in the other language");
  assert.equal(await page.getAttribute("#first", "aria-label"), "到开头");
  assert.match(await page.textContent("footer"), /仿真软件不是安全装置/);
  await page.keyboard.press("l");
  assert.deepEqual(await texts(), english);
  assert.match(await page.textContent("footer"), /not a safety device/);
});

test("? opens the help and closes it", async () => {
  await page.keyboard.press("?");
  assert.ok(await page.locator("#keys").isVisible());
  assert.ok((await page.locator("#key-list dt").count()) > 5);
  await page.keyboard.press("?");
  assert.ok(!(await page.locator("#keys").isVisible()));
});

test("every control has a name, and the keyboard reaches it", async () => {
  const nameless = await page.$$eval("button, input, select, [role=listbox], [role=img]", (all) =>
    all.filter((one) => !(one.getAttribute("aria-label") || one.textContent.trim())).map((one) => one.outerHTML));
  assert.deepEqual(nameless, []);
  const reached = new Set();
  for (let i = 0; i < 16; i++) {
    await page.keyboard.press("Tab");
    reached.add(await page.evaluate(() => document.activeElement.id));
  }
  for (const id of ["first", "back", "play", "forward", "last", "position", "speed", "fit", "language", "help", "program", "picture"])
    assert.ok(reached.has(id), `${id} is reached by Tab`);
  assert.equal(await page.getAttribute("#readout", "aria-live"), "polite");
});

test("dark and light differ, paper is always light", async () => {
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await background();
  await page.emulateMedia({ colorScheme: "dark" });
  assert.notEqual(await background(), light);
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  assert.equal(await background(), light);
  await page.evaluate(() => window.dispatchEvent(new Event("afterprint")));
  assert.notEqual(await background(), light);
  await page.emulateMedia({ colorScheme: "light" });
});

test("a window of a phone shows everything in one column", async () => {
  await page.setViewportSize({ width: 420, height: 800 });
  await settle();
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= document.documentElement.clientWidth));
  assert.ok((await page.locator("#picture").boundingBox()).width > 350);
  await page.setViewportSize({ width: 1300, height: 900 });
});

test("the demo: a figure line lights the passes it shaped", { skip: !isDemo }, async () => {
  await page.click("#line-15");
  const { lit } = await state();
  // Three rough passes end on this arc, then it is cut with and without allowance.
  assert.equal(lit.length, 5);
  await page.click("#line-9");
  assert.ok((await state()).lit.length > 30, "the cycle's own line lights all of it");
});

test("the demo: a diagnostic, an operation and marks lead to their lines", { skip: !isDemo }, async () => {
  assert.equal(await page.textContent("#line-29 mark.warning"), "Z5.");
  assert.ok(await page.locator("#line-29 .sign.warning").isVisible());
  await page.click("#diagnostics .found.warning .link");
  assert.equal((await state()).selectedLine, 29);
  await page.click("#operations tbody tr:nth-child(3) .link");
  assert.equal((await state()).selectedLine, 21);
  assert.equal(await page.locator(".row.selected").count(), 7);
  assert.match(await readout(), /lines 21 to 27.*4 moves/);
});

test("the demo: every cycle has a table of its passes, and a pass lights its moves", { skip: !isDemo }, async () => {
  const summaries = await page.$$eval("#cycles summary", (all) => all.map((one) => one.textContent));
  assert.deepEqual(summaries, ["G71 Rough turning, 10 passesline 9", "G70 Finish turning, 1 passline 19", "G76 Thread in many passes, 6 passesline 31"]);
  const cells = (row) => page.$$eval(`#${row} td`, (all) => all.map((one) => one.textContent));
  assert.deepEqual(await cells("pass-0-3"), ["4", "cut", "8", "36, 2.1", "36, −28.5", "U2. in line 8, figure line 15"]);
  assert.deepEqual((await cells("pass-2-0")).slice(0, 3), ["1", "thread", "0.35"], "counted from the crest");
  assert.equal((await cells("pass-2-5")).at(-1), "P920 in line 31");
  await page.click("#pass-0-3 .link");
  const { lit, selectedLine } = await state();
  assert.equal(selectedLine, 9);
  // In, cut, escape, back; and nothing of the other passes.
  assert.equal(lit.length, 4);
  assert.deepEqual(await page.evaluate((all) => all.map((i) => turnwright.passOfSegment(i)), lit), Array(4).fill([0, 3]));
  assert.deepEqual(await page.evaluate(() => turnwright.passNumbersDrawn()), [4]);
  assert.equal(await page.getAttribute("#pass-0-3", "aria-current"), "true");
  assert.match(await readout(), /G71 Rough turning.*pass 4.*depth 8.*U2\. in line 8/);
  await page.click("#language");
  assert.match((await cells("pass-0-3")).at(-1), /第 8 行的 U2\.，轮廓第 15 行/);
  assert.equal(await page.getAttribute("#pass-0-3", "aria-current"), "true", "the choice stays");
  await page.keyboard.press("Escape");
  assert.equal(await page.locator("#cycles tr[aria-current]").count(), 0);
  assert.deepEqual(await page.evaluate(() => turnwright.passNumbersDrawn()), []);
});

test("the demo: a click on a pass in the picture marks its row, the line of a cycle numbers its passes", { skip: !isDemo }, async () => {
  await page.click("#cycles details[data-cycle='0'] summary");
  assert.equal(await page.locator("#cycles details[data-cycle='0']").getAttribute("open"), null, "closed by hand");
  await page.evaluate(() => scrollTo(0, 0));
  const segment = await page.evaluate(() => {
    for (let i = 0; ; i++) if (String(turnwright.passOfSegment(i)) === "0,2") {
      const { x, y } = turnwright.placeOf(i), box = document.getElementById("picture").getBoundingClientRect();
      if (x > box.left + 80 && x < box.right - 20 && y > box.top + 40) return i;
    }
  });
  const place = await page.evaluate((i) => turnwright.placeOf(i), segment);
  await page.mouse.click(place.x, place.y);
  const [cycle, row] = await page.evaluate(() => turnwright.selectedPass);
  assert.equal(cycle, 0);
  assert.equal(await page.getAttribute(`#pass-0-${row}`, "aria-current"), "true");
  assert.equal(await page.locator("#cycles details[data-cycle='0']").getAttribute("open"), "", "opened again");
  await page.click("#line-9");
  assert.deepEqual(await page.evaluate(() => turnwright.passNumbersDrawn()), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
  await page.click("#line-5");
  assert.deepEqual(await page.evaluate(() => turnwright.passNumbersDrawn()), []);
  await page.evaluate(() => turnwright.goTo(3));
  assert.equal(await page.evaluate(() => turnwright.selectedPass), null);
});

test("the demo: text of the program stays text", { skip: !isDemo }, async () => {
  assert.equal(await page.textContent("#line-33 code"), "N300 T0000 (</script><b>not bold</b> & 车刀)");
  assert.equal(await page.locator("#rows b").count(), 0);
});

test("no test above made the page complain", async () => {
  for (const key of ["ArrowRight", "ArrowDown", "+", "-", "Shift+ArrowLeft", "Shift+ArrowUp", "Enter", "Escape", "End"]) await page.keyboard.press(key);
  await settle();
  assert.deepEqual(complaints, []);
});
