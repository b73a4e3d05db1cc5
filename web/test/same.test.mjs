// The program of the page says what the program of a terminal says: the same JSON and the same status, file by file.
// SHADERCHECK is the program of this machine, DIST the page.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { after, test } from "node:test";
import { pathToFileURL } from "node:url";
import { build } from "esbuild";

const { SHADERCHECK, DIST } = process.env;
const root = join(import.meta.dirname, "../..");
const folder = mkdtempSync(join(tmpdir(), "shadercheck-web-"));
after(() => rmSync(folder, { recursive: true }));

await build({ entryPoints: ["src/program.ts"], bundle: true, format: "esm", outfile: join(folder, "program.mjs") });
const { run } = await import(pathToFileURL(join(folder, "program.mjs")));
const module = await WebAssembly.compile(readFileSync(join(DIST, "shadercheck.wasm")));

const CASES = [
  ["fixtures/printed/cylinder.vert", ["lint", "FILE", "--format", "json"]],
  ["fixtures/printed/morph.cpp", ["lint", "FILE", "--format", "json"]],
  ["fixtures/tour/scene.frag", ["lint", "FILE", "--format", "json", "--level", "strict"]],
  ["fixtures/kernels/wrong/histogram.wgsl", ["lint", "FILE", "--format", "json"]],
  ["fixtures/kernels/wrong/histogram.wgsl", ["fuzz", "FILE", "--format", "json", "--lane", "embedded"]],
  ["fixtures/kernels/wrong/halve.comp", ["fuzz", "FILE", "--format", "json", "--lane", "embedded"]],
  ["fixtures/precision/phone.frag", ["fuzz", "FILE", "--format", "json", "--lane", "embedded"]],
  ["fixtures/compare/functions.glsl", ["fuzz", "FILE", "--format", "json", "--lane", "embedded"]],
  ["fixtures/improve/formulas.wgsl", ["trace", "FILE", "--function", "haversine", "--format", "json", "--lane", "embedded"]],
  ["fixtures/improve/formulas.glsl", ["improve", "FILE", "--function", "growth", "--format", "json", "--lane", "embedded"]],
  ["fixtures/improve/sound.glsl", ["improve", "FILE", "--format", "json", "--lane", "embedded"]],
  ["fixtures/tune/all.frag", ["tune", "FILE", "--format", "json"]],
  ["shaders/chapter9/sphere.vert", ["translate", "FILE", "--to", "wgsl"]],
  ["shaders/chapter9/skinning.vert", ["translate", "FILE", "--to", "msl"]],
  ["fixtures/kernels/wrong/sort.wgsl", ["fuzz", "FILE", "--format", "json", "--lane", "embedded"]],
  ["fixtures/tune/distance.frag", ["tune", "FILE", "--format", "json"]],
];

for (const [path, args] of CASES) {
  test(`${args[0]} ${path}`, async () => {
    const name = basename(path);
    const text = readFileSync(join(root, path), "utf8");
    writeFileSync(join(folder, name), text);
    const here = args.map((argument) => (argument === "FILE" ? name : argument));
    const native = spawnSync(SHADERCHECK, here, { cwd: folder, encoding: "utf8", env: { ...process.env, LANG: "C" } });
    const web = await run(module, here, { [name]: text });
    assert.equal(web.status, native.status, web.err + native.stderr);
    assert.equal(plain(web.out), plain(native.stdout));
  });
}

/** Without what a clock says. */
function plain(text) {
  return text.replace(/"(seconds|elapsed|duration)": [\d.e+-]+/g, '"$1": 0');
}
