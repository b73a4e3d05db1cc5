//! Macros that a build or a host gives, and that nothing in a text defines: types of buffers, sizes of workgroups.
//!
//! A kernel that is built once for each type cannot be run without one. Where a text holds no errors once such names stand for
//! something plain, it is run with that, and the report says so.

use base::diagnostic::Severity;
use syntax::{Lacks, Parsed};

/// Macros that are assumed: names and values.
pub type Assumed = Vec<(String, String)>;

/// Reads a text with more macros.
type Parse<'p> = dyn Fn(&[(String, String)]) -> Parsed + 'p;

/// Times that names are looked for which only show when others are known.
const ROUNDS: usize = 6;

/// Names that are assumed at most.
const MOST: usize = 16;

/// What a type may stand for, the plainest first.
const TYPES: [&str; 5] = ["float", "vec4", "uint", "int", "ivec4"];

/// What a number may stand for: a size that is none of the first sizes of buffers, and the least.
const VALUES: [&str; 3] = ["32", "1", "4"];

/// What is assumed of a text that `parse` reads with more macros; none where nothing is lacking, or it has errors whatever is
/// assumed.
pub fn assumed(parse: &Parse<'_>) -> Option<Assumed> {
    let mut parsed = parse(&[]);
    // A version that stands elsewhere, or another language, is more than a macro.
    if parsed.shader.lacking().is_empty() || parsed.shader.wgsl().is_some() {
        return None;
    }
    let mut all = Assumed::new();
    let mut kinds = Vec::new();
    for _ in 0..ROUNDS {
        let fresh: Vec<(String, Lacks)> = parsed.shader.lacking().to_vec();
        if fresh.is_empty() {
            break;
        }
        for (name, what) in fresh {
            let known = all.iter().any(|(known, _)| *known == name);
            if known || all.len() == MOST || !may_be_given(&parsed, &name, what) {
                return None;
            }
            all.push((name.clone(), plainest(&name, what)));
            kinds.push(what);
        }
        parsed = parse(&all);
    }
    let mut left = errors(&parsed);
    for (k, what) in kinds.into_iter().enumerate() {
        let others: &[&str] = match what {
            Lacks::Type | Lacks::Function => &TYPES,
            Lacks::Value => &VALUES,
        };
        for other in others {
            if left == 0 {
                break;
            }
            let before = std::mem::replace(&mut all[k].1, (*other).to_owned());
            let now = errors(&parse(&all));
            if now < left {
                left = now;
            } else {
                all[k].1 = before;
            }
        }
    }
    (left == 0).then_some(all)
}

/// Errors of a text, and names that it lacks.
fn errors(parsed: &Parsed) -> usize {
    let errors = parsed.diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    errors + parsed.shader.lacking().len()
}

/// Whether a name may be one that a build gives: in capitals, as macros are; or a type, unless it is a slip of the pen.
fn may_be_given(parsed: &Parsed, name: &str, what: Lacks) -> bool {
    let macro_like = syntax::is_macro(name);
    let slip = parsed.diagnostics.iter().any(|d| d.help.is_some() && d.file.slice(d.span) == name);
    !slip && !name.starts_with("gl_") && (macro_like || what == Lacks::Type)
}

/// What a name stands for at first. A function of one argument becomes a conversion.
fn plainest(name: &str, what: Lacks) -> String {
    let vector =
        ["vec2", "vec3", "vec4", "mat2", "mat3", "mat4"].into_iter().find(|of| name.to_lowercase().contains(of));
    match what {
        Lacks::Type | Lacks::Function => vector.unwrap_or(TYPES[0]).to_owned(),
        Lacks::Value => VALUES[0].to_owned(),
    }
}

/// The note about what is assumed.
pub fn note(assumed: &[(String, String)]) -> String {
    let words: Vec<String> = assumed.iter().map(|(name, value)| format!("--define {name}={value}")).collect();
    let names = if assumed.len() == 1 { "a name that nothing defines" } else { "names that nothing defines" };
    format!("assumed {}: {names} here, as a build or a host may; state others by --define", words.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;
    use syntax::{Shader, Stage};

    fn of(text: &str) -> Option<Assumed> {
        let file = SourceFile::new("k.comp", format!("#version 450\n{text}"));
        assumed(&|defines| Shader::parse_with(&file, Stage::Compute, defines))
    }

    fn pairs(of: &[(&str, &str)]) -> Option<Assumed> {
        Some(of.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect())
    }

    #[test]
    fn types_and_sizes_of_a_build_become_plain_ones() {
        let text = "layout(local_size_x = WIDTH) in;\nlayout(binding = 0) buffer B { ELEMENT x[]; };\n\
                    void main() { x[gl_GlobalInvocationID.x] = ELEMENT(2.0 * float(x[0])); }\n";
        assert_eq!(of(text), pairs(&[("WIDTH", "32"), ("ELEMENT", "float")]));
        let text = "layout(local_size_x = 8) in;\nlayout(binding = 0) buffer B { ELEMENT x[]; };\n\
                    void main() { x[0].xyz = x[1].yzw; }\n";
        assert_eq!(of(text), pairs(&[("ELEMENT", "vec4")]));
    }

    #[test]
    fn slips_and_names_of_the_author_are_told() {
        let around = |line: &str| {
            format!("layout(local_size_x = 8) in;\nbuffer B {{ float x[]; }};\nvoid main() {{ {line} }}\n")
        };
        assert_eq!(of(&around("float total = 1.0; x[0] = totl;")), None);
        assert_eq!(of(&around("x[0] = scale * 2.0;")), None);
        assert_eq!(of(&around("x[0] = 1.0;")), None);
        // What else is wrong stays wrong.
        assert_eq!(of(&around("x[0] = SCALE * vec2(1.0);")), None);
    }
}
