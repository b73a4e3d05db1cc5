// The packaged extension in a real host: code-server, which is VS Code with its window in a browser. Opens the tour, counts
// the findings, shows a translation beside the text, and may take a picture.
//
//   mkdir host && cd host && npm install code-server playwright-core     (Node.js 24, headers of Kerberos, Chromium)
//   SHADERCHECK=target/debug/shadercheck node editors/vscode/host/run.mjs host [picture.png]
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import * as path from "node:path";
import { fileURLToPath } from "node:url";

const [modules, picture] = process.argv.slice(2);
assert.ok(modules, "name the folder in which code-server and playwright-core are installed");
const extension = path.dirname(path.dirname(fileURLToPath(import.meta.url)));
const program = path.resolve(process.env.SHADERCHECK ?? "target/debug/shadercheck");
const require = createRequire(path.resolve(modules, "package.json"));
const { chromium } = require("playwright-core");
const entry = path.resolve(modules, "node_modules/code-server/out/node/entry.js");
const place = mkdtempSync(path.join(tmpdir(), "shadercheck-host-"));
const folder = path.join(place, "tour");
const data = path.join(place, "data");
cpSync(path.join(extension, "../../fixtures/tour"), folder, { recursive: true });
// The extension runs where the files are: its settings are those of that machine.
for (const [kind, settings] of [
  ["Machine", { "shadercheck.path": program }],
  ["User", { "workbench.startupEditor": "none", "editor.minimap.enabled": false, "workbench.secondarySideBar.defaultVisibility": "hidden" }],
]) {
  mkdirSync(path.join(data, kind), { recursive: true });
  writeFileSync(path.join(data, kind, "settings.json"), JSON.stringify(settings));
}
const options = ["--user-data-dir", data, "--extensions-dir", path.join(place, "extensions")];
const packed = path.join(extension, "dist/shadercheck.vsix");
execFileSync(process.execPath, [entry, ...options, "--install-extension", packed], { stdio: "inherit" });
const port = 20000 + (process.pid % 20000);
const quiet = ["--auth", "none", "--disable-telemetry", "--disable-update-check", "--disable-workspace-trust"];
const host = spawn(process.execPath, [entry, ...options, ...quiet, "--bind-addr", `127.0.0.1:${port}`, folder], { stdio: "ignore" });
let browser;
try {
  const address = `http://127.0.0.1:${port}/?folder=${folder}`;
  for (let tries = 0; !(await fetch(address).catch(() => undefined)); tries++) {
    assert.ok(tries < 120, "the host does not start");
    await new Promise((resolve) => setTimeout(resolve, 500));
  }
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox"] });
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page.setDefaultTimeout(60_000);
  await page.goto(address);
  await page.locator(".monaco-list-row", { hasText: "scene.frag" }).dblclick();
  // Four errors and six warnings, in the bar below.
  await page.locator('a[aria-label="Warnings: 6"], [aria-label*="Errors: 4"][aria-label*="Warnings: 6"]').first().waitFor();
  await page.keyboard.press("Control+Shift+M");
  await page.locator(".markers-panel .monaco-list-row", { hasText: "is looked up as a uniform" }).first().waitFor();
  const lens = page.locator(".codelens-decoration a", { hasText: "Show as WGSL" }).first();
  await lens.waitFor();
  if (picture) await page.screenshot({ path: picture });
  await lens.click();
  await page.locator(".tab", { hasText: "translate-scene.frag.wgsl" }).waitFor();
  await page.locator(".view-line", { hasText: "struct FragmentOutput" }).first().waitFor();
  console.log("the tour has its ten findings, and a translation is shown beside it");
} finally {
  await browser?.close();
  host.kill();
  rmSync(place, { recursive: true, force: true, maxRetries: 5 });
}
