//! I013: a position that two programs compute alike, for a test that wants the same bits, without the promise of them.

mod position;

use std::collections::BTreeMap;

use base::diagnostic::{Code, Diagnostic, Message, Safety, Severity, message};
use base::text::Span;
use hosts::HostFile;
use hosts::depth::{equal_depth, keeps_depth};
use hosts::paths::folder;
use rayon::prelude::*;
use reading::{Project, ShaderFile};

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::spelled::Spelled;
use position::{Position, has_prepass};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I013"),
    name: "position-not-invariant",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Project(check),
};

fn check(project: &Project, findings: &mut Findings<'_>) {
    let equal: Vec<(&HostFile, Span)> =
        project.hosts().filter_map(|host| Some((host, equal_depth(host.file.text())?))).collect();
    let shaders: Vec<&ShaderFile> = project.shaders().collect();
    // Most projects ask for nothing of the kind.
    let asks = |shader: &&ShaderFile| has_prepass(shader) || shader.file.text().contains("invariant");
    if equal.is_empty() && !shaders.iter().any(asks) {
        return;
    }
    let all: Vec<Position<'_>> = shaders.into_par_iter().flat_map_iter(Position::all_of).collect();
    let computed = all.iter().filter(|position| position.spelled.as_ref().is_none_or(|spelled| spelled.rounds));
    let all: Vec<&Position<'_>> = computed.collect();
    // Where every pass clears it, none is tested against the depth of another.
    let kept = project.hosts().filter_map(|host| keeps_depth(host.file.text())).reduce(|any, one| any || one);
    if kept != Some(false) {
        of_passes(&all, findings);
    }
    let mut alike: BTreeMap<&str, Vec<&Position<'_>>> = BTreeMap::new();
    for position in &all {
        if let Some(spelled) = position.spelled.as_ref() {
            alike.entry(&spelled.of_any_order).or_default().push(position);
        }
    }
    for group in alike.values() {
        of_promise(group, findings);
        let test = equal.iter().find_map(|(host, place)| Some((*host, *place, drawn(host, group, project)?)));
        if let Some((host, place, pair)) = test {
            of_test(pair, (host, place), findings);
        }
    }
}

