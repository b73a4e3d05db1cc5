//! The commands in README.md, README.ja.md, CONTRIBUTING.md and the pages of the book exist, with the options that they show.

use std::process::Command;

use super::{Fault, File, expect_none, file, messages, project};

/// Most lines that README.md, and the same in Japanese, may have.
const README: usize = 150;

/// Documents with commands.
pub(super) fn documents(files: &[File]) -> Vec<&File> {
    let is_page = |path: &str| path.starts_with("docs/book/src/") && path.ends_with(".md");
    let wanted = |path: &str| ["README.md", "README.ja.md", "CONTRIBUTING.md"].contains(&path) || is_page(path);
    files.iter().filter(|file| wanted(&file.path)).collect()
}

/// Commands that start with `program` and that its help does not know. `help` gives the help of a subcommand, or
/// nothing when there is no such subcommand.
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

/// Options in a page that `help` does not know.
fn unknown_options(page: &File, help: &str) -> Vec<Fault> {
    let known = |option: &str| help.split([' ', ',', '=', '\n', '[', ']']).any(|word| word == option);
    let spans = code(page).into_iter().filter(|(_, fenced, text)| !fenced && text.starts_with("--"));
    let options = spans.flat_map(|(line, _, text)| text.split([' ', '=']).map(move |word| (line, word)));
    // A bare `--` is the operator of GLSL.
    let unknown = options.filter(|(_, word)| word.len() > 2 && word.starts_with("--") && !known(word));
    unknown.map(|(line, word)| page.fault(line, format!("there is no option `{word}`"))).collect()
}

/// The commands of a document with their lines, without prompts and comments.
fn commands(document: &File) -> Vec<(usize, &str)> {
    code(document).into_iter().map(|(line, _, text)| (line, command(text))).collect()
}

fn command(text: &str) -> &str {
    text.trim_start_matches("$ ").split(" #").next().unwrap_or_default().trim()
}

/// The code of a document with its lines: lines of fenced blocks (`true`), and code within a line of prose (`false`).
pub(super) fn code(document: &File) -> Vec<(usize, bool, &str)> {
    let mut fenced = false;
    let mut found = Vec::new();
    for (at, line) in document.text.lines().enumerate() {
        let text = line.trim();
        if text.starts_with("```") {
            fenced = !fenced;
        } else if fenced {
            found.push((at + 1, true, text));
        } else {
            found.extend(line.split('`').skip(1).step_by(2).map(|code| (at + 1, false, code)));
        }
    }
    found
}

/// What the program prints, where it succeeds.
fn output_of(words: &[&str]) -> Option<String> {
    let output = Command::new(env!("CARGO_BIN_EXE_shadercheck")).args(words).output().expect("the binary starts");
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// What the program prints as help for these words; nothing when it does not know them.
fn help_of(words: &[&str]) -> Option<String> {
    output_of(&[words, &["--help"]].concat())
}

#[test]
fn the_tasks_of_the_documents_exist() {
    let files = project();
    let usage = &file(&files, "xtask/src/main.rs").text;
    // `cargo xtask check` passes its options to the program.
    let options = help_of(&["check"]).expect("the gate has help");
    let help = |task: &str| {
        let known = usage.lines().any(|line| line.starts_with(&format!("  {task} ")));
        known.then(|| format!("{usage}\n{options}"))
    };
    let unknown = |document: &File| unknown_commands(document, "cargo xtask", &help);
    expect_none(&documents(&files).into_iter().flat_map(unknown).collect::<Vec<_>>());
    for page in ["README.md", "README.ja.md"] {
        let readme = commands(file(&files, page));
        assert!(readme.iter().any(|(_, line)| *line == "cargo xtask check"), "{page} does not show the gate");
        assert!(readme.iter().any(|(_, line)| *line == "cargo xtask test"), "{page} does not show the tests");
    }
}

#[test]
fn the_commands_of_the_documents_exist() {
    let files = project();
    let help = |command: &str| {
        // `--version` and its like are options of the program itself.
        if command.starts_with("--") {
            return help_of(&[]);
        }
        let own = help_of(&[command])?;
        // A command may have commands of its own, with options of theirs.
        let below = own.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
        let below = below.filter_map(|line| help_of(&[command, line.split_whitespace().next()?]));
        Some(below.fold(own.clone(), |all, help| all + &help))
    };
    let documents = documents(&files);
    assert!(documents.len() > 20, "the book has {} pages", documents.len());
    let shown = documents.iter().flat_map(|document| commands(document));
    assert!(shown.filter(|(_, line)| line.starts_with("shadercheck ")).count() > 50, "the book shows no commands");
    let unknown = |document: &File| unknown_commands(document, "shadercheck", &help);
    expect_none(&documents.into_iter().flat_map(unknown).collect::<Vec<_>>());
}

#[test]
fn the_options_in_pages_of_rules_exist() {
    let help = ["lint", "check", "fuzz"].map(|command| help_of(&[command]).expect("the command has help")).concat();
    let list = output_of(&["explain"]).expect("the rules are listed");
    let codes: Vec<&str> = list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(codes.len() > 100, "{list}");
    let mut faults = Vec::new();
    for rule in codes {
        for lang in ["en", "ja"] {
            let page = output_of(&["explain", rule, "--lang", lang]).expect("the rule has a page");
            faults.extend(unknown_options(&File::new(&format!("explain {rule}"), &page), &help));
        }
    }
    expect_none(&faults);
}

#[test]
fn the_options_in_help_texts_exist() {
    let list = help_of(&[]).expect("the program has help");
    let below = list.lines().skip_while(|line| *line != "Every day:").take_while(|line| *line != "Options:");
    let named = below.filter(|line| line.starts_with("  "));
    let commands: Vec<&str> = named.filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() > 8, "{list}");
    let help: String = commands.iter().filter_map(|command| help_of(&[command])).collect();
    assert_eq!(undeclared(&help), [""; 0]);
}

