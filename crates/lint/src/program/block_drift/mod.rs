//! I009: blocks of one name that differ.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Severity, message};
use reading::{Project, ShaderFile};
use syntax::interface::{Block, Storage};

use reading::program::Program;
use reading::program::link::{agree, block as block_of, is_built_in};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I009"),
    name: "block-drift",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
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
            let Some(drift) = drift(block, first, only_of_vulkan(block) && only_of_vulkan(first)) else { continue };
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

/// True for a block of a text that OpenGL does not take.
fn only_of_vulkan(block: &Block) -> bool {
    block.qualifiers.layout_entry("set").is_some()
}

/// The first difference between two blocks, as seen from `block`. Vulkan does not link them: with `ends_early`, one may stop
/// before the other.
fn drift(block: &Block, other: &Block, ends_early: bool) -> Option<Message> {
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
    (a != b && !ends_early)
        .then(|| message!("{a} members here and {b} there", "メンバの数がここでは {a}、向こうでは {b} です"))
}
