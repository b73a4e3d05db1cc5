//! `concise`: one line each, for editors and `grep`.

use base::diagnostic::{Diagnostic, Lang};
use base::text::printable;
use lint::with_name;

use super::{Context, Format};

/// The format.
pub const FORMAT: Format = Format { name: "concise", summary: "One line each", write };

fn write(found: &[Diagnostic], context: &Context) -> String {
    found.iter().map(|d| line(d, context.lang)).collect()
}

/// `file:line:column: error[T001 name-of-the-rule]: message`. Line breaks in messages become blanks.
fn line(d: &Diagnostic, lang: Lang) -> String {
    let message = printable(&d.message.in_lang(lang).replace(['\r', '\n'], " "));
    format!("{}: {}[{}]: {message}\n", d.file.locate(d.span.start), d.severity.name(), with_name(d.code.0))
}

#[cfg(test)]
mod tests {
    use super::super::testing::sample;
    use super::*;

    #[test]
    fn each_finding_is_one_line() {
        let found = [sample(), sample()];
        let line = "側/円 柱.vert:2:21: error[T001 constructor-too-many-args]: too few, or: 100% of it\n";
        assert_eq!(write(&found, &Context::default()), line.repeat(2));
        let japanese = write(&found[..1], &Context { lang: Lang::Ja, ..Context::default() });
        assert!(japanese.ends_with(": 足りません\n"));
    }
}
