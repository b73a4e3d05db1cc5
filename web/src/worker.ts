// A thread that runs the program. The page ends it when a run takes too long, and starts another.

import { type Ended, type Files, run } from "./program";

/** What the page sends: the program, once and first; then what it asks for. */
export type Asked = { module: WebAssembly.Module } | { id: number; args: string[]; files: Files };

/** How a run ended. */
export interface Answer {
  id: number;
  ended: Ended;
}

let module: WebAssembly.Module | undefined;

self.onmessage = async ({ data }: MessageEvent<Asked>) => {
  if ("module" in data) module = data.module;
  else if (module !== undefined) {
    const answer: Answer = { id: data.id, ended: await run(module, data.args, data.files) };
    self.postMessage(answer);
  }
};
