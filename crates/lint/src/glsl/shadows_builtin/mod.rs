//! V005: a variable or function has the name of a built-in function.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::{Shader, is_builtin_function};

use super::compile::{fresh, is_private};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("V005"),
    name: "shadows-builtin",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn is_builtin(shader: &Shader, name: &str) -> bool {
    match shader.wgsl() {
        Some(_) => syntax::wgsl::is_builtin(name),
        None => is_builtin_function(shader, name),
    }
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let title =
        |name: &str| message!("`{name}` is the name of a built-in function", "`{name}` は組み込み関数の名前です");
    let why = || {
        message!(
            "the built-in function cannot be called while this is known",
            "この名前が有効な間、組み込み関数を呼べません"
        )
    };
    for (id, symbol) in shader.symbols() {
        let Some(span) = symbol.span.filter(|_| is_builtin(shader, &symbol.name)) else { continue };
        let found = findings
            .at(&file.file, span, title(&symbol.name))
            .with_label(message!("hides the function", "関数を隠します"))
            .with_why(why())
            .with_help(message!("choose another name", "別の名前にしてください"));
        let plain =
            is_private(shader, id) && !shader.uses_of(id).any(|u| u.from_macro) && file.file.slice(span) == symbol.name;
        findings.push(if plain {
            let new = fresh(shader, &symbol.name);
            let mut edits = vec![Edit::replace(span, new.clone())];
            edits.extend(shader.uses_of(id).map(|u| Edit::replace(u.span, new.clone())));
            found.with_fix(message!("rename it to `{new}`", "`{new}` に変える"), Safety::Safe, edits)
        } else {
            found
        });
    }
    for (_, function) in shader.functions() {
        if is_builtin(shader, &function.name.name) {
            findings.push(
                findings
                    .at(&file.file, function.name.span, title(&function.name.name))
                    .with_label(message!("hides the function", "関数を隠します"))
                    .with_why(why())
                    .with_help(message!("choose another name", "別の名前にしてください")),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::glsl::testing::strict_count;

    #[test]
    fn names_of_wgsl_are_whole() {
        let of = |name: &str| {
            crate::wgsl::testing::count("V005", &format!("fn f() -> f32 {{ let {name} = 1.0; return {name}; }}"))
        };
        assert_eq!((of("quadSwapX"), of("subgroupAdd"), of("quad_vertices"), of("subgroup_count")), (1, 1, 0, 0));
    }

    /// Findings of this rule at the strict level.
    fn count(name: &str, text: &str) -> usize {
        strict_count(super::RULE.code, name, text)
    }

    #[test]
    fn names_count_by_version() {
        let text =
            |v: &str, n: &str| format!("#version {v}\nvoid main() {{ float {n} = 1.0; gl_Position = vec4({n}); }}\n");
        assert_eq!(count("a.vert", &text("150", "mix")), 1);
        assert_eq!(count("a.vert", &text("150", "mixed")), 0);
        // `texture` came with 1.30.
        assert_eq!(count("a.vert", &text("120", "texture")), 0);
        assert_eq!(count("a.vert", &text("130", "texture")), 1);
        assert_eq!(
            count(
                "a.vert",
                "#version 150\nfloat sign(vec2 a) { return a.x; }\nvoid main() { gl_Position = vec4(1.0); }\n"
            ),
            1
        );
    }
}
