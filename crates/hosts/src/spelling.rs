//! Names of functions of OpenGL as the bindings of a language spell them.

use base::text::Span;

use crate::HostFile;

/// A function of OpenGL (`glUniform1f`), spelled as the one at `place` is: `uniform1f` in WebGL, `uniform_1_f32` and
/// `Uniform1f` in Rust.
pub fn spelled(host: &HostFile, place: Span, function: &str) -> String {
    let like = host.file.slice(place);
    let Some(name) = function.strip_prefix("gl") else { return function.to_owned() };
    if like.contains('_') {
        return in_small_letters(name);
    }
    match like.chars().next() {
        Some('g') if like.strip_prefix("gl").is_some_and(|l| l.starts_with(|c: char| c.is_ascii_uppercase())) => {
            function.to_owned()
        }
        Some(c) if c.is_ascii_lowercase() => {
            let (first, rest) = name.split_at(1);
            format!("{}{rest}", first.to_ascii_lowercase())
        }
        _ => name.to_owned(),
    }
}

/// `Uniform1f` as `uniform_1_f32`.
fn in_small_letters(name: &str) -> String {
    let mut made = String::new();
    for c in name.chars() {
        if (c.is_ascii_uppercase() || c.is_ascii_digit()) && !made.is_empty() {
            made.push('_');
        }
        made.push(c.to_ascii_lowercase());
    }
    for (short, long) in [("ui", "_u32"), ("f", "_f32"), ("i", "_i32"), ("d", "_f64")] {
        for (ending, slice) in [(format!("{short}v"), "_slice"), (short.to_owned(), "")] {
            let stem = made.strip_suffix(&ending).filter(|s| s.ends_with(|c: char| c.is_ascii_digit()));
            if let Some(stem) = stem {
                return format!("{stem}{long}{slice}");
            }
        }
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;

    #[test]
    fn functions_are_spelled_as_their_neighbours_are() {
        for (like, function, expected) in [
            ("glUniform1f", "glUniform4f", "glUniform4f"),
            ("uniform1f", "glUniform4f", "uniform4f"),
            ("uniformMatrix3fv", "glUniformMatrix4fv", "uniformMatrix4fv"),
            ("Uniform1f", "glUniform4f", "Uniform4f"),
            ("uniform_1_f32", "glUniform4f", "uniform_4_f32"),
            ("uniform_1_f32", "glUniform2uiv", "uniform_2_u32_slice"),
            ("uniform_1_f32", "glUniformMatrix4fv", "uniform_matrix_4_f32_slice"),
            ("get_uniform_location", "glGetAttribLocation", "get_attrib_location"),
        ] {
            let host = HostFile::new(&SourceFile::new("a.cpp", like), true);
            assert_eq!(spelled(&host, Span::new(0, like.len()), function), expected, "{like}");
        }
    }
}
