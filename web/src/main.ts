// The page: files, editor and panes. What the program says is shown as it says it.

import { Editor } from "./editor";
import { EXAMPLES } from "./examples";
import { button, fileBar, take, type Changes } from "./files";
import { edited, type Finding } from "./finding";
import { PANES, type Pane, TARGETS } from "./panes";
import { problems } from "./problems";
import type { Files } from "./program";
import { load, Runner } from "./runner";
import { example } from "./rule";
import { packed, type State, unpacked } from "./state";
import { terminal } from "./terminal";

/** How long the visitor must pause before the linter runs, in milliseconds. */
const PAUSE = 40;

/** How much the linter tells, as its option has it. */
const LEVELS = ["default", "strict", "heuristic"];

const at = (id: string) => document.getElementById(id) as HTMLElement;
const [result, bar, status] = [at("result"), at("bar"), at("state")];

let state: State = first();
const tabs = new Map<string, HTMLButtonElement>();
let level = "default";
let target = TARGETS[0] ?? "wgsl";
let findings: Finding[] = [];
let pause = 0;
/** Runs of panes so far: what an earlier one gives is not shown. */
let runs = 0;
let linting = false;
let changed = false;

const program = load();
// The linter answers while something else runs.
const [linter, runner] = [new Runner(program), new Runner(program)];
const editor = new Editor(at("editor"), typed, explain, repair);

function first(): State {
  const [shown] = EXAMPLES;
  return { files: shown?.files ?? [], at: 0, pane: shown?.pane ?? "problems" };
}

function current(): { name: string; text: string } {
  return state.files[state.at] ?? { name: "shader.frag", text: "" };
}

function texts(): Files {
  return Object.fromEntries(state.files.map(({ name, text }) => [name, text]));
}

function names(): string[] {
  return state.files.map(({ name }) => name);
}

function typed(text: string): void {
  state.files = state.files.map((file, k) => (k === state.at ? { ...file, text } : file));
  clearTimeout(pause);
  pause = window.setTimeout(lint, PAUSE);
}

/** Runs the linter on all files; what is typed meanwhile is looked at behind it. */
async function lint(): Promise<void> {
  changed = true;
  if (linting) return;
  linting = true;
  while (changed) {
    changed = false;
    try {
      const ended = await linter.run(["lint", ...names(), "--level", level, "--format", "json", "--exit-zero"], texts());
      if (ended.status !== 0) throw new Error(ended.err);
      findings = JSON.parse(ended.out) as Finding[];
      if (state.pane === "problems") result.replaceChildren(problems(findings, { jump, explain, repair }));
    } catch (error) {
      findings = [];
      if (state.pane === "problems") result.replaceChildren(terminal(words(error), jump));
    }
    mark();
    panes();
  }
  linting = false;
}

/** Shows the findings of the file that is open in the editor. */
function mark(): void {
  editor.show(findings.filter((finding) => finding.file === current().name));
}

function words(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}

function jump(file: string, line: number, column: number): void {
  const index = state.files.findIndex(({ name }) => name === file);
  if (index < 0) return;
  if (index !== state.at) show(index);
  editor.jump(line, column);
}

function repair(finding: Finding): void {
  if (finding.fix === null) return;
  state.files = edited(state.files, finding.fix.edits);
  show(state.at);
  void lint();
}

async function explain(code: string): Promise<void> {
  const ended = await linter.run(["--color", "always", "explain", code], {});
  const parts = [button("Back to the problems", () => pane("problems"))];
  for (const part of ["Bad", "Good"] as const) {
    const files = example(ended.out, part);
    if (files.length === 0) continue;
    parts.push(button(`Open the ${part.toLowerCase()} example`, () => restore({ files, at: 0, pane: "problems" })));
  }
  bar.replaceChildren(...parts);
  result.replaceChildren(terminal(ended.out + ended.err, jump));
}

async function runPane(chosen: Pane): Promise<void> {
  const mine = ++runs;
  // Nobody waits for the run before it.
  if (runner.busy) runner.stop("stopped for another run");
  const args = chosen.args({ file: current().name, names: names(), target });
  result.replaceChildren();
  if (typeof args === "string") {
    bar.replaceChildren(args);
    return;
  }
  const stop = button("Stop", () => runner.stop("stopped"));
  const begun = performance.now();
  bar.replaceChildren(stop, "running…");
  let outcome: string;
  try {
    const ended = await runner.run(args, texts());
    if (mine !== runs || state.pane !== chosen.id) return;
    outcome = `status ${ended.status}, ${((performance.now() - begun) / 1000).toFixed(2)} s`;
    const block = terminal(ended.err + ended.out, jump);
    block.classList.toggle("wide", chosen.table === true);
    result.replaceChildren(block);
  } catch (error) {
    outcome = words(error);
  }
  if (mine === runs && state.pane === chosen.id) controls(chosen, outcome);
}

