//! `github`: commands of GitHub Actions that put findings beside the lines of a change.
//! <https://docs.github.com/actions/reference/workflow-commands-for-github-actions>

use crate::actions::{data, property};
use base::diagnostic::{Diagnostic, Severity};
use lint::with_name;

use super::{Context, Format};

/// The format.
pub const FORMAT: Format = Format { name: "github", summary: "Annotations of GitHub Actions", write };

fn write(found: &[Diagnostic], context: &Context) -> String {
    found.iter().map(|d| command(d, context)).collect()
}

fn command(d: &Diagnostic, context: &Context) -> String {
    let kind = match d.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Info => "notice",
    };
    let (from, to) = (d.file.position(d.span.start), d.file.position(d.span.end));
    let file = property(context.path(d.file.name()));
    let title = property(&with_name(d.code.0));
    // Columns are shown for one line alone.
    let end = if from.line == to.line && to.column > from.column {
        format!(",endColumn={}", to.column - 1)
    } else {
        String::new()
    };
    let parts = [Some(&d.message), d.why.as_ref(), d.help.as_ref()];
    let message: Vec<&str> = parts.into_iter().flatten().map(|part| part.in_lang(context.lang)).collect();
    let message = data(&message.join("\n"));
    format!(
        "::{kind} file={file},line={},endLine={},col={}{end},title={title}::{message}\n",
        from.line, to.line, from.column
    )
}

#[cfg(test)]
mod tests {
    use super::super::testing::sample;
    use super::*;

    #[test]
    fn what_the_runner_would_read_as_its_own_is_escaped() {
        let mut found = sample();
        found.file = base::text::SourceFile::new("a,b:c%.vert", found.file.text());
        assert_eq!(
            write(&[found], &Context::default()),
            "::error file=a%2Cb%3Ac%25.vert,line=2,endLine=2,col=21,endColumn=24,title=T001 constructor-too-many-args::too few, or: 100%25%0Aof it%0Abecause%0Ado something\n"
        );
    }
}
