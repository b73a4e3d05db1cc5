// The language server by the library of the client, over the real transport.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { mkdtempSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import * as path from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { program } from "./build.mjs";

const { createProtocolConnection, StreamMessageReader, StreamMessageWriter } = createRequire(import.meta.url)(
  "vscode-languageserver-protocol/node",
);

// A program that was built without it says so by its status.
const missing = spawnSync(program, ["lsp", "--help"]).status !== 0 && `${program} has no command \`lsp\``;
const TEXT = "#version 330 core\nin vec4 p;\nvoid main() { gl_Position = vec4(vec3(p.x, p.y, p.z, 1.0), 1.0); }\n";

test("a mistake is told when a file is opened, and gone when it is repaired", { skip: missing, timeout: 60_000 }, async () => {
  const folder = mkdtempSync(path.join(tmpdir(), "shadercheck-vscode-"));
  const file = path.join(folder, "a.vert");
  writeFileSync(file, TEXT);
  const server = spawn(program, ["lsp"], { cwd: folder, stdio: ["pipe", "pipe", "inherit"] });
  const connection = createProtocolConnection(new StreamMessageReader(server.stdout), new StreamMessageWriter(server.stdin));
  const told = [];
  let wake = () => {};
  connection.onNotification("textDocument/publishDiagnostics", (message) => {
    told.push(message);
    wake();
  });
  connection.onRequest("client/registerCapability", () => null);
  connection.onRequest("workspace/configuration", ({ items }) => items.map(() => null));
  connection.listen();
  const until = async (holds) => {
    while (!told.some(holds)) await new Promise((resolve) => (wake = resolve));
    return told.find(holds);
  };
  const uri = pathToFileURL(file).href;
  const { capabilities } = await connection.sendRequest("initialize", {
    processId: process.pid,
    rootUri: pathToFileURL(folder).href,
    workspaceFolders: [{ uri: pathToFileURL(folder).href, name: "folder" }],
    capabilities: { textDocument: { publishDiagnostics: { relatedInformation: true } } },
  });
  assert.ok(capabilities.textDocumentSync, JSON.stringify(capabilities));
  connection.sendNotification("initialized", {});
  connection.sendNotification("textDocument/didOpen", { textDocument: { uri, languageId: "glsl", version: 1, text: TEXT } });
  const wrong = await until((message) => message.uri === uri && message.diagnostics.some((d) => d.code === "T001"));
  const diagnostic = wrong.diagnostics.find((d) => d.code === "T001");
  assert.equal(diagnostic.range.start.line, 2);
  told.length = 0;
  connection.sendNotification("textDocument/didChange", {
    textDocument: { uri, version: 2 },
    contentChanges: [{ text: TEXT.replace(", p.z, 1.0)", ", p.z)") }],
  });
  await until((message) => message.uri === uri && !message.diagnostics.some((d) => d.code === "T001"));
  await connection.sendRequest("shutdown");
  const ended = new Promise((resolve) => server.on("exit", resolve));
  connection.sendNotification("exit");
  assert.equal(await ended, 0);
  connection.dispose();
});
