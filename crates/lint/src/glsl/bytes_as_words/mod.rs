//! K005: a stride in bytes between elements of an array of 32-bit words.

use std::collections::BTreeMap;

use crate::rule::{Check, Findings, Level, Pages, Rule};
use analysis::kernel::{Product, plain, sum};
use base::diagnostic::{Code, Severity, message};
use reading::ShaderFile;
use syntax::Shader;
use syntax::ast::{ExprId, ExprKind};
use syntax::symbols::SymbolId;
use syntax::types::{ArraySize, ScalarType, Type};
use syntax::wgsl::ModuleItem;

use analysis::forms::Forms;
use syntax::words::words;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("K005"),
    name: "bytes-as-words",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

/// Names that say that a constant is the distance or the size of a structure.
const SIZES: [&str; 3] = ["stride", "size", "sizeof"];

/// Records in one array of words: where they begin, and which of their words are written.
struct Records {
    /// The variable with the place of a record.
    base: SymbolId,
    /// Words from one to the next, as the text counts them.
    stride: f64,
    /// The product with the stride.
    at: ExprId,
    /// The factor that is the stride, where it is a named constant.
    name: Option<SymbolId>,
    /// The words that are written, from the beginning of a record.
    written: Vec<f64>,
}

fn is_words(shader: &Shader, base: ExprId) -> bool {
    let Type::Array(element, ArraySize::Unsized) = shader.type_of(base) else { return false };
    matches!(element.scalar(), Some(ScalarType::Uint | ScalarType::Int)) && element.is_scalar()
}

/// A structure that takes so many bytes and is called as a constant is, but for the word `STRIDE`.
fn structure_of(shader: &Shader, constant: SymbolId, bytes: f64) -> Option<String> {
    let symbol = shader.symbol(constant);
    structure_in(shader, &symbol.name, bytes).or_else(|| {
        // A text has what it needs of the files that it imports, and the structure may be no part of that.
        let (author, _) = shader.file().origin(symbol.span?);
        let other = author.name() != shader.file().name() && author.text().contains("struct ");
        other.then(|| structure_in(&Shader::parse_wgsl(&author).shader, &symbol.name, bytes)).flatten()
    })
}

