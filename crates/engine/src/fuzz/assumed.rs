//! Macros that a build or a host gives, and that nothing in a text defines: types of buffers, sizes of workgroups.
//!
//! A kernel that is built once for each type cannot be run without one. Where a text holds no errors once such names stand for
//! something plain, it is run with that, and the report says so.

use base::diagnostic::Severity;
use program::WIDE_BYTES;
use syntax::interface::Storage;
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
    let mut all = names(parse).unwrap_or_default();
    let parsed = parse(&all);
    if errors(&parsed) == 0 && has_bytes_in_buffers(&parsed) {
        all.push((WIDE_BYTES.to_owned(), "1".to_owned()));
    }
    (!all.is_empty()).then_some(all)
}

/// True when numbers of 8 bits lie in buffers.
fn has_bytes_in_buffers(parsed: &Parsed) -> bool {
    let blocks = &parsed.shader.interface().blocks;
    blocks.iter().filter(|block| matches!(block.storage, Storage::Buffer | Storage::Uniform)).any(|block| {
        // A structure that is only declared is in no buffer.
        block.ty.has_scalar(&|scalar| scalar.is_integer() && scalar.bits() == 8)
    })
}

/// What is assumed of names.
fn names(parse: &Parse<'_>) -> Option<Assumed> {
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
            let sized = of_32_bits(&name);
            // What a type is that says its size, nothing else may be.
            let others: &[&str] = match what {
                _ if sized.is_some() => &[],
                Lacks::Type | Lacks::Function => &TYPES,
                Lacks::Value => &VALUES,
            };
            all.push((name.clone(), sized.unwrap_or_else(|| plainest(&name, what))));
            kinds.push(others);
        }
        parsed = parse(&all);
    }
    let mut left = errors(&parsed);
    for (k, others) in kinds.into_iter().enumerate() {
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
    // A type that an extension brings is told with the line that is missing, and is no slip.
    let sized = of_32_bits(name).is_some();
    let slip = !sized && parsed.diagnostics.iter().any(|d| d.help.is_some() && d.file.slice(d.span) == name);
    // Numbers of 64 bits have more digits than any that could stand for them.
    let wide = !macro_like && name.contains("64");
    !slip && !wide && !name.starts_with("gl_") && (macro_like || what == Lacks::Type)
}

/// The type of 32 bits for one that is smaller or says its size, where the extension that brings it is not on:
/// `uint8_t`, `f16vec2`.
fn of_32_bits(name: &str) -> Option<String> {
    const BITS: [&str; 3] = ["8", "16", "32"];
    let scalars = [("uint", "uint", "u", "uvec"), ("int", "int", "i", "ivec"), ("float", "float", "f", "vec")];
    scalars.into_iter().find_map(|(long, scalar, short, vector)| {
        let sized = |text: &str| BITS.contains(&text);
        let single = name.strip_prefix(long).and_then(|rest| rest.strip_suffix("_t")).filter(|bits| sized(bits));
        let several = || {
            let (bits, count) = name.strip_prefix(short)?.split_once("vec")?;
            (sized(bits) && ["2", "3", "4"].contains(&count)).then(|| format!("{vector}{count}"))
        };
        single.map(|_| scalar.to_owned()).or_else(several)
    })
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

/// What to tell of what is assumed.
pub fn assumption_note(assumed: &[(String, String)]) -> String {
    let (bytes, others): (Vec<_>, Vec<_>) = assumed.iter().partition(|(name, _)| name == WIDE_BYTES);
    let (types, names): (Vec<_>, Vec<_>) = others.into_iter().partition(|(name, _)| of_32_bits(name).is_some());
    let words = |of: Vec<&(String, String)>| {
        of.into_iter().map(|(name, value)| format!("--define {name}={value}")).collect::<Vec<_>>().join(" ")
    };
    let mut told = Vec::new();
    if !names.is_empty() {
        let what = if names.len() == 1 { "a name that nothing defines" } else { "names that nothing defines" };
        told.push(format!("assumed {}: {what} here, as a build or a host may; state others by --define", words(names)));
    }
    if !types.is_empty() {
        let what =
            "types of other sizes, for which those of 32 bits stand: their ranges and places in buffers are others";
        told.push(format!("assumed {}: {what}", words(types)));
    }
    if !bytes.is_empty() {
        let what = "numbers of 8 bits take in buffers the place of those of 32: distances in memory are others";
        told.push(format!("assumed {}: {what}", words(bytes)));
    }
    told.join("; ")
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
    fn types_that_say_their_size_keep_their_kind() {
        let text = "layout(local_size_x = 8) in;\nlayout(binding = 0) buffer B { uint8_t x[]; };\n\
                    layout(binding = 1) buffer C { f16vec2 y[]; };\nvoid main() { y[0].x = float(x[0] & 3u); }\n";
        let found = of(text).unwrap();
        assert_eq!(Some(&found), pairs(&[("uint8_t", "uint"), ("f16vec2", "vec2")]).as_ref());
        assert!(assumption_note(&found).contains("places in buffers are others"));
        for (name, kind) in [("int16_t", "int"), ("float32_t", "float"), ("u8vec4", "uvec4"), ("i32vec3", "ivec3")] {
            assert_eq!(of_32_bits(name).as_deref(), Some(kind), "{name}");
        }
        for name in ["uint_t", "float16", "f16mat2", "vec2", "u8vec5", "i24vec2"] {
            assert_eq!(of_32_bits(name), None, "{name}");
        }
        assert_eq!(of(&text.replace("uint8_t", "uint64_t")), None, "no type of 32 bits holds that");
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