/// Passes whose depth others are tested against, by their names.
fn of_passes(all: &[&Position<'_>], findings: &mut Findings<'_>) {
    for pass in all.iter().filter(|pass| pass.is_of_prepass) {
        let others = || all.iter().filter(|other| !other.is_of_prepass && near(pass, other));
        let same = |of: fn(&Spelled) -> &str| {
            let spelled = pass.spelled.as_ref().map(of);
            others().find(|other| spelled.is_some() && other.spelled.as_ref().map(of) == spelled)
        };
        let (exact, any) = (same(|s| &s.text), same(|s| &s.of_any_order));
        match (exact, any) {
            (None, Some(other)) => findings.push(in_another_order(pass, other, findings)),
            _ if pass.is_pinned => {}
            (exact, _) => {
                let Some(other) = exact.or_else(|| others().next()) else { continue };
                let what = message!(
                    "the position of a pass before others is not `invariant`",
                    "先に描くパスの位置が `invariant` ではありません"
                );
                let label = message!("a pass that comes later", "後のパス");
                findings.push(report(pass, what, findings).with_related(other.file(), other.place, label));
            }
        }
    }
}

/// A promise that one of two programs makes: of more than two, nobody knows which one is meant.
fn of_promise(group: &[&Position<'_>], findings: &mut Findings<'_>) {
    let [a, b] = group else { return };
    let (promise, other) = if a.is_pinned { (a, b) } else { (b, a) };
    if !promise.is_pinned || other.is_pinned || !near(promise, other) || other.is_of_prepass {
        return;
    }
    let found = report(other, alike(), findings);
    let label = message!("promised here alone", "`invariant` はここだけです");
    findings.push(found.with_related(promise.file(), promise.place, label).with_why(message!(
        "`invariant` makes the bits of two programs equal if both declare it; in one alone it promises nothing",
        "`invariant` は両方のプログラムで宣言したときだけ同じビットを保証します。片方だけでは何の保証にもなりません"
    )));
}

/// What a test for equal depth needs of the two programs that may be meant.
fn of_test((a, b): (&Position<'_>, &Position<'_>), (host, place): (&HostFile, Span), findings: &mut Findings<'_>) {
    let test = || message!("the test for equal depth", "深度が等しいかどうかの比較");
    if a.is_of_prepass || b.is_of_prepass || a.is_pinned != b.is_pinned {
        return;
    }
    let exact = |position: &Position<'_>| position.spelled.as_ref().map(|spelled| spelled.text.clone());
    if exact(a) != exact(b) {
        findings.push(in_another_order(a, b, findings).with_related(&host.file, place, test()));
        return;
    }
    for (position, other) in [(a, b), (b, a)].into_iter().filter(|(position, _)| !position.is_pinned) {
        let found = report(position, alike(), findings).with_related(&host.file, place, test());
        findings.push(found.with_related(
            other.file(),
            other.place,
            message!("computed alike here", "ここでも同じ計算"),
        ));
    }
}

/// True for shaders of one folder.
fn near(a: &Position<'_>, b: &Position<'_>) -> bool {
    folder(a.file().name()) == folder(b.file().name())
}

/// The two that a host may draw with, if there are no more: those in its folder, or all where the folder has no shader. Of
/// more, nobody knows which are meant. Copies of one text are one.
fn drawn<'a, 'p>(
    host: &HostFile,
    group: &[&'a Position<'p>],
    project: &Project,
) -> Option<(&'a Position<'p>, &'a Position<'p>)> {
    let own = folder(host.file.name());
    let within = |name: &str| name.strip_prefix(own).is_some_and(|rest| own.is_empty() || rest.starts_with('/'));
    let all = !project.shaders().any(|shader| within(shader.file.name()));
    let mut drawn = group.iter().filter(|position| all || within(position.file().name()));
    let (first, second) = (drawn.next()?, drawn.next()?);
    let copied = first.place == second.place && first.file().text() == second.file().text();
    (drawn.next().is_none() && !copied).then_some((first, second))
}

fn alike() -> Message {
    message!(
        "another program computes this position by the same expression, and nothing promises the same bits",
        "別のプログラムも同じ式で位置を計算しますが、同じビットになる保証がありません"
    )
}

fn report(position: &Position<'_>, what: Message, findings: &Findings<'_>) -> Diagnostic {
    let found = findings
        .at(position.file(), position.place, what)
        .with_label(message!("may differ in the last bits", "末尾のビットが違うかもしれません"))
        .with_why(message!(
            "a compiler may fuse or reorder a product and a sum in one program and not in the other; pixels whose depth is \
             not equal to the last bit are left out, and the surface flickers",
            "コンパイラは積と和を一方のプログラムだけで融合したり並べ替えたりできます。深度が最後のビットまで等しくない画素は描かれず、面がちらつきます"
        ))
        .with_help(message!(
            "declare `invariant gl_Position;` (in WGSL `@invariant @builtin(position)`) in both, and compute it alike",
            "両方で `invariant gl_Position;`（WGSL では `@invariant @builtin(position)`）を宣言し、同じ計算にしてください"
        ));
    match &position.pin {
        Some(edit) => {
            found.with_fix(message!("declare it invariant", "invariant を宣言する"), Safety::Safe, vec![edit.clone()])
        }
        None => found,
    }
}

/// The same product, by other operations: no promise makes its bits equal.
fn in_another_order(position: &Position<'_>, other: &Position<'_>, findings: &Findings<'_>) -> Diagnostic {
    findings
        .at(
            position.file(),
            position.place,
            message!(
                "another program computes this position as the same product in another order",
                "別のプログラムは同じ積を別の順序で計算しています"
            ),
        )
        .with_label(message!("other roundings", "丸めが違います"))
        .with_related(other.file(), other.place, message!("the other order", "別の順序"))
        .with_why(message!(
            "a product of matrices and a product of a matrix and a vector are rounded differently: their depths are not equal, \
             whatever is declared `invariant`",
            "行列どうしの積と、行列とベクトルの積では丸めが違うので、`invariant` と宣言しても深度は等しくなりません"
        ))
        .with_help(message!("write both with the same parentheses", "両方の括弧をそろえてください"))
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::{EditList, SourceFile};

    const DEPTH: &str = "#version 330 core\nin vec3 place;\nuniform mat4 camera;\nuniform mat4 model;\n\
        void main()\n{\n  gl_Position = camera * model * vec4(place, 1.0);\n}\n";
    const COLOUR: &str = "#version 330 core\nin vec3 place;\nin vec3 colour;\nuniform mat4 camera;\nuniform mat4 model;\n\
        out vec3 shade;\nvoid main()\n{\n  shade = colour;\n  vec4 point = vec4(place, 1.0);\n  \
        gl_Position = camera * model * point;\n}\n";
    const HOST: &str = "void draw() { glUseProgram(program); glDepthFunc(GL_EQUAL); }";

    /// The files that I013 speaks of, and their texts with its fix.
    fn found(files: &[(&str, &str)]) -> Vec<(String, String)> {
        let inputs: Vec<Input> = files.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))).collect();
        let found = run(&inputs);
        let own = found.iter().filter(|d| d.code == super::RULE.code);
        let fixed = own.map(|d| {
            let edits = d.fix.clone().map_or_else(EditList::default, |fix| fix.edits.into_iter().collect());
            (d.file.name().to_owned(), edits.apply(d.file.text()).unwrap().text)
        });
        fixed.collect()
    }

    #[test]
    fn a_test_for_equal_depth_wants_the_promise_in_both() {
        let all = found(&[("a/depth.vert", DEPTH), ("a/colour.vert", COLOUR), ("a/draw.cpp", HOST)]);
        let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["a/colour.vert", "a/depth.vert"]);
        assert!(all[1].1.starts_with("#version 330 core\ninvariant gl_Position;\nin vec3 place;"), "{}", all[1].1);
        let fixed: Vec<(&str, &str)> = all.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
        assert_eq!(found(&[fixed[0], fixed[1], ("a/draw.cpp", HOST)]), []);
    }

    #[test]
    fn more_than_two_are_not_told_apart() {
        let third = COLOUR.replace("shade = colour;", "shade = colour.zyx;");
        let files = [("depth.vert", DEPTH), ("colour.vert", COLOUR), ("third.vert", &third), ("draw.cpp", HOST)];
        assert_eq!(found(&files), []);
    }

    #[test]
    fn a_pass_before_others_promises_its_position() {
        let several = DEPTH.replace(";\n}", ";\n  gl_Position.xy += gl_Position.ww * 0.1;\n}");
        for (name, text) in [("depth_prepass.vert", DEPTH), ("zPrePass.vert", DEPTH), ("prepass.vert", &several)] {
            let all = found(&[(name, text), ("colour.vert", COLOUR)]);
            assert_eq!(all.len(), 1, "{name}: {all:?}");
            assert!(all[0].0 == name && all[0].1.contains("invariant gl_Position;"), "{name}");
            // Drawn alone, it is that of both passes.
            assert_eq!(found(&[(name, text), ("other/colour.vert", COLOUR)]), [], "{name}");
        }
    }

    #[test]
    fn a_pass_whose_depth_every_other_one_clears_promises_nothing() {
        let host =
            |then: &str| format!("const a = {{ depthLoadOp: 'clear' }};\nconst b = {{ depthLoadOp: '{then}' }};\n");
        let files = |host: &str| found(&[("prepass.vert", DEPTH), ("colour.vert", COLOUR), ("draw.js", host)]).len();
        assert_eq!((files(&host("load")), files(&host("clear"))), (1, 0));
    }

    #[test]
    fn a_product_in_another_order_has_other_bits_whatever_is_promised() {
        let pinned = |text: &str| text.replace("in vec3 place", "invariant gl_Position;\nin vec3 place");
        let other = pinned(&COLOUR.replace("camera * model * point", "camera * (model * point)"));
        let files = [pinned(DEPTH), other];
        assert_eq!(found(&[("prepass.vert", &files[0]), ("colour.vert", &files[1])]).len(), 1);
        assert_eq!(found(&[("depth.vert", &files[0]), ("colour.vert", &files[1]), ("draw.cpp", HOST)]).len(), 1);
        assert_eq!(found(&[("depth.vert", &files[0]), ("colour.vert", &files[1])]), []);
    }

    #[test]
    fn a_promise_of_one_of_two_is_none() {
        let promised = DEPTH.replace("in vec3", "invariant gl_Position;\nin vec3");
        let all = found(&[("depth.vert", &promised), ("colour.vert", COLOUR)]);
        assert_eq!(all.len(), 1);
        assert_eq!(all[0].0, "colour.vert");
    }

    #[test]
    fn other_tests_other_expressions_and_other_folders_are_silent() {
        let host = HOST.replace("GL_EQUAL", "GL_LEQUAL");
        assert_eq!(found(&[("a/depth.vert", DEPTH), ("a/colour.vert", COLOUR), ("a/draw.cpp", &host)]), []);
        let other = COLOUR.replace("camera * model * point", "camera * point");
        assert_eq!(found(&[("a/depth.vert", DEPTH), ("a/colour.vert", &other), ("a/draw.cpp", HOST)]), []);
        let files = [("b/depth.vert", DEPTH), ("b/colour.vert", COLOUR), ("a/draw.cpp", HOST), ("a/depth.vert", DEPTH)];
        assert_eq!(found(&files), []);
        // A copy of one text is one program.
        assert_eq!(found(&[("a/depth.vert", DEPTH), ("a/copy.vert", DEPTH), ("a/draw.cpp", HOST)]), []);
    }

    #[test]
    fn what_is_only_copied_is_silent() {
        let copied = |text: &str| text.replace("camera * model * ", "");
        let files = [copied(DEPTH), copied(COLOUR)];
        assert_eq!(found(&[("depth.vert", &files[0]), ("colour.vert", &files[1]), ("draw.cpp", HOST)]), []);
    }

    #[test]
    fn entry_points_of_wgsl_have_the_attribute() {
        let module = |position: &str| {
            format!(
                "struct Out {{ @location(0) shade: vec3f, {position} place: vec4f }}\n\
                 @group(0) @binding(0) var<uniform> camera: mat4x4f;\n\
                 @vertex fn depth(@location(0) p: vec3f) -> {position} vec4f {{ return camera * vec4f(p, 1.0); }}\n\
                 @vertex fn colour(@location(0) p: vec3f) -> Out {{\n  var out: Out;\n  \
                 out.place = camera * vec4f(p, 1.0);\n  out.shade = p;\n  return out;\n}}\n"
            )
        };
        let host = "const p = device.createRenderPipeline({ depthStencil: { format, depthCompare: 'equal' } });";
        let all = found(&[("m.wgsl", &module("@builtin(position)")), ("draw.ts", host)]);
        assert_eq!(all.len(), 2, "{all:#?}");
        assert!(all.iter().all(|(_, text)| text.matches("@invariant @builtin(position)").count() == 1), "{all:#?}");
        assert_eq!(found(&[("m.wgsl", &module("@invariant @builtin(position)")), ("draw.ts", host)]), []);
        let made = module("@builtin(position)").replace("var out: Out;", "return Out(p, camera * vec4f(p, 1.0));");
        let made = made.replace("\n  out.place = camera * vec4f(p, 1.0);\n  out.shade = p;\n  return out;", "");
        assert_eq!(found(&[("m.wgsl", &made), ("draw.ts", host)]).len(), 2, "{made}");
    }
}
