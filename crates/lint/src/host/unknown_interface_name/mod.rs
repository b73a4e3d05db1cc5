//! H031: a block, an output, a varying or a subroutine is named that no stage has.

use tree_sitter::Node;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Safety, Severity, message};
use base::text::{Edit, Span};
use hosts::HostFile;
use hosts::cpp::index::Index;
use hosts::cpp::program::source;
use hosts::cpp::tree::{arguments, bare, callee, elements, plain_string};
use hosts::suggest::{list, list_in_japanese, nearest};
use reading::Project;
use reading::program::Program;
use reading::program::resolve;
use syntax::Stage;
use syntax::interface::Storage;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H031"),
    name: "unknown-interface-name",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

/// What a function asks a program for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Asked {
    UniformBlock,
    Buffer,
    Output,
    Varying,
    Subroutine,
}

impl Asked {
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::UniformBlock => ("uniform block", "uniform ブロック"),
            Self::Buffer => ("buffer block", "バッファブロック"),
            Self::Output => ("fragment output", "フラグメントシェーダの出力"),
            Self::Varying => ("output to capture", "取り出せる出力"),
            Self::Subroutine => ("subroutine", "サブルーチン"),
        }
    }

    /// What follows from a name that is none.
    fn effect(self) -> Message {
        match self {
            Self::UniformBlock | Self::Buffer | Self::Subroutine => {
                message!("gives GL_INVALID_INDEX", "GL_INVALID_INDEX になります")
            }
            Self::Output => message!("binds nothing", "何にも結び付きません"),
            Self::Varying => message!("the program does not link", "プログラムがリンクできません"),
        }
    }

    /// The names of this kind in a program.
    fn names<'p>(self, program: &Program<'p>) -> Vec<&'p str> {
        let blocks = |storage: Storage| {
            let all = program.shaders().iter().flat_map(|s| s.shader.interface().blocks.iter());
            all.filter(move |b| b.storage == storage).map(|b| b.name.name.as_str()).collect::<Vec<_>>()
        };
        match self {
            Self::UniformBlock => blocks(Storage::Uniform),
            Self::Buffer => blocks(Storage::Buffer),
            Self::Output => outputs(program, Stage::Fragment),
            Self::Varying => {
                let before = [Stage::Geometry, Stage::TessEvaluation, Stage::Vertex];
                let last = before.into_iter().find(|s| program.shaders().iter().any(|f| f.shader.stage() == *s));
                last.map_or_else(Vec::new, |stage| outputs(program, stage))
            }
            Self::Subroutine => {
                let functions = program.shaders().iter().flat_map(|s| s.shader.functions());
                functions.map(|(_, f)| f.name.name.as_str()).collect()
            }
        }
    }
}

/// The outputs of a stage, and its blocks with their members.
fn outputs<'p>(program: &Program<'p>, stage: Stage) -> Vec<&'p str> {
    let Some(shader) = program.stage(stage) else { return Vec::new() };
    let interface = shader.shader.interface();
    let blocks = interface.blocks.iter().filter(|b| b.storage == Storage::Out);
    let of_blocks = blocks.flat_map(|b| std::iter::once(&b.name.name).chain(b.members.iter().map(|m| &m.name.name)));
    interface.outputs.iter().map(|v| &v.name).chain(of_blocks).map(String::as_str).collect()
}

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    const ASKING: [&str; 4] = ["glBindFragData", "glGetUniformBlock", "glGetProgramResource", "glTransformFeedbackV"];
    let text = host.file.text();
    if !ASKING.iter().any(|a| text.contains(a)) && !text.contains("glGetSubroutineIndex") {
        return;
    }
    let Some(index) = Index::new(host) else { return };
    for &call in &index.calls {
        let Some((asked, names)) = asked(&index, call) else { continue };
        let Some(program) = arguments(call).first().and_then(|p| resolve(host, project, &source(&index, call, *p)))
        else {
            continue;
        };
        let stages = program.shaders();
        // Without its stage nothing is known; blocks and functions may stand in any.
        let known = match asked {
            Asked::Output => program.stage(Stage::Fragment).is_some(),
            Asked::Varying => program.vertex().is_some() && stages.iter().all(|s| s.is_plain()) && program.is_whole(),
            Asked::UniformBlock | Asked::Buffer | Asked::Subroutine => program.is_complete(),
        };
        let declared = asked.names(&program);
        for (name, place) in names {
            let base = name.split(['.', '[', ':']).next().unwrap_or(&name);
            if known && !base.starts_with("gl_") && !declared.contains(&base) {
                report(host, asked, (&name, place), (&program, &declared), findings);
            }
        }
    }
}

