//! I009: blocks of one name that differ.

use crate::project::{Project, ShaderFile};
use crate::rule::{Check, Example, Findings, Japanese, Level, Page, Rule};
use base::diagnostic::{Code, Message, Severity, message};
use syntax::interface::{Block, Storage};

use super::Program;
use super::link::{agree, block as block_of, is_built_in};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I009"),
    name: "block-drift",
    severity: Severity::Error,
    level: Level::Default,
    summary: "a block has other members in another stage of the program",
    page: Page {
        what: "Reports blocks of one name whose members differ between two stages in number, name, order or type: uniform and storage blocks, and output blocks with the input block that they go to. Names of instances may differ. Blocks with bindings that differ are two blocks to Vulkan, and push constants may differ.",
        why: "Stages meet by the name of the block, and its members have to be the same; otherwise the program does not link.",
        bad: &[
            Example {
                name: "lamp.vert",
                text: "#version 330 core\nlayout(std140) uniform Light\n{\n  vec4 place;\n  vec4 color;\n};\nin vec4 position;\nout float far;\nvoid main(void)\n{\n  far = length(position - place);\n  gl_Position = position + color;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 330 core\nlayout(std140) uniform Light\n{\n  vec4 place;\n  vec3 color;\n};\nin float far;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(color / far, place.w);\n}\n",
            },
        ],
        good: &[
            Example {
                name: "lamp.vert",
                text: "#version 330 core\nlayout(std140) uniform Light\n{\n  vec4 place;\n  vec4 color;\n};\nin vec4 position;\nout float far;\nvoid main(void)\n{\n  far = length(position - place);\n  gl_Position = position + color;\n}\n",
            },
            Example {
                name: "lamp.frag",
                text: "#version 330 core\nlayout(std140) uniform Light\n{\n  vec4 place;\n  vec4 color;\n};\nin float far;\nout vec4 fc;\nvoid main(void)\n{\n  fc = vec4(color.rgb / far, place.w);\n}\n",
            },
        ],
        fix: "There is no fix: which of the two is meant is not known.",
        references: &[
            "OpenGL Shading Language 3.30, section 4.3.7 (Interface Blocks): blocks of one name have to match",
        ],
        ja: Japanese {
            summary: "ブロックのメンバが、プログラムの別のステージと違います",
            what: "同じ名前のブロックのうち、二つのステージでメンバの数、名前、順序、型のいずれかが違うものを報告します。uniform ブロックとストレージブロック、および出力ブロックとそれを受け取る入力ブロックを調べます。インスタンス名は違ってもかまいません。バインディングが違うブロックは Vulkan では別のブロックなので、報告しません。プッシュ定数も違ってかまいません。",
            why: "ステージ間の対応はブロック名で決まり、メンバは同じでなければなりません。違うとプログラムはリンクできません。",
            fix: "no fix（修正なし）: どちらのつもりか分かりません。",
        },
    },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, _project: &Project, findings: &mut Findings<'_>) {
    let shaders = program.shaders();
    if !shaders.iter().all(|s| s.is_plain()) {
        return;
    }
    for (i, shader) in shaders.iter().enumerate() {
        for block in shader.shader.interface().blocks.iter().filter(|b| !is_built_in(&b.name.name)) {
            let name = &block.name.name;
            let other = match block.storage {
                Storage::Uniform | Storage::Buffer => {
                    shaders[..i].iter().find_map(|s| block_of(s, block.storage, name).map(|b| (s, b)))
                }
                Storage::In => i
                    .checked_sub(1)
                    .and_then(|before| block_of(shaders[before], Storage::Out, name).map(|b| (&shaders[before], b))),
                Storage::Out | Storage::Shared | Storage::Const | Storage::Global => None,
            };
            let Some((there, first)) = other.filter(|(there, first)| !apart((shader, block), (there, first))) else {
                continue;
            };
            let Some(drift) = drift(block, first) else { continue };
            let (en, ja) = (drift.to_string(), drift.in_lang(base::diagnostic::Lang::Ja).to_owned());
            let place = there.file.name();
            findings.push(
                findings
                    .at(
                        &shader.file,
                        block.name.span,
                        message!(
                            "the block `{name}` is not that of {place}: {en}",
                            "ブロック `{name}` が {place} のものと違います: {ja}"
                        ),
                    )
                    .with_label(message!("differs", "違いがあります"))
                    .with_related(&there.file, first.name.span, message!("the other one", "もう一方のブロック"))
                    .with_why(message!(
                        "blocks of one name have to have the same members in all stages; the program does not link",
                        "同じ名前のブロックは全ステージで同じメンバを持たなければならず、プログラムはリンクできません"
                    ))
                    .with_help(message!(
                        "declare the block in the same way in both files",
                        "両方のファイルで同じように宣言してください"
                    )),
            );
        }
    }
}

/// True for blocks that are two in Vulkan, which finds them by their bindings, whatever their names are, and lets each
/// stage see another part of the push constants (GLSL for Vulkan, "Shader Resource Interface"). A text with bindings may
/// be for either API.
fn apart((shader, block): (&ShaderFile, &Block), (there, other): (&ShaderFile, &Block)) -> bool {
    let pushed = |b: &Block| b.qualifiers.layout_entry("push_constant").is_some();
    let place = |s: &ShaderFile, b: &Block| {
        let text = |key| b.qualifiers.layout_entry(key).map(|entry| s.file.slice(entry.span).to_owned());
        text("binding").map(|binding| (text("set"), binding))
    };
    let (here, there) = (place(shader, block), place(there, other));
    pushed(block) || pushed(other) || (here.is_some() && there.is_some() && here != there)
}

/// The first difference between two blocks, as seen from `block`.
fn drift(block: &Block, other: &Block) -> Option<Message> {
    for (member, theirs) in block.members.iter().zip(&other.members) {
        let (a, b) = (&member.name.name, &theirs.name.name);
        if a != b {
            return Some(message!("`{a}` here is `{b}` there", "ここの `{a}` は向こうでは `{b}` です"));
        }
        if !agree(&member.ty, &theirs.ty) {
            let (x, y) = (&member.ty, &theirs.ty);
            return Some(message!(
                "`{a}` is `{x}` here and `{y}` there",
                "`{a}` はここでは `{x}`、向こうでは `{y}` です"
            ));
        }
    }
    let (a, b) = (block.members.len(), other.members.len());
    (a != b).then(|| message!("{a} members here and {b} there", "メンバの数がここでは {a}、向こうでは {b} です"))
}
