//! A name and a value side by side: arguments of a call, an entry of a list, an assignment to an element.

use super::{HostMacros, Text, is_name, plain_value};
use crate::script::HostText;

/// Reads all pairs, and the names of shader files beside them.
pub fn read(texts: &[Text], found: &mut HostMacros) {
    for (k, one) in texts.iter().enumerate() {
        let HostText::String { text, at, statement, .. } = one else { continue };
        found.note_shader(text, *statement);
        // `"-DWIDTH=32"` and `"WIDTH=32"` are a pair in one string.
        let option = text.strip_prefix("-D").unwrap_or(text);
        if let Some((name, value)) = option.split_once('=').filter(|(name, value)| is_name(name) && !value.is_empty()) {
            if !value.contains(char::is_whitespace) && whole(texts, k) && !value.contains(['{', '$', '%']) {
                found.add(name, value, *at, *statement);
            }
            continue;
        }
        if is_in_list(texts, k) {
            continue;
        }
        for value in values_behind(texts, k) {
            found.add(text, &value, *at, *statement);
        }
    }
}

/// True for one of three or more strings in brackets, none of which is the value of another: `["position", "normal", "uv"]`.
fn is_in_list(texts: &[Text], k: usize) -> bool {
    let is_part = |text: &Text| matches!(text, HostText::String { .. } | HostText::Mark(','));
    let start = texts[..k].iter().rposition(|text| !is_part(text));
    let end = texts[k..].iter().position(|text| !is_part(text)).map_or(texts.len(), |end| k + end);
    let list = start.filter(|start| texts[*start] == HostText::Mark('[')).map(|start| &texts[start + 1..end]);
    let strings = |list: &[Text]| list.iter().filter(|text| matches!(text, HostText::String { .. })).count();
    list.is_some_and(|list| texts.get(end) == Some(&HostText::Mark(']')) && strings(list) > 2)
}

/// True for a string that nothing is added to.
fn whole(texts: &[Text], k: usize) -> bool {
    !matches!(texts.get(k + 1), Some(HostText::Mark('+' | '<' | '.' | '%')))
}

/// The values of the pair whose name is the text at `k`: several where a condition chooses.
fn values_behind(texts: &[Text], k: usize) -> Vec<String> {
    let mut at = k + 1;
    match texts.get(at) {
        // A branch of a condition is no name.
        Some(HostText::Mark(':')) if k > 0 && texts[k - 1] == HostText::Mark('?') => return Vec::new(),
        Some(HostText::Mark(',' | ':')) => at += 1,
        Some(HostText::Mark(']')) if texts.get(at + 1) == Some(&HostText::Mark('=')) => at += 2,
        Some(HostText::Mark('=')) if texts.get(at + 1) == Some(&HostText::Mark('>')) => at += 2,
        _ => return Vec::new(),
    }
    let mut depth = 0_usize;
    let mut end = at;
    while let Some(text) = texts.get(end) {
        match text {
            HostText::Mark('(' | '[' | '{') => depth += 1,
            HostText::Mark(')' | ']' | '}') if depth == 0 => break,
            HostText::Mark(')' | ']' | '}') => depth -= 1,
            HostText::Mark(',' | ';') if depth == 0 => break,
            _ => {}
        }
        end += 1;
    }
    let value = &texts[at..end];
    let choice = value.iter().position(|text| *text == HostText::Mark('?'));
    let Some(choice) = choice else { return literal(value).into_iter().collect() };
    let branches = value[choice + 1..].split(|text| *text == HostText::Mark(':'));
    branches.map(literal).collect::<Option<_>>().unwrap_or_default()
}

/// A value that is written down.
fn literal(value: &[Text]) -> Option<String> {
    match value {
        [HostText::String { text, complete: true, .. }] => Some(text.clone()),
        [HostText::Word(word)] => plain_value(word).map(str::to_owned),
        [HostText::Mark('-'), HostText::Word(word)] => plain_value(word).map(|word| format!("-{word}")),
        // `String::from("float")`, `"float".to_string()`, `std::string("float")`
        [
            HostText::String { text, complete: true, .. },
            HostText::Mark('.'),
            HostText::Word(word),
            HostText::Mark('('),
            HostText::Mark(')'),
        ] if matches!(word.as_str(), "to_string" | "to_owned" | "into" | "c_str" | "toString") => Some(text.clone()),
        [head @ .., HostText::Mark('('), HostText::String { text, complete: true, .. }, HostText::Mark(')')] => {
            let named = |text: &Text| {
                matches!(text, HostText::Word(word) if ["std", "string", "String", "from", "Some", "str"].contains(&&**word))
                    || *text == HostText::Mark(':')
            };
            head.iter().all(named).then(|| text.clone())
        }
        _ => None,
    }
}
