// The panes beside the editor: what each runs. One line here is a pane more.

/** What is open. */
export interface Shown {
  /** The file that is shown. */
  file: string;
  /** All files. */
  names: string[];
  /** The language that is translated to. */
  target: string;
}

export interface Pane {
  id: string;
  title: string;
  /** What it does, in a sentence. */
  about: string;
  /** Its result is a table, whose lines are not broken. */
  table?: true;
  /** The command line; where it lacks something, what that is. */
  args(shown: Shown): string[] | string;
}

const text = ["--color", "always"];
const SUITE = ".suite.toml";

/** Panes that run when they are asked to; the list of problems beside them runs while typing. */
export const PANES: Pane[] = [
  {
    id: "fuzz",
    title: "Fuzz",
    about: "Runs every function and kernel on generated inputs and shows the smallest ones that go wrong.",
    args: ({ file }) => [...text, "fuzz", file],
  },
  {
    id: "trace",
    title: "Trace",
    about: "Shows where the value of the smallest failing case goes wrong, expression after expression.",
    table: true,
    args: ({ file }) => [...text, "trace", file],
  },
  {
    id: "improve",
    title: "Improve",
    about: "Finds formulas that lose fewer bits and are worse on no known device.",
    args: ({ file }) => [...text, "improve", file],
  },
  {
    id: "tune",
    title: "Tune",
    about: "Finds which declarations may be mediump on phones, and which must be highp.",
    table: true,
    args: ({ file }) => [...text, "tune", file],
  },
  {
    id: "check",
    title: "Check",
    about: "Runs the suites: every output of a shader compared with its formula, within derived bounds.",
    table: true,
    args: ({ names }) => {
      const suites = names.filter((name) => name.endsWith(SUITE));
      return suites.length > 0 ? [...text, "check", ...suites] : `No suite is open: add a file NAME${SUITE}.`;
    },
  },
  {
    id: "compare",
    title: "Compare",
    about: "Runs the functions of two files on the same inputs and tells whether they compute the same.",
    args: ({ file, names }) => {
      const other = names.find((name) => name !== file && !name.endsWith(SUITE));
      return other === undefined ? "Two shaders are compared: add the other one." : [...text, "compare", file, other];
    },
  },
  {
    id: "translate",
    title: "Translate",
    about: "Translates the shader, and compares the translation with it.",
    args: ({ file, target }) => [...text, "translate", "--to", target, file],
  },
];

/** Languages of the pane that translates. */
export const TARGETS = ["wgsl", "glsl", "msl", "hlsl"];
