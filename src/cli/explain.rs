//! `shadercheck explain`: the page of a rule, or the list of all rules.

use std::io::Write;

use clap::Args;

use crate::cli::LangName;
use crate::cli::status::ExitStatus;
use base::diagnostic::Code;
use lint::{RULES, by_code, nearest};
use report::page;
use syntax::errors;

/// Explain a rule, an error code or a kind of finding; without an argument, list all rules and codes
#[derive(Args, Clone, Debug, Default)]
pub struct ExplainArgs {
    /// Code (T001) or name (constructor-too-many-args) of a rule, code of an error (E020), kind of a finding of `check`
    /// (deviation), or `suite` for the keys of suite files
    #[arg(value_name = "RULE")]
    pub code: Option<String>,
    /// Language of the page [default: from LANG]
    #[arg(long, value_enum)]
    pub lang: Option<LangName>,
}

/// Runs the command: pages go to `out`, complaints to `err`. `color` makes headings bold.
///
/// # Errors
/// When `out` or `err` cannot be written to.
pub fn run(args: &ExplainArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    let lang = super::lang(args.lang);
    let Some(given) = &args.code else {
        let width = RULES.iter().map(|r| r.name.len()).max().unwrap_or(0);
        for rule in RULES {
            writeln!(
                out,
                "{}  {:width$}  {:7}  {}",
                rule.code,
                rule.name,
                rule.severity.name(),
                rule.pages.summary(lang)
            )?;
        }
        for (code, line) in errors::all().chain(BUILDING.iter().copied()) {
            writeln!(out, "{code}  {:width$}  {:7}  {line}", "", "error")?;
        }
        return Ok(ExitStatus::Clean);
    };
    #[cfg(feature = "run")]
    if given.eq_ignore_ascii_case("suite") {
        out.write_all(engine::suite::page().as_bytes())?;
        return Ok(ExitStatus::Clean);
    }
    let Some(rule) = by_code(given) else {
        if let Some(line) = code(given).or_else(|| kind(given)) {
            writeln!(out, "{line}")?;
            return Ok(ExitStatus::Clean);
        }
        let nearest = nearest(given);
        let hint = if nearest.is_empty() { String::new() } else { format!("; did you mean {}?", nearest.join(", ")) };
        writeln!(err, "error: no rule is called `{given}`{hint}")?;
        writeln!(err, "`shadercheck explain` lists all rules")?;
        return Ok(ExitStatus::Error);
    };
    out.write_all(page::markdown(rule, lang, color).as_bytes())?;
    Ok(ExitStatus::Clean)
}

/// Errors of what makes a program of a text, which the linter alone does not have.
#[cfg(feature = "run")]
const BUILDING: &[(Code, &str)] = &[
    (program::UNSUPPORTED, "a construct that cannot be run or translated here"),
    (program::INCOMPLETE, "the shader lacks something that running it needs"),
    (program::NAGA, "naga's parser of WGSL refuses the text"),
    (program::VALIDATOR, "naga's validator refuses the module"),
    (program::COMPILER, "the compiler of a text in HLSL or Slang refuses it"),
];
#[cfg(not(feature = "run"))]
const BUILDING: &[(Code, &str)] = &[];

/// What an error code stands for, and what it rests on.
fn code(given: &str) -> Option<String> {
    let is = |(code, _): &(Code, &str)| code.0.eq_ignore_ascii_case(given);
    if let Some((code, line)) = BUILDING.iter().find(|row| is(row)) {
        return Some(format!("{code}  error of building a program: {line}"));
    }
    let (code, line) = errors::all().find(is)?;
    let rests: Vec<&str> = errors::rests_on(code).words().collect();
    let told = match rests.is_empty() {
        true => "It holds whatever is put around the text.".to_owned(),
        false => format!(
            "It rests on {}. Where the text leaves one of these open, it is reported at `--level strict`.",
            rests.join("; on ")
        ),
    };
    Some(format!("{code}  error of the front end: {line}\n{told}"))
}

/// What a kind of finding of `check` and `fuzz` stands for.
#[cfg(feature = "run")]
fn kind(given: &str) -> Option<String> {
    let about = |of: &str, about: &str, warning: bool| {
        format!("{given}  {} of `shadercheck {of}`: {about}", if warning { "warning" } else { "finding" })
    };
    let of_check = || {
        let kind = engine::suite::run::FindingKind::ALL.into_iter().find(|kind| kind.name() == given);
        let kind = kind.map(|kind| (kind.about(), kind.is_warning()));
        kind.or_else(|| report::check::about(given).map(|line| (line, false)))
    };
    let of_fuzz = || engine::fuzz::FuzzFindingKind::ALL.iter().find(|kind| kind.name() == given);
    let lines: Vec<String> = (of_check().map(|(line, warning)| about("check", line, warning)).into_iter())
        .chain(of_fuzz().map(|kind| about("fuzz", kind.about(), false)))
        .collect();
    (!lines.is_empty()).then(|| lines.join("\n"))
}

#[cfg(not(feature = "run"))]
fn kind(_: &str) -> Option<String> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn explain(code: Option<&str>) -> (ExitStatus, String, String) {
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let args = ExplainArgs { code: code.map(str::to_owned), lang: Some(LangName::En) };
        let status = run(&args, &mut out, &mut err, false).unwrap();
        (status, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
    }

    #[test]
    fn every_page_is_shown_as_it_is_written() {
        for rule in RULES {
            let (status, out, err) = explain(Some(rule.code.0));
            assert_eq!((status, err.as_str()), (ExitStatus::Clean, ""));
            assert_eq!(out, rule.pages.en);
        }
    }

    #[test]
    fn an_unknown_rule_names_the_nearest() {
        for (given, nearest) in [("T0O1", "T001 constructor-too-many-args"), ("acos-domain", "N006 acos-asin-domain")] {
            let (status, out, err) = explain(Some(given));
            assert_eq!((status, out.as_str()), (ExitStatus::Error, ""));
            assert!(err.contains(&format!("`{given}`")) && err.contains(nearest), "{err}");
        }
    }

    #[test]
    fn a_name_gives_the_page_of_its_code() {
        for name in ["acos-asin-domain", "acos_asin_domain", "ACOS-asin-domain"] {
            assert_eq!(explain(Some(name)), explain(Some("N006")));
        }
    }

    #[test]
    fn codes_of_the_front_end_are_known_too() {
        let (status, out, _) = explain(Some("e030"));
        assert_eq!(status, ExitStatus::Clean);
        assert!(out.starts_with("E030"), "{out}");
    }

    #[test]
    #[cfg(feature = "run")]
    fn codes_and_kinds_of_other_reports_are_known_too() {
        for (given, part) in [
            ("E902", "E902  error of building a program: naga's validator"),
            ("deviation", "deviation  finding of `shadercheck check`: Outputs deviate"),
            ("rounded_literal", "rounded_literal  warning of `shadercheck check`"),
            ("lane", "lane  finding of `shadercheck check`: The lane failed."),
        ] {
            let (status, out, _) = explain(Some(given));
            assert_eq!(status, ExitStatus::Clean, "{given}");
            assert!(out.starts_with(part), "{out}");
        }
    }

    #[test]
    fn without_a_code_all_rules_are_listed() {
        let (_, out, _) = explain(None);
        assert_eq!(out.lines().count(), RULES.len() + errors::all().len() + BUILDING.len());
        assert!(RULES.iter().all(|r| out.contains(r.name)));
    }
}
