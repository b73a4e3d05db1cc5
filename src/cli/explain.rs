//! `shadercheck explain`: the page of a rule, or the list of all rules.

use std::io::Write;

use clap::Args;

use crate::cli::LangName;
use crate::cli::status::ExitStatus;
use lint::{RULES, by_code, nearest};
use report::page;
use syntax::errors;

/// Show what a rule of the lint tool means; without a rule, list all
#[derive(Args, Clone, Debug, Default)]
pub struct ExplainArgs {
    /// Code (T001) or name (constructor-too-many-args) of a rule, or `suite` for the keys of suite files
    #[arg(value_name = "RULE")]
    pub code: Option<String>,
    /// Language of the page; LANG decides when it is left out
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
        for (code, line) in errors::ALL {
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
        if let Some((code, line)) = errors::ALL.iter().find(|(c, _)| c.0.eq_ignore_ascii_case(given)) {
            writeln!(out, "{code}  error of the front end: {line}")?;
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
    fn without_a_code_all_rules_are_listed() {
        let (_, out, _) = explain(None);
        assert_eq!(out.lines().count(), RULES.len() + errors::ALL.len());
        assert!(RULES.iter().all(|r| out.contains(r.name)));
    }
}
