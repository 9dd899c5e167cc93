// Solids, meshes and drawings for CAD, read back by programs that know nothing of this one: STEP by OpenCASCADE
// (occt-import-js), GLB by the validator of the Khronos group, DXF by a parser.
//
// TURNWRIGHT_BIN  the binary; without it `cargo run`
import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";

const require = createRequire(import.meta.url);
const HERE = path.dirname(fileURLToPath(import.meta.url));
const ROOT = path.join(HERE, "..");
const COUNT = 40;
// Triangles of OpenCASCADE: how far from the solid, mm and rad, and by what share of its volume they may be off then. The
// fine ones take seconds for a part.
const COARSE = { mm: 0.05, rad: 0.3, share: 5e-3 };
const FINE = { mm: 0.01, rad: 0.3, share: 1e-3 };

let folder, occt, manifest;

before(async () => {
  folder = mkdtempSync(path.join(tmpdir(), "turnwright-solids-"));
  const make = ["run", "--quiet", "-p", "turnwright-export", "--example", "demo_solids", "--", folder, String(COUNT)];
  execFileSync(process.env.CARGO ?? "cargo", make, { cwd: ROOT, stdio: ["ignore", "inherit", "inherit"] });
  manifest = JSON.parse(readFileSync(path.join(folder, "manifest.json"), "utf8"));
  occt = await require("occt-import-js")();
});

after(() => rmSync(folder, { recursive: true, force: true }));

function run(...args) {
  const [program, first] = process.env.TURNWRIGHT_BIN
    ? [process.env.TURNWRIGHT_BIN, []]
    : [process.env.CARGO ?? "cargo", ["run", "--quiet", "-p", "turnwright", "--"]];
  return spawnSync(program, [...first, ...args], { cwd: ROOT, encoding: "utf8" });
}

function readStep(file, { mm, rad } = COARSE) {
  const limits = { linearUnit: "millimeter", linearDeflectionType: "absolute_value", linearDeflection: mm, angularDeflection: rad };
  const result = occt.ReadStepFile(readFileSync(file), limits);
  assert.ok(result.success, file);
  return result.meshes;
}

// Tetrahedra from the origin to every triangle.
function volumeOf(mesh) {
  const p = mesh.attributes.position.array, index = mesh.index.array;
  let six = 0;
  for (let at = 0; at < index.length; at += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => [0, 1, 2].map((axis) => p[3 * index[at + k] + axis]));
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six / 6;
}

const sum = (numbers) => numbers.reduce((a, b) => a + b, 0);
const count = (text, word) => text.split(word).length - 1;
const KINDS = {
  Plane: "PLANE(", Cylinder: "CYLINDRICAL_SURFACE(", Cone: "CONICAL_SURFACE(", Sphere: "SPHERICAL_SURFACE(",
  Torus: "TOROIDAL_SURFACE(", SpindleTorus: "SURFACE_OF_REVOLUTION(",
};

test("OpenCASCADE reads every STEP file, with all its faces and the volume of the section", () => {
  assert.ok(manifest.length > 0.9 * COUNT);
  for (const [number, part] of manifest.entries()) {
    const file = path.join(folder, `${part.name}.step`);
    const limits = number < 5 ? FINE : COARSE;
    const meshes = readStep(file, limits);
    const faces = sum(Object.values(part.faces));
    assert.equal(sum(meshes.map((mesh) => mesh.brep_faces.length)), faces, `${part.name}: faces`);
    const volume = sum(meshes.map(volumeOf));
    assert.ok(Math.abs(volume - part.volume) < limits.share * part.volume, `${part.name}: ${volume} for ${part.volume}`);
    const text = readFileSync(file, "utf8");
    for (const [kind, word] of Object.entries(KINDS)) {
      assert.equal(count(text, word), part.faces[kind] ?? 0, `${part.name}: ${kind}`);
    }
    assert.equal(count(text, "MANIFOLD_SOLID_BREP(") + count(text, "BREP_WITH_VOIDS("), part.pieces, part.name);
  }
});

test("the glTF validator finds no error and no warning", async () => {
  const { validateBytes } = require("gltf-validator");
  for (const part of manifest) {
    const bytes = new Uint8Array(readFileSync(path.join(folder, `${part.name}.glb`)));
    const { issues, info } = await validateBytes(bytes, { format: "glb", maxIssues: 10 });
    assert.deepEqual(issues.messages, [], part.name);
    assert.ok(info.totalTriangleCount > 100 && info.materialCount === 1, part.name);
  }
});