function controls(chosen: Pane, outcome: string): void {
  const run = button("Run", () => void runPane(chosen));
  run.className = "run";
  const parts: (HTMLElement | string)[] = [run];
  if (chosen.id === "translate") {
    const choose = (name: string) => {
      target = name;
      void runPane(chosen);
    };
    parts.push(choice("Language", TARGETS, target, choose));
  }
  bar.replaceChildren(...parts, outcome);
}

/** A list of words of which one is chosen. */
function choice(label: string, words: string[], now: string, choose: (word: string) => void): HTMLSelectElement {
  const made = document.createElement("select");
  made.setAttribute("aria-label", label);
  made.append(...words.map((word) => new Option(word, word, false, word === now)));
  made.onchange = () => choose(made.value);
  return made;
}

/** Shows a pane; those that have to be asked run at once. */
function pane(id: string): void {
  state.pane = id;
  panes();
  const chosen = PANES.find((one) => one.id === id);
  if (chosen !== undefined) {
    void runPane(chosen);
    return;
  }
  const choose = (word: string) => {
    level = word;
    void lint();
  };
  bar.replaceChildren(choice("Level", LEVELS, level, choose), "What is wrong, without running anything, while you type.");
  result.replaceChildren(problems(findings, { jump, explain, repair }));
}

/** Marks the pane that is shown. The tabs stay: one that is replaced while it is clicked loses the click. */
function panes(): void {
  for (const [id, tab] of tabs) tab.ariaSelected = String(id === state.pane);
  const count = findings.length === 0 ? "" : ` (${findings.length})`;
  const problems = tabs.get("problems");
  if (problems !== undefined) problems.textContent = `Problems${count}`;
}

function makeTabs(): void {
  const first = { id: "problems", title: "Problems", about: "What is wrong, without running anything." };
  for (const { id, title, about } of [first, ...PANES]) {
    const tab = button(title, () => pane(id));
    tab.title = about;
    tab.role = "tab";
    tabs.set(id, tab);
    at("panes").append(tab);
  }
}

/** Shows a file. */
function show(index: number): void {
  state.at = index;
  const { name, text } = current();
  editor.open(name, text);
  mark();
  at("files").replaceChildren(...fileBar(state.files, index, changes));
}

const changes: Changes = {
  files: () => state.files,
  change(files, index) {
    state = { ...state, files };
    show(index);
    void lint();
  },
  refuse: (why) => say(why, true),
};

async function share(): Promise<void> {
  const fragment = await packed(state);
  history.replaceState(null, "", fragment);
  const copied = await navigator.clipboard?.writeText(location.href).then(
    () => true,
    () => false,
  );
  say(copied ? "The link is copied; it holds the files." : "The link stands in the address bar.");
}

function say(text: string, failed = false): void {
  status.textContent = text;
  status.classList.toggle("failed", failed);
}

function restore(restored: State): void {
  state = restored;
  findings = [];
  show(state.at);
  pane(state.pane);
  void lint();
}

/** The bad example of the rule of `#rule=T001`. */
async function ofRule(fragment: string): Promise<State | undefined> {
  const code = /^#rule=(\w+)$/.exec(fragment)?.[1];
  if (code === undefined) return undefined;
  const page = await linter.run(["explain", code], {});
  const files = example(page.out, "Bad");
  return files.length === 0 ? undefined : { files, at: 0, pane: "problems" };
}

async function begin(): Promise<void> {
  makeTabs();
  const list = at("examples") as HTMLSelectElement;
  list.append(...EXAMPLES.map(({ title }, k) => new Option(title, String(k))));
  list.onchange = () => {
    const chosen = EXAMPLES[Number(list.value)];
    if (list.value !== "" && chosen !== undefined) restore({ files: chosen.files, at: 0, pane: chosen.pane });
  };
  at("editor").addEventListener("dragover", (event) => event.preventDefault());
  at("editor").addEventListener("drop", (event) => {
    event.preventDefault();
    event.stopPropagation();
    void take(event.dataTransfer?.files, changes);
  }, { capture: true });
  at("share").onclick = () => void share();
  let opened = state;
  try {
    opened = (await unpacked(location.hash)) ?? (await ofRule(location.hash)) ?? state;
  } catch {
    say("The link is damaged: it was cut, or is of another page. An example is shown instead.", true);
  }
  restore(opened);
  program.then(
    () => status.classList.contains("failed") || say("Nothing is sent anywhere."),
    (error) => say(`The program cannot be loaded: ${words(error)}`, true),
  );
  window.onhashchange = () => location.reload();
  if ("serviceWorker" in navigator) navigator.serviceWorker.register("offline.js").catch(() => undefined);
}

void begin();
