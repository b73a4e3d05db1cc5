// The tabs of the open files, and what may be done with files.

import type { Open } from "./state";

/** What the page does when files change. */
export interface Changes {
  /** The files as they are now: what was typed since the bar was made is in them. */
  files(): Open[];
  /** Other files are open, or another one is shown. */
  change(files: Open[], at: number): void;
  /** What could not be done. */
  refuse(why: string): void;
}

/** Largest file that is taken, in bytes. */
const LARGEST = 1 << 20;
const QUESTION = "Name of the file; its ending tells its language and stage";

/** A button. */
export function button(text: string, click: () => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.textContent = text;
  made.onclick = click;
  return made;
}

/** The tabs of files, with one that is shown, and the buttons behind them. */
export function fileBar(files: Open[], at: number, changes: Changes): HTMLElement[] {
  const tabs = files.map(({ name }, k) => {
    const tab = button(name, () => changes.change(changes.files(), k));
    tab.ariaCurrent = String(k === at);
    return tab;
  });
  const add = () => {
    const now = changes.files();
    const name = named(now, "shader.frag");
    if (name !== undefined) changes.change([...now, { name, text: "" }], now.length);
  };
  const rename = () => {
    const now = changes.files();
    const name = named(now, now[at]?.name ?? "", at);
    if (name !== undefined) changes.change(now.map((file, k) => (k === at ? { ...file, name } : file)), at);
  };
  const remove = () => {
    if (!window.confirm(`Remove ${files[at]?.name} from this page?`)) return;
    const kept = changes.files().filter((_, k) => k !== at);
    changes.change(kept.length > 0 ? kept : [{ name: "shader.frag", text: "" }], Math.max(0, Math.min(at, kept.length - 1)));
  };
  const own = [
    button("New", add),
    button("Open", () => choose(changes)),
    button("Rename", rename),
    button("Remove", remove),
  ];
  for (const one of own) one.className = "file";
  return [...tabs, ...own];
}

/** Takes files of the visitor, which stay in the page: beside those that are open, instead of those of the same names. */
export async function take(list: FileList | null | undefined, changes: Changes): Promise<void> {
  const read = [...(list ?? [])].map(async (file) => {
    if (file.size > LARGEST) throw new Error(`${file.name} is larger than a megabyte`);
    return { name: file.name, text: await file.text() };
  });
  try {
    const taken = await Promise.all(read);
    const kept = changes.files().filter(({ name }) => taken.every((file) => file.name !== name));
    if (taken.length > 0) changes.change([...kept, ...taken], kept.length);
  } catch (error) {
    changes.refuse(error instanceof Error ? error.message : String(error));
  }
}

function choose(changes: Changes): void {
  const input = document.createElement("input");
  input.type = "file";
  input.multiple = true;
  input.onchange = () => void take(input.files, changes);
  input.click();
}

/** Asks for a name that no other file has; nothing where the visitor changed his mind. */
function named(files: Open[], proposed: string, own = -1): string | undefined {
  const name = window.prompt(QUESTION, proposed)?.trim();
  if (name === undefined || name === "" || name === files[own]?.name) return undefined;
  if (files.some((file) => file.name === name)) {
    window.alert(`There is a file ${name}.`);
    return undefined;
  }
  if (/^\/|\.\.|\\/.test(name)) {
    window.alert("A name has no leading slash, no `..` and no backslash.");
    return undefined;
  }
  return name;
}
