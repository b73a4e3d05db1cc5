// The page: files, editor and panes. What the program says is shown as it says it.

import { Editor } from "./editor";
import { EXAMPLES } from "./examples";
import { edited, type Finding } from "./finding";
import { PANES, type Pane, TARGETS } from "./panes";
import { problems } from "./problems";
import type { Files } from "./program";
import { load, Runner } from "./runner";
import { example } from "./rule";
import { packed, type State, unpacked } from "./state";
import { terminal } from "./terminal";

/** How long the visitor must pause before the linter runs, in milliseconds. */
const PAUSE = 150;

const at = (id: string) => document.getElementById(id) as HTMLElement;
const [result, bar, status] = [at("result"), at("bar"), at("state")];

let state: State = first();
const tabs = new Map<string, HTMLButtonElement>();
let target = TARGETS[0] ?? "wgsl";
let findings: Finding[] = [];
let pause = 0;
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
      const ended = await linter.run(["lint", ...names(), "--format", "json", "--exit-zero"], texts());
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
  const ended = await runner.run(["--color", "always", "explain", code], {});
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
  const args = chosen.args({ file: current().name, names: names(), target });
  result.replaceChildren();
  if (typeof args === "string") {
    bar.replaceChildren(args);
    return;
  }
  const stop = button("Stop", () => runner.stop("stopped"));
  const begun = performance.now();
  bar.replaceChildren(stop, "running…");
  let told: string;
  try {
    const ended = await runner.run(args, texts());
    told = `status ${ended.status}, ${((performance.now() - begun) / 1000).toFixed(2)} s`;
    if (state.pane === chosen.id) {
      const block = terminal(ended.err + ended.out, jump);
      block.classList.toggle("wide", chosen.table === true);
      result.replaceChildren(block);
    }
  } catch (error) {
    told = words(error);
  }
  if (state.pane === chosen.id) controls(chosen, told);
}

function controls(chosen: Pane, told: string): void {
  const run = button("Run", () => void runPane(chosen));
  run.className = "run";
  const parts: (HTMLElement | string)[] = [run];
  if (chosen.id === "translate") {
    const choice = document.createElement("select");
    choice.setAttribute("aria-label", "Language");
    choice.append(...TARGETS.map((name) => new Option(name, name, false, name === target)));
    choice.onchange = () => {
      target = choice.value;
      void runPane(chosen);
    };
    parts.push(choice);
  }
  bar.replaceChildren(...parts, told);
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
  bar.replaceChildren("What is wrong, without running anything. It is told while you type.");
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
  files();
}

function files(): void {
  const open = state.files.map(({ name }, k) => {
    const tab = button(name, () => (k === state.at ? rename(k) : show(k)));
    tab.ariaCurrent = String(k === state.at);
    if (k === state.at) tab.title = "Click to rename; the ending tells the language and the stage";
    return tab;
  });
  const more = button("+", add);
  more.title = "Add a file";
  more.ariaLabel = "Add a file";
  at("files").replaceChildren(...open, more);
}

function add(): void {
  const name = named("Name of the file; its ending tells its language and stage", "shader.frag");
  if (name === undefined) return;
  state.files = [...state.files, { name, text: "" }];
  show(state.files.length - 1);
  void lint();
}

function rename(index: number): void {
  const before = state.files[index]?.name ?? "";
  const name = named("Name of the file; nothing removes it", before, true);
  if (name === undefined || name === before) return;
  if (name === "") state.files = state.files.filter((_, k) => k !== index);
  else state.files = state.files.map((file, k) => (k === index ? { ...file, name } : file));
  if (state.files.length === 0) state.files = [{ name: "shader.frag", text: "" }];
  show(Math.min(index, state.files.length - 1));
  void lint();
}

/** Asks for a name that no other file has; nothing where the visitor changed his mind. */
function named(question: string, proposed: string, mayBeEmpty = false): string | undefined {
  const name = window.prompt(question, proposed)?.trim();
  if (name === undefined || (name === "" && !mayBeEmpty)) return undefined;
  const taken = name !== proposed || !mayBeEmpty;
  if (taken && state.files.some((file) => file.name === name)) {
    window.alert(`There is a file ${name}.`);
    return undefined;
  }
  if (/^\/|\.\.|\\/.test(name)) {
    window.alert("A name has no leading slash, no `..` and no backslash.");
    return undefined;
  }
  return name;
}

function button(text: string, click: () => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.textContent = text;
  made.onclick = click;
  return made;
}

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
  const page = await runner.run(["explain", code], {});
  const files = example(page.out, "Bad");
  return files.length === 0 ? undefined : { files, at: 0, pane: "problems" };
}

async function begin(): Promise<void> {
  makeTabs();
  const choice = at("examples") as HTMLSelectElement;
  choice.append(...EXAMPLES.map(({ title }, k) => new Option(title, String(k))));
  choice.onchange = () => {
    const chosen = EXAMPLES[Number(choice.value)];
    if (choice.value !== "" && chosen !== undefined) restore({ files: chosen.files, at: 0, pane: chosen.pane });
  };
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
