//! Set-up, gate, tests and benchmarks of shadercheck: `cargo xtask`.

mod accuracy;
mod against;
mod book;
mod cargo;
mod editor;
mod features;
mod folder;
mod host;
mod not_run;
mod opengl;
mod package;
mod repository;
mod setup;
mod site;
#[cfg(unix)]
mod slurm;
mod snapshots;
mod tasks;
mod vulkan;
mod web;

use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

use anyhow::Result;

const USAGE: &str = "\
usage: cargo xtask <task> [arguments]

  check [ARGS]...   build, set the machine up, then run the gate: `shadercheck check ARGS`; without any, the lane
                    `vulkan` gives its verdict first, and then all lanes run
  test [--install] [ARGS]...
                    set the machine up, then run the whole suite of tests; ARGS go to the test runner
                    (without any, documentation tests and the checks of `tidy` run as well); tests that
                    are left out because something is not installed are listed; --install installs what they need
                    (Chromium, Node, Python, validators), and where it could, a test that is left out fails
  tidy              tests of the project's own structure, unreferenced snapshots, shared builds
  bench [ARGS]...   set the machine up, then print how fast gate and linter are; with --against-script
                    [--samples N] [--rounds N] [--program FILE], beside a test written by hand with
                    moderngl and numpy, in a Python environment that is thrown away
  book [--program FILE]
                    write the book in docs/book with a page for each lint rule and one of the errors of devices, and make a web
                    site of it with mdBook, in target/book/html, whose links are checked; --program takes the rules from FILE and builds nothing
  editor [--program FILE]
                    build the extension for VS Code, test it with the program, and package it; needs npm
  package [--program FILE] [--lint] [--papers FOLDER] [archive] [deb] [npm] [wheel]
                    build the program as it is released, and packages of it in target/package/out: archive with completions,
                    manual, licences and bill of materials, Debian package, npm packages, Python wheel; install each
                    into an empty folder and lint a shader with it; --program packages FILE, --lint builds the linter
                    alone; formats that are named are made, or else all whose tools are installed; --papers writes what
                    comes with the program to FOLDER, and packages nothing
  web [--test] [--program FILE]
                    build the program for WebAssembly and the page that runs it in a browser, in target/web/page; --test
                    compares it with the program of this machine, or FILE, and tries the page in Chromium; needs npm, and
                    a compiler for the web, which it names where there is none
  repository [ADDRESS]
                    check that the files say where the project is; write ADDRESS, such as https://github.com/NAME/shadercheck,
                    into all that name it
  soundness [--samples N] [--seed N] [SUITE.toml...]
                    judge devices that err as far as they may, 100 million samples unless told
                    otherwise, on suite files that are named or the chapter's; status 1 when one of them is accused
  survey FOLDER... [--list REASON] [--every N] [--run] [--vulkan] [--translate]
                    how many shaders of some folders reach a valid module, by version and stage, and what
                    stops the others; --list names the files that REASON stops, --every takes one
                    file in N, --run runs what is valid, --vulkan takes shaders for Vulkan too,
                    --translate tells how many are translated to each language, accepted by its
                    validator, and mean the same there
  piglit FOLDER... [--list REASON] [--every N]
                    how many of piglit's generated tests (built-in-functions/vs-*, gs-*, fs-* and
                    cs-*.shader_test, below some folders) agree with the interpreter and with lane vulkan; --list names the
                    tests that REASON stops, or that disagree
  slurm-demo [--samples N] [--suite NAME] [--lane NAME] [--builtin NAME] [--program FILE]
                    start a throw-away Slurm cluster of two nodes on this machine, check a suite in shards on
                    100 million samples unless told otherwise, kill a shard on the way, sweep a built-in over
                    all of binary32 (not with --builtin none), and compare both with the single run; needs slurm-wlm and
                    munge

Set-up means a Vulkan driver: where none is found, lavapipe is installed with apt-get when this user
may do that without a password. SHADERCHECK_NO_INSTALL=1 forbids it.
";

fn main() -> ExitCode {
    let mut messages = io::stderr();
    let code = run(std::env::args_os().skip(1).collect(), &mut messages).unwrap_or_else(|error| {
        // Nothing is left to be done when standard error is closed.
        let _ = writeln!(messages, "xtask: {error:#}");
        2
    });
    ExitCode::from(code)
}

fn run(arguments: Vec<OsString>, messages: &mut dyn Write) -> Result<u8> {
    let mut arguments = arguments.into_iter();
    let task = arguments.next();
    let rest: Vec<OsString> = arguments.collect();
    match task.as_ref().and_then(|t| t.to_str()) {
        // Arguments of the others go on to a program that has a help of its own.
        Some(
            "tidy" | "book" | "editor" | "package" | "repository" | "soundness" | "survey" | "piglit" | "slurm-demo"
            | "web",
        ) if rest.iter().any(|a| a == "--help" || a == "-h") => {
            io::stdout().write_all(USAGE.as_bytes())?;
            Ok(0)
        }
        Some("check") => tasks::check(&rest, messages),
        Some("test") => tasks::test(&rest, messages),
        Some("tidy") if rest.is_empty() => tasks::tidy(messages),
        Some("bench") => tasks::bench(&rest, messages),
        Some("book") => book::run(&rest, messages),
        Some("editor") => editor::run(&rest, messages),
        Some("package") => package::run(&rest, messages),
        Some("web") => web::run(&rest, messages),
        Some("repository") => repository::run(&rest, messages),
        Some("soundness") => tasks::soundness(&rest),
        #[cfg(unix)]
        Some("slurm-demo") => slurm::run(&rest, messages),
        Some("survey") if !rest.is_empty() => tasks::survey(&rest),
        Some("piglit") if !rest.is_empty() => tasks::piglit(&rest, messages),
        Some("help" | "--help" | "-h") => {
            io::stdout().write_all(USAGE.as_bytes())?;
            Ok(0)
        }
        _ => {
            if let Some(task) = task {
                writeln!(messages, "xtask: cannot run `{}`", [vec![task], rest].concat().join(" ".as_ref()).display())?;
            }
            messages.write_all(USAGE.as_bytes())?;
            Ok(2)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(arguments: &[&str]) -> String {
        let mut messages = Vec::new();
        let code = run(arguments.iter().map(OsString::from).collect(), &mut messages).unwrap();
        assert_eq!(code, 2);
        String::from_utf8(messages).unwrap()
    }

    #[test]
    fn no_task_gives_usage_and_status_2() {
        assert!(refused(&[]).starts_with("usage: cargo xtask"));
    }

    #[test]
    fn an_unknown_task_is_named() {
        assert!(refused(&["chekc", "sphere"]).starts_with("xtask: cannot run `chekc sphere`\nusage:"));
    }

    #[test]
    fn tidy_takes_no_arguments() {
        assert!(refused(&["tidy", "src"]).starts_with("xtask: cannot run `tidy src`"));
    }

    #[test]
    fn usage_names_every_task() {
        for task in [
            "check",
            "test",
            "tidy",
            "bench",
            "book",
            "editor",
            "package",
            "repository",
            "soundness",
            "survey",
            "piglit",
            "slurm-demo",
        ] {
            assert!(USAGE.lines().any(|l| l.starts_with(&format!("  {task} "))), "{task}");
        }
    }
}
