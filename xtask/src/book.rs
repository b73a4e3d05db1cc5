//! `cargo xtask book`: the book in `docs/book`, with a page for each lint rule, as a web site.

use std::ffi::OsString;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use crate::accuracy;
use crate::cargo::{program, status, workspace};
use crate::folder::copy;
use crate::site;

/// The line of SUMMARY.md below which the pages of the rules are listed.
const RULES: &str = "- [Lint rules](rules.md)\n";

/// The line of SUMMARY.md below which the page of the errors of devices is listed.
const CALIBRATE: &str = "- [Measure a device](calibrate.md)\n";
const ACCURACY: &str = "  - [How exact devices are](accuracy.md)\n";

/// The words of the third column of `shadercheck explain`.
const SEVERITIES: [&str; 3] = ["error", "warning", "info"];

/// A line of `shadercheck explain`.
#[derive(Debug, PartialEq, Eq)]
struct Rule<'a> {
    code: &'a str,
    /// Empty for an error of the front end.
    name: &'a str,
    severity: &'a str,
    summary: &'a str,
}

/// Pages by file name, and their lines in SUMMARY.md.
type Pages = (Vec<(String, String)>, String);

/// Writes the sources of the book and the pages of all rules below the build folder, and runs mdBook on them. Status 2
/// when mdBook is missing.
pub fn run(arguments: &[OsString], messages: &mut dyn Write) -> Result<u8> {
    let workspace = workspace()?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace.join("target"), PathBuf::from);
    let target = std::path::absolute(target)?;
    let program = match arguments {
        [] => program(&target)?,
        [option, program] if option == "--program" => {
            fs::canonicalize(program).with_context(|| format!("cannot find {}", program.display()))?
        }
        _ => bail!("book takes no argument but --program FILE"),
    };
    let folder = target.join("book");
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| format!("cannot remove {}", folder.display()))?;
    }
    // Pages include documents beside the book, by relative paths.
    copy(&workspace.join("docs"), &folder.join("docs"))?;
    fs::copy(workspace.join("ARCHITECTURE.md"), folder.join("ARCHITECTURE.md"))
        .context("cannot copy ARCHITECTURE.md")?;
    let book = folder.join("docs").join("book");
    write(&book.join("src"), pages(&explain(&program, None)?, &|code| explain(&program, Some(code)))?, RULES)?;
    let (page, table) = accuracy::pages(&workspace.join("crates/judge/profiles"))?;
    let files = vec![("accuracy.md".to_owned(), page), ("accuracy.json".to_owned(), table)];
    write(&book.join("src"), (files, ACCURACY.to_owned()), CALIBRATE)?;
    if Command::new("mdbook").arg("--version").output().is_err() {
        writeln!(messages, "xtask: mdBook is missing; to install it: cargo install mdbook --locked")?;
        return Ok(2);
    }
    let site = folder.join("html");
    let failed = status(Command::new("mdbook").arg("build").arg(&book).arg("--dest-dir").arg(&site))?;
    if failed != 0 {
        return Ok(failed);
    }
    let broken = site::broken(&site)?;
    for fault in &broken {
        writeln!(messages, "xtask: {fault}")?;
    }
    writeln!(messages, "xtask: the book is {}", site.join("index.html").display())?;
    Ok(u8::from(!broken.is_empty()))
}

/// What `shadercheck explain` prints about a rule, or the list of all rules.
fn explain(program: &Path, code: Option<&str>) -> Result<String> {
    let output = Command::new(program).arg("explain").args(code).args(["--lang", "en"]).output();
    let output = output.with_context(|| format!("cannot start {}", program.display()))?;
    ensure!(output.status.success(), "`explain` failed: {}", String::from_utf8_lossy(&output.stderr).trim());
    Ok(String::from_utf8(output.stdout)?)
}

