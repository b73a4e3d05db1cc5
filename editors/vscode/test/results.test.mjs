// Finding the program, and what its reports say.
import assert from "node:assert/strict";
import { chmodSync, mkdirSync, mkdtempSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import * as path from "node:path";
import { test } from "node:test";
import { load, program } from "./build.mjs";

const { find, run } = await load("program");
const { results, nameOf, page } = await load("results");
const { serverOptions } = await load("options");
const folder = () => mkdtempSync(path.join(tmpdir(), "shadercheck-vscode-"));

test("the server gets the settings that are stated", () => {
  const given = (stated) => serverOptions({ get: (name, otherwise) => stated[name] ?? otherwise });
  const hints = { conversions: true, offsets: true };
  assert.deepEqual(given({}), { hints });
  const stated = { lang: "ja", level: "strict", select: ["T"], ignore: ["N004"], rulePages: "https://a.example" };
  assert.deepEqual(given(stated), { ...stated, hints });
  assert.deepEqual(given({ "hints.offsets": false }).hints, { ...hints, offsets: false });
});

test("the program comes from the setting, or from PATH", () => {
  const at = folder();
  mkdirSync(path.join(at, "empty"));
  const file = path.join(at, "shadercheck");
  writeFileSync(file, "#!/bin/sh\n");
  const PATH = [path.join(at, "empty"), "", at].join(path.delimiter);
  assert.match(find("", { PATH }, "linux").problem, /not on PATH/, "it cannot be run");
  chmodSync(file, 0o755);
  assert.deepEqual(find("", { PATH }, "linux"), { program: file });
  assert.deepEqual(find(file, {}, "linux"), { program: file });
  assert.deepEqual(find("~/shadercheck", { HOME: at }, "linux"), { program: file });
  assert.match(find(at, {}, "linux").problem, /is no program/, "a folder");
  assert.match(find("/nowhere/shadercheck", { PATH }, "linux").problem, /shadercheck\.path/, "PATH stands in for no setting");
});

function project(factor) {
  const at = folder();
  const write = (name, text) => writeFileSync(path.join(at, name), text);
  write("tone.glsl", `float tone(float x) {\n    return x / (1.0 + x) * ${factor};\n}\n`);
  write("wanted.glsl", "float tone(float x) { return x / (1.0 + x); }\n");
  write(
    "tone.suite.toml",
    'suite = "tone"\nshader = "tone.glsl"\nstage = "function"\nentry = "tone"\nsamples = 64\nreference = "wanted.glsl"\n' +
      '[[inputs]]\nnames = ["x"]\ngenerator = "interval"\nrange = [0.5, 4.0]\n',
  );
  return at;
}

const check = (at) => run(program, ["check", "tone.suite.toml", "--lane", "embedded", "--format", "json"], at);

test("a suite that fails is told with place, inputs and command", async () => {
  const at = project("1.5");
  const ran = await check(at);
  assert.equal(ran.code, 1, ran.err);
  const [{ suite, failures, skipped }] = results(ran.out, at);
  assert.deepEqual([suite, failures.length, skipped], ["tone", 1, undefined]);
  assert.deepEqual(failures[0].place, { file: path.join(at, "tone.glsl"), line: 2, column: 12 });
  assert.match(failures[0].message, /^tone on embedded\/compute: .*\n {2}float x = 0\.5\nreproduce: shadercheck check /);
});

test("a suite that passes has no failures", async () => {
  const ran = await check(project("1.0"));
  assert.equal(ran.code, 0, ran.err);
  assert.deepEqual(results(ran.out, "/").map((result) => result.failures), [[]]);
});

test("a suite that cannot be read gives no report, and says why", async () => {
  const at = project("1.0");
  writeFileSync(path.join(at, "tone.suite.toml"), "suite = 3\n");
  const ran = await check(at);
  assert.equal(ran.code, 2);
  assert.match(ran.out + ran.err, /tone\.suite\.toml:1:9/);
});

test("one failure on several lanes is told for each, equal ones once, and what one lane judged is not skipped", () => {
  const finding = { kind: "deviation", severity: "error", message: "wrong" };
  const entry = (lane, more) => ({ suite: "s", lane, stage: "compute", ...more });
  const report = { suites: [entry("a", { findings: [finding, finding] }), entry("b", { not_run: "no samples" })] };
  assert.deepEqual(results(JSON.stringify(report), "/"), [
    { suite: "s", failures: [{ message: "s on a/compute: wrong", place: undefined }], skipped: undefined },
  ]);
  const none = { suites: [entry("b", { not_run: "no samples", findings: [{ ...finding, severity: "warning" }] })] };
  assert.deepEqual(results(JSON.stringify(none), "/"), [{ suite: "s", failures: [], skipped: "no samples" }]);
  assert.throws(() => results("", "/"));
});

test("the name of a suite is that of its top level", () => {
  assert.deepEqual(nameOf('# a suite\r\nsuite = "sphere"\r\n'), { name: "sphere", line: 1 });
  assert.equal(nameOf('[[inputs]]\nsuite = "no"\n'), undefined);
});

test("the page in a web view runs its own script alone and loads nothing", () => {
  const shown = page("<html><head><title>a</title></head><body><script>1</script><script type='x'>2</script></body></html>", "N0");
  assert.match(shown, /<head><meta http-equiv="Content-Security-Policy" content="default-src 'none';[^"]*script-src 'nonce-N0'">/);
  assert.equal(shown.match(/<script nonce="N0"/g).length, 2);
});
