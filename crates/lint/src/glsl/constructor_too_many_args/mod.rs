//! T001: a constructor gets more components than its type has.

use crate::rule::{Check, Level, Pages, Rule};
use base::diagnostic::{Code, Diagnostic, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{Callee, ExprId, ExprKind};
use syntax::symbols::CallTarget;
use syntax::types::Type;

use super::walk::declarators;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("T001"),
    name: "constructor-too-many-args",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::FrontEnd(complete),
};

fn complete(file: &ShaderFile, found: Diagnostic) -> Option<Diagnostic> {
    let shader = &file.shader;
    let call = shader.arena().iter().find_map(|(id, e)| match &e.kind {
        ExprKind::Call { callee: Callee::Type(written), args } if written.span == found.span && !e.from_macro => {
            Some((id, written, args))
        }
        _ => None,
    });
    let Some((id, written, args)) = call else { return Some(found) };
    let Some(CallTarget::Constructor(ty)) = shader.callee(id) else { return Some(found) };
    let Some(Extra { first, given }) = extra_arguments(shader, ty, args) else { return Some(found) };
    let surplus = || Span::new(shader.expr(args[first - 1]).span.end, shader.expr(args[args.len() - 1]).span.end);
    Some(fix(shader, id, ty, given, found, written.name_span, surplus))
}

fn fix(
    shader: &Shader,
    call: ExprId,
    ty: &Type,
    given: usize,
    found: Diagnostic,
    name: Span,
    surplus: impl FnOnce() -> Span,
) -> Diagnostic {
    let fits = destination(shader, call).filter(|wanted| {
        matches!(wanted, Type::Vector(..)) && wanted.scalar() == ty.scalar() && wanted.components() == Some(given)
    });
    match fits {
        Some(wanted) => {
            let edit = Edit::replace(name, wanted.to_string());
            found.with_fix(message!("construct a `{wanted}`", "`{wanted}` にする"), Safety::Safe, vec![edit])
        }
        None => found.with_fix(
            message!("remove what is too many", "余分な引数を削る"),
            Safety::Unsafe,
            vec![Edit::delete(surplus())],
        ),
    }
}

struct Extra {
    /// Index of the first argument that is not needed; at least 1.
    first: usize,
    /// Components of all arguments.
    given: usize,
}

/// The arguments behind the last needed one; none when there are none, or a type is not known.
fn extra_arguments(shader: &Shader, ty: &Type, args: &[ExprId]) -> Option<Extra> {
    let needed = ty.components()?;
    let counts: Vec<usize> = args.iter().map(|&a| shader.type_of(a).components()).collect::<Option<_>>()?;
    let mut sum = 0;
    let mut first = None;
    for (index, count) in counts.iter().enumerate() {
        if sum >= needed && first.is_none() {
            first = Some(index);
        }
        sum += count;
    }
    first.map(|first| Extra { first, given: sum })
}

/// Type of the variable or target that takes the value of `call` as it is.
fn destination(shader: &Shader, call: ExprId) -> Option<Type> {
    let mut value = call;
    // Operands come before their users: one pass finds the parentheses around the call.
    for (id, expr) in shader.arena().iter() {
        match &expr.kind {
            ExprKind::Paren(inner) if *inner == value => value = id,
            ExprKind::Assign { op: None, op_span: _, target, value: assigned } if *assigned == value => {
                return Some(shader.type_of(*target).clone());
            }
            _ => {}
        }
    }
    let mut found = None;
    declarators(shader, |declarator| {
        if declarator.initializer.as_ref().is_some_and(|i| i.value == value) {
            let symbol = shader.symbols().find(|(_, s)| s.span == Some(declarator.name.span));
            found = symbol.map(|(_, s)| s.ty.clone());
        }
    });
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Input, run};
    use base::text::{EditList, SourceFile};

    fn lint(statement: &str) -> Vec<Diagnostic> {
        let text = format!(
            "#version 150 core\nin vec4 q;\nout vec4 c;\nvoid main(void)\n{{\n  {statement}\n  gl_Position = q;\n  c = q;\n}}\n"
        );
        let mut found = run(&[Input::new(SourceFile::new("a.vert", text))]);
        found.retain(|d| d.code.0 != "D006");
        found
    }

    fn fixed(statement: &str) -> (Safety, String) {
        let found = lint(statement);
        assert_eq!(found.iter().map(|d| d.code.0).collect::<Vec<_>>(), ["T001"], "{found:#?}");
        let fix = found[0].fix.clone().unwrap();
        let text = fix.edits.into_iter().collect::<EditList>().apply(found[0].file.text()).unwrap().text;
        (fix.safety, text.lines().nth(5).unwrap().trim().to_owned())
    }

    #[test]
    fn rejects_four_components_in_vec3() {
        let found = lint("vec3 p = vec3(1.0, 2.0, 3.0, 4.0);");
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].message, "`vec3` has 3 components, but is given 4");
        assert_eq!(found[0].file.slice(found[0].span), "vec3");
    }

    #[test]
    fn the_declared_type_decides_the_fix() {
        assert_eq!(
            fixed("vec4 p = vec3(1.0, 2.0, 3.0, 4.0);"),
            (Safety::Safe, "vec4 p = vec4(1.0, 2.0, 3.0, 4.0);".to_owned())
        );
        assert_eq!(
            fixed("vec4 p; p = (vec3(q.xyz, 4.0));"),
            (Safety::Safe, "vec4 p; p = (vec4(q.xyz, 4.0));".to_owned())
        );
        assert_eq!(
            fixed("vec3 p = vec3(1.0, 2.0, 3.0, 4.0);"),
            (Safety::Unsafe, "vec3 p = vec3(1.0, 2.0, 3.0);".to_owned())
        );
        assert_eq!(fixed("vec3 p = vec3(q, 1.0);"), (Safety::Unsafe, "vec3 p = vec3(q);".to_owned()));
    }

    #[test]
    fn a_cut_argument_is_legal() {
        for statement in [
            "vec3 p = vec3(q);",
            "vec3 p = vec3(1.0, q);",
            "float x = float(q);",
            "mat3 m = mat3(mat4(1.0));",
            "mat2 m = mat2(q);",
            "vec4 p = vec4(q.xyz, 1.0);",
        ] {
            assert!(lint(statement).is_empty(), "{statement}");
        }
    }

    #[test]
    fn a_constructor_from_a_macro_has_no_fix() {
        let text = "#version 150 core\n#define P vec3(1.0, 2.0, 3.0, 4.0)\nvoid main(void)\n{\n  vec3 p = P;\n  \
                    gl_Position = vec4(p, 1.0);\n}\n";
        let found = run(&[Input::new(SourceFile::new("a.vert", text))]);
        assert_eq!(found.len(), 1, "{found:#?}");
        assert!(found[0].code.0 == "T001" && found[0].fix.is_none() && found[0].help.is_some());
    }
}
