// The editor: CodeMirror with the findings of the linter in it.

import { HighlightStyle, StreamLanguage, syntaxHighlighting } from "@codemirror/language";
import { clike, shader } from "@codemirror/legacy-modes/mode/clike";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { EditorState, type Extension } from "@codemirror/state";
import { EditorView } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import { basicSetup } from "codemirror";
import { type Finding, offset } from "./finding";

const words = (text: string) => Object.fromEntries(text.split(" ").map((word) => [word, true]));

const wgsl = clike({
  name: "wgsl",
  keywords: words(
    "alias break case const const_assert continue continuing default diagnostic discard else enable fn for if let loop " +
      "override requires return struct switch var while import",
  ),
  types: words(
    "bool f16 f32 i32 u32 vec2 vec3 vec4 vec2f vec3f vec4f vec2i vec3i vec4i vec2u vec3u vec4u vec2h vec3h vec4h mat2x2 " +
      "mat3x3 mat4x4 mat2x2f mat3x3f mat4x4f array atomic ptr sampler texture_2d texture_3d texture_cube texture_storage_2d",
  ),
  blockKeywords: words("case else for if loop switch while struct fn"),
  atoms: words("true false storage uniform workgroup private function read write read_write"),
  hooks: {
    "@": (stream: { eatWhile(pattern: RegExp): void }) => {
      stream.eatWhile(/[\w]/);
      return "meta";
    },
  },
});

// Colours are those of the page, so that they follow its dark form.
const colours = HighlightStyle.define([
  { tag: tags.keyword, color: "var(--keyword)" },
  { tag: [tags.typeName, tags.standard(tags.name)], color: "var(--type)" },
  { tag: [tags.number, tags.bool, tags.atom], color: "var(--number)" },
  { tag: tags.comment, color: "var(--faint)", fontStyle: "italic" },
  { tag: [tags.meta, tags.processingInstruction], color: "var(--meta)" },
  { tag: tags.string, color: "var(--string)" },
]);

export class Editor {
  #view: EditorView;
  #extensions: Extension[];
  #name = "";

  /** `changed` is told what the visitor types, `explain` which code he asks for, `repair` which repair he takes. */
  constructor(
    parent: HTMLElement,
    changed: (text: string) => void,
    private readonly explain: (code: string) => void,
    private readonly repair: (finding: Finding) => void,
  ) {
    this.#extensions = [
      basicSetup,
      lintGutter(),
      syntaxHighlighting(colours),
      EditorView.updateListener.of((update) => {
        if (update.docChanged) changed(update.state.doc.toString());
      }),
      EditorView.contentAttributes.of({ "aria-label": "Shader", spellcheck: "false" }),
    ];
    this.#view = new EditorView({ parent });
  }

  /** Shows a file. What is undone later is of this file alone; a repair of the file that is shown can be undone. */
  open(name: string, text: string): void {
    const doc = this.#view.state.doc;
    if (name !== this.#name) {
      const language = StreamLanguage.define(name.endsWith(".wgsl") ? wgsl : shader);
      this.#view.setState(EditorState.create({ doc: text, extensions: [...this.#extensions, language] }));
    } else if (text !== doc.toString()) {
      this.#view.dispatch({ changes: { from: 0, to: doc.length, insert: text } });
    }
    this.#name = name;
  }

  /** Marks the findings of the file that is shown. */
  show(findings: Finding[]): void {
    const text = this.#view.state.doc.toString();
    const all = findings.map((finding): Diagnostic => {
      const from = offset(text, finding.line, finding.column);
      const actions = [{ name: `About ${finding.code}`, apply: () => this.explain(finding.code) }];
      const { fix } = finding;
      if (fix !== null) actions.unshift({ name: fix.title, apply: () => this.repair(finding) });
      return {
        from,
        to: Math.max(from, offset(text, finding.end_line, finding.end_column)),
        severity: finding.severity,
        source: finding.code,
        message: finding.message,
        actions,
      };
    });
    this.#view.dispatch(setDiagnostics(this.#view.state, all));
  }

  /** Puts the cursor at a place and shows it. */
  jump(line: number, column: number): void {
    const at = offset(this.#view.state.doc.toString(), line, column);
    this.#view.dispatch({ selection: { anchor: at }, effects: EditorView.scrollIntoView(at, { y: "center" }) });
    this.#view.focus();
  }
}
