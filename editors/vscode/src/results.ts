// What `shadercheck check --format json` says, as the test explorer shows it. Nothing here needs an editor.

import * as path from "node:path";

/** A place in a file: lines and columns count from 1. */
export interface Place {
  file: string;
  line: number;
  column: number;
}

export interface Failure {
  message: string;
  place?: Place;
}

/** The result of a suite: failures of all lanes, each told once. */
export interface Result {
  suite: string;
  failures: Failure[];
  /** Why it was not judged. */
  skipped?: string;
}

interface Finding {
  kind: string;
  severity: string;
  message: string;
  file?: string;
  line?: number;
  column?: number;
  reproduce?: string;
  case?: { inputs?: { declared?: string; decimal?: string[] }[]; computed_at?: { at?: string } };
}

interface Entry {
  suite: string;
  lane?: string;
  stage?: string;
  findings?: Finding[];
  not_run?: string;
}

/** Reads a report. Throws where it is none. */
export function results(report: string, cwd: string): Result[] {
  const { suites } = JSON.parse(report) as { suites: Entry[] };
  const found = new Map<string, Result & { judged: boolean }>();
  for (const entry of suites) {
    const result = found.get(entry.suite) ?? { suite: entry.suite, failures: [], judged: false };
    found.set(entry.suite, result);
    if (entry.not_run) result.skipped ??= entry.not_run;
    else result.judged = true;
    const on = entry.lane ? ` on ${entry.lane}/${entry.stage}` : "";
    const add = (message: string, place?: Place) => {
      if (!result.failures.some((known) => known.message === message)) result.failures.push({ message, place });
    };
    for (const finding of entry.findings ?? []) {
      if (finding.severity === "error") add(described(`${entry.suite}${on}`, finding), placeOf(finding, cwd));
    }
  }
  return [...found.values()].map(({ judged, ...result }) => (judged ? { ...result, skipped: undefined } : result));
}

function described(on: string, finding: Finding): string {
  const inputs = (finding.case?.inputs ?? []).map((input) => `  ${input.declared} = ${(input.decimal ?? []).join(", ")}`);
  const again = finding.reproduce ? [`reproduce: ${finding.reproduce}`] : [];
  return [`${on}: ${finding.message}`, ...inputs, ...again].join("\n");
}

function placeOf(finding: Finding, cwd: string): Place | undefined {
  if (finding.file && finding.line) {
    return { file: path.resolve(cwd, finding.file), line: finding.line, column: finding.column ?? 1 };
  }
  const at = /^(.*):(\d+):(\d+)$/.exec(finding.case?.computed_at?.at ?? "");
  return at ? { file: path.resolve(cwd, at[1]), line: Number(at[2]), column: Number(at[3]) } : undefined;
}

/** The name that a suite file gives itself, with its line from 0. */
export function nameOf(text: string): { name: string; line: number } | undefined {
  const lines = text.split(/\r?\n/);
  for (let line = 0; line < lines.length; line++) {
    if (/^\s*\[/.test(lines[line])) return undefined;
    const found = /^\s*suite\s*=\s*["']([^"']+)["']/.exec(lines[line]);
    if (found) return { name: found[1], line };
  }
  return undefined;
}

/** The page of a run as a web view shows it: its own styles and script, and nothing from elsewhere. */
export function page(html: string, nonce: string): string {
  const policy = `default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'nonce-${nonce}'`;
  const meta = `<meta http-equiv="Content-Security-Policy" content="${policy}">`;
  return html.replace(/<head>/i, (head) => head + meta).replace(/<script(?=[\s>])/gi, `<script nonce="${nonce}"`);
}
