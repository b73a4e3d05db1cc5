// Suites in the test explorer.

import * as path from "node:path";
import * as vscode from "vscode";
import { run } from "./program";
import { nameOf, results, type Failure } from "./results";

const PATTERN = "**/*.suite.toml";

/** Shows suites and runs them; `program` finds the program, or tells the user why there is none. */
export function suites(program: () => string | undefined): vscode.Disposable {
  const controller = vscode.tests.createTestController("shadercheck", "shadercheck");

  async function add(uri: vscode.Uri): Promise<void> {
    const text = Buffer.from(await vscode.workspace.fs.readFile(uri)).toString("utf8");
    const named = nameOf(text);
    if (!named) return controller.items.delete(uri.toString());
    const item = controller.createTestItem(uri.toString(), named.name, uri);
    item.range = new vscode.Range(named.line, 0, named.line, 0);
    item.description = vscode.workspace.asRelativePath(uri);
    controller.items.add(item);
  }

  async function all(): Promise<void> {
    await Promise.all((await vscode.workspace.findFiles(PATTERN)).map(add));
  }

  function failed(failure: Failure): vscode.TestMessage {
    const message = new vscode.TestMessage(failure.message);
    if (failure.place) {
      const at = new vscode.Position(Math.max(0, failure.place.line - 1), Math.max(0, failure.place.column - 1));
      message.location = new vscode.Location(vscode.Uri.file(failure.place.file), at);
    }
    return message;
  }

  async function one(tests: vscode.TestRun, item: vscode.TestItem, using: string, signal: AbortSignal): Promise<void> {
    const file = item.uri?.fsPath;
    if (!file) return tests.skipped(item);
    const settings = vscode.workspace.getConfiguration("shadercheck", item.uri);
    const samples = settings.get<number>("check.samples", 0);
    const lanes = settings.get<string[]>("check.lanes", []);
    const args = ["check", path.basename(file), "--format", "json"];
    if (samples > 0) args.push("--samples", String(samples));
    if (lanes.length > 0) args.push("--lane", lanes.join(","));
    tests.started(item);
    const start = Date.now();
    const ran = await run(using, args, path.dirname(file), signal);
    const took = Date.now() - start;
    if (ran.code === -1) return tests.skipped(item);
    tests.appendOutput(ran.err.replace(/\r?\n/g, "\r\n"), undefined, item);
    let found;
    try {
      found = results(ran.out, path.dirname(file));
    } catch {
      return tests.errored(item, new vscode.TestMessage(ran.err.trim() || `shadercheck ended with status ${ran.code}`), took);
    }
    const failures = found.flatMap((result) => result.failures);
    const skipped = found.find((result) => result.skipped)?.skipped;
    if (failures.length > 0) tests.failed(item, failures.map(failed), took);
    else if (ran.code > 1) tests.errored(item, new vscode.TestMessage(ran.err.trim()), took);
    else if (skipped) {
      tests.appendOutput(`${item.label}: ${skipped}\r\n`, undefined, item);
      tests.skipped(item);
    } else tests.passed(item, took);
  }

  async function start(request: vscode.TestRunRequest, token: vscode.CancellationToken): Promise<void> {
    const tests = controller.createTestRun(request);
    const stop = new AbortController();
    token.onCancellationRequested(() => stop.abort());
    const using = program();
    const items: vscode.TestItem[] = [];
    if (request.include) items.push(...request.include);
    else controller.items.forEach((item) => items.push(item));
    try {
      // One by one: a suite uses all processors.
      for (const item of items.filter((item) => !request.exclude?.includes(item))) {
        if (token.isCancellationRequested || !using) tests.skipped(item);
        else await one(tests, item, using, stop.signal);
      }
    } finally {
      tests.end();
    }
  }

  controller.refreshHandler = all;
  controller.createRunProfile("Run", vscode.TestRunProfileKind.Run, start, true);
  const watcher = vscode.workspace.createFileSystemWatcher(PATTERN);
  watcher.onDidCreate(add);
  watcher.onDidChange(add);
  watcher.onDidDelete((uri) => controller.items.delete(uri.toString()));
  void all();
  return vscode.Disposable.from(controller, watcher);
}
