#!/usr/bin/env node
// Starts the program of the platform's package, with the same arguments, streams and exit status.
"use strict";

const { spawnSync } = require("node:child_process");
const { constants } = require("node:os");

function binary() {
  if (process.env.SHADERCHECK_BINARY) return process.env.SHADERCHECK_BINARY;
  const name = `@shadercheck/cli-${process.platform}-${process.arch}`;
  const file = process.platform === "win32" ? "shadercheck.exe" : "shadercheck";
  try {
    return require.resolve(`${name}/${file}`);
  } catch {
    console.error(
      `shadercheck: the package ${name} is not installed. If npm left optional packages out, install again without ` +
        "--omit=optional; on another platform, build from source with `cargo install shadercheck`.",
    );
    process.exit(2);
  }
}

const { error, status, signal } = spawnSync(binary(), process.argv.slice(2), { stdio: "inherit" });
if (error) {
  console.error(`shadercheck: ${error.message}`);
  process.exit(2);
}
process.exit(status ?? 128 + (constants.signals[signal] ?? 0));
