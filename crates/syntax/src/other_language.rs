//! Texts in another language than the one that they are read as, which is what the ending of their file says.

use base::diagnostic::{Diagnostic, Severity, message};
use base::text::{SourceFile, Span};

use crate::errors::OTHER_LANGUAGE;
use crate::wgsl::tokens;

/// A language that a text may look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Looks {
    /// GLSL or GLSL ES.
    Glsl,
    /// WGSL.
    Wgsl,
    /// HLSL.
    Hlsl,
}

impl Looks {
    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Glsl => "GLSL",
            Self::Wgsl => "WGSL",
            Self::Hlsl => "HLSL",
        }
    }

    fn endings(self) -> &'static str {
        match self {
            Self::Glsl => ".vert, .geom, .frag, .comp or .glsl",
            Self::Wgsl => ".wgsl",
            Self::Hlsl => ".hlsl",
        }
    }
}

/// What in a text only one language has, in the order of the text.
fn marks(text: &str, own: Looks) -> Vec<(Looks, Span)> {
    let all = tokens(text);
    let word = |k: usize| all.get(k).map_or("", |token| &text[token.span.range()]);
    let named = |name: &str| name.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let mark = |k: usize| match (word(k), word(k + 1), word(k + 2)) {
        ("#", "version", _) | ("layout", "(", _) => Some(Looks::Glsl),
        (name, ..) if name.starts_with("gl_") => Some(Looks::Glsl),
        ("void", "main", "(") if word(k + 3) == ")" => Some(Looks::Glsl),
        ("@", "vertex" | "fragment" | "compute" | "group" | "builtin" | "location", _) => Some(Looks::Wgsl),
        ("fn", name, "(") if named(name) => Some(Looks::Wgsl),
        ("cbuffer", name, _) if named(name) => Some(Looks::Hlsl),
        ("numthreads" | "register", "(", _) => Some(Looks::Hlsl),
        // In GLSL these are names that a macro may give a type.
        ("float2" | "float3" | "float4", name, _) if own == Looks::Wgsl && named(name) => Some(Looks::Hlsl),
        (":", name, _) if name.starts_with("SV_") => Some(Looks::Hlsl),
        // `static const float4 k`, `Output o = (Output)0;`
        ("static", "const", name) if named(name) => Some(Looks::Hlsl),
        ("(", name, ")") if named(name) && word(k + 3) == "0" => Some(Looks::Hlsl),
        // `(float3x3)m`: GLSL has no casts.
        ("(", name, ")") if is_hlsl_type(name) && named(word(k + 3)) => Some(Looks::Hlsl),
        _ => None,
    };
    (0..all.len()).filter_map(|k| Some((mark(k)?, all[k].span))).collect()
}

/// `float3`, `half4`, `float3x3`.
fn is_hlsl_type(name: &str) -> bool {
    let size = name.strip_prefix("float").or_else(|| name.strip_prefix("half"));
    let digit = |c: u8| (b'1'..=b'4').contains(&c);
    size.is_some_and(|size| match *size.as_bytes() {
        [n] => digit(n),
        [rows, b'x', columns] => digit(rows) && digit(columns),
        _ => false,
    })
}

/// Words without which no mark of another language than this is in a text.
fn words_of_others(own: Looks) -> &'static [&'static str] {
    match own {
        Looks::Glsl => {
            &["@", "fn ", "cbuffer", "numthreads", "register", "SV_", "static", ")0", ") 0", "(float", "(half"]
        }
        Looks::Wgsl => &["version", "layout", "gl_", "main", "cbuffer", "numthreads", "register", "SV_", "float"],
        Looks::Hlsl => &["version", "layout", "gl_", "main", "@", "fn "],
    }
}

/// The language of a text that is read as `own`, has nothing that only `own` has, and has what only another language has;
/// with the first such place.
pub fn looks_like(text: &str, own: Looks) -> Option<(Looks, Span)> {
    // Most texts have none of these words, which is quicker to see than their tokens.
    if !words_of_others(own).iter().any(|word| text.contains(word)) {
        return None;
    }
    let marks = marks(text, own);
    let &(other, span) = marks.first()?;
    let alone = other != own && marks.iter().all(|(looks, _)| *looks == other);
    alone.then_some((other, span))
}

/// True for a module of WGSL in a file whose ending says GLSL, as engines keep them.
pub fn is_wgsl(text: &str) -> bool {
    matches!(looks_like(text, Looks::Glsl), Some((Looks::Wgsl, _)))
}

/// The same as a diagnostic.
pub fn other_language(file: &SourceFile, own: Looks) -> Option<Diagnostic> {
    let (other, span) = looks_like(file.text(), own)?;
    let (looks, says, endings) = (other.name(), own.name(), other.endings());
    let what = message!(
        "the text looks like {looks}, and is read as {says}",
        "テキストは {looks} のようですが、{says} として読まれています"
    );
    let help = message!("give its file the ending {endings}", "ファイルの拡張子を {endings} にしてください");
    Some(Diagnostic::new(OTHER_LANGUAGE, Severity::Error, file, span, what).with_help(help))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn other(text: &str, own: Looks) -> Option<String> {
        let found = other_language(&SourceFile::new("a", text), own)?;
        Some(format!("{} {}", found.file.locate(found.span.start), found.message))
    }

    #[test]
    fn a_text_in_another_language_is_told_at_its_first_mark() {
        let glsl = "// fn f(\n#version 330\nin vec4 p;\nvoid main() { gl_Position = p; }\n";
        let wgsl = "@vertex\nfn main(@location(0) p: vec4f) -> @builtin(position) vec4f { return p; }\n";
        let hlsl = "float4x4 m : register(b0);\nfloat4 main(float4 p : POSITION) : SV_Position { return mul(m, p); }\n";
        let told = "a:2:1 the text looks like GLSL, and is read as WGSL";
        assert_eq!(other(glsl, Looks::Wgsl).as_deref(), Some(told));
        assert!(other(wgsl, Looks::Glsl).unwrap().starts_with("a:1:1 the text looks like WGSL"));
        assert!(other(hlsl, Looks::Glsl).unwrap().starts_with("a:1:14 the text looks like HLSL"));
        let parts = "#include \"in.hlsl\"\nO main(I input)\n{\n  O output = (O)0;\n  return output;\n}\n";
        assert!(other(parts, Looks::Glsl).unwrap().starts_with("a:4:14 the text looks like HLSL"));
        let cast = "p_flat main(v_static I)\n{\n  p_flat O;\n  O.N = mul((float3x3)m_WV, I.Nh);\n  return O;\n}\n";
        assert!(other(cast, Looks::Glsl).unwrap().starts_with("a:4:13 the text looks like HLSL"));
        assert!(other("float3 f(float3 x) { return x; }", Looks::Wgsl).unwrap().contains("HLSL"));
        for (text, own) in [(glsl, Looks::Glsl), (wgsl, Looks::Wgsl)] {
            assert_eq!(other(text, own), None);
        }
    }

    #[test]
    fn a_text_with_marks_of_two_languages_or_of_none_is_left_alone() {
        let both = "#ifdef HLSL\ncbuffer C { float4 a; };\n#else\nlayout(std140) uniform C { vec4 a; };\n#endif\n";
        for text in [both, "float f(float x) { return x; }", "", "struct S { int register_; };"] {
            assert_eq!(other(text, Looks::Glsl), None, "{text}");
            assert_eq!(other(text, Looks::Wgsl), None, "{text}");
        }
    }
}
