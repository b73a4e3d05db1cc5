// The command line of shadercheck, compiled to WebAssembly, on files in memory. It is the program that a machine has, so the
// page says what the terminal says.

import { Directory, File, type Inode, OpenFile, PreopenDirectory, WASI } from "@bjorn3/browser_wasi_shim";

/** Texts by their paths, which have no leading slash. */
export type Files = Record<string, string>;

/** How a run ended. */
export interface Ended {
  /** Exit status: 0 clean, 1 findings, 2 what could not be done. */
  status: number;
  out: string;
  err: string;
  /** Files that the run wrote or changed. */
  written: Files;
}

const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** Runs `shadercheck ARGUMENTS` in a folder that has these files and nothing else. */
export async function run(module: WebAssembly.Module, args: string[], files: Files): Promise<Ended> {
  const [stdin, stdout, stderr] = [empty(), empty(), empty()];
  const root = tree(files);
  const folder = new PreopenDirectory("/", root);
  const streams = [stdin, stdout, stderr].map((file) => new OpenFile(file));
  const wasi = new WASI(["shadercheck", ...args], ["LANG=C"], [...streams, folder], { debug: false });
  const instance = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport });
  let status: number;
  let trapped = "";
  try {
    status = wasi.start(instance as { exports: { memory: WebAssembly.Memory; _start: () => unknown } });
  } catch (error) {
    status = 2;
    const deep = error instanceof RangeError;
    trapped = deep
      ? "error: this needs more stack than the browser gives; the program of a terminal has more\n"
      : `error: the program ended early: ${error instanceof Error ? error.message : String(error)}\n`;
  }
  return {
    status,
    out: decoder.decode(stdout.data),
    err: decoder.decode(stderr.data) + trapped,
    written: changed(root, files, ""),
  };
}

function empty(): File {
  return new File([]);
}

function tree(files: Files): Map<string, Inode> {
  const root = new Map<string, Inode>();
  for (const [path, text] of Object.entries(files)) {
    const parts = path.split("/").filter((part) => part !== "");
    const name = parts.pop();
    if (name === undefined) continue;
    let at = root;
    for (const part of parts) {
      const there = at.get(part);
      const folder = there instanceof Directory ? there : new Directory([]);
      at.set(part, folder);
      at = folder.contents;
    }
    at.set(name, new File(encoder.encode(text)));
  }
  return root;
}

function changed(folder: Map<string, Inode>, before: Files, prefix: string): Files {
  const found: Files = {};
  for (const [name, node] of folder) {
    const path = prefix + name;
    if (node instanceof Directory) {
      Object.assign(found, changed(node.contents, before, `${path}/`));
    } else if (node instanceof File) {
      const text = decoder.decode(node.data);
      if (before[path] !== text) found[path] = text;
    }
  }
  return found;
}
