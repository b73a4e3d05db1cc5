//! What is taken for a placeholder that nobody states, where its place says what it has to be.

use base::text::{SourceFile, Span};

use super::in_line_comment;

/// What is assumed, and why, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Assumption {
    pub value: String,
    pub why: &'static str,
}

fn assumed(value: impl Into<String>, why: &'static str) -> Option<Assumption> {
    Some(Assumption { value: value.into(), why })
}

/// How much the place of a placeholder says; more is less.
pub(super) type Rank = u8;

/// What a placeholder may be, by its place. `count` numbers the bindings that are assumed. None where a whole line, or nothing
/// that can be told, stands there.
pub(super) fn by_place(file: &SourceFile, span: Span, count: usize) -> Option<(Rank, Assumption)> {
    let text = file.text();
    if in_line_comment(text, span.start) {
        return None;
    }
    let before = text[..span.start].trim_end();
    let after = &text[span.end..];
    let line = text[..span.start].rfind(['\n', '\r']).map_or(0, |end| end + 1);
    let rest = after.split(['\n', '\r']).next().unwrap_or("");
    let alone = text[line..span.start].trim().is_empty();
    // In brackets that are still open, what stands before them.
    let inside = opening(before);
    if let Some((word, commas)) = inside {
        match word {
            "@workgroup_size" => {
                let several = before.ends_with(',') || rest.trim_start().starts_with(',');
                let value = match (commas, several) {
                    (0, false) => "64",
                    (0 | 1, _) => "8",
                    _ => "1",
                };
                return assumed(value, "the size of a workgroup").map(|a| (0, a));
            }
            // That of the elements, whatever they are.
            "stride" | "@stride" => return assumed("0", "the stride of the elements").map(|a| (1, a)),
            "@group" => return assumed("0", "a group of bindings").map(|a| (1, a)),
            "@binding" | "@location" | "@id" => {
                return assumed(count.to_string(), "a number of a binding").map(|a| (1, a));
            }
            _ => {}
        }
    }
    // A part of a name tells names apart: `input_{{ n }}`.
    let named = before.len() == span.start
        && before
            .rsplit(|c: char| !(c.is_alphanumeric() || c == '_'))
            .next()
            .is_some_and(|word| word.len() > 3 && word.starts_with(|c: char| c.is_alphabetic() || c == '_'));
    if named {
        return assumed(count.to_string(), "a part of a name").map(|a| (1, a));
    }
    // As many rounds as a test needs: those of loops in loops are a product.
    let head = text[line..span.start].trim_start();
    let rounds =
        head.starts_with("for") && head.contains(';') && before.ends_with(['<', '=']) && !before.ends_with("==");
    if rounds && before.trim_end_matches('=').ends_with('<') {
        return assumed("3", "a number of rounds").map(|a| (2, a));
    }
    // No number is shifted by more bits than it has.
    if before.ends_with("<<") || before.ends_with(">>") {
        return assumed("4", "a number of bits").map(|a| (2, a));
    }
    // Structures hold structures with arrays: their lengths are a product.
    if before.ends_with(',') && inside_array(before) && inside_structure(before) {
        return assumed("4", "the length of an array").map(|a| (2, a));
    }
    let suffix =
        |s: &str| after.starts_with(s) && !after[s.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
    if suffix("u") || suffix("i") {
        return assumed("64", "a whole number").map(|a| (3, a));
    }
    if suffix("f") || suffix("h") || after.starts_with('.') {
        return assumed("1", "a number").map(|a| (3, a));
    }
    if alone {
        return None;
    }
    if before.ends_with("texture_storage_2d<")
        || before.ends_with("texture_storage_3d<")
        || before.ends_with("_2d_array<")
    {
        return assumed("rgba8unorm", "a format of texels").map(|a| (1, a));
    }
    if before.ends_with("var<storage,") {
        return assumed("read_write", "an access").map(|a| (1, a));
    }
    if before.ends_with("vec") || before.ends_with("mat") {
        return assumed("4", "a size of vectors").map(|a| (1, a));
    }
    // Between two operands, and in front of arguments.
    let operand = |c: char| c.is_alphanumeric() || c == '_' || c == ')' || c == ']';
    let word = before.rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or("");
    let follows = text[..span.start].ends_with([' ', '\t']) && before.ends_with(operand) && word != "return";
    if follows && rest.trim_start().starts_with(|c: char| c.is_alphanumeric() || c == '_' || c == '(') {
        return assumed("+", "an operator").map(|a| (3, a));
    }
    if rest.starts_with('(') {
        return assumed("abs", "a function").map(|a| (3, a));
    }
    let typed = |word: &str| {
        let name = before.strip_suffix('=').map(str::trim_end)?;
        let start = name.rfind(|c: char| !(c.is_alphanumeric() || c == '_')).map_or(0, |at| at + 1);
        name[..start].trim_end().ends_with(word).then_some(())
    };
    let type_place = before.ends_with(['<', ':']) && !before.ends_with("< ") || before.ends_with("->");
    let generic = before.ends_with('<') && rest.trim_start().starts_with(['>', ',']);
    if before.ends_with(':') || before.ends_with("->") || generic || typed("alias").is_some() || typed("type").is_some()
    {
        return assumed("f32", "a type of numbers").map(|a| (2, a));
    }
    if type_place {
        return None;
    }
    if before.ends_with(',') && inside_array(before) {
        return assumed("64", "the length of an array").map(|a| (2, a));
    }
    let counted = rest.trim_start().starts_with('/')
        || before.ends_with(['<', '%', '/', '*'])
        || before.ends_with("<=")
        || before.ends_with(">=");
    assumed(if counted { "64" } else { "1" }, "a number").map(|a| (4, a))
}

/// The word before the round bracket that is open at the end of a text, and the commas behind it.
fn opening(before: &str) -> Option<(&str, usize)> {
    let (mut depth, mut commas) = (0_usize, 0);
    for (at, c) in before.char_indices().rev() {
        match c {
            ')' => depth += 1,
            '(' if depth == 0 => {
                let head = before[..at].trim_end();
                let start = head.rfind(|c: char| !(c.is_alphanumeric() || "_@".contains(c))).map_or(0, |at| at + 1);
                return head.get(start..).map(|word| (word, commas));
            }
            '(' => depth -= 1,
            ',' if depth == 0 => commas += 1,
            ';' | '{' => return None,
            _ => {}
        }
    }
    None
}

/// True in a structure of which the text ends inside of the brackets.
fn inside_structure(before: &str) -> bool {
    let mut depth = 0_usize;
    let open = before.char_indices().rev().find(|(_, c)| {
        depth += usize::from(*c == '}');
        let is_open = *c == '{' && depth == 0;
        depth -= usize::from(*c == '{' && depth > 0);
        is_open
    });
    let part = |c: char| c.is_alphanumeric() || c == '_';
    let head = open.map(|(at, _)| before[..at].trim_end().trim_end_matches(part).trim_end());
    head.is_some_and(|head| head.ends_with("struct"))
}

/// True behind `array<T,`.
fn inside_array(before: &str) -> bool {
    let (mut depth, mut end) = (0_usize, None);
    for (at, c) in before.char_indices().rev() {
        match c {
            '>' => depth += 1,
            '<' if depth == 0 => {
                end = Some(at);
                break;
            }
            '<' => depth -= 1,
            ';' | '{' | '}' => return false,
            _ => {}
        }
    }
    end.is_some_and(|at| before[..at].trim_end().ends_with("array"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_says_what_stands_there() {
        let value = |text: &str| {
            let (start, end) = (text.find("{{").unwrap(), text.find("}}").unwrap() + 2);
            by_place(&SourceFile::new("a.wgsl", text), Span::new(start, end), 3).map(|(_, a)| a.value)
        };
        for (text, wanted) in [
            ("@compute @workgroup_size({{ x }})", "64"),
            ("@compute @workgroup_size({{ x }}, 8)", "8"),
            ("@workgroup_size(8, 8, {{ z }})", "1"),
            ("@group(0) @binding({{ b }}) var", "3"),
            ("var<storage> a: array<{{ elem }}>;", "f32"),
            ("alias T = {{ elem }};", "f32"),
            ("fn f(x: {{ elem }}) -> f32", "f32"),
            ("var<private> a: array<vec4<f32>, {{ n }}>;", "64"),
            ("struct S { x: f32, a: array<vec4<f32>, {{ n }}u>, }", "4"),
            ("struct S { y: array<f32, #{M}>, a: array<f32, {{ n }}>, }", "4"),
            ("struct S { x: f32 } var<private> a: array<f32, {{ n }}>;", "64"),
            ("if (i < {{ n }}u) {", "64"),
            ("key >> {{ bits }}u", "4"),
            ("const STRIDE: u32 = {{ bytes }} / 4u;", "64"),
            ("let x = {{ alpha }} * y;", "1"),
            ("texture_storage_2d<{{F}}, write>", "rgba8unorm"),
            ("  for (var i = 0u; i < {{ n }}u; i++) {", "3"),
            ("a: vec{{n}}<f32>", "4"),
            ("var<storage> var_{{ input[0] }}: Array;", "3"),
            ("data: [[stride({{ s }})]] array<f32>;", "0"),
            ("x = a[0] {{ op }} b[0];", "+"),
            ("x = {{ f }}(y);", "abs"),
        ] {
            assert_eq!(value(text).as_deref(), Some(wanted), "{text}");
        }
        for text in ["struct P {\n  {{ FIELDS }}\n}", "// {{ x }}"] {
            assert_eq!(value(text), None, "{text}");
        }
    }
}
