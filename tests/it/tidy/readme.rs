//! The commands in README.md exist, with the options that it shows.

use std::process::Command;

use super::{Fault, File, expect_none, file, messages, project};

/// Commands in fenced blocks that start with `program` and that its help does not know. `help`
/// gives the help of a subcommand, or nothing when there is no such subcommand.
fn unknown_commands(document: &File, program: &str, help: &dyn Fn(&str) -> Option<String>) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (line, command) in commands(document) {
        let Some(rest) = command.strip_prefix(program).and_then(|rest| rest.strip_prefix(' ')) else { continue };
        let mut words = rest.split([' ', '=']).map(|word| word.trim_matches(['[', ']', '.', ',']));
        let subcommand = words.next().unwrap_or_default();
        let Some(help) = help(subcommand) else {
            faults.push(document.fault(line, format!("`{program}` has no command `{subcommand}`")));
            continue;
        };
        let known = |option: &str| help.split([' ', ',', '=', '\n', '[', ']']).any(|word| word == option);
        for option in words.filter(|word| word.starts_with("--") && !known(word)) {
            faults.push(document.fault(line, format!("`{program} {subcommand}` has no option `{option}`")));
        }
    }
    faults
}

/// The lines of fenced blocks, without prompts and comments.
fn commands(document: &File) -> impl Iterator<Item = (usize, &str)> {
    let mut fenced = false;
    document.text.lines().enumerate().filter_map(move |(at, line)| {
        let fence = line.starts_with("```");
        fenced ^= fence;
        let command = line.trim().trim_start_matches("$ ").split(" #").next()?.trim();
        (fenced && !fence).then_some((at + 1, command))
    })
}

#[test]
fn the_tasks_of_the_readme_exist() {
    let files = project();
    let usage = &file(&files, "xtask/src/main.rs").text;
    let readme = file(&files, "README.md");
    let help = |task: &str| {
        let known = usage.lines().any(|line| line.starts_with(&format!("  {task} ")));
        // A task hands its options to the program that it runs.
        let options = readme.text.split_whitespace().filter(|word| word.starts_with("--")).collect::<Vec<_>>();
        known.then(|| options.join(" "))
    };
    expect_none(&unknown_commands(readme, "cargo xtask", &help));
    assert!(commands(readme).any(|(_, line)| line == "cargo xtask check"), "the README does not show the gate");
    assert!(commands(readme).any(|(_, line)| line == "cargo xtask test"), "the README does not show the tests");
}

#[test]
fn the_commands_of_the_readme_exist() {
    let files = project();
    let of = |words: &[&str]| {
        let run = Command::new(env!("CARGO_BIN_EXE_shadercheck")).args(words).arg("--help").output();
        let output = run.expect("the binary starts");
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let help = |command: &str| {
        let own = of(&[command])?;
        // A command may have commands of its own, with options of theirs.
        let below = own.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
        let below = below.filter_map(|line| of(&[command, line.split_whitespace().next()?]));
        Some(below.fold(own.clone(), |all, help| all + &help))
    };
    expect_none(&unknown_commands(file(&files, "README.md"), "shadercheck", &help));
}

#[cfg(test)]
mod planted {
    use super::*;

    fn said(text: &str) -> Vec<String> {
        let help = |command: &str| (command == "check").then(|| "  --seed <S>, -q\n  --lane=<L>".to_owned());
        let faults = unknown_commands(&File::new("README.md", text), "shadercheck", &help);
        messages(&faults).into_iter().map(String::from).collect()
    }

    #[test]
    fn a_command_that_does_not_exist_is_reported() {
        assert_eq!(said("```\nshadercheck chekc sphere\n```\n"), ["`shadercheck` has no command `chekc`"]);
    }

    #[test]
    fn an_option_that_does_not_exist_is_reported() {
        assert_eq!(
            said("```sh\n$ shadercheck check --sed 1 # all\n```\n"),
            ["`shadercheck check` has no option `--sed`"]
        );
    }

    #[test]
    fn commands_that_exist_and_prose_are_fine() {
        assert!(said("shadercheck is a tool\n```\nshadercheck check --seed=1 [--lane L]\nother --x\n```\n").is_empty());
    }
}
