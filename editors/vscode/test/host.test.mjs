// The bundle in a stand-in for the editor: it is activated, starts the server that the settings name, and runs a suite.
import assert from "node:assert/strict";
import { chmodSync, mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import Module, { createRequire } from "node:module";
import { tmpdir } from "node:os";
import * as path from "node:path";
import { test } from "node:test";
import { root } from "./build.mjs";

/** Anything: a class, a function and an object whose members are anything. */
function anything() {
  return new Proxy(class {}, {
    get: (target, name) => (name in target || typeof name === "symbol" ? Reflect.get(target, name) : (target[name] = anything())),
    apply: () => anything(),
  });
}

class Disposable {
  static from = (...all) => new Disposable(() => all.forEach((one) => one.dispose?.()));
  constructor(call) {
    this.call = call;
  }
  dispose() {
    this.call?.();
  }
}

const event = () => new Disposable();
const uri = (file) => ({ fsPath: file, scheme: "file", path: file, toString: () => `file://${file}` });

/** The parts of the editor that the extension uses by itself; the rest, which its client uses, is anything. */
function editor(folder, settings) {
  const seen = { commands: [], errors: [], items: new Map(), run: undefined, results: [] };
  const items = {
    add: (item) => seen.items.set(item.id, item),
    delete: (id) => seen.items.delete(id),
    forEach: (call) => seen.items.forEach((item) => call(item)),
  };
  const tests = {
    started: () => {},
    appendOutput: () => {},
    end: () => seen.results.push(["end"]),
    ...Object.fromEntries(
      ["passed", "failed", "errored", "skipped"].map((name) => [
        name,
        (item, messages) => seen.results.push([name, item.label, [messages].flat().map((m) => m?.message ?? "")]),
      ]),
    ),
  };
  const known = {
    version: "1.91.0",
    env: Object.assign(anything(), { appName: "stand-in", language: "en" }),
    Disposable,
    EventEmitter: class {
      event = () => event();
      fire() {}
      dispose() {}
    },
    Position: class {
      constructor(line, character) {
        Object.assign(this, { line, character });
      }
    },
    Range: class {},
    Location: class {
      constructor(uri, range) {
        Object.assign(this, { uri, range });
      }
    },
    TestMessage: class {
      constructor(message) {
        this.message = message;
      }
    },
    TestRunProfileKind: { Run: 1 },
    Uri: { file: uri, parse: uri },
    commands: { registerCommand: (name) => (seen.commands.push(name), event()), executeCommand: async () => {} },
    window: Object.assign(anything(), { showErrorMessage: async (text) => void seen.errors.push(text) }),
    workspace: Object.assign(anything(), {
      workspaceFolders: [{ uri: uri(folder), name: "folder", index: 0 }],
      textDocuments: [],
      notebookDocuments: [],
      getConfiguration: () => ({ get: (name, other) => settings[name] ?? other }),
      onDidChangeConfiguration: event,
      createFileSystemWatcher: () => ({ onDidCreate: event, onDidChange: event, onDidDelete: event, dispose() {} }),
      findFiles: async () => [uri(path.join(folder, "tone.suite.toml"))],
      asRelativePath: (file) => path.relative(folder, file.fsPath),
      fs: { readFile: async (file) => readFileSync(file.fsPath) },
    }),
    tests: {
      createTestController: () => ({
        items,
        createTestItem: (id, label, file) => ({ id, label, uri: file }),
        createRunProfile: (_name, _kind, handler) => (seen.run = handler),
        createTestRun: () => tests,
        dispose() {},
      }),
    },
  };
  const rest = anything();
  const vscode = new Proxy(known, { get: (target, name) => (name in target ? target[name] : rest[name]), has: () => true });
  return { vscode, seen };
}

function load(vscode) {
  const bundle = path.join(root, "dist", "extension.js");
  const original = Module._load;
  Module._load = (name, ...others) => (name === "vscode" ? vscode : original(name, ...others));
  try {
    const require = createRequire(import.meta.url);
    delete require.cache[bundle];
    return require(bundle);
  } finally {
    Module._load = original;
  }
}

/** A program that notes how it was called, answers as a server, and else reports `report`. */
function stand(folder, report, status) {
  const file = path.join(folder, "stand-in");
  const server = `
    const fs = require("node:fs");
    fs.appendFileSync(${JSON.stringify(path.join(folder, "calls"))}, process.argv.slice(2).join(" ") + "\\n");
    if (process.argv[2] !== "lsp") {
      process.stdout.write(${JSON.stringify(JSON.stringify(report))});
      process.exit(${status});
    }
    let text = "";
    process.stdin.on("data", (data) => {
      text += data;
      for (let found; (found = /Content-Length: (\\d+)\\r\\n\\r\\n/.exec(text)); ) {
        const start = found.index + found[0].length, end = start + Number(found[1]);
        if (text.length < end) return;
        const { id, method } = JSON.parse(text.slice(start, end));
        text = text.slice(end);
        fs.appendFileSync(${JSON.stringify(path.join(folder, "received"))}, method + "\\n");
        if (method === "exit") process.exit(0);
        if (id === undefined) continue;
        const answer = JSON.stringify({ jsonrpc: "2.0", id, result: method === "initialize" ? { capabilities: {} } : null });
        process.stdout.write("Content-Length: " + answer.length + "\\r\\n\\r\\n" + answer);
      }
    });`;
  writeFileSync(file, `#!${process.execPath}\n${server}\n`);
  chmodSync(file, 0o755);
  return file;
}

function project() {
  const folder = mkdtempSync(path.join(tmpdir(), "shadercheck-vscode-"));
  writeFileSync(path.join(folder, "tone.suite.toml"), 'suite = "tone"\n');
  return folder;
}

const request = { include: undefined, exclude: undefined };
const token = { isCancellationRequested: false, onCancellationRequested: event };

test("it is activated, starts the server with the settings, and shows suites", async () => {
  const folder = project();
  const file = stand(folder, { suites: [{ suite: "tone", lane: "embedded", stage: "compute" }] }, 0);
  const { vscode, seen } = editor(folder, { path: file, lang: "ja" });
  const extension = load(vscode);
  await extension.activate({ subscriptions: [] });
  assert.deepEqual(seen.errors, []);
  assert.equal(readFileSync(path.join(folder, "calls"), "utf8"), "lsp\n");
  const commands = ["improveExpression", "report", "restart", "version"].map((name) => `shadercheck.${name}`);
  assert.deepEqual(seen.commands.sort(), commands);
  assert.deepEqual([...seen.items.values()].map((item) => item.label), ["tone"]);
  await seen.run(request, token);
  assert.deepEqual(seen.results, [["passed", "tone", [""]], ["end"]]);
  await extension.deactivate();
  // The last message is on its way when the client is done.
  const received = () => readFileSync(path.join(folder, "received"), "utf8").trim().split("\n");
  for (let k = 0; k < 100 && received().length < 4; k++) await new Promise((resolve) => setTimeout(resolve, 50));
  assert.deepEqual(received(), [
    "initialize",
    "initialized",
    "shutdown",
    "exit",
  ]);
});

test("a suite that fails is marked, and what cannot be run is an error", async () => {
  const folder = project();
  const finding = { kind: "deviation", severity: "error", message: "wrong", file: "tone.glsl", line: 2, column: 3 };
  const file = stand(folder, { suites: [{ suite: "tone", lane: "embedded", stage: "compute", findings: [finding] }] }, 1);
  const { vscode, seen } = editor(folder, { path: file });
  const extension = load(vscode);
  await extension.activate({ subscriptions: [] });
  await seen.run(request, token);
  assert.deepEqual(seen.results, [["failed", "tone", ["tone on embedded/compute: wrong"]], ["end"]]);
  await extension.deactivate();
  writeFileSync(path.join(folder, "stand-in"), "#!/bin/sh\necho 'no such lane' >&2\nexit 2\n");
  seen.results.length = 0;
  await seen.run(request, token);
  assert.deepEqual(seen.results, [["errored", "tone", ["no such lane"]], ["end"]]);
});

test("a program that is missing is told once, with what to do", async () => {
  const { vscode, seen } = editor(project(), { path: "/nowhere/shadercheck" });
  await load(vscode).activate({ subscriptions: [] });
  assert.match(seen.errors.join("\n"), /shadercheck\.path/);
});
