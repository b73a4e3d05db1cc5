// Runs in a thread beside the page, one at a time, with a limit; a new thread stands behind a run that was stopped.

import type { Ended, Files } from "./program";
import type { Answer, Asked } from "./worker";

/** A run that was stopped, by the visitor or by the limit. */
export class Stopped extends Error {}

/** Longest run in milliseconds. */
const LONGEST = 120_000;

interface Waiting {
  done(ended: Ended): void;
  stop(why: Error): void;
  timer: number;
}

/** The program, compiled once for all threads. */
export async function load(): Promise<WebAssembly.Module> {
  const response = await fetch("shadercheck.wasm");
  if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
  return WebAssembly.compileStreaming(response);
}

export class Runner {
  #worker: Promise<Worker>;
  #waiting = new Map<number, Waiting>();
  #next = 0;

  constructor(private readonly module: Promise<WebAssembly.Module>) {
    this.#worker = this.#begin();
  }

  /** Runs a command on files in memory. Rejects with [`Stopped`] where it is stopped, and where there is no program. */
  run(args: string[], files: Files): Promise<Ended> {
    const id = this.#next++;
    return new Promise((done, stop) => {
      const late = () => this.stop(`stopped after ${LONGEST / 1000} s`);
      this.#waiting.set(id, { done, stop, timer: window.setTimeout(late, LONGEST) });
      const send = (worker: Worker) => {
        if (this.#waiting.has(id)) worker.postMessage({ id, args, files } satisfies Asked);
      };
      this.#worker.then(send, stop);
    });
  }

  /** True while a run has not ended. */
  get busy(): boolean {
    return this.#waiting.size > 0;
  }

  /** Ends what runs; the thread is started again. */
  stop(why: string): void {
    this.#worker.then((worker) => worker.terminate(), () => undefined);
    this.#worker = this.#begin();
    const waiting = [...this.#waiting.values()];
    this.#waiting.clear();
    for (const { stop, timer } of waiting) {
      clearTimeout(timer);
      stop(new Stopped(why));
    }
  }

  async #begin(): Promise<Worker> {
    const module = await this.module;
    const worker = new Worker("worker.js", { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<Answer>) => {
      const waiting = this.#waiting.get(data.id);
      this.#waiting.delete(data.id);
      if (waiting === undefined) return;
      clearTimeout(waiting.timer);
      waiting.done(data.ended);
    };
    worker.onerror = () => this.stop("the thread of the program was lost");
    worker.postMessage({ module } satisfies Asked);
    return worker;
  }
}
