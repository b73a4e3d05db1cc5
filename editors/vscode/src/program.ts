// Finds the program and runs it. Nothing here needs an editor.

import { execFile } from "node:child_process";
import { accessSync, constants, statSync } from "node:fs";
import * as path from "node:path";

/** What a run left. */
export interface Ran {
  /** Exit status: 0 clean, 1 findings, 2 something could not be run; -1 when it was stopped. */
  code: number;
  out: string;
  err: string;
}

/** The program that a setting names, or the first of `PATH`; a text that says what to do where there is none. */
export function find(setting: string, env: NodeJS.ProcessEnv, platform: NodeJS.Platform): { program: string } | { problem: string } {
  const endings = platform === "win32" ? (env.PATHEXT ?? ".EXE;.CMD").split(";") : [""];
  if (setting !== "") {
    const home = setting.startsWith("~/") ? path.join(env.HOME ?? "", setting.slice(2)) : setting;
    const found = ["", ...endings].map((ending) => home + ending).find(runs);
    return found ? { program: found } : { problem: `The setting "shadercheck.path" names ${setting}, which is no program.` };
  }
  for (const folder of (env.PATH ?? "").split(path.delimiter).filter((folder) => folder !== "")) {
    const found = endings.map((ending) => path.join(folder, "shadercheck" + ending)).find(runs);
    if (found) return { program: found };
  }
  return { problem: 'shadercheck is not on PATH. Install it, or set "shadercheck.path".' };
}

function runs(file: string): boolean {
  try {
    accessSync(file, constants.X_OK);
    return statSync(file).isFile();
  } catch {
    return false;
  }
}

/** Runs the program to its end; `signal` stops it, and it then reports what it has. */
export function run(program: string, args: string[], cwd: string, signal?: AbortSignal): Promise<Ran> {
  return new Promise((resolve, reject) => {
    const options = { cwd, signal, maxBuffer: 1 << 28, killSignal: "SIGINT" as const };
    execFile(program, args, options, (error, out, err) => {
      if (!error) resolve({ code: 0, out, err });
      else if (typeof error.code === "number") resolve({ code: error.code, out, err });
      else if (error.name === "AbortError" || error.signal) resolve({ code: -1, out, err });
      else reject(error);
    });
  });
}
