//! Names that the conditions of a text ask for.

use base::text::SourceFile;

use crate::token::{Kind, tokens};

/// Names that conditions of a text ask for and do not compare with a value: features of WESL in `@if` and `@elif`, and
/// names in `#ifdef`, `#ifndef`, `#if` and `#elif`. In the order of the text, each once.
pub fn features(file: &SourceFile) -> Vec<String> {
    let text = file.text();
    let mut found: Vec<String> = Vec::new();
    let mut add = |name: &str| {
        if !found.iter().any(|known| known == name) {
            found.push(name.to_owned());
        }
    };
    let all = tokens(text);
    let word = |at: usize| all.get(at).map_or("", |token| file.slice(token.span));
    for at in 0..all.len() {
        if all[at].kind == Kind::At && matches!(word(at + 1), "if" | "elif") && word(at + 2) == "(" {
            let inside = (at + 3..all.len()).take_while(|&t| word(t) != ")" || word(t + 1) == ")");
            inside.filter(|&t| all[t].kind == Kind::Word).for_each(|t| add(word(t)));
        }
    }
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    for line in text.lines() {
        let Some(directive) = line.trim_start().strip_prefix('#') else { continue };
        let directive = directive.trim_start();
        let asks = ["ifdef", "ifndef", "if", "elif", "else ifdef", "else if"];
        let Some(condition) = asks.iter().find_map(|word| directive.strip_prefix(word)) else { continue };
        let condition = condition.split("//").next().unwrap_or_default();
        if !condition.contains(['=', '<', '>', '+', '*']) && !condition.starts_with(is_name) {
            condition.split(|c| !is_name(c)).filter(|w| w.starts_with(char::is_alphabetic)).for_each(&mut add);
        }
    }
    found.retain(|name| !matches!(name.as_str(), "true" | "false" | "defined"));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_asked_for_by_conditions_alone() {
        let text = "@if(A && !(B || A)) const x = 1;\n@else const x = 2;\n@group(0) @binding(1) var t: T;\n#ifdef C // D\n\
                    # if defined(E) && F\n#else ifdef G\n#if H == 3\n#endif\n#import if_else\n@elif(I) fn f() {}\n";
        assert_eq!(features(&SourceFile::new("a.wesl", text)), ["A", "B", "I", "C", "E", "F", "G"]);
    }
}
