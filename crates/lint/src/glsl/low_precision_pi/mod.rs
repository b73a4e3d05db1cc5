//! N014: π, or a multiple of it, with fewer digits than the shader can use.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Message, Safety, Severity, message};
use base::text::Edit;
use reading::ShaderFile;
use syntax::{TokenKind, TokenPlace};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("N014"),
    name: "low-precision-pi",
    severity: Severity::Info,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Any(check),
};

struct Constant {
    name: &'static str,
    value: f64,
    /// To 18 significant digits, correctly rounded.
    digits: &'static str,
    /// How many digits it takes to recognise it.
    least: usize,
}

const CONSTANTS: &[Constant] = &[
    Constant { name: "π", value: PI, digits: "3.14159265358979324", least: 3 },
    Constant { name: "2π", value: TAU, digits: "6.28318530717958648", least: 3 },
    Constant { name: "π/2", value: FRAC_PI_2, digits: "1.57079632679489662", least: 5 },
    Constant { name: "π/4", value: FRAC_PI_4, digits: "0.785398163397448310", least: 5 },
    Constant { name: "1/π", value: FRAC_1_PI, digits: "0.318309886183790672", least: 5 },
    Constant { name: "180/π", value: 180.0 / PI, digits: "57.2957795130823209", least: 5 },
    Constant { name: "π/180", value: PI / 180.0, digits: "0.0174532925199432958", least: 5 },
];

fn check(file: &ShaderFile, findings: &mut Findings<'_>) {
    for token in file.shader.tokens() {
        if token.kind != TokenKind::Number || token.place == TokenPlace::Inactive {
            continue;
        }
        let text = file.file.slice(token.span);
        let Some((number, constant)) = meant(text) else { continue };
        let suffix = &text[number.len()..];
        let off = (number.parse::<f64>().unwrap_or(constant.value) - constant.value).abs();
        let name = constant.name;
        let why = why(constant, suffix);
        findings.push(
            findings
                .at(
                    &file.file,
                    token.span,
                    message!(
                        "`{text}` stands for {name}, off by {off:.1e}",
                        "`{text}` は {name} のつもりですが、{off:.1e} ずれています"
                    ),
                )
                .with_label(message!("meant to be {name}", "{name} のつもり"))
                .with_why(why)
                .with_fix(
                    message!("write {name} with 18 digits", "{name} を 18 桁で書く"),
                    Safety::Unsafe,
                    vec![Edit::replace(token.span, format!("{}{suffix}", constant.digits))],
                ),
        );
    }
}

fn why(constant: &Constant, suffix: &str) -> Message {
    let (name, digits) = (constant.name, constant.digits);
    if is_double(suffix) {
        return message!(
            "{name} is {digits} to the precision of a double",
            "double の精度では {name} は {digits} です"
        );
    }
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is what is asked for")]
    let single = constant.value as f32;
    message!("the nearest binary32 value to {name} is {single}", "{name} に最も近い binary32 の値は {single} です")
}

fn is_double(suffix: &str) -> bool {
    suffix.eq_ignore_ascii_case("lf")
}

/// The constant that a literal stands for inexactly, with the literal less its suffix.
fn meant(text: &str) -> Option<(&str, &'static Constant)> {
    let number = text.trim_end_matches(['f', 'F', 'l', 'L']);
    let plain = number.bytes().all(|b| b.is_ascii_digit() || b == b'.') && number.contains('.');
    if !plain {
        return None;
    }
    let value: f64 = number.parse().ok()?;
    let decimals = number.len() - number.find('.')? - 1;
    let significant = number.trim_start_matches(['0', '.']).bytes().filter(u8::is_ascii_digit).count();
    let unit = 10f64.powi(-i32::try_from(decimals).ok()?);
    let constant = CONSTANTS.iter().find(|c| {
        // Rounded or cut at its last digit; half a unit in 1e-9 covers the rounding of the quotient.
        significant >= c.least && (value - c.value).abs() < unit * (1.0 + 1e-9) && is_rounding(value, c.value, unit)
    })?;
    #[expect(clippy::cast_possible_truncation, reason = "rounding to binary32 is what is asked for")]
    let exact =
        if is_double(&text[number.len()..]) { value == constant.value } else { value as f32 == constant.value as f32 };
    (!exact).then_some((number, constant))
}

/// True when `value` is `exact` rounded to a multiple of `unit`, or cut.
fn is_rounding(value: f64, exact: f64, unit: f64) -> bool {
    let steps = (value / unit).round();
    steps == (exact / unit).round() || steps == (exact / unit).floor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Input, run};
    use base::text::SourceFile;

    fn constant(text: &str) -> Option<&'static str> {
        meant(text).map(|(_, c)| c.name)
    }

    #[test]
    fn short_literals_are_recognised() {
        for (text, name) in [
            ("3.14", "π"),
            ("3.141", "π"),
            ("3.142", "π"),
            ("3.1416", "π"),
            ("3.14159", "π"),
            ("3.141592", "π"),
            ("3.141593", "π"),
            ("3.14f", "π"),
            ("6.28", "2π"),
            ("6.283185", "2π"),
            ("1.5708", "π/2"),
            ("0.78540", "π/4"),
            (".31831", "1/π"),
            ("57.296", "180/π"),
            ("0.017453", "π/180"),
            ("3.14159265358lf", "π"),
        ] {
            assert_eq!(constant(text), Some(name), "{text}");
        }
    }

    #[test]
    fn other_numbers_are_not() {
        for text in [
            "3.1",
            "3.15",
            "3.14160",
            "3.0",
            "3",
            "1.57",
            "0.785",
            "0.318",
            "57.3",
            "6.29",
            "0.0",
            "3.14e0",
            "0x3",
            "314.0",
            "3.1415927",
            "3.14159265",
            "3.14159265358979324",
            "6.2831853",
            "6.28318530717958648",
            "3.141592653589793lf",
        ] {
            assert_eq!(constant(text), None, "{text}");
        }
    }

    #[test]
    fn the_digits_are_those_of_the_constants() {
        for c in CONSTANTS {
            let parsed: f64 = c.digits.parse().unwrap();
            assert!((parsed - c.value).abs() <= f64::EPSILON * c.value, "{}", c.name);
            let significant = c.digits.trim_start_matches(['0', '.']).bytes().filter(u8::is_ascii_digit).count();
            assert_eq!(significant, 18, "{}", c.name);
            assert!(meant(c.digits).is_none(), "{}: the fix is clean", c.name);
        }
    }

    #[test]
    fn the_message_names_the_constant_and_the_error() {
        let text = "#version 150 core\n#define PI 3.141593\n/* 円周 */ const float a = 6.283185;\nvoid main() { gl_Position = vec4(a * PI); }\n";
        let found = run(&[Input::new(SourceFile::new("a.vert", text))]);
        let reported: Vec<_> = found.iter().map(|d| (d.file.locate(d.span.start), d.message.to_string())).collect();
        assert_eq!(
            reported,
            [
                ("a.vert:2:12".to_owned(), "`3.141593` stands for π, off by 3.5e-7".to_owned()),
                ("a.vert:3:26".to_owned(), "`6.283185` stands for 2π, off by 3.1e-7".to_owned()),
            ]
        );
        assert!(found[0].why.as_ref().unwrap().contains("3.1415927"));
    }
}
