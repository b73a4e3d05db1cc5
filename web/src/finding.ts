// The findings of `shadercheck lint --format json`, as the page on stable interfaces describes them.

export interface Place {
  file: string;
  /** Counted from 1, in characters; ends are exclusive. */
  line: number;
  column: number;
  end_line: number;
  end_column: number;
}

export interface Edit extends Place {
  replacement: string;
}

export interface Finding extends Place {
  code: string;
  name: string | null;
  severity: "error" | "warning" | "info";
  message: string;
  label: string | null;
  related: (Place & { message: string })[];
  why: string | null;
  help: string | null;
  fix: { title: string; safety: "safe" | "unsafe"; edits: Edit[] } | null;
}

/** Offset in UTF-16 units of a place that counts characters; the end of the line where the line is shorter. */
export function offset(text: string, line: number, column: number): number {
  let start = 0;
  for (let k = 1; k < line; k++) {
    const end = text.indexOf("\n", start);
    if (end < 0) return text.length;
    start = end + 1;
  }
  const end = text.indexOf("\n", start);
  const stop = end < 0 ? text.length : end;
  let at = start;
  for (let k = 1; k < column && at < stop; k++) at += (text.codePointAt(at) ?? 0) > 0xffff ? 2 : 1;
  return at;
}

/** The texts with the edits of a repair made, last place first. */
export function edited(files: { name: string; text: string }[], edits: Edit[]): { name: string; text: string }[] {
  return files.map(({ name, text }) => {
    const here = edits
      .filter((edit) => edit.file === name)
      .map((edit) => ({
        from: offset(text, edit.line, edit.column),
        to: offset(text, edit.end_line, edit.end_column),
        insert: edit.replacement,
      }))
      .sort((a, b) => b.from - a.from);
    return { name, text: here.reduce((t, { from, to, insert }) => t.slice(0, from) + insert + t.slice(to), text) };
  });
}
