//! N016: a normal whose length is not 1 in a formula that asks for a direction.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Severity, message};
use reading::ShaderFile;
use syntax::ast::{ExprId, ExprKind, Interpolation, UnaryOp};
use syntax::interface::Storage;
use syntax::symbols::SymbolKind;
use syntax::types::Type;
use syntax::words::words;
use syntax::{Shader, Stage};

use super::walk::{declarators, expressions};
use analysis::forms::{Forms, builtin};
use analysis::names;
use analysis::numeric::{bare, calls};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N016"),
    name: "normal-not-normalised",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut wrong: Vec<(ExprId, Message)> = Vec::new();
    if shader.stage() == Stage::Fragment || file.is_wgsl() {
        wrong.extend(interpolated(shader));
    }
    wrong.extend(from_derivatives(shader));
    for (id, message) in wrong {
        findings.push(
            findings
                .at(&file.file, shader.expr(id).span, message)
                .with_label(message!("its length is not 1", "長さが 1 ではありません"))
                .with_why(message!(
                    "cosines and reflections are those of the angle only for directions of length 1",
                    "内積が余弦になり、反射が正しくなるのは、長さが 1 の方向だけです"
                ))
                .with_help(message!("use `normalize` first", "先に `normalize` を使ってください")),
        );
    }
}

/// Interpolated normals in products that ask for directions.
fn interpolated(shader: &Shader) -> Vec<(ExprId, Message)> {
    let mut uses = calls(shader, &["dot", "reflect", "refract"]).peekable();
    if uses.peek().is_none() {
        return Vec::new();
    }
    let forms = Forms::new(shader);
    let mut found = Vec::new();
    for call in uses {
        let [a, b, ..] = call.args else { continue };
        if shader.text_of(*a) == shader.text_of(*b) {
            continue;
        }
        for arg in [a, b] {
            let value = unsigned(shader, &forms, *arg);
            let Some(name) = names::of(shader, value).filter(|n| names::is_direction(n)) else { continue };
            if *shader.type_of(value) == Type::VEC3 && is_interpolated(shader, value) {
                let function = call.name;
                found.push((
                    *arg,
                    message!(
                        "`{name}` is interpolated, and `{function}` takes it without `normalize`",
                        "補間された `{name}` が `normalize` されずに `{function}` に渡されています"
                    ),
                ));
                break;
            }
        }
    }
    found
}

/// What an expression stands for, without signs.
fn unsigned(shader: &Shader, forms: &Forms<'_>, id: ExprId) -> ExprId {
    let id = forms.value(id);
    match shader.expr(id).kind {
        ExprKind::Unary { op: UnaryOp::Minus, op_span: _, operand } => unsigned(shader, forms, operand),
        _ => id,
    }
}

/// True for an input of a fragment shader that is not flat, and for a member of such a block.
fn is_interpolated(shader: &Shader, id: ExprId) -> bool {
    if shader.wgsl().is_some() {
        return analysis::entry::is_interpolated(shader, id);
    }
    let interface = shader.interface();
    let flat = |q: &syntax::ast::Qualifiers| q.interpolation().is_some_and(|(i, _)| i == Interpolation::Flat);
    let member = |block: usize, name: &str| {
        let Some(block) = interface.blocks.get(block) else { return false };
        let member = block.members.iter().find(|m| m.name.name == name);
        block.storage == Storage::In && member.is_some_and(|m| !flat(&m.qualifiers))
    };
    match &shader.expr(id).kind {
        ExprKind::Name(name) => match shader.symbol_of(id).map(|s| shader.symbol(s).kind) {
            Some(SymbolKind::Global(Storage::In)) => interface.input(name).is_some_and(|v| !flat(&v.qualifiers)),
            Some(SymbolKind::BlockMember(block)) => member(block, name),
            _ => false,
        },
        ExprKind::Field { base, field } => match shader.symbol_of(bare(shader, *base)).map(|s| shader.symbol(s).kind) {
            Some(SymbolKind::BlockInstance(block)) => member(block, &field.name),
            _ => false,
        },
        _ => false,
    }
}

