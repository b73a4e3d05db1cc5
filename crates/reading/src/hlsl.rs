//! Names of HLSL in GLSL.

use base::diagnostic::{Code, Diagnostic};
use syntax::{Shader, errors};

/// The code of errors about such names.
pub const HLSL_NAME: Code = Code("T011");

/// What GLSL has for a name of HLSL.
pub enum Counterpart {
    /// The same under another name.
    Renamed(String),
    /// `clamp(x, 0.0, 1.0)`.
    Clamped,
    /// Something that is written otherwise: words about it, in English and in Japanese.
    Rewritten(&'static str, &'static str),
}

/// What GLSL has for a name of HLSL; none for other names.
pub fn counterpart(name: &str) -> Option<Counterpart> {
    let renamed = |to: &str| Some(Counterpart::Renamed(to.to_owned()));
    let rewritten = |en, ja| Some(Counterpart::Rewritten(en, ja));
    match name {
        "lerp" => renamed("mix"),
        "frac" => renamed("fract"),
        "ddx" => renamed("dFdx"),
        "ddy" => renamed("dFdy"),
        "rsqrt" => renamed("inversesqrt"),
        "atan2" => renamed("atan"),
        "saturate" => Some(Counterpart::Clamped),
        "mul" => rewritten(
            "write `a * b`, and mind that HLSL stores matrices by rows or columns as it is told",
            "`a * b` と書きます。HLSL では行列の格納順が設定によって変わることに注意してください",
        ),
        "fmod" => rewritten(
            "write `x - y * trunc(x / y)`; `mod` differs for negative numbers",
            "`x - y * trunc(x / y)` と書きます。`mod` は負の数で結果が異なります",
        ),
        "tex2D" | "tex2Dlod" | "texCUBE" => {
            rewritten("sample with `texture(sampler, coordinate)`", "`texture(sampler, coordinate)` で参照します")
        }
        "clip" => rewritten("write `if (x < 0.0) discard;`", "`if (x < 0.0) discard;` と書きます"),
        "rcp" => rewritten("write `1.0 / x`", "`1.0 / x` と書きます"),
        "mad" => rewritten("write `a * b + c`", "`a * b + c` と書きます"),
        "half" => renamed("float"),
        _ => vector_or_matrix(name).map(Counterpart::Renamed),
    }
}

/// `vec3` for `float3`, `mat4` for `float4x4`. A `float2x3` has two rows, and is a `mat3x2`.
fn vector_or_matrix(name: &str) -> Option<String> {
    let families = [("float", ""), ("half", ""), ("double", "d"), ("uint", "u"), ("int", "i"), ("bool", "b")];
    let (size, prefix) = families.iter().find_map(|(family, prefix)| Some((name.strip_prefix(family)?, *prefix)))?;
    let digit = |c: &u8| (b'2'..=b'4').contains(c);
    match size.as_bytes() {
        [n] if digit(n) => Some(format!("{prefix}vec{size}")),
        [rows, b'x', columns] if digit(rows) && digit(columns) && matches!(prefix, "" | "d") => {
            let (rows, columns) = (char::from(*rows), char::from(*columns));
            Some(if rows == columns { format!("{prefix}mat{rows}") } else { format!("{prefix}mat{columns}x{rows}") })
        }
        _ => None,
    }
}

/// Gives errors of the front end about unknown types and functions the code of this rule when HLSL has the
/// name and the shader does not declare it.
pub fn claim(shader: &Shader, mut diagnostic: Diagnostic) -> Diagnostic {
    let unknown = [errors::UNKNOWN_TYPE, errors::UNKNOWN_FUNCTION].contains(&diagnostic.code);
    let name = diagnostic.file.slice(diagnostic.span);
    let declared = || shader.symbols().any(|(_, s)| s.name == name) || shader.function(name).is_some();
    if unknown && counterpart(name).is_some() && !declared() {
        diagnostic.code = HLSL_NAME;
    }
    diagnostic
}
