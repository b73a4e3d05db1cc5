// The extension: starts the language server, shows suites and the page of a run.

import { randomBytes } from "node:crypto";
import { mkdtemp, readFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import * as path from "node:path";
import * as vscode from "vscode";
import { LanguageClient } from "vscode-languageclient/node";
import { serverOptions } from "./options";
import { find, run } from "./program";
import { page } from "./results";
import { suites } from "./suites";

const SHADERS = ["glsl", "wgsl", "hlsl", "slang"];
const HOSTS = ["c", "cpp", "javascript", "typescript", "javascriptreact", "typescriptreact", "python", "java", "kotlin", "rust"];

let client: LanguageClient | undefined;

function settings(): vscode.WorkspaceConfiguration {
  return vscode.workspace.getConfiguration("shadercheck");
}

/** The program, or nothing once the user was told. */
function program(): string | undefined {
  const found = find(settings().get<string>("path", ""), process.env, process.platform);
  if ("program" in found) return found.program;
  void vscode.window.showErrorMessage(found.problem, "Open settings").then((answer) => {
    if (answer) void vscode.commands.executeCommand("workbench.action.openSettings", "shadercheck.path");
  });
  return undefined;
}

async function start(): Promise<void> {
  const command = program();
  if (!command) return;
  const languages = settings().get<boolean>("hosts", true) ? [...SHADERS, ...HOSTS] : SHADERS;
  client = new LanguageClient(
    "shadercheck",
    "shadercheck",
    // Without a transport, the streams are taken and no option is added.
    { command, args: ["lsp"] },
    {
      initializationOptions: serverOptions(settings()),
      documentSelector: languages.map((language) => ({ scheme: "file", language })),
      middleware: { window: { showDocument: (params) => beside(vscode.Uri.parse(params.uri)) } },
      synchronize: { fileEvents: vscode.workspace.createFileSystemWatcher("**/shadercheck.toml") },
    },
  );
  await client.start();
}

/** Shows what a command of the server wrote, and leaves the cursor where it is. */
async function beside(uri: vscode.Uri): Promise<{ success: boolean }> {
  const document = await vscode.workspace.openTextDocument(uri);
  const options = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true, preview: true };
  await vscode.window.showTextDocument(document, options);
  return { success: true };
}

/** Looks for better formulas for the expressions in the line of the cursor. */
async function improve(): Promise<void> {
  const editor = vscode.window.activeTextEditor;
  if (!editor || !client) return;
  const line = editor.selection.active.line + 1;
  await vscode.commands.executeCommand("shadercheck.improve", editor.document.uri.toString(), null, line);
}

async function stop(): Promise<void> {
  const running = client;
  client = undefined;
  await running?.dispose();
}

async function restart(): Promise<void> {
  await stop();
  await start();
}

/** Checks all suites of a folder and shows the page. */
async function report(): Promise<void> {
  const command = program();
  const folder = vscode.workspace.workspaceFolders?.[0]?.uri.fsPath;
  if (!command) return;
  if (!folder) return void vscode.window.showErrorMessage("Open a folder with suites first.");
  const out = await mkdtemp(path.join(tmpdir(), "shadercheck-"));
  const options = { location: vscode.ProgressLocation.Notification, title: "shadercheck check", cancellable: true };
  const ran = await vscode.window.withProgress(options, (_progress, token) => {
    const stop = new AbortController();
    token.onCancellationRequested(() => stop.abort());
    return run(command, ["check", ".", "--report-dir", out], folder, stop.signal);
  });
  let html: string;
  try {
    html = await readFile(path.join(out, "index.html"), "utf8");
  } catch {
    return void vscode.window.showErrorMessage(ran.err.trim() || "shadercheck wrote no report.");
  }
  const panel = vscode.window.createWebviewPanel("shadercheck.report", "shadercheck", vscode.ViewColumn.Beside, {
    enableScripts: true,
    localResourceRoots: [],
  });
  panel.webview.html = page(html, randomBytes(16).toString("hex"));
}

async function version(): Promise<void> {
  const command = program();
  if (!command) return;
  const ran = await run(command, ["--version", "--verbose"], path.dirname(command));
  void vscode.window.showInformationMessage(ran.out.trim(), { modal: true });
}

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  context.subscriptions.push(
    vscode.commands.registerCommand("shadercheck.restart", restart),
    vscode.commands.registerCommand("shadercheck.report", report),
    vscode.commands.registerCommand("shadercheck.version", version),
    vscode.commands.registerCommand("shadercheck.improveExpression", improve),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("shadercheck")) void restart();
    }),
    suites(program),
  );
  try {
    await start();
  } catch (error) {
    void vscode.window.showErrorMessage(`The language server of shadercheck does not start: ${error}`);
  }
}

export function deactivate(): Promise<void> {
  return stop();
}