test("a DXF parser finds the lines and arcs on their layers", () => {
  const DxfParser = require("dxf-parser").default ?? require("dxf-parser");
  for (const part of manifest) {
    const dxf = new DxfParser().parseSync(readFileSync(path.join(folder, `${part.name}.dxf`), "utf8"));
    const onLayer = (layer) => dxf.entities.filter((entity) => entity.layer === layer);
    assert.deepEqual(Object.keys(dxf.tables.layer.layers).sort(), ["CENTRE", "PART", "STOCK", "THREAD"]);
    assert.ok(onLayer("PART").length > 2 && onLayer("PART").length <= part.edges, part.name);
    assert.ok(dxf.entities.every((entity) => ["LINE", "ARC"].includes(entity.type)), part.name);
    assert.equal(onLayer("CENTRE").length, 1);
  }
});

test("run writes a part with threads, by convention as STEP, as they wind in triangles, and everybody can read it", async () => {
  const out = path.join(folder, "bush");
  const ran = run("run", path.join(HERE, "bush.nc"), "--out", out, "--format", "json");
  assert.equal(ran.status, 0, ran.stderr);
  const [mesh, ...others] = readStep(path.join(out, "part.step"));
  assert.deepEqual(others, []);
  const text = readFileSync(path.join(out, "part.step"), "utf8");
  const names = [...text.matchAll(/ADVANCED_FACE\('([^']+)'/g)].map((match) => match[1]);
  assert.deepEqual([...new Set(names)].sort(), ["THREAD D40 P2 ROOT D37.546", "THREAD INSIDE D28.376 P1.5 ROOT D30"]);
  // Threads have a colour of their own.
  const coloured = mesh.brep_faces.filter((face) => face.color && face.color[2] < 0.5);
  assert.equal(coloured.length, names.length);
  const { validateBytes } = require("gltf-validator");
  const { issues, info } = await validateBytes(new Uint8Array(readFileSync(path.join(out, "part.glb"))), { format: "glb" });
  assert.deepEqual(issues.messages, []);
  assert.equal(info.materialCount, 2);
  const DxfParser = require("dxf-parser").default ?? require("dxf-parser");
  const section = new DxfParser().parseSync(readFileSync(path.join(out, "part.dxf"), "utf8"));
  assert.deepEqual([...new Set(section.entities.map((entity) => entity.layer))].sort(), ["CENTRE", "PART", "STOCK", "THREAD"]);
  const way = new DxfParser().parseSync(readFileSync(path.join(out, "path.dxf"), "utf8"));
  assert.deepEqual([...new Set(way.entities.map((entity) => entity.layer))].sort(), ["CENTRE", "FEED", "RAPID", "THREADING"]);
  // The STL holds what the section with its grooves holds; the STEP file has none.
  const exact = JSON.parse(ran.stdout).part.volume_mm3;
  const stl = readFileSync(path.join(out, "part.stl"));
  let six = 0;
  for (let at = 84; at < stl.length; at += 50) {
    const v = [...Array(9).keys()].map((k) => stl.readFloatLE(at + 12 + 4 * k));
    six += v[0] * (v[4] * v[8] - v[5] * v[7]) + v[1] * (v[5] * v[6] - v[3] * v[8]) + v[2] * (v[3] * v[7] - v[4] * v[6]);
  }
  assert.ok(Math.abs(six / 6 - exact) < 1e-3 * exact, `${six / 6} for ${exact}`);
  assert.ok(volumeOf(mesh) > 1.005 * exact);
});

test("the parts of all examples are solids that hold what their sections do", () => {
  const examples = path.join(ROOT, "examples");
  const files = readdirSync(examples, { recursive: true }).filter((file) => file.endsWith(".nc"));
  assert.ok(files.length > 15);
  for (const file of files) {
    const out = path.join(folder, file);
    const ran = run("run", path.join(examples, file), "--out", out, "--format", "json");
    const part = JSON.parse(ran.stdout).part;
    if (!part) continue;
    const volume = sum(readStep(path.join(out, "part.step")).map(volumeOf));
    // Grooves of threads are not in the solid.
    const least = part.volume_mm3 * (1 - COARSE.share), most = part.volume_mm3 * (part.threads.length ? 1.1 : 1 + COARSE.share);
    assert.ok(least < volume && volume < most, `${file}: ${volume} for ${part.volume_mm3}`);
  }
});
