//! The commands in the help of the program, in groups by who needs them.

use std::fmt::Write as _;

use clap::Command;

/// Headings with the commands below each.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Every day", &["lint", "fuzz", "trace", "test", "check", "compare", "lsp", "mcp"]),
    ("Suites", &["init", "mutate", "explain"]),
    ("Numbers", &["improve", "tune", "calibrate", "refdata"]),
    ("Machines", &["lanes", "translate", "torture", "merge", "completions"]),
];

/// The same command line, whose help lists its commands in groups. One that stands in no group is listed last.
pub fn grouped(command: Command) -> Command {
    let named = |name: &str| command.get_subcommands().find(|own| own.get_name() == name && !own.is_hide_set());
    let visible = command.get_subcommands().filter(|own| !own.is_hide_set()).map(Command::get_name);
    let others: Vec<&str> = visible.filter(|name| GROUPS.iter().all(|(_, own)| !own.contains(name))).collect();
    let mut list = String::new();
    for (heading, names) in GROUPS.into_iter().chain([("Others", &others[..])]) {
        let here: Vec<&Command> = names.iter().filter_map(|name| named(name)).collect();
        if here.is_empty() {
            continue;
        }
        let _ = writeln!(list, "{heading}:");
        for own in here {
            let about = own.get_about().map(ToString::to_string).unwrap_or_default();
            let _ = writeln!(list, "  {:<12} {about}", own.get_name());
        }
        list.push('\n');
    }
    let template = format!(
        "{{before-help}}{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{list}Options:\n{{options}}{{after-help}}"
    );
    command.help_template(template)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::CommandFactory as _;

    #[test]
    fn every_command_stands_in_one_group_and_the_short_help_fits_on_a_screen() {
        let help = grouped(Cli::command()).render_help().to_string();
        for own in Cli::command().get_subcommands().filter(|own| !own.is_hide_set()) {
            let line = format!("\n  {:<12} ", own.get_name());
            assert_eq!(help.matches(&line).count(), 1, "{}\n{help}", own.get_name());
        }
        assert!(!help.contains("Others:"), "{help}");
        assert!(help.find("lint") < help.find("torture"), "{help}");
        assert!(help.lines().count() <= 40 && help.lines().all(|line| line.chars().count() <= 100), "{help}");
    }
}
