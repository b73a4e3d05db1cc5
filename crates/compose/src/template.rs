//! Placeholders of template engines: `{{name}}` (Handlebars, Jinja, Tera and many a `replace`), and the conditions that
//! Jinja and Handlebars share. Loops, filters and calls need the engine, and are refused by name.

use base::text::{Assembly, SourceFile, Span};
use syntax::errors;

use crate::Problems;
use crate::stand_in::{self, Role, StandIns};

/// Puts values into a text. A text without placeholders stays as it is. Where something may stand in for what has no
/// value, nothing is missing.
pub(crate) fn fill(
    file: &SourceFile,
    defines: &[(String, String)],
    stand_ins: bool,
    problems: &mut Problems,
) -> SourceFile {
    let text = file.text();
    let found = marks(text, stand_ins);
    if found.is_empty() {
        return file.clone();
    }
    let value = |name: &str| defines.iter().find(|(defined, _)| defined == name).map(|(_, value)| value.as_str());
    let holds = |name: &str| value(name).is_some_and(|value| !matches!(value, "false" | "0"));
    let mut out = Assembly::new();
    let mut at = 0;
    // For each condition that is open: its place, whether its text stays, and whether one of its branches has stayed.
    let mut open: Vec<(Span, bool, bool)> = Vec::new();
    let mut names = StandIns::default();
    for Mark { span, what } in found {
        let kept = open.iter().all(|(_, kept, _)| *kept);
        if kept {
            out.copy(file, Span::new(at, span.start.max(at)));
        }
        at = span.end.max(at);
        match what {
            What::Comment => {}
            What::Value(name) if stand_ins && value(&name).is_none() => {
                if kept && !in_line_comment(text, span.start) {
                    at = names.put(file, span, &mut out);
                }
            }
            What::If(..) | What::Elif(..) | What::Else | What::End | What::Other if stand_ins => {
                match stand_in::role(file.slice(span)) {
                    Role::Open => open.push((span, true, true)),
                    Role::Branch => {
                        if let Some((_, kept, _)) = open.last_mut() {
                            *kept = false;
                        }
                    }
                    Role::Close => drop(open.pop()),
                    Role::Text if kept && !in_line_comment(text, span.start) => at = names.put(file, span, &mut out),
                    Role::Text | Role::Nothing => {}
                }
            }
            What::If(name, negated) => {
                let holds = holds(&name) != negated;
                open.push((span, holds, holds));
            }
            What::Elif(name, negated) => match open.last_mut() {
                Some((_, kept, any)) => {
                    *kept = !*any && holds(&name) != negated;
                    *any |= *kept;
                }
                None => problems.add(errors::TEMPLATE, file, span, "this branch has no `if` before it", OPEN),
            },
            What::Else => match open.last_mut() {
                Some((_, kept, any)) => {
                    *kept = !*any;
                    *any = true;
                }
                None => problems.add(errors::TEMPLATE, file, span, "this `else` has no `if` before it", OPEN),
            },
            What::End => {
                if open.pop().is_none() {
                    problems.add(errors::TEMPLATE, file, span, "nothing ends here", OPEN);
                }
            }
            What::Value(_) | What::Other if !kept => {}
            What::Value(name) => match value(&name) {
                Some(value) => out.replace(value, file, span),
                // Nobody reads what stands in a comment.
                None if in_line_comment(text, span.start) => out.copy(file, span),
                None => {
                    let help = format!("give its value with `--define {name}=VALUE`; an empty value is one");
                    problems.add(errors::TEMPLATE, file, span, format!("the placeholder `{name}` has no value"), &help);
                }
            },
            What::Other => {
                let shown = file.slice(span).to_owned();
                let message = format!("`{shown}` needs the template engine of its host");
                let help =
                    "give the text as the engine writes it; placeholders `{{name}}` and `{% if name %}` are read";
                problems.add(errors::TEMPLATE, file, span, message, help);
            }
        }
    }
    if let Some((span, ..)) = open.first().filter(|_| !stand_ins) {
        problems.add(errors::TEMPLATE, file, *span, "this condition is never ended", OPEN);
    }
    out.copy(file, Span::new(at, text.len()));
    names.declare(file, &mut out);
    out.finish(file.name())
}

const OPEN: &str =
    "conditions are `{% if name %}`, `{% else %}` and `{% endif %}`, or `{{#if name}}`, `{{else}}` and `{{/if}}`";

struct Mark {
    span: Span,
    what: What,
}

enum What {
    Value(String),
    If(String, bool),
    Elif(String, bool),
    Else,
    End,
    Comment,
    Other,
}

/// Pairs of braces of the engines, with what stands between them on one line; of any expressions, if that is asked.
fn marks(text: &str, expressions: bool) -> Vec<Mark> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(start) = text[at..].find('{').map(|offset| at + offset) {
        at = start + 1;
        let Some((open, close)) = [("{{{", "}}}"), ("{{", "}}"), ("{%", "%}"), ("{#", "#}")]
            .into_iter()
            .find(|(open, _)| text[start..].starts_with(open))
        else {
            continue;
        };
        let inside = start + open.len();
        let Some(len) = text[inside..].find(close) else { continue };
        // Blocks within blocks are braces side by side as well, and go on over lines.
        if text[inside..inside + len].contains(['\n', '\r', '{', ';']) {
            continue;
        }
        let end = inside + len + close.len();
        let part = &text[inside..inside + len];
        let expression = || (expressions && open == "{{" && !part.trim().is_empty()).then_some(What::Other);
        let Some(what) = meaning(open, part).or_else(expression) else { continue };
        found.push(Mark { span: Span::new(start, end), what });
        at = end;
    }
    found
}

