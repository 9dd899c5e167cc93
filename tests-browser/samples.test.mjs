// Samples of a motion as Parquet, read by hyparquet, which knows nothing of this program: cell for cell what the table
// in CSV says.
//
// TURNWRIGHT_BIN  the binary; without it `cargo run`
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { parquetReadObjects } from "hyparquet";

const ROOT = path.join(path.dirname(fileURLToPath(import.meta.url)), "..");
let folder;
before(() => { folder = mkdtempSync(path.join(tmpdir(), "turnwright-samples-")); });
after(() => rmSync(folder, { recursive: true, force: true }));

function motion(name, ...args) {
  const [program, first] = process.env.TURNWRIGHT_BIN
    ? [process.env.TURNWRIGHT_BIN, []]
    : [process.env.CARGO ?? "cargo", ["run", "--quiet", "-p", "turnwright", "--"]];
  const file = path.join(folder, name);
  const ran = spawnSync(program, [...first, "motion", ...args, "-o", file], { cwd: ROOT, encoding: "utf8" });
  assert.equal(ran.status, 0, ran.stderr);
  return readFileSync(file);
}

async function compare(...args) {
  const [head, ...rows] = motion("samples.csv", ...args).toString("utf8").trimEnd().split("\n");
  const names = head.split(",");
  const bytes = motion("samples.parquet", ...args);
  const file = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const objects = await parquetReadObjects({ file });
  assert.equal(objects.length, rows.length);
  rows.forEach((row, index) => {
    row.split(",").forEach((cell, column) => {
      const name = names[column], value = objects[index][name];
      const expected = cell === "" ? null : name === "kind" ? cell : Number(cell);
      assert.equal(value ?? null, expected, `row ${index}, ${name}`);
    });
  });
  return objects;
}

test("two axes, more rows than a group holds", async () => {
  const program = path.join(ROOT, "examples/fanuc-0i-mate-tb/O4008-rough-turning.nc");
  const rows = await compare(program, "--rate", "1000");
  assert.ok(rows.length > 65_536, `${rows.length} rows`);
  assert.deepEqual(Object.keys(rows[0]), ["time_s", "x_mm", "z_mm", "path_mm_per_s", "rpm", "turns", "kind", "line"]);
});

test("a turn-mill, whose C axis has no angle in polar interpolation", async () => {
  const program = path.join(folder, "polar.nc"), setup = path.join(folder, "polar.toml");
  writeFileSync(setup, 'control = "fanuc-0i-tf"\nmachine = "turn-mill"\n');
  writeFileSync(program, "O1\nG98 G00 X60. Z5.\nC0\nG12.1\nG01 X40. F200\nC10.\nX-40.\nG13.1\nG00 X60.\nC90.\nM30\n");
  const rows = await compare(program, "--rate", "200");
  assert.ok(rows.some((row) => row.c_deg === null) && rows.some((row) => row.c_deg === 90));
});
