//! K002: stores by the number of the invocation, without a guard for those that are too many.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{indexed_arrays, kernels, unguarded_store};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::types::{ArraySize, Type};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K002"),
    name: "unguarded-invocation",
    severity: Severity::Info,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    for kernel in kernels(shader) {
        // Of a size that is not stated, nothing is known; groups of one have no invocation too many.
        if kernel.size.is_none_or(|size| size == [1, 1, 1]) {
            continue;
        }
        let Some(stored) = unguarded_store(shader, &kernel) else { continue };
        let arrays = indexed_arrays(shader, stored);
        // The type of a template's array may be in another text.
        let open = |ty: &Type| {
            matches!(ty, Type::Array(_, ArraySize::Unsized)) || (file.template.is_some() && *ty == Type::Error)
        };
        if !arrays.iter().any(|a| open(shader.type_of(*a))) {
            continue;
        }
        let text = shader.text_of(stored);
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(stored).span,
                    message!(
                        "every invocation stores to `{text}`, also those that are one too many",
                        "余ったインベケーションも `{text}` に書き込みます"
                    ),
                )
                .with_why(message!(
                    "a dispatch is made of whole work groups: the last one may have invocations without an item",
                    "ディスパッチはワークグループ単位なので、最後のグループには要素のないインベケーションがありえます"
                ))
                .with_help(message!(
                    "compare the index with the length of the array, and return where it is past the end",
                    "添字を配列の長さと比べ、終わりを超えたら戻ってください"
                )),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::strict_count;
    use super::*;

    fn count(size: u32, length: &str, body: &str) -> usize {
        let text = format!(
            "#version 430\nlayout(local_size_x = {size}) in;\n\
             layout(std430, binding = 0) buffer D {{ float data[{length}]; }};\n\
             void main()\n{{\n uint i = gl_GlobalInvocationID.x;\n {body}\n}}\n"
        );
        strict_count(RULE.code, "a.comp", &text)
    }

    #[test]
    fn stores_of_every_invocation_are_reported() {
        assert_eq!(count(64, "", "data[i] = 1.0;"), 1);
        assert_eq!(count(64, "", "uint k = 2u * i + 1u; data[k] += data[k - 1u];"), 1);
        assert_eq!(count(64, "", "data[i] = float(i % 16u);"), 1, "the remainder is no index");
    }

    #[test]
    fn guarded_ones_are_not() {
        assert_eq!(count(64, "", "if (i < uint(data.length())) data[i] = 1.0;"), 0);
        assert_eq!(count(64, "", "i = min(i, 99u); data[i] = 1.0;"), 0);
        assert_eq!(count(64, "", "data[i % 100u] = 1.0;"), 0);
        assert_eq!(count(64, "", "uint k = i % 100u; data[2u * k] = 1.0;"), 0);
        assert_eq!(count(64, "64", "data[i] = 1.0;"), 0, "a stated length");
        assert_eq!(count(1, "", "data[i] = 1.0;"), 0, "one invocation a group");
    }
}
