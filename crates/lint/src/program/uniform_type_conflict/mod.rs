//! I006: a uniform with two types, or one that is also a member of a block.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::{Project, ShaderFile};
use syntax::interface::{Block, Storage, Variable};

use reading::program::Program;
use reading::program::link::agree;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I006"),
    name: "uniform-type-conflict",
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
        for uniform in &shader.shader.interface().uniforms {
            let earlier = shaders[..i].iter().find_map(|s| s.shader.interface().uniform(&uniform.name).map(|u| (s, u)));
            let Some((other, first)) = earlier.filter(|(_, u)| !agree(&u.ty, &uniform.ty)) else { continue };
            let (name, here, there) = (&uniform.name, uniform.ty.to_string(), first.ty.to_string());
            let place = other.file.name();
            findings.push(
                findings
                    .at(
                        &shader.file,
                        uniform.name_span,
                        message!(
                            "the uniform `{name}` is `{here}` here, and `{there}` in {place}",
                            "uniform `{name}` はここでは `{here}`、{place} では `{there}` です"
                        ),
                    )
                    .with_label(message!("`{here}` here", "ここでは `{here}`"))
                    .with_related(&other.file, first.name_span, message!("`{there}` here", "ここでは `{there}`"))
                    .with_why(message!(
                        "stages share their uniforms; two types for one name do not link",
                        "uniform はステージの間で共有されるので、型が違うとリンクできません"
                    ))
                    .with_help(message!(
                        "declare `{name}` with one type, or give one of them another name",
                        "`{name}` を同じ型で宣言するか、一方の名前を変えてください"
                    )),
            );
        }
        for other in shaders.iter().filter(|other| other.file.name() != shader.file.name()) {
            in_a_block(shader, other, findings);
        }
    }
}

/// Uniforms of one stage that are members of a block without an instance name in another: both are names of the one space of
/// uniforms.
fn in_a_block(shader: &ShaderFile, other: &ShaderFile, findings: &mut Findings<'_>) {
    let unnamed =
        |block: &&Block| block.instance.is_none() && matches!(block.storage, Storage::Uniform | Storage::Buffer);
    let used = |uniform: &&Variable| shader.shader.uses_of(uniform.symbol).next().is_some();
    for uniform in shader.shader.interface().uniforms.iter().filter(used) {
        let blocks = other.shader.interface().blocks.iter().filter(unnamed);
        let member = |block: &'_ Block| {
            let member = block.members.iter().find(|member| member.name.name == uniform.name)?;
            Some((block.name.name.clone(), member.name.span))
        };
        let Some((block, place)) = blocks.into_iter().find_map(member) else { continue };
        let (name, there) = (&uniform.name, other.file.name());
        findings.push(
            findings
                .at(
                    &shader.file,
                    uniform.name_span,
                    message!(
                        "`{name}` is a uniform of its own here, and a member of the block `{block}` in {there}",
                        "`{name}` はここでは単独の uniform、{there} ではブロック `{block}` のメンバです"
                    ),
                )
                .with_label(message!("outside of a block", "ブロックの外"))
                .with_related(&other.file, place, message!("inside of one", "ブロックの中"))
                .with_why(message!(
                    "a block without an instance name has its members in the name space that all uniforms share; \
                     the program does not link",
                    "インスタンス名のないブロックのメンバは、uniform 全体と同じ名前空間にあり、プログラムはリンクできません"
                ))
                .with_help(message!(
                    "declare the block in both stages, or give one of the two another name",
                    "両方のステージでブロックを宣言するか、一方の名前を変えてください"
                )),
        );
    }
}
