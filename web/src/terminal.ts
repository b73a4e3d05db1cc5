// What the program prints to a terminal, as elements: colours become classes, and places become links.

/** Called with a place of the text: file, line and column, counted from 1. */
export type Jump = (file: string, line: number, column: number) => void;

const ESCAPE = /\x1b\[([0-9;]*)m|\x1b\]8;[^;]*;([^\x1b\x07]*)(?:\x1b\\|\x07)/g;
const PLACE = /([\w./-]+\.[A-Za-z]+):(\d+)(?::(\d+))?/g;

/** A block of text as a terminal would show it. */
export function terminal(text: string, jump: Jump): HTMLElement {
  const block = document.createElement("pre");
  block.className = "terminal";
  let classes: string[] = [];
  let at = 0;
  const put = (end: number) => {
    if (end > at) block.append(piece(text.slice(at, end), classes, jump));
  };
  for (const match of text.matchAll(ESCAPE)) {
    put(match.index);
    at = match.index + match[0].length;
    if (match[1] !== undefined) classes = styled(classes, match[1]);
  }
  put(text.length);
  return block;
}

function piece(text: string, classes: string[], jump: Jump): HTMLElement {
  const span = document.createElement("span");
  span.className = classes.join(" ");
  let at = 0;
  for (const match of text.matchAll(PLACE)) {
    const [whole, file, line, column] = match;
    if (file === undefined || line === undefined) continue;
    span.append(text.slice(at, match.index));
    const link = document.createElement("button");
    link.className = "place";
    link.textContent = whole;
    link.onclick = () => jump(file, Number(line), Number(column ?? 1));
    span.append(link);
    at = match.index + whole.length;
  }
  span.append(text.slice(at));
  return span;
}

function styled(classes: string[], codes: string): string[] {
  let now = classes;
  for (const code of codes.split(";")) {
    const number = Number(code);
    if (number === 0) now = [];
    else if (number === 1) now = [...now, "bold"];
    else if (number === 2) now = [...now, "dim"];
    else if ((number >= 30 && number <= 37) || (number >= 90 && number <= 97)) {
      now = [...now.filter((name) => !name.startsWith("colour")), `colour${number % 10}`];
    }
  }
  return now;
}
