//! W002: atomics in a buffer that can only be read.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::wgsl::{Module, TypeSyntax};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("W002"),
    name: "atomic-in-read-only-storage",
    severity: Severity::Error,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Wgsl(check),
};

/// True for a type that holds an atomic.
fn holds_atomic(module: &Module, ty: &TypeSyntax, depth: usize) -> bool {
    // A structure inside of itself has no size, and is no type.
    if depth == 0 {
        return false;
    }
    let inner = ty.args.iter().filter_map(|a| a.ty.as_ref()).any(|t| holds_atomic(module, t, depth - 1));
    let members = module.members(&ty.name.name).unwrap_or(&[]);
    ty.name.name == "atomic" || inner || members.iter().any(|m| holds_atomic(module, &m.ty, depth - 1))
}

fn check(file: &ShaderFile, module: &Module, findings: &mut Findings<'_>) {
    const DEEPEST: usize = 16;
    for (variable, _) in module.globals() {
        let space: Vec<&str> = variable.space.iter().map(|s| s.name.as_str()).collect();
        let read_only = matches!(space.as_slice(), ["storage"] | ["storage", "read"]);
        let Some(ty) = variable.ty.as_ref().filter(|_| read_only && !module.varies) else { continue };
        if !holds_atomic(module, ty, DEEPEST) {
            continue;
        }
        let name = &variable.name.name;
        findings.push(
            findings
                .at(
                    &file.file,
                    variable.name.span,
                    message!(
                        "`{name}` holds atomics and is read-only",
                        "`{name}` はアトミックを含みますが、読み取り専用です"
                    ),
                )
                .with_label(message!("only to be read", "読み取り専用"))
                .with_related(&file.file, ty.span, message!("has an atomic", "アトミックを含む"))
                .with_why(message!(
                    "atomics can only be in storage that is `read_write`",
                    "アトミックは `read_write` のストレージにしか置けません"
                ))
                .with_help(message!(
                    "declare it `var<storage, read_write>`, or use a structure without atomics here",
                    "`var<storage, read_write>` にするか、ここではアトミックのない構造体を使ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::count;

    #[test]
    fn atomics_are_found_inside_of_types() {
        let of = |space: &str, ty: &str| {
            count(
                "W002",
                &format!(
                    "struct S {{ a: atomic<u32>, }}\nalias T = u32;\n@group(0) @binding(0) var<{space}> v: {ty};\n"
                ),
            )
        };
        assert_eq!(of("storage", "array<S>"), 1);
        assert_eq!(of("storage, read", "atomic<i32>"), 1);
        assert_eq!(of("storage, read_write", "array<S>"), 0);
        assert_eq!(of("storage, read", "array<T>"), 0);
    }
}