fn report(
    host: &HostFile,
    asked: Asked,
    (name, place): (&str, Span),
    (program, declared): (&Program<'_>, &[&str]),
    findings: &mut Findings<'_>,
) {
    let ((en, ja), files) = (asked.words(), program.names());
    let mut found = findings
        .at(
            &host.file,
            place,
            message!("no {en} of {files} is called `{name}`", "{files} に `{name}` という{ja}はありません"),
        )
        .with_label(asked.effect())
        .with_why(message!(
            "a name that the program does not have gives no GL error here, and what is set with it goes nowhere",
            "プログラムにない名前はここでは GL エラーにならず、設定した内容はどこにも届きません"
        ));
    if let Some(meant) = nearest(name, declared.iter().copied()) {
        let edit = Edit::replace(place, meant);
        found = found.with_fix(message!("write `{meant}`", "`{meant}` と書く"), Safety::Unsafe, vec![edit]);
    }
    let (en, ja) = (list(declared), list_in_japanese(declared));
    findings.push(found.with_help(message!("there are: {en}", "あるのは {ja} です")));
}

/// What a call asks for, and the names.
fn asked(index: &Index<'_>, call: Node<'_>) -> Option<(Asked, Vec<(String, Span)>)> {
    let file = &index.host.file;
    let (function, _) = callee(call, file)?;
    let all = arguments(call);
    let string = |at: usize| plain_string(*all.get(at)?, file).map(|(name, place)| vec![(name.to_owned(), place)]);
    let text = |at: usize| all.get(at).map_or("", |n| index.host.text(bare(*n)));
    Some(match function {
        "glGetUniformBlockIndex" => (Asked::UniformBlock, string(1)?),
        "glBindFragDataLocation" => (Asked::Output, string(2)?),
        "glBindFragDataLocationIndexed" => (Asked::Output, string(3)?),
        "glGetSubroutineIndex" => (Asked::Subroutine, string(2)?),
        "glGetProgramResourceIndex" if text(1) == "GL_UNIFORM_BLOCK" => (Asked::UniformBlock, string(2)?),
        "glGetProgramResourceIndex" if text(1) == "GL_SHADER_STORAGE_BLOCK" => (Asked::Buffer, string(2)?),
        "glTransformFeedbackVaryings" => (Asked::Varying, varyings(index, *all.get(2)?)?),
        _ => return None,
    })
}

/// The names in the array that is passed: a list of literals that is written once.
fn varyings(index: &Index<'_>, array: Node<'_>) -> Option<Vec<(String, Span)>> {
    let mut values = index.values(index.root, index.host.text(bare(array)));
    let list = values.next().filter(|_| values.next().is_none())?.value;
    let given = if list.kind() == "initializer_list" { elements(list) } else { vec![list] };
    given.into_iter().map(|n| plain_string(n, &index.host.file).map(|(s, p)| (s.to_owned(), p))).collect()
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    const VERTEX: &str = "#version 430 core\nin vec4 p;\nuniform Matrices { mat4 mc; };\nout vec3 moved;\n\
                          void main() { moved = p.xyz; gl_Position = mc * p; }\n";
    const FRAGMENT: &str = "#version 430 core\nin vec3 moved;\nout vec4 color;\nbuffer Counts { int n; };\n\
                            void main() { color = vec4(moved, 1.0); n = 1; }\n";

    fn reported(body: &str) -> Vec<String> {
        let host = format!("void f() {{ GLuint p = load(\"a.vert\", \"a.frag\"); {body} }}");
        let files = [("a.vert", VERTEX), ("a.frag", FRAGMENT), ("m.cpp", &host)];
        let found = run(&files.map(|(n, t)| Input::new(SourceFile::new(n, t))));
        found.into_iter().filter(|d| d.code.0 == "H031").map(|d| d.message.to_string()).collect()
    }

    #[test]
    fn names_that_no_stage_has_are_reported() {
        for (body, expected) in [
            ("glGetUniformBlockIndex(p, \"Matrix\");", "no uniform block of a.vert, a.frag is called `Matrix`"),
            ("glBindFragDataLocation(p, 0, \"colour\");", "no fragment output of a.vert, a.frag is called `colour`"),
            (
                "const char* names[] = { \"move\" }; glTransformFeedbackVaryings(p, 1, names, GL_SEPARATE_ATTRIBS);",
                "no output to capture of a.vert, a.frag is called `move`",
            ),
            (
                "glGetProgramResourceIndex(p, GL_SHADER_STORAGE_BLOCK, \"Count\");",
                "no buffer block of a.vert, a.frag is called `Count`",
            ),
            (
                "glGetSubroutineIndex(p, GL_VERTEX_SHADER, \"first\");",
                "no subroutine of a.vert, a.frag is called `first`",
            ),
        ] {
            assert_eq!(reported(body), [expected], "{body}");
        }
    }

    #[test]
    fn names_that_are_there_are_not() {
        for body in [
            "glGetUniformBlockIndex(p, \"Matrices\");",
            "glBindFragDataLocation(p, 0, \"color\");",
            "const char* names[] = { \"moved\", \"gl_Position\" }; glTransformFeedbackVaryings(p, 2, names, m);",
            "glTransformFeedbackVaryings(p, count, names, m);",
            "glGetProgramResourceIndex(p, GL_SHADER_STORAGE_BLOCK, \"Counts\");",
            "glGetProgramResourceIndex(p, GL_UNIFORM, \"anything\");",
        ] {
            assert_eq!(reported(body), [""; 0], "{body}");
        }
    }
}
