// What is packaged, and that the manifest and the code speak of the same things.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import * as path from "node:path";
import { test } from "node:test";
import { root } from "./build.mjs";

const manifest = JSON.parse(readFileSync(path.join(root, "package.json"), "utf8"));
const sources = readdirSync(path.join(root, "src")).map((name) => readFileSync(path.join(root, "src", name), "utf8")).join("\n");

test("the package holds the bundle and its papers, and nothing else", () => {
  const vsce = path.join(root, "node_modules", ".bin", "vsce");
  const files = execFileSync(vsce, ["ls", "--no-dependencies"], { cwd: root, encoding: "utf8" }).trim().split("\n").sort();
  const grammars = ["syntaxes/glsl.tmLanguage.json", "syntaxes/wgsl.tmLanguage.json"];
  const papers = ["CHANGELOG.md", "LICENSE", "README.md"];
  assert.deepEqual(files, [...papers, "dist/extension.js", "language.json", "package.json", ...grammars]);
});

test("grammars tell comments, words and numbers apart", () => {
  for (const { language, path: file } of manifest.contributes.grammars) {
    const { patterns } = JSON.parse(readFileSync(path.join(root, file), "utf8"));
    const scope = (text) => patterns.find((p) => new RegExp(`^(?:${p.match ?? p.begin})`).exec(text)?.[0] === text)?.name;
    const said = { "// x": "comment.line", return: "keyword.control", "1.5e-3": "constant.numeric", true: "constant.language" };
    const own = language === "glsl" ? { vec3: "storage.type", uniform: "storage.modifier" } : { vec3f: "storage.type", "@group": "storage.modifier" };
    for (const [text, kind] of Object.entries({ ...said, ...own })) assert.ok(scope(text)?.startsWith(kind), `${language}: ${text}`);
    assert.equal(scope("uniformly"), undefined);
  }
});

test("every command of the manifest is registered, and no other", () => {
  const listed = manifest.contributes.commands.map((command) => command.command).sort();
  const registered = [...sources.matchAll(/registerCommand\("([^"]+)"/g)].map((found) => found[1]).sort();
  assert.deepEqual(registered, listed);
});

test("every setting of the manifest is read, and no other", () => {
  const listed = Object.keys(manifest.contributes.configuration.properties);
  const read = [...sources.matchAll(/\.get<[^>]+>\("([^"]+)"/g)].map((found) => `shadercheck.${found[1]}`);
  // The client reads the level of its log by itself.
  assert.deepEqual([...new Set(read), "shadercheck.trace.server"].sort(), listed.sort());
});

test("a folder that is not trusted cannot choose the program", () => {
  assert.deepEqual(manifest.capabilities.untrustedWorkspaces.restrictedConfigurations, ["shadercheck.path"]);
});

test("the endings are those of shaders that the linter reads", () => {
  const endings = manifest.contributes.languages.flatMap((language) => language.extensions);
  assert.equal(new Set(endings).size, endings.length);
  for (const ending of [".vert", ".frag", ".comp", ".glsl", ".wgsl"]) assert.ok(endings.includes(ending), ending);
});