/// Options that a help text speaks of, and that it does not declare at the start of a line.
fn undeclared(help: &str) -> Vec<&str> {
    let options = |line| -> Vec<&str> {
        let words = str::split(line, |c: char| !(c.is_ascii_alphanumeric() || c == '-'));
        words.filter(|word| word.len() > 2 && word.starts_with("--")).collect()
    };
    let declaring = help.lines().filter(|line| line.trim_start().starts_with('-'));
    let declared: Vec<&str> = declaring.filter_map(|line| options(line).first().copied()).collect();
    help.lines().flat_map(options).filter(|option| !declared.contains(option)).collect()
}

#[test]
fn the_readme_is_short() {
    let files = project();
    for page in ["README.md", "README.ja.md"] {
        let lines = file(&files, page).text.lines().count();
        assert!(lines <= README, "{page} has {lines} lines; the limit is {README}: the rest belongs in the book");
    }
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
        assert_eq!(said("run `shadercheck chekc sphere` first\n"), ["`shadercheck` has no command `chekc`"]);
    }

    #[test]
    fn an_option_that_does_not_exist_is_reported() {
        assert_eq!(
            said("```sh\n$ shadercheck check --sed 1 # all\n```\n"),
            ["`shadercheck check` has no option `--sed`"]
        );
        assert_eq!(said("- a list\n  ```sh\n  shadercheck check --sed 1\n  ```\n").len(), 1);
    }

    #[test]
    fn an_option_of_a_page_that_does_not_exist_is_reported() {
        let faults =
            |text: &str| unknown_options(&File::new("explain A001", text), "  --level <LEVEL>\n  --fix\n").len();
        assert_eq!(faults("With `--strict`, it says more; with `--level strict` too, and `--fix` repairs `x--`.\n"), 1);
        assert_eq!(faults("```glsl\n--i;\n```\n"), 0);
    }

    #[test]
    fn an_option_of_a_help_text_that_does_not_exist_is_reported() {
        let help = "  -o, --output <FILE>  With --fix, or --strict\n      --fix\n";
        assert_eq!(undeclared(help), ["--strict"]);
    }

    #[test]
    fn commands_that_exist_and_prose_are_fine() {
        assert!(said("shadercheck is a tool\n```\nshadercheck check --seed=1 [--lane L]\nother --x\n```\n").is_empty());
    }

    #[test]
    fn pages_of_the_book_are_documents_and_other_files_are_not() {
        let paths = [
            "README.md",
            "README.ja.md",
            "docs/book/src/lanes.md",
            "docs/glossary.md",
            "docs/book/book.toml",
            "src/README.md",
        ];
        let files = paths.map(|path| File::new(path, ""));
        let found: Vec<&str> = documents(&files).iter().map(|file| file.path.as_str()).collect();
        assert_eq!(found, ["README.md", "README.ja.md", "docs/book/src/lanes.md"]);
    }
}
