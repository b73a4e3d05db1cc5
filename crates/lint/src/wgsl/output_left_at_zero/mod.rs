//! W018: a member of what a stage hands on that nothing writes, and that the next stage reads.

use std::collections::HashSet;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind, StmtKind};
use syntax::symbols::{FunctionId, SymbolId};
use syntax::types::Type;
use syntax::walk;
use syntax::wgsl::Module;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W018"),
    name: "output-left-at-zero",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Wgsl(check),
};

fn check(file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    // What is not in this text may write it.
    if module.composed || !file.is_sound() {
        return;
    }
    let mut returned: Option<HashSet<ExprId>> = None;
    for entry in &module.entry_points {
        let Type::Struct(output) = &shader.function_info(entry.function).return_type else { continue };
        let returned = returned.get_or_insert_with(|| values_returned(shader));
        for (symbol, info) in shader.symbols() {
            let local = info.span.and_then(|span| module.locals.get(&span.start));
            let Some(variable) = local.filter(|variable| variable.value.is_none()) else { continue };
            if !matches!(&info.ty, Type::Struct(own) if own.name == output.name) {
                continue;
            }
            let Some(written) = members_named(shader, symbol, entry.function, returned) else { continue };
            for member in module.members(&output.name).into_iter().flatten() {
                let name = member.name.name.as_str();
                if written.contains(name) || !is_read(shader, &output.name, name, entry.function) {
                    continue;
                }
                let own = &variable.name.name;
                findings.push(
                    findings
                        .at(
                            &file.file,
                            variable.name.span,
                            message!(
                                "`{own}.{name}` is returned, and never written",
                                "`{own}.{name}` は返されますが、どこでも書かれていません"
                            ),
                        )
                        .with_label(message!("`{name}` stays 0", "`{name}` は 0 のまま"))
                        .with_why(message!(
                            "a variable without initialiser begins as 0, and another stage reads `{name}`",
                            "初期化子のない変数は 0 から始まり、別のステージが `{name}` を読みます"
                        ))
                        .with_help(message!(
                            "write `{own}.{name}`, or remove the member",
                            "`{own}.{name}` に書き込むか、メンバーを削除してください"
                        )),
                );
            }
        }
    }
}

/// The expressions that functions return.
fn values_returned(shader: &Shader) -> HashSet<ExprId> {
    let mut all = HashSet::new();
    walk::statements(shader, |stmt| {
        if let StmtKind::Return(Some(value)) = stmt.kind {
            all.insert(value);
        }
    });
    all
}

/// The members of a variable that a function names, where it only names members of it and returns it.
fn members_named<'s>(
    shader: &'s Shader,
    variable: SymbolId,
    function: FunctionId,
    returned: &HashSet<ExprId>,
) -> Option<HashSet<&'s str>> {
    let mut named = HashSet::new();
    let mut uses: HashSet<ExprId> = shader.uses_of(variable).map(|u| u.expr).collect();
    if shader.uses_of(variable).any(|u| u.function != Some(function)) || !uses.iter().any(|id| returned.contains(id)) {
        return None;
    }
    uses.retain(|id| !returned.contains(id));
    for (_, expr) in shader.arena().iter() {
        if let ExprKind::Field { base, field } = &expr.kind
            && uses.remove(base)
        {
            named.insert(field.name.as_str());
        }
    }
    uses.is_empty().then_some(named)
}

/// True for a member that another function reads.
fn is_read(shader: &Shader, structure: &str, member: &str, except: FunctionId) -> bool {
    let of = |symbol| matches!(&shader.symbol(symbol).ty, Type::Struct(own) if own.name == structure);
    let elsewhere = shader.uses().iter().filter(|u| u.function != Some(except) && u.access.reads() && of(u.symbol));
    let reads: HashSet<ExprId> = elsewhere.map(|u| u.expr).collect();
    shader.arena().iter().any(
        |(_, expr)| matches!(&expr.kind, ExprKind::Field { base, field } if reads.contains(base) && field.name == member),
    )
}

#[cfg(test)]
mod tests {
    use super::super::testing::count;

    #[test]
    fn a_member_that_nothing_writes_is_reported() {
        let of = |body: &str, read: &str| {
            count(
                "W018",
                &format!(
                    "struct Out {{ @builtin(position) position: vec4f, @location(0) uv: vec2f, @location(1) color: vec3f }}\n\
                     fn fill(o: ptr<function, Out>) {{ (*o).uv = vec2f(1.0); }}\n\
                     @vertex fn vs(@location(0) p: vec3f) -> Out {{ {body} }}\n\
                     @fragment fn fs(in: Out) -> @location(0) vec4f {{ return vec4f({read}, 1.0); }}\n"
                ),
            )
        };
        let most = "var o: Out; o.position = vec4f(p, 1.0); o.color = p;";
        assert_eq!(of(&format!("{most} return o;"), "in.color * in.uv.x"), 1);
        assert_eq!(of(&format!("{most} return o;"), "in.color"), 0, "nobody reads it");
        assert_eq!(of(&format!("{most} o.uv = p.xy; return o;"), "in.color * in.uv.x"), 0);
        assert_eq!(of(&format!("{most} o.uv.x = p.x; return o;"), "in.color * in.uv.x"), 0);
        assert_eq!(of(&format!("{most} fill(&o); return o;"), "in.color * in.uv.x"), 0);
        assert_eq!(of("var o: Out; o = Out(vec4f(p, 1.0), p.xy, p); return o;", "in.color * in.uv.x"), 0);
        assert_eq!(of("return Out(vec4f(p, 1.0), p.xy, p);", "in.color * in.uv.x"), 0);
    }
}
