//! Text inside of a page. maud escapes what stands between tags and in attributes.

use std::fmt;

use maud::{Markup, PreEscaped, Render, html};

/// A message in which what stands between backticks is code.
pub(super) struct Message<T>(pub T);

impl<T: fmt::Display> Render for Message<T> {
    fn render(&self) -> Markup {
        let text = self.0.to_string();
        let parts: Vec<&str> = text.split('`').collect();
        // Backticks that have no partner stay what they are.
        if parts.len().is_multiple_of(2) {
            return html! { (text) };
        }
        html! { @for (k, part) in parts.iter().enumerate() { @if k % 2 == 1 { code { (part) } } @else { (part) } } }
    }
}

/// Parts with a comma and a space between them.
pub(super) fn commas(parts: &[Markup]) -> Markup {
    html! { @for (k, part) in parts.iter().enumerate() { @if k > 0 { ", " } (part) } }
}

/// Markup with escapes of Rust in place of control characters, which no page may have.
pub(super) fn printable(markup: Markup) -> Markup {
    let PreEscaped(text) = markup;
    let is_printable = |c: char| !c.is_control() || matches!(c, '\n' | '\t');
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_printable(c) { shown.push(c) } else { shown.extend(c.escape_default()) }
    }
    PreEscaped(shown)
}

/// JSON inside of a script element: nothing in it can end the element.
pub(super) fn script(value: &serde_json::Value) -> Markup {
    PreEscaped(value.to_string().replace('<', "\\u003c").replace('>', "\\u003e").replace('&', "\\u0026"))
}

/// A number of samples with its thousands set apart.
pub(super) fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A number with three digits.
pub(super) fn number(x: f64) -> String {
    match x.abs() {
        _ if x.is_nan() => "NaN".to_owned(),
        _ if x.is_infinite() => if x > 0.0 { "∞" } else { "−∞" }.to_owned(),
        0.0 => "0".to_owned(),
        size if (1e-3..1e5).contains(&size) => {
            let text = format!("{x:.3}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        _ => format!("{x:.2e}"),
    }
}

/// A name for an element of the page: letters, digits and hyphens.
pub(super) fn slug(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_text() {
        let evil = "</script><script>alert(\"1\")&'\u{1b}[1m";
        let PreEscaped(shown) = printable(html! { p title=(evil) { (evil) (Message(evil)) } });
        let text = "&lt;/script&gt;&lt;script&gt;alert(&quot;1&quot;)&amp;'\\u{1b}[1m";
        assert_eq!(shown, format!("<p title=\"{text}\">{text}{text}</p>"));
        let PreEscaped(json) = script(&serde_json::json!({ "name": evil }));
        assert!(!json.contains(['<', '>', '&']), "{json}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&json).unwrap()["name"], evil);
    }

    #[test]
    fn what_stands_between_backticks_is_code() {
        let shown = |text: &str| Message(text).render().into_string();
        assert_eq!(shown("`a<b>` is `1`"), "<code>a&lt;b&gt;</code> is <code>1</code>");
        assert_eq!(shown("one ` alone"), "one ` alone");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(count(12), "12");
        assert_eq!([0.0, 1.5, 0.25, 1e-9, f64::INFINITY].map(number), ["0", "1.5", "0.25", "1.00e-9", "∞"]);
    }
}
