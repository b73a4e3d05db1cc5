// Makes the page in DIST of the program in WASM: `node build.mjs WASM DIST`.

import { copyFile, mkdir } from "node:fs/promises";
import { join } from "node:path";
import { build } from "esbuild";

const [wasm, dist] = process.argv.slice(2);
if (wasm === undefined || dist === undefined) throw new Error("usage: node build.mjs WASM DIST");
await mkdir(dist, { recursive: true });
await build({
  entryPoints: ["main", "worker", "offline"].map((name) => `src/${name}.ts`),
  bundle: true,
  format: "esm",
  target: "es2022",
  minify: true,
  // Examples are files of the repository.
  loader: { ".vert": "text", ".frag": "text", ".glsl": "text", ".wgsl": "text", ".toml": "text" },
  outdir: dist,
});
for (const file of ["index.html", "style.css"]) await copyFile(file, join(dist, file));
await copyFile(wasm, join(dist, "shadercheck.wasm"));
