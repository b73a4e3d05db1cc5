// Modules that need no editor, compiled for the tests.
import { build } from "esbuild";
import { mkdtempSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import * as path from "node:path";
import { fileURLToPath } from "node:url";

export const root = path.dirname(path.dirname(fileURLToPath(import.meta.url)));

/** A module of `src`. */
export async function load(name) {
  const outfile = path.join(mkdtempSync(path.join(tmpdir(), "shadercheck-vscode-")), `${name}.cjs`);
  await build({ entryPoints: [path.join(root, "src", `${name}.ts`)], bundle: true, platform: "node", format: "cjs", outfile });
  return createRequire(import.meta.url)(outfile);
}

/** The program under test; SHADERCHECK names it, as `cargo xtask editor` does. */
export const program = process.env.SHADERCHECK ?? "shadercheck";