/// The same in one text.
fn structure_in(shader: &Shader, constant: &str, bytes: f64) -> Option<String> {
    let module = shader.wgsl()?;
    let mut own = words(constant);
    own.retain(|word| !SIZES.contains(&word.as_str()));
    own.sort();
    module.items.iter().find_map(|item| {
        let ModuleItem::Struct { name, members: _ } = item else { return None };
        let mut theirs = words(&name.name);
        theirs.sort();
        let size = module.layouts.get(&name.name)?.extent.size;
        (theirs == own && size as f64 == bytes).then(|| name.name.clone())
    })
}

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    let forms = Forms::new(shader);
    let mut found: BTreeMap<(SymbolId, SymbolId), Records> = BTreeMap::new();
    for (_, expr) in shader.arena().iter() {
        let ExprKind::Assign { target, .. } = expr.kind else { continue };
        let ExprKind::Index { base, index } = shader.expr(plain(shader, target)).kind else { continue };
        let Some(array) = shader.symbol_of(base).filter(|_| is_words(shader, base)) else { continue };
        // `start` and `start + 2`.
        let terms = sum(shader, index);
        let (start, offset) = match terms.as_slice() {
            [start] => (start, 0.0),
            [start, rest] if rest.factors.is_empty() => (start, rest.times),
            _ => continue,
        };
        let Some(start) = start.only().filter(|_| start.times == 1.0) else { continue };
        let value = forms.value(start.id);
        let Some(variable) = start.symbol.filter(|_| value != start.id) else { continue };
        // `i * 16`
        let is_stride = |term: &Product| term.factors.len() == 1 && term.times >= 8.0 && term.times % 4.0 == 0.0;
        let Some(stride) = sum(shader, value).into_iter().find(is_stride) else { continue };
        let records = found.entry((array, variable)).or_insert_with(|| Records {
            base: variable,
            stride: stride.times,
            at: value,
            name: named(shader, value, stride.times),
            written: Vec::new(),
        });
        records.written.push(offset);
    }
    let mut told = Vec::new();
    for ((array, _), records) in found {
        let last = records.written.iter().copied().fold(0.0, f64::max);
        let structure = records.name.and_then(|name| structure_of(shader, name, records.stride));
        let quarter = records.stride / 4.0;
        // All that is written lies in the first quarter, and fills it but for one word.
        let filled = last > 0.0 && last < quarter && last + 2.0 >= quarter;
        if (structure.is_none() && !filled) || told.contains(&records.at) {
            continue;
        }
        told.push(records.at);
        let (name, stride) = (&shader.symbol(array).name, records.stride);
        let written = last + 1.0;
        let begin = &shader.symbol(records.base).name;
        let why = match structure {
            Some(structure) => message!(
                "`{structure}` has {stride} bytes, which are {quarter} elements of `{name}`",
                "`{structure}` は {stride} バイトで、`{name}` の {quarter} 要素にあたります"
            ),
            None => message!(
                "{written} elements of each are written: {stride} is their number of bytes, rounded up",
                "それぞれ {written} 要素が書き込まれており、{stride} はそのバイト数です"
            ),
        };
        findings.push(
            findings
                .at(
                    &file.file,
                    shader.expr(records.at).span,
                    message!(
                        "`{begin}` goes on by {stride} elements of 4 bytes, and {stride} bytes seem to be meant",
                        "`{begin}` は 4 バイトの要素 {stride} 個ずつ進みますが、{stride} バイトのつもりと思われます"
                    ),
                )
                .with_why(why)
                .with_help(message!(
                    "divide the stride by 4: an index counts elements",
                    "添字は要素の数なので、間隔を 4 で割ってください"
                )),
        );
    }
}

/// The constant that gives a product its number.
fn named(shader: &Shader, id: ExprId, stride: f64) -> Option<SymbolId> {
    let is = |id: &ExprId| {
        let symbol = shader.symbol_of(*id)?;
        (shader.fold(*id)?.as_f64() == Some(stride)).then_some(symbol)
    };
    super::walk::expressions(shader, id).iter().find_map(is)
}

#[cfg(test)]
mod tests {
    use crate::wgsl::testing::count;

    fn module(body: &str) -> usize {
        let text = format!(
            "struct DrawArgs {{ count: u32, first: u32, base: u32 }}\nconst DRAW_ARGS_STRIDE: u32 = 12u;\n\
             @group(0) @binding(0) var<storage, read_write> d: array<u32>;\n\
             fn f(i: u32, start: u32, a: DrawArgs) {{\n{body}\n}}\n"
        );
        count("K005", &text)
    }

    #[test]
    fn strides_in_bytes_are_reported() {
        assert_eq!(module("let at = start + i * 16u; d[at] = 1u; d[at + 1u] = 2u; d[at + 2u] = 3u;"), 1);
        assert_eq!(module("let at = DRAW_ARGS_STRIDE * i; d[at] = 1u;"), 1);
    }

    #[test]
    fn strides_in_elements_are_not() {
        assert_eq!(module("let at = start + i * 4u; d[at] = 1u; d[at + 1u] = 2u; d[at + 2u] = 3u;"), 0);
        assert_eq!(module("let at = start + i * 16u; d[at] = 1u; d[at + 7u] = 2u;"), 0);
        assert_eq!(module("let at = start + i * 16u; d[at] = 1u;"), 0, "one word says nothing");
        assert_eq!(module("let at = i * 64u; d[at] = 1u; d[at + 1u] = 2u;"), 0, "most of it is not written");
        assert_eq!(module("let at = i * (DRAW_ARGS_STRIDE / 4u); d[at] = 1u; d[at + 1u] = 2u;"), 0);
    }
}