/// Adds pages to the sources of the book, and their lines to the table of contents, below the line `above`.
fn write(source: &Path, (pages, lines): Pages, above: &str) -> Result<()> {
    for (name, text) in pages {
        let path = source.join(name);
        fs::create_dir_all(path.parent().unwrap_or(source))?;
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    let summary = source.join("SUMMARY.md");
    let text = fs::read_to_string(&summary).with_context(|| format!("cannot read {}", summary.display()))?;
    Ok(fs::write(&summary, listed(&text, &lines, above)?)?)
}

/// SUMMARY.md with lines below another.
fn listed(summary: &str, lines: &str, above: &str) -> Result<String> {
    let (before, behind) = summary.split_once(above).with_context(|| format!("SUMMARY.md lacks `{}`", above.trim()))?;
    Ok(format!("{before}{above}{lines}{behind}"))
}

/// One page for each rule that has one, and a table of all. `explain` gives the page of a rule.
fn pages(list: &str, explain: &dyn Fn(&str) -> Result<String>) -> Result<Pages> {
    let mut table = "# All rules\n\n| Code | Name | Severity | What |\n|---|---|---|---|\n".to_owned();
    let (mut pages, mut lines) = (Vec::new(), "  - [All rules](rules/all.md)\n".to_owned());
    for line in list.lines() {
        let Rule { code, name, severity, summary } =
            rule(line).with_context(|| format!("`explain` lists what is no rule: {line}"))?;
        let (file, page) = (format!("{name}.md"), explain(code)?);
        let has_page = page.starts_with("# ");
        let shown = if has_page { format!("[{code}]({file})") } else { code.to_owned() };
        table += &format!("| {shown} | {name} | {severity} | {} |\n", summary.replace('|', "\\|"));
        if has_page {
            lines += &format!("  - [{code} {name}](rules/{file})\n");
            pages.push((format!("rules/{file}"), page));
        }
    }
    ensure!(!pages.is_empty(), "`explain` lists no rule");
    pages.push(("rules/all.md".to_owned(), table));
    Ok((pages, lines))
}

fn rule(line: &str) -> Option<Rule<'_>> {
    let (code, rest) = word(line)?;
    let (first, behind) = word(rest)?;
    let (name, severity, summary) = if SEVERITIES.contains(&first) {
        ("", first, behind)
    } else {
        let (severity, summary) = word(behind)?;
        (first, severity, summary)
    };
    SEVERITIES.contains(&severity).then_some(Rule { code, name, severity, summary: summary.trim() })
}

/// The first word, and what stands behind it.
fn word(text: &str) -> Option<(&str, &str)> {
    text.trim_start().split_once(' ')
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str = "\
D001  uninitialised-read  warning  read before it has a value
E001                      error    no `a | b`
";

    #[test]
    fn rules_with_a_name_and_without_one_are_read() {
        let rules: Vec<_> =
            LIST.lines().map(|line| rule(line).unwrap()).map(|r| (r.code, r.name, r.severity)).collect();
        assert_eq!(rules, [("D001", "uninitialised-read", "warning"), ("E001", "", "error")]);
        assert_eq!(rule("D001  uninitialised-read  grave  read"), None);
        assert_eq!(rule(""), None);
    }

    #[test]
    fn rules_with_a_page_are_linked_from_the_table() {
        let explain = |code: &str| -> Result<String> {
            let text = if code == "D001" { "# D001\n" } else { "E001  one line\n" };
            Ok(text.to_owned())
        };
        let (pages, lines) = pages(LIST, &explain).unwrap();
        assert_eq!(pages[0], ("rules/uninitialised-read.md".to_owned(), "# D001\n".to_owned()));
        let table = "| [D001](uninitialised-read.md) | uninitialised-read | warning | read before it has a value |\n\
                     | E001 |  | error | no `a \\| b` |\n";
        assert!(pages[1].1.ends_with(table), "{}", pages[1].1);
        assert_eq!(
            lines,
            "  - [All rules](rules/all.md)\n  - [D001 uninitialised-read](rules/uninitialised-read.md)\n"
        );
    }

    #[test]
    fn a_list_without_rules_is_an_error() {
        assert!(pages("", &|_| Ok(String::new())).is_err());
        assert!(pages("nothing\n", &|_| Ok(String::new())).is_err());
    }

    #[test]
    fn the_summary_of_the_book_lists_the_page_of_the_rules() {
        let listed = listed(include_str!("../../docs/book/src/SUMMARY.md"), "  - [A](rules/a.md)\n", RULES).unwrap();
        assert!(listed.contains("(rules.md)\n  - [A](rules/a.md)\n"));
        assert!(super::listed("# Summary\n", "", RULES).is_err());
    }
}
