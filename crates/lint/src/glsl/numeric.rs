//! What rules about numbers share.

use analysis::forms::{Forms, builtin};
use analysis::numeric::BuiltinCall;
use analysis::range::{Observed, Range};
use syntax::Shader;
use syntax::ast::{Callee, ExprId, ExprKind};

use crate::Level;

/// The range of the first argument of a call where nothing is known of a scalar product that it is, of two different
/// vectors: what is meant as a cosine can be negative, and beyond 1 where the vectors are longer.
pub fn cosine<'s>(
    shader: &'s Shader,
    observed: &Observed,
    call: &BuiltinCall<'s>,
    forms: &mut Option<Forms<'s>>,
) -> Option<(Level, Range)> {
    let mut ranges = observed.visits(call.id).iter().filter_map(|v| v.operands.first()).flat_map(|v| &v.parts);
    let range = ranges.find(|r| r.lo == f64::NEG_INFINITY && r.hi == f64::INFINITY)?;
    let forms = forms.get_or_insert_with(|| Forms::new(shader));
    let (_, args) = builtin(shader, forms.value(*call.args.first()?), &["dot"])?;
    let [a, b] = args else { return None };
    (shader.text_of(*a) != shader.text_of(*b)).then_some((Level::Strict, *range))
}

/// True for constants and for vectors of them.
pub fn is_constant(shader: &Shader, id: ExprId) -> bool {
    shader.fold(id).is_some()
        || match &shader.expr(id).kind {
            ExprKind::Paren(inner) => is_constant(shader, *inner),
            ExprKind::Call { callee: Callee::Type(_), args } => args.iter().all(|a| is_constant(shader, *a)),
            _ => false,
        }
}

/// Things that rules about numbers need in their tests.
#[cfg(test)]
pub mod testing {
    use crate::Config;
    use crate::{Input, Level, Selection, Settings, run_with};
    use analysis::range::Stated;
    use base::diagnostic::{Diagnostic, Safety};
    use base::text::{EditList, SourceFile};

    /// A fragment shader with these statements in `main`; `p`, `q`, `n` are inputs, `s`, `t` uniforms,
    /// `declared` is a uniform that is between 0 and 200.
    pub fn shader(before: &str, body: &str) -> String {
        format!(
            "#version 330 core\nin vec3 p;\nin vec3 q;\nin vec3 n;\nuniform float s;\nuniform float t;\n\
             uniform float declared;\nuniform sampler2D image;\nout vec4 color;\n{before}\nvoid main()\n{{\n  \
             float r = 0.0;\n  vec3 v = p;\n  {body}\n  color = vec4(v, r);\n}}\n"
        )
    }

    /// What a rule says about a text at a level.
    pub fn lint(code: &str, level: Level, text: &str) -> Vec<Diagnostic> {
        let ranges = vec![Stated { name: "declared".to_owned(), min: 0.0, max: 200.0 }];
        let settings = Settings {
            selection: Selection::default().at(level),
            config: Config { ranges, ..Config::default() },
            ..Settings::default()
        };
        let found = run_with(&[Input::new(SourceFile::new("a.frag", text))], &settings);
        assert!(found.iter().all(|d| !d.code.0.starts_with('E')), "{found:#?}\n{text}");
        found.into_iter().filter(|d| d.code.0 == code).collect()
    }

    /// The rule speaks once of each of these bodies at that level, and not below it.
    pub fn rings(code: &str, level: Level, bodies: &[&str]) {
        for body in bodies {
            let text = shader("", body);
            assert_eq!(lint(code, level, &text).len(), 1, "{code} at {level:?}: {body}");
            let below = match level {
                Level::Default => continue,
                Level::Strict => Level::Default,
                Level::Heuristic => Level::Strict,
            };
            assert!(lint(code, below, &text).is_empty(), "{code} at {below:?}: {body}");
        }
    }

    /// The rule says nothing about these bodies, even at that level.
    pub fn silent(code: &str, level: Level, bodies: &[&str]) {
        for body in bodies {
            let found = lint(code, level, &shader("", body));
            assert!(found.is_empty(), "{code} at {level:?}: {body}\n{found:#?}");
        }
    }

    /// The body after the fix of the only finding, which must be unsafe and end the finding.
    pub fn fixed(code: &str, body: &str) -> String {
        let text = shader("", body);
        let found = lint(code, Level::Heuristic, &text);
        assert_eq!(found.len(), 1, "{found:#?}");
        let fix = found[0].fix.clone().unwrap();
        assert_eq!(fix.safety, Safety::Unsafe);
        let after = fix.edits.into_iter().collect::<EditList>().apply(&text).unwrap().text;
        let left = lint(code, Level::Heuristic, &after);
        assert!(left.is_empty(), "{left:#?}\n{after}");
        let line = text.lines().position(|l| l.trim() == body).unwrap();
        after.lines().nth(line).unwrap().trim().to_owned()
    }

    /// A call that comes from a macro is told without a fix.
    pub fn macro_has_no_fix(code: &str, expression: &str) {
        let text = shader(&format!("#define M(a) {expression}"), "r = M(s);");
        let found = lint(code, Level::Heuristic, &text);
        assert!(!found.is_empty() && found.iter().all(|d| d.fix.is_none()), "{found:#?}");
    }
}
