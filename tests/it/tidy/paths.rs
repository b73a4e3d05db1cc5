//! The paths that a Rust file names, from its tokens: comments and strings do not count, and
//! `use a::{b, c}` is two paths.

use std::str::FromStr;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A path such as `crate::text::Span`.
#[derive(Debug, PartialEq, Eq)]
pub struct Named {
    pub segments: Vec<String>,
    pub line: usize,
    /// How many modules of this file surround it.
    pub inside: usize,
    /// It stands under `#[cfg(test)]`.
    pub test: bool,
    /// It stands in a `use` declaration.
    pub import: bool,
}

#[derive(Clone, Copy)]
struct Place {
    inside: usize,
    test: bool,
    import: bool,
}

/// All paths of a file in order, or why it could not be read.
pub fn named(text: &str) -> Result<Vec<Named>, String> {
    let tokens = TokenStream::from_str(text).map_err(|error| error.to_string())?;
    let mut found = Vec::new();
    walk(tokens, Place { inside: 0, test: false, import: false }, &mut found);
    Ok(found)
}

fn walk(tokens: TokenStream, outer: Place, found: &mut Vec<Named>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut place = outer;
    let mut at = 0;
    while at < tokens.len() {
        match &tokens[at] {
            TokenTree::Punct(mark) if mark.as_char() == '#' => {
                // Inner attributes have `!` before the group.
                let group = at + 1 + usize::from(is_punct(tokens.get(at + 1), '!'));
                if let Some(TokenTree::Group(attribute)) = tokens.get(group) {
                    place.test |= is_test(attribute.stream());
                    at = group;
                }
            }
            TokenTree::Punct(mark) if mark.as_char() == ';' => place = outer,
            TokenTree::Group(group) => {
                let in_module = at >= 2 && is_ident(&tokens[at - 2], "mod");
                let inner = Place { inside: place.inside + usize::from(in_module), ..place };
                walk(group.stream(), inner, found);
                if group.delimiter() == Delimiter::Brace {
                    place = outer;
                }
            }
            TokenTree::Ident(ident) if ident == "use" => place.import = true,
            TokenTree::Ident(_) => at = path(&tokens, at, &[], place, found),
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
        at += 1;
    }
}

/// Reads the path that starts at the identifier `at` behind `prefix`; gives its last token.
fn path(tokens: &[TokenTree], mut at: usize, prefix: &[String], place: Place, found: &mut Vec<Named>) -> usize {
    let mut segments = prefix.to_vec();
    let line = tokens[at].span().start().line;
    segments.push(tokens[at].to_string());
    while is_punct(tokens.get(at + 1), ':') && is_punct(tokens.get(at + 2), ':') {
        match tokens.get(at + 3) {
            Some(TokenTree::Ident(ident)) => segments.push(ident.to_string()),
            Some(TokenTree::Punct(star)) if star.as_char() == '*' => segments.push("*".into()),
            Some(TokenTree::Group(tree)) if tree.delimiter() == Delimiter::Brace => {
                branches(tree.stream(), &segments, place, found);
                return at + 3;
            }
            _ => break,
        }
        at += 3;
    }
    found.push(Named { segments, line, inside: place.inside, test: place.test, import: place.import });
    at
}

fn branches(tree: TokenStream, prefix: &[String], place: Place, found: &mut Vec<Named>) {
    let tokens: Vec<TokenTree> = tree.into_iter().collect();
    let mut at = 0;
    while at < tokens.len() {
        match &tokens[at] {
            TokenTree::Ident(ident) if ident == "as" => at += 1,
            TokenTree::Ident(_) => at = path(&tokens, at, prefix, place, found),
            TokenTree::Punct(star) if star.as_char() == '*' => {
                let segments = [prefix, &["*".into()]].concat();
                let line = star.span().start().line;
                found.push(Named { segments, line, inside: place.inside, test: place.test, import: place.import });
            }
            _ => {}
        }
        at += 1;
    }
}

fn is_punct(token: Option<&TokenTree>, mark: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == mark)
}

fn is_ident(token: &TokenTree, name: &str) -> bool {
    matches!(token, TokenTree::Ident(ident) if ident == name)
}

fn is_test(attribute: TokenStream) -> bool {
    let text = attribute.to_string().replace(' ', "");
    text == "test" || (text.starts_with("cfg(") && text.contains("test") && !text.contains("not(test"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spelled(text: &str) -> Vec<String> {
        named(text).unwrap().into_iter().map(|path| path.segments.join("::")).filter(|p| p.contains("::")).collect()
    }

    #[test]
    fn use_trees_are_expanded() {
        assert_eq!(
            spelled("use crate::{text::{Span, Edit as E}, value, lane::*};"),
            ["crate::text::Span", "crate::text::Edit", "crate::value", "crate::lane::*"]
        );
    }

    #[test]
    fn paths_in_bodies_count_and_generics_end_them() {
        assert_eq!(
            spelled("fn f() { let v = crate::a::b::<c::D>(std::fs::read); }"),
            ["crate::a::b", "c::D", "std::fs::read"]
        );
    }

    #[test]
    fn comments_and_strings_do_not_count() {
        assert!(
            spelled("//! [crate::lane]\n// crate::lane\nconst A: &str = \"crate::lane\"; /* std::fs */").is_empty()
        );
    }

    #[test]
    fn lines_modules_and_test_code_are_told_apart() {
        let paths = named("use a::b;\n#[cfg(test)]\nmod tests {\n    use super::c;\n}\nuse d::e;").unwrap();
        let facts: Vec<_> = paths
            .iter()
            .filter(|p| p.segments.len() == 2)
            .map(|p| (p.segments[1].as_str(), p.line, p.inside, p.test, p.import))
            .collect();
        assert_eq!(facts, [("b", 1, 0, false, true), ("c", 4, 1, true, true), ("e", 6, 0, false, true)]);
    }

    #[test]
    fn code_that_is_left_out_of_tests_is_not_test_code() {
        assert!(!named("#[cfg(not(test))] use a::b;").unwrap()[0].test);
    }

    #[test]
    fn text_that_is_not_rust_is_an_error() {
        assert!(named("fn f( {").is_err());
    }
}
