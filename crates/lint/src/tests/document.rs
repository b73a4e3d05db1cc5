//! Documents, seen from what is reported.

use base::diagnostic::Safety;
use base::text::SourceFile;
use hosts::document::printed_shaders;
use syntax::Stage;

use crate::{Input, Settings, run};

macro_rules! fixture {
    ($name:literal) => {
        ($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/documents/", $name)))
    };
}

/// What is told besides information, with its place and the text there.
fn told((name, text): (&str, &str)) -> Vec<String> {
    let found = run(&[Input::new(SourceFile::new(name, text))]);
    let grave = found.iter().filter(|d| d.severity > base::diagnostic::Severity::Info);
    grave.map(|d| format!("{} {} {}", d.file.locate(d.span.start), d.code, d.file.slice(d.span))).collect()
}

#[test]
fn the_chapter_has_its_printed_defects_and_no_others() {
    assert_eq!(
        told(fixture!("chapter.md")),
        [
            "chapter.md:44:23 T001 vec3",
            "chapter.md:64:13 H029 attribute",
            "chapter.md:78:60 H004 \"p1\"",
            "chapter.md:115:15 H001 glGetUniformLocation",
        ]
    );
}

#[test]
fn a_tutorial_is_read_whatever_marks_its_blocks() {
    for (wrong, right, expected) in [
        (
            fixture!("tutorial.md"),
            fixture!("tutorial_right.md"),
            &[
                "tutorial.md:27:30 T004 *",
                "tutorial.md:41:32 E020 colours",
                "tutorial.md:50:21 H001 glGetUniformLocation",
            ][..],
        ),
        (
            fixture!("lesson.html"),
            fixture!("lesson_right.html"),
            &["lesson.html:19:18 T003 vec3(fog * depth)", "lesson.html:33:72 E020 depths"],
        ),
        (
            fixture!("note.adoc"),
            fixture!("note_right.adoc"),
            &["note.adoc:17:32 T001 vec3", "note.adoc:26:17 H002 glGetAttribLocation"],
        ),
        (fixture!("paper.tex"), fixture!("paper_right.tex"), &["paper.tex:16:25 E020 lits", "paper.tex:25:40 T004 *"]),
    ] {
        assert_eq!(told(wrong), expected);
        assert_eq!(told(right), [""; 0]);
    }
}

/// Without a language behind the fences, and in a file that is no Markdown by its name.
#[test]
fn code_is_known_without_a_word_for_it() {
    let (_, text) = fixture!("chapter.md");
    let bare = text.replace("```glsl", "```").replace("```cpp", "```");
    let codes = |name: &str, text: &str| -> Vec<String> {
        told((name, text)).iter().map(|t| t.split(' ').nth(1).unwrap_or("").to_owned()).collect()
    };
    for name in ["chapter.md", "chapter.txt", "chapter"] {
        assert_eq!(codes(name, &bare), ["T001", "H029", "H004", "H001"], "{name}");
    }
    let tildes = bare.replace("```", "~~~~").replace('\n', "\r\n");
    assert_eq!(codes("chapter.markdown", &tildes), ["T001", "H029", "H004", "H001"]);
}

#[test]
fn repairs_are_written_into_the_document() {
    let fixed = |(name, text): (&str, &str), safety| {
        let outcome = crate::fix::fix(&[Input::new(SourceFile::new(name, text))], &Settings::default(), safety);
        outcome.files.first().map(|f| f.after.text().to_owned())
    };
    let (name, text) = fixture!("chapter.md");
    let after = fixed((name, text), Safety::Safe).unwrap();
    assert_eq!(
        after,
        text.replace("p1Loc = glGetUniformLocation", "p1Loc = glGetAttribLocation").replace("vec3(cos", "vec4(cos")
    );
    let (name, text) = fixture!("tutorial.md");
    let after = fixed((name, text), Safety::Safe).unwrap();
    assert_eq!(after, text.replace("normalLoc = glGetUniformLocation", "normalLoc = glGetAttribLocation"));
    let page = (
        "a.html",
        "<pre class=\"glsl\">\n#version 330 core\nout vec4 c;\nin vec2 a;\nvoid main() { bvec2 b = a &lt; vec2(0.5); c = vec4(b, b); }\n</pre>\n",
    );
    if let Some(after) = fixed(page, Safety::Unsafe) {
        assert!(!after.contains("< vec2") && after.contains("</pre>"), "{after}");
    }
}

#[test]
fn shaders_of_a_document_can_be_taken_out() {
    let (name, text) = fixture!("tutorial.md");
    let file = SourceFile::new(name, text);
    let found = printed_shaders(&file);
    let stages: Vec<Stage> = found.iter().map(|s| s.stage).collect();
    assert_eq!(stages, [Stage::Vertex, Stage::Fragment]);
    let vertex = &found[0];
    assert_eq!(vertex.file.name(), "tutorial.md:14");
    let at = vertex.file.text().find("projection * position").unwrap();
    assert_eq!(vertex.file.locate(at), "tutorial.md:27:19");
    assert!(vertex.lines.contains(&13) && vertex.lines.contains(&28), "{:?}", vertex.lines);
    let page = SourceFile::new(
        "a.html",
        "<pre>\n#version 330 core\nout vec4 c;\nvoid main() { c = vec4(float(1 &lt; 2)); }\n</pre>",
    );
    let found = printed_shaders(&page);
    assert!(found[0].file.text().contains("1 < 2"));
}

#[test]
fn other_blocks_are_left_alone() {
    for text in [
        "```js\nvoid main() { vec3 a = vec4(1.0); gl_Position = a; }\n```\n",
        "```\n$ glslangValidator shader.vert\n```\n",
        "```python\nglGetUniformLocation(program, \"a\")\n```\n",
        "```wgsl\nfn main() {} // shader\n```\n",
        "Inline `void main() { gl_Position = vec3(1.0); }` is prose.\n\n```\nshader\n```\n",
        "```glsl\nvec3 a = ${colour}; void main() { gl_FragColor = vec3(1.0); }\n```\n",
    ] {
        assert_eq!(told(("a.md", text)), [""; 0], "{text}");
    }
}

#[test]
fn a_part_is_not_blamed_for_what_it_lacks() {
    for text in [
        "```glsl\ngl_Position = mvp * vec4(position, 1.0);\n```\n",
        "```glsl\nvoid main() {\n  colour = shade(n) * tint;\n}\n```\n",
        "```glsl\n#version 330 core\nuniform mat4 m;\n```\n",
        "```glsl\n#version 330 core\n...\nvoid main() {\n    ...\n    gl_Position = m * p;\n}\n```\n",
        "```glsl\n#version 330 core\n// inputs as before ...\nvoid main() { gl_Position = m * p; }\n```\n",
        "```glsl\n#version 330 core\nout vec4 c;\n-uniform vec3 k;\n+uniform vec4 k;\nvoid main() { c = k; }\n```\n",
        "```glsl\nvec3 c = vec2(1.0).xyz; // invalid: there is no z\n```\n",
        "```glsl\nfor each light { add(light) }\n```\n",
        "```cpp\nglUseProgram(program);\n...\nglUniform1f(glGetUniformLocation(program, \"time\"), t);\n```\n",
    ] {
        assert_eq!(told(("a.md", text)), [""; 0], "{text}");
    }
    // What is wrong in any context is told.
    assert_eq!(told(("a.md", "```glsl\nvec4 p = vec3(0.5, 0.5, 0.5, 1.0);\n```\n")).len(), 1);
}
