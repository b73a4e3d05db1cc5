//! Functions of a module in WGSL that have to do with `f16`: what formulas lose there is not measured.

use std::collections::BTreeSet;

use base::text::Span;
use syntax::Shader;

/// What declares a name.
const KEYWORDS: [&str; 7] = ["fn", "struct", "var", "let", "const", "override", "alias"];

/// A declaration of a module.
struct HalfItem<'s> {
    name: Option<&'s str>,
    words: BTreeSet<&'s str>,
}

/// Names of functions and other declarations that mention `f16`, or one that does.
pub fn halves(shader: &Shader) -> BTreeSet<String> {
    if shader.wgsl().is_none() {
        return BTreeSet::new();
    }
    let file = shader.file();
    let words: Vec<(Span, &str)> =
        syntax::wgsl::tokens(file.text()).iter().map(|token| (token.span, file.slice(token.span))).collect();
    let item = |span: Span| {
        let inside: Vec<&str> = words.iter().filter(|(at, _)| span.contains(at.start)).map(|(_, word)| *word).collect();
        HalfItem { name: declared(&inside), words: inside.into_iter().collect() }
    };
    let items: Vec<HalfItem<'_>> = shader.unit().items.iter().map(|one| item(one.span)).collect();
    let mut found: BTreeSet<&str> = BTreeSet::new();
    loop {
        let before = found.len();
        for one in &items {
            if one.words.iter().any(|word| is_half(word) || (found.contains(word) && one.name != Some(*word))) {
                found.extend(one.name);
            }
        }
        if found.len() == before {
            return found.into_iter().map(str::to_owned).collect();
        }
    }
}

/// The name behind the keyword of a declaration, and behind what stands in angle brackets there.
fn declared<'s>(words: &[&'s str]) -> Option<&'s str> {
    let at = words.iter().position(|word| KEYWORDS.contains(word))?;
    let mut depth = 0;
    words[at + 1..].iter().copied().find(|word| {
        depth += match *word {
            "<" => 1,
            ">" => -1,
            _ => 0,
        };
        depth == 0 && *word != ">"
    })
}

/// True for `f16`, for a vector or matrix of them by its short name, and for a literal of one.
fn is_half(word: &str) -> bool {
    let short = word.strip_suffix('h').is_some_and(|rest| {
        let sizes = rest.strip_prefix("vec").or_else(|| rest.strip_prefix("mat"));
        let hexadecimal = rest.starts_with("0x") && !rest.contains('p');
        sizes.is_some_and(|sizes| sizes.starts_with(|c: char| c.is_ascii_digit()))
            || rest.starts_with(|c: char| c.is_ascii_digit() || c == '.') && !hexadecimal
    });
    word == "f16" || short
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;

    #[test]
    fn what_mentions_halves_is_found_and_the_rest_is_not() {
        let text = "enable f16;\nalias Half = f16;\nstruct P { w: Half, x: f32 }\n@group(0) @binding(0) var<uniform> p: P;\n\
            const s = 1.5h;\nfn a(x: f32) -> f32 { return x + p.x; }\nfn b(x: f32) -> f32 { return x + 1.0; }\n\
            fn c(v: vec2h) -> f32 { return f32(v.x); }\nfn d(x: f32) -> f32 { return a(x); }\n\
            fn e(x: f32) -> f32 { let half = x * 0.5; return b(half); }\n";
        let parsed = Shader::parse_wgsl(&SourceFile::new("a.wgsl", text));
        let found = halves(&parsed.shader);
        let names: Vec<&str> = found.iter().map(String::as_str).collect();
        assert_eq!(names, ["Half", "P", "a", "c", "d", "p", "s"]);
    }
}