/// Normals that are products of derivatives, whose length is the area of a pixel.
fn from_derivatives(shader: &Shader) -> Vec<(ExprId, Message)> {
    let mut crosses = calls(shader, &["cross"]).peekable();
    if crosses.peek().is_none() {
        return Vec::new();
    }
    let forms = Forms::new(shader);
    let slopes = ["dFdx", "dFdy", "dFdxFine", "dFdyFine", "dFdxCoarse", "dFdyCoarse"];
    let is_slope = |id: &ExprId| builtin(shader, unsigned(shader, &forms, *id), &slopes).is_some();
    let taken: Vec<ExprId> = calls(shader, &["normalize", "length", "inversesqrt"])
        .flat_map(|c| c.args.iter().flat_map(|a| expressions(shader, *a)))
        .collect();
    let mut found = Vec::new();
    for call in crosses.filter(|c| c.args.len() == 2 && c.args.iter().all(is_slope)) {
        let mut symbol = None;
        declarators(shader, |d| {
            if d.initializer.as_ref().is_some_and(|i| bare(shader, i.value) == call.id) {
                symbol = shader.symbols().find(|(_, s)| s.span == Some(d.name.span)).map(|(id, _)| id);
            }
        });
        if let Some(parent) = forms.parent(call.id)
            && let ExprKind::Assign { op: None, op_span: _, target, value: _ } = shader.expr(parent).kind
        {
            symbol = shader.symbol_of(target);
        }
        let Some(symbol) = symbol else { continue };
        let name = &shader.symbol(symbol).name;
        let is_direction = names::is_normal(name) || words(name).iter().any(|w| w == "ng");
        if !is_direction || taken.iter().any(|id| shader.symbol_of(*id) == Some(symbol)) {
            continue;
        }
        found.push((
            call.id,
            message!(
                "`{name}` is a product of derivatives, and is never normalised",
                "`{name}` は偏微分の外積で、一度も正規化されません"
            ),
        ));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::testing::strict_count;
    use super::*;

    fn count(declared: &str, body: &str) -> usize {
        let text = format!(
            "#version 330 core\n{declared}\nin vec3 place;\nuniform vec3 lamp;\nout vec4 color;\nvoid main()\n{{\n  \
             vec3 l = normalize(lamp - place);\n  {body}\n}}\n"
        );
        strict_count(RULE.code, "a.frag", &text)
    }

    #[test]
    fn interpolated_normals_are_reported_where_a_direction_is_meant() {
        for body in [
            "color = vec4(max(dot(l, normal), 0.0));",
            "vec3 m = normal; color = vec4(max(dot(m, l), 0.0));",
            "color = vec4(reflect(-l, -normal), 1.0);",
        ] {
            assert_eq!(count("in vec3 normal;", body), 1, "{body}");
        }
        assert_eq!(count("in vec3 viewDir;", "color = vec4(dot(l, viewDir));"), 1);
        assert_eq!(count("in Vertex { vec3 normal; } vertex;", "color = vec4(dot(l, vertex.normal));"), 1);
        assert_eq!(count("in Vertex { vec3 normal; };", "color = vec4(dot(l, normal));"), 1);
    }

    #[test]
    fn others_are_not() {
        for body in [
            "vec3 m = normalize(normal); color = vec4(dot(m, l));",
            "vec3 m = normal; m = normalize(m); color = vec4(dot(m, l));",
            "color = vec4(dot(normal, normal));",
            "color = vec4(normal, 1.0);",
        ] {
            assert_eq!(count("in vec3 normal;", body), 0, "{body}");
        }
        assert_eq!(count("flat in vec3 normal;", "color = vec4(dot(l, normal));"), 0);
        assert_eq!(count("uniform vec3 normal;", "color = vec4(dot(l, normal));"), 0);
        assert_eq!(count("in vec3 tint;", "color = vec4(dot(l, tint));"), 0);
    }

    #[test]
    fn products_of_derivatives_are_normals_only_after_normalize() {
        let body = |end: &str| format!("vec3 dx = dFdx(place); vec3 n = cross(dx, dFdy(place)); {end}");
        assert_eq!(count("", &body("color = vec4(n, 1.0);")), 1);
        assert_eq!(count("", &body("n = normalize(n); color = vec4(n, 1.0);")), 0);
        assert_eq!(count("", "vec3 area = cross(dFdx(place), dFdy(place)); color = vec4(area, 1.0);"), 0);
        assert_eq!(count("", "vec3 n = normalize(cross(dFdx(place), dFdy(place))); color = vec4(n, 1.0);"), 0);
    }
}
