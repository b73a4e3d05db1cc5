// The findings of the linter as a list.

import type { Finding } from "./finding";
import type { Jump } from "./terminal";

/** What a visitor may do with a finding. */
export interface Actions {
  jump: Jump;
  explain(code: string): void;
  repair(finding: Finding): void;
}

/** The list; a sentence where there is nothing. */
export function problems(findings: Finding[], actions: Actions): HTMLElement {
  const list = document.createElement("ul");
  list.className = "problems";
  if (findings.length === 0) {
    const none = document.createElement("p");
    none.className = "none";
    none.textContent = "No problem found. Fuzz runs every function on many inputs.";
    return none;
  }
  list.append(...findings.map((finding) => item(finding, actions)));
  return list;
}

function item(finding: Finding, actions: Actions): HTMLElement {
  const { file, line, column, code, name, message, label, why, help, fix } = finding;
  const entry = element("li", finding.severity);
  const head = element("div", "head");
  const about = button(`${code}${name === null ? "" : ` ${name}`}`, "code", () => actions.explain(code));
  about.title = "Show the page of this rule";
  head.append(element("span", "severity", finding.severity), about);
  head.append(button(`${file}:${line}:${column}`, "place", () => actions.jump(file, line, column)));
  entry.append(head, element("p", "message", message));
  if (label !== null && label !== "" && label !== message) entry.append(element("p", "label", label));
  for (const other of finding.related) {
    const row = element("p", "related");
    row.append(button(`${other.file}:${other.line}:${other.column}`, "place", () => {
      actions.jump(other.file, other.line, other.column);
    }), ` ${other.message}`);
    entry.append(row);
  }
  if (why !== null) entry.append(element("p", "why", why));
  if (help !== null) entry.append(element("p", "help", help));
  if (fix !== null) {
    const take = button(fix.title, "fix", () => actions.repair(finding));
    if (fix.safety === "unsafe") take.title = "Look at what it changes: the meaning may be another";
    entry.append(take);
  }
  return entry;
}

function element(tag: string, kind: string, text = ""): HTMLElement {
  const made = document.createElement(tag);
  made.className = kind;
  made.textContent = text;
  return made;
}

function button(text: string, kind: string, click: () => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.className = kind;
  made.textContent = text;
  made.onclick = click;
  return made;
}