/// What a pair of braces says; none for braces of the shader itself.
fn meaning(open: &str, inside: &str) -> Option<What> {
    let trimmed = inside.trim_matches(['-', '~', '&']).trim();
    let words: Vec<&str> = trimmed.split_whitespace().collect();
    let is_name = |word: &str| {
        word.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && word.chars().all(|c| c.is_alphanumeric() || "_-./".contains(c))
    };
    let name = |word: &&str| is_name(word).then(|| (*word).to_owned());
    if open == "{#" || (open == "{{" && trimmed.starts_with('!')) {
        return Some(What::Comment);
    }
    let what = match (open, &words[..]) {
        ("{%", ["if", one]) => name(one).map(|n| What::If(n, false)),
        ("{%", ["if", "not", one]) => name(one).map(|n| What::If(n, true)),
        ("{%", ["elif", one]) => name(one).map(|n| What::Elif(n, false)),
        ("{%", ["elif", "not", one]) => name(one).map(|n| What::Elif(n, true)),
        ("{%" | "{{", ["else"]) => Some(What::Else),
        ("{%", ["endif"]) | ("{{", ["/if" | "/unless"]) => Some(What::End),
        ("{{", ["#if", one]) => name(one).map(|n| What::If(n, false)),
        ("{{", ["#unless", one]) => name(one).map(|n| What::If(n, true)),
        ("{{" | "{{{", [one]) if is_name(one) => Some(What::Value((*one).to_owned())),
        ("{%", [_, ..]) => Some(What::Other),
        ("{{", [first, ..]) if first.starts_with(['#', '/', '>', '^']) => Some(What::Other),
        // A filter, a call or a path: `{{ x | upper }}`.
        ("{{", [first, "|", ..]) if is_name(first) => Some(What::Other),
        _ => return None,
    };
    Some(what.unwrap_or(What::Other))
}

fn in_line_comment(text: &str, at: usize) -> bool {
    let line = text[..at].rfind(['\n', '\r']).map_or(0, |end| end + 1);
    text[line..at].contains("//")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(text: &str, defines: &[(&str, &str)]) -> (String, Vec<String>) {
        let defines: Vec<_> = defines.iter().map(|&(n, v)| (n.to_owned(), v.to_owned())).collect();
        let mut problems = Problems::default();
        let out = fill(&SourceFile::new("a.wgsl", text), &defines, false, &mut problems);
        let shown = |d: &base::diagnostic::Diagnostic| format!("{} {}", d.file.locate(d.span.start), d.message);
        (out.text().to_owned(), problems.found.iter().map(shown).collect())
    }

    #[test]
    fn values_stand_where_their_names_stood() {
        let (text, told) =
            filled("struct P {\n{{FIELDS}}\n}\nconst n = {{ count }};", &[("FIELDS", "x: f32"), ("count", "3")]);
        assert_eq!((text.as_str(), told.len()), ("struct P {\nx: f32\n}\nconst n = 3;", 0));
    }

    #[test]
    fn conditions_choose_by_values() {
        let text = "{% if a %}A{% elif b %}B{% else %}C{% endif %} {{#unless a}}D{{else}}E{{/unless}}";
        assert_eq!(filled(text, &[("a", "1")]).0, "A E");
        assert_eq!(filled(text, &[("b", "1"), ("a", "0")]).0, "B D");
        assert_eq!(filled(text, &[]), ("C D".to_owned(), vec![]));
    }

    #[test]
    fn what_has_no_value_and_what_needs_an_engine_is_told() {
        let told = |text| filled(text, &[]).1;
        assert_eq!(told("a\n  {{X}}"), ["a.wgsl:2:3 the placeholder `X` has no value"]);
        assert_eq!(told("{% for i in xs %}"), ["a.wgsl:1:1 `{% for i in xs %}` needs the template engine of its host"]);
        assert_eq!(told("{% if a %}"), ["a.wgsl:1:1 this condition is never ended"]);
        assert_eq!(told("// {{X}}"), Vec::<String>::new());
    }

    #[test]
    fn names_stand_in_for_what_is_not_known() {
        let standing = |text: &str| {
            let mut problems = Problems::default();
            let out = fill(&SourceFile::new("a.wgsl", text), &[], true, &mut problems);
            assert!(problems.found.is_empty());
            out.text().to_owned()
        };
        assert_eq!(
            standing("if (i < {{ n[0] / 4 }}u && j < {{ n[0] / 4 }}u) { x = {{ a }}; }"),
            "if (i < stand_in_0 && j < stand_in_0) { x = stand_in_1; }\noverride stand_in_0: u32;"
        );
        assert_eq!(standing("struct S {\n  a: f32,\n  {{PADDING}}\n}"), "struct S {\n  a: f32,\n  \n}");
        assert_eq!(standing("{% if n % 4 == 0 %}A{% else %}B{% endif %}C"), "AC");
        assert_eq!(standing("{%- include \"a\" -%}\n// {{X}}\n{{#each xs}}D{{/each}}"), "\n// \nD");
        assert_eq!(standing("{% for i in xs %}{{ i }}{% endfor"), "stand_in_0{% endfor");
    }

    #[test]
    fn blocks_in_blocks_are_no_placeholders() {
        let text = "fn f() {{ let a = 1; }}\nfn g() {{\n}}\nfn h() {{}}";
        assert_eq!(filled(text, &[]), (text.to_owned(), vec![]));
    }
}
