//! What names say of the values that they stand for.

use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::words::words;

use crate::numeric::bare;

/// True when a word of the name begins with one of these.
pub fn has_word(name: &str, wanted: &[&str]) -> bool {
    words(name).iter().any(|w| wanted.iter().any(|x| w.starts_with(x)))
}

/// True for the name of a normal: `aNormal`, `normal_eye`, `N`; not for that of a matrix or texture of normals.
pub fn is_normal(name: &str) -> bool {
    let words = words(name);
    let other =
        ["matrix", "mat", "mtx", "map", "tex", "sampler", "uv", "coord", "scale", "strength", "offset", "transform"];
    let says = |w: &str| {
        ["normal", "norm", "normals", "nrm", "nor"].contains(&w)
            || w.strip_suffix("normal").is_some_and(|p| p.len() <= 1)
    };
    let letter = name.len() <= 2 && words.last().is_some_and(|w| w == "n");
    (letter || words.iter().any(|w| says(w))) && !words.iter().any(|w| other.iter().any(|o| w.starts_with(o)))
}

/// True for the name of a direction: a normal, or what says that it is one.
pub fn is_direction(name: &str) -> bool {
    is_normal(name) || words(name).iter().any(|w| ["dir", "direction"].contains(&w.as_str()))
}

/// The name of a variable or of a member; none for other expressions.
pub fn of(shader: &Shader, id: ExprId) -> Option<&str> {
    match &shader.expr(bare(shader, id)).kind {
        ExprKind::Name(name) => Some(name),
        ExprKind::Field { base, field } if crate::forms::is_member(shader, *base) => Some(&field.name),
        ExprKind::Field { base, field: _ } | ExprKind::Index { base, index: _ } => of(shader, *base),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_are_known_by_their_names() {
        for name in ["normal", "aNormal", "normal_eye", "N", "vN", "vnormal", "fragNormal", "n", "normal0"] {
            assert!(is_normal(name), "{name}");
        }
        for name in ["normalMatrix", "normal_map", "normalScale", "abnormal", "nn", "noise", "count", "normalized"] {
            assert!(!is_normal(name), "{name}");
        }
    }
}
