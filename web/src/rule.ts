// The page of a rule, as `shadercheck explain` prints it, and the examples in it.

import type { Open } from "./state";

/** The files of the bad or the good example of a page; none where it has no such part. */
export function example(page: string, part: "Bad" | "Good"): Open[] {
  const lines = page.replaceAll(/\x1b\[[\d;]*m/g, "").split("\n");
  const begin = lines.indexOf(`## ${part}`);
  if (begin < 0) return [];
  const files: Open[] = [];
  let name: string | undefined;
  let text: string[] | undefined;
  for (const line of lines.slice(begin + 1)) {
    if (text === undefined && line.startsWith("## ")) break;
    if (line.startsWith("```")) {
      if (text === undefined) {
        name ??= `example.${line.slice(3) === "wgsl" ? "wgsl" : "frag"}`;
        text = [];
      } else {
        files.push({ name: name ?? "example.frag", text: `${text.join("\n")}\n` });
        [name, text] = [undefined, undefined];
      }
    } else if (text !== undefined) text.push(line);
    else name = /^`([^`]+)`$/.exec(line)?.[1] ?? name;
  }
  return files;
}
