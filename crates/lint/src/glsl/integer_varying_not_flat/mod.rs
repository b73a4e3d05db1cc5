//! I005: a fragment input of integers that is not flat.

use std::collections::BTreeSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::entry::{inputs, is_flat};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::Stage;
use syntax::ast::{Interpolation, Qualifiers};
use syntax::interface::Storage;
use syntax::types::{ScalarType, Type};
use syntax::wgsl::Module;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("I005"),
    name: "integer-varying-not-flat",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if let Some(module) = shader.wgsl() {
        return in_wgsl(file, module, findings);
    }
    if shader.stage() != Stage::Fragment || shader.version().number < 130 {
        return;
    }
    for input in shader.interface().inputs.iter().filter(|v| !v.name.starts_with("gl_") && is_whole(&v.ty)) {
        if interpolation(&input.qualifiers) != Some(Interpolation::Flat) {
            report(file, &input.name, input.name_span, &input.ty, &input.qualifiers, input.type_span.start, findings);
        }
    }
    for block in shader.interface().blocks.iter().filter(|b| b.storage == Storage::In) {
        for member in block.members.iter().filter(|m| is_whole(&m.ty)) {
            let of_block = interpolation(&block.qualifiers);
            if interpolation(&member.qualifiers).or(of_block) != Some(Interpolation::Flat) {
                let (name, start) = (&member.name, member.type_span.start);
                report(file, &name.name, name.span, &member.ty, &member.qualifiers, start, findings);
            }
        }
    }
}

/// Inputs of the fragment stages of a module, as parameters or as members of their structures.
fn in_wgsl(file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let mut told = BTreeSet::new();
    for entry in module.entry_points.iter().filter(|e| e.stage == Stage::Fragment && !module.varies) {
        for input in inputs(shader, module, entry.item) {
            let ty = match (input.member, &shader.symbol(input.param).ty) {
                (None, ty) => Some(ty),
                (Some(name), Type::Struct(s)) => s.fields.iter().find(|f| f.name == name).map(|f| &f.ty),
                (Some(_), _) => None,
            };
            let Some(ty) = ty.filter(|ty| is_whole(ty)) else { continue };
            let Some(location) = Module::attribute(input.attributes, "location") else { continue };
            if is_flat(shader, input.attributes) || !told.insert(input.name.span) {
                continue;
            }
            let stated = Module::attribute(input.attributes, "interpolate");
            let edit = match stated {
                Some(interpolate) => Edit::replace(interpolate.span, "@interpolate(flat)"),
                None => Edit::insert(location.span.end, " @interpolate(flat)"),
            };
            let (name, ty) = (&input.name.name, syntax::wgsl::spelling(ty));
            findings.push(
                findings
                    .at(
                        &file.file,
                        input.name.span,
                        message!("`{name}` is `{ty}` and not flat", "`{name}` は `{ty}` ですが flat ではありません"),
                    )
                    .with_label(message!("cannot be interpolated", "補間できません"))
                    .with_why(message!(
                        "integers are not interpolated: browsers refuse a module that does not say so, though naga takes it",
                        "整数は補間されません。flat の指定がないモジュールは、naga は受け取りますが、ブラウザは拒否します"
                    ))
                    .with_fix(
                        message!("write `@interpolate(flat)`", "`@interpolate(flat)` を付ける"),
                        Safety::Safe,
                        vec![edit],
                    ),
            );
        }
    }
}

fn report(
    file: &ShaderFile,
    name: &str,
    place: Span,
    ty: &Type,
    qualifiers: &Qualifiers,
    type_start: usize,
    findings: &mut Findings<'_>,
) {
    let edit = match qualifiers.interpolation() {
        Some((_, span)) => Edit::replace(span, "flat"),
        None => Edit::insert(qualifiers.storage().map_or(type_start, |(_, span)| span.start), "flat "),
    };
    findings.push(
        findings
            .at(
                &file.file,
                place,
                message!("`{name}` is `{ty}`, but not `flat`", "`{name}` は `{ty}` ですが、`flat` ではありません"),
            )
            .with_label(message!("cannot be interpolated", "補間できません"))
            .with_why(message!(
                "integer and double inputs of a fragment shader have to be `flat`; the shader does not compile",
                "フラグメントシェーダの整数と double の入力は `flat` でなければならず、シェーダはコンパイルできません"
            ))
            .with_fix(message!("write `flat`", "`flat` と書く"), Safety::Safe, vec![edit]),
    );
}

fn interpolation(qualifiers: &Qualifiers) -> Option<Interpolation> {
    qualifiers.interpolation().map(|(i, _)| i)
}

/// True for a type that is, or contains, integers or doubles.
fn is_whole(ty: &Type) -> bool {
    match ty {
        Type::Scalar(s) | Type::Vector(s, _) | Type::Matrix(s, _, _) => s.is_integer() || *s == ScalarType::Double,
        Type::Array(element, _) => is_whole(element),
        Type::Struct(s) => s.fields.iter().any(|f| is_whole(&f.ty)),
        Type::Error | Type::Void | Type::Opaque(_) => false,
    }
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    fn codes(name: &str, text: &str) -> Vec<&'static str> {
        run(&[Input::new(SourceFile::new(name, text))]).iter().map(|d| d.code.0).filter(|c| *c == "I005").collect()
    }

    #[test]
    fn only_fragment_inputs_of_whole_numbers_are_reported() {
        let fragment =
            |input: &str| format!("#version 330 core\n{input}\nout vec4 c;\nvoid main() {{ c = vec4(1.0); }}\n");
        for reported in ["in int a;", "smooth in uvec2 a;", "in B { vec2 p; int a; } b;", "in int a[2];"] {
            assert_eq!(codes("a.frag", &fragment(reported)), ["I005"], "{reported}");
        }
        for silent in
            ["flat in int a;", "in vec4 a;", "flat in B { int a; } b;", "in B { flat int a; } b;", "uniform int a;"]
        {
            assert!(codes("a.frag", &fragment(silent)).is_empty(), "{silent}");
        }
        assert!(codes("a.vert", "#version 330 core\nin int a;\nvoid main() { gl_Position = vec4(a); }\n").is_empty());
    }
}
