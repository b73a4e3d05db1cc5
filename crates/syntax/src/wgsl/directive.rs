//! Directives of preprocessors that texts in WGSL have, and slips in them.

use base::diagnostic::message;
use base::text::Span;

use super::super::sink::Sink;
use super::super::{errors, names};

/// Those that go on with a condition or end it, and those that go with them.
const COMMON: [&str; 10] = ["if", "ifdef", "ifndef", "else", "elif", "elifdef", "elifndef", "endif", "define", "undef"];

/// What some preprocessors have beside these.
const OTHERS: [&str; 9] = ["include", "import", "export", "elseif", "elsif", "defined", "end", "for", "endfor"];

/// Tells a directive that no preprocessor has and that is like a common one, in a text with conditions. A directive of the host
/// alone stands there more than once, or is like none of them.
pub(super) fn tell_slips(directives: &[Span], sink: &mut Sink) {
    let file = sink.file.clone();
    let is_condition = |at: &Span| COMMON[..8].contains(&file.slice(*at));
    if !directives.iter().any(is_condition) {
        return;
    }
    for &at in directives {
        let word = file.slice(at);
        let plain = word.bytes().all(|b| b.is_ascii_lowercase()) && !COMMON.contains(&word) && !OTHERS.contains(&word);
        if !plain || directives.iter().filter(|other| file.slice(**other) == word).count() > 1 {
            continue;
        }
        // Two letters are as near to many words.
        let Some(near) = names::nearest(word, COMMON.into_iter().filter(|common| common.len() > 2)) else { continue };
        let message = message!("`#{word}` is no directive", "`#{word}` というディレクティブはありません");
        let diagnostic = sink
            .start(errors::UNKNOWN_DIRECTIVE, at, message)
            .with_label(message!("unknown directive", "未知のディレクティブ"))
            .with_help(message!("did you mean `#{near}`?", "`#{near}` のことですか"));
        sink.push(diagnostic);
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Shader;
    use base::text::SourceFile;

    fn told(text: &str) -> Vec<String> {
        let parsed = Shader::parse_wgsl(&SourceFile::new("a.wgsl", text));
        parsed.diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect()
    }

    #[test]
    fn slips_in_directives_are_told_and_directives_of_a_host_are_not() {
        let text = |middle: &str, end: &str| {
            format!("#ifdef WIDE\nconst N = 4u;\n{middle}\nconst N = 2u;\n{end}\nfn f() -> u32 {{ return N; }}\n")
        };
        assert_eq!(told(&text("#els", "#endif")), ["E010 `#els` is no directive"]);
        assert_eq!(told(&text("#else", "#endifx")), ["E010 `#endifx` is no directive"]);
        assert_eq!(told(&text("#else", "#endif").replace("ifdef", "ifdfe")), ["E010 `#ifdfe` is no directive"]);
        for right in [
            text("#else", "#endif"),
            text("#else", "#end"),
            text("#elseif TALL", "#endif"),
            text("#bind group", "#endif"),
            text("#els", "#endif").repeat(2),
            text("#ELS", "#endif"),
            "#ifdfe\nconst N = 4u;\n".to_owned(),
        ] {
            assert_eq!(told(&right), [""; 0], "{right}");
        }
    }
}
