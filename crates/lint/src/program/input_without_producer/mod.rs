//! I001: an input that the stage before does not write.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use hosts::paths::folder;
use hosts::suggest::{list, list_in_japanese, nearest};
use reading::{Project, ShaderFile};
use syntax::Stage;
use syntax::interface::{Storage, Variable};

use super::stage_in_japanese;
use reading::program::link::{
    block as block_of, consumer, in_block, input_type, is_built_in, is_read, is_used, output_type, producer,
};
use reading::program::{Known, Program};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I001"),
    name: "input-without-producer",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Program(check),
};

fn check(program: &Program<'_>, project: &Project, findings: &mut Findings<'_>) {
    for (from, to) in program.links() {
        let interface = to.shader.interface();
        for input in &interface.inputs {
            let known = is_built_in(&input.name)
                || producer(from, to, input).is_some()
                || in_block(from, Storage::Out, &input.name)
                || bypasses(program, input);
            if known
                || !is_used(to, input)
                || between(program, project, to, &|other| producer(other, to, input).is_some())
            {
                continue;
            }
            let (name, stage, place) = (&input.name, from.shader.stage().name(), from.file.name());
            let ja_stage = stage_in_japanese(from.shader.stage());
            let outputs: Vec<&str> = from.shader.interface().outputs.iter().map(|v| v.name.as_str()).collect();
            let (all, ja_all) = (list(&outputs), list_in_japanese(&outputs));
            // It is written at another location.
            let elsewhere = outputs.contains(&name.as_str());
            let mut found = findings
                .at(
                    &to.file,
                    input.name_span,
                    message!(
                        "`{name}` is read here, but the {stage} stage has no such output",
                        "`{name}` を読んでいますが、{ja_stage}にその出力がありません"
                    ),
                )
                .with_label(message!("no output of {place} goes here", "{place} の出力がつながりません"))
                .with_why(message!(
                    "the program does not link, or the value is undefined",
                    "プログラムがリンクできないか、値が不定になります"
                ))
                .with_help(if elsewhere {
                    message!(
                        "{place} writes `{name}` at another location: give both the same `layout(location = …)`",
                        "{place} は `{name}` を別のロケーションに書いています。同じ `layout(location = …)` にしてください"
                    )
                } else if outputs.is_empty() {
                    message!("{place} has no output", "{place} には出力がありません")
                } else {
                    message!("the outputs of {place} are {all}", "{place} の出力は {ja_all} です")
                });
            if let Some(meant) = meant(from, to, input) {
                let title = &meant.name;
                found = found.with_related(
                    &from.file,
                    meant.name_span,
                    message!("`{title}` is written, and nobody reads it", "`{title}` は書かれますが、読まれません"),
                );
                if let Some(edits) = rename(to, input, title) {
                    found = found.with_fix(message!("write `{title}`", "`{title}` と書く"), Safety::Unsafe, edits);
                }
            }
            findings.push(found);
        }
        for block in interface.blocks.iter().filter(|b| b.storage == Storage::In && !is_built_in(&b.name.name)) {
            let loose = |name: &str| from.shader.interface().output(name).is_some();
            let known = block_of(from, Storage::Out, &block.name.name).is_some()
                || block.qualifiers.layout_entry("location").is_some()
                || block.members.iter().any(|m| loose(&m.name.name));
            let used = block.symbol.is_some_and(|s| is_read(to, s))
                || block.members.iter().any(|m| m.symbol.is_some_and(|s| is_read(to, s)));
            let guessed = program.shaders().len() > 2 && program.how_known() == Known::Name;
            if known
                || !used
                || guessed
                || between(program, project, to, &|other| block_of(other, Storage::Out, &block.name.name).is_some())
            {
                continue;
            }
            let (name, stage, place) = (&block.name.name, from.shader.stage().name(), from.file.name());
            let ja_stage = stage_in_japanese(from.shader.stage());
            findings.push(
                findings
                    .at(
                        &to.file,
                        block.name.span,
                        message!(
                            "the block `{name}` is read here, but the {stage} stage has no such output block",
                            "ブロック `{name}` を読んでいますが、{ja_stage}にその出力ブロックがありません"
                        ),
                    )
                    .with_label(message!("no block of {place} goes here", "{place} のブロックがつながりません"))
                    .with_why(message!(
                        "blocks of two stages meet by the name of the block, not by that of the instance",
                        "ステージ間のブロックは、インスタンス名ではなくブロック名で対応します"
                    ))
                    .with_help(message!(
                        "give the output block of {place} the name `{name}`",
                        "{place} の出力ブロックの名前を `{name}` にしてください"
                    )),
            );
        }
    }
}

/// True when a stage that lies between these two may be in another file, with another name: shaders that belong together
/// by their names alone may have one, and there is one in the folder that writes what is read.
fn between(program: &Program<'_>, project: &Project, to: &ShaderFile, writes: &dyn Fn(&ShaderFile) -> bool) -> bool {
    let here = folder(to.file.name());
    let may = |other: &ShaderFile| {
        matches!(other.shader.stage(), Stage::Geometry | Stage::TessEvaluation) && folder(other.file.name()) == here
    };
    let last = to.shader.stage() == Stage::Fragment;
    last && program.how_known() == Known::Name && project.shader_files().any(|(_, other)| may(other) && writes(other))
}

/// True for a fragment input that a stage before the last one writes: another rule tells it, and where
/// the program is known by names alone, the stage between may be left out.
fn bypasses(program: &Program<'_>, input: &Variable) -> bool {
    let shaders = program.shaders();
    let earlier = shaders.len().saturating_sub(2);
    shaders[..earlier]
        .iter()
        .any(|s| s.shader.interface().output(&input.name).is_some() || in_block(s, Storage::Out, &input.name))
}

/// The one output of the same type that resembles an input and that nobody reads.
fn meant<'p>(from: &'p ShaderFile, to: &ShaderFile, input: &Variable) -> Option<&'p Variable> {
    let wanted = input_type(to, &input.ty, &input.qualifiers)?;
    let free = from.shader.interface().outputs.iter().filter(|o| {
        let same = output_type(from, &o.ty, &o.qualifiers).is_some_and(|t| t == wanted);
        same && !is_built_in(&o.name) && consumer(from, to, o).is_none()
    });
    let name = nearest(&input.name, free.map(|o| o.name.as_str()))?;
    from.shader.interface().output(name)
}

/// The edits that give an input another name; none when a macro uses it or the name is taken.
fn rename(shader: &ShaderFile, input: &Variable, name: &str) -> Option<Vec<Edit>> {
    let taken = shader.shader.symbols().any(|(_, s)| s.name == name) || shader.shader.function(name).is_some();
    let uses: Vec<_> = shader.shader.uses_of(input.symbol).collect();
    if taken || uses.iter().any(|u| u.from_macro) {
        return None;
    }
    let places = uses.iter().map(|u| u.span).chain([input.name_span]);
    Some(places.map(|span| Edit::replace(span, name)).collect())
}
