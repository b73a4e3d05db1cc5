//! `check` on a terminal: a table, progress and colours; and the same text as elsewhere with `--plain`.

use std::process::{Command, Stdio};

use test_record::not_run;

use crate::binary::{root, run};

/// What the program writes to a terminal of this width, and its status; `None` without `script`, which makes one.
fn on_terminal(columns: usize, args: &str) -> Option<(String, i32)> {
    let program = env!("CARGO_BIN_EXE_shadercheck");
    let line = format!("stty cols {columns} rows 40; exec {program} {args}");
    let mut script = Command::new("script");
    script.args(["-qec", &line, "/dev/null"]).current_dir(root()).env_remove("NO_COLOR").env("TERM", "xterm-256color");
    let output = script.stdin(Stdio::null()).output();
    let Ok(output) = output else {
        not_run("there is no `script`, which is part of bsdutils on Debian and Ubuntu: terminals");
        return None;
    };
    Some((String::from_utf8_lossy(&output.stdout).into_owned(), output.status.code().unwrap_or(-1)))
}

/// The text without colours and cursor movements, and without what the bar drew: it is the lines that stay.
fn lines(text: &str) -> Vec<String> {
    let mut plain = String::new();
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        if c == '\u{1b}' {
            // A command ends with a letter.
            chars.by_ref().find(char::is_ascii_alphabetic);
        } else if c == '\r' {
            plain.push('\n');
        } else {
            plain.push(c);
        }
    }
    let bar =
        |line: &&str| !line.contains(" samples/s") && !line.trim_start().starts_with('[') && !line.contains(" of ");
    plain.lines().map(str::trim_end).filter(|line| !line.is_empty()).filter(bar).map(str::to_owned).collect()
}

const SUITES: &str = "check sphere hermite hair --samples 64 --lane embedded,vulkan";

#[test]
fn a_terminal_gets_a_table_that_fits_and_progress() {
    for columns in [80, 200] {
        let Some((text, status)) = on_terminal(columns, SUITES) else { return };
        assert_eq!(status, 0, "{text}");
        assert!(text.contains(" samples/s") && text.contains("suite 3 of 3"), "no progress:\n{text}");
        assert!(text.contains("\u{1b}[32m"), "no colours:\n{text}");
        let lines = lines(&text);
        let head = lines.iter().position(|line| line.trim_start().starts_with("vulkan  ")).unwrap();
        let table = &lines[head..][..5];
        assert!(table[0].ends_with("embedded"), "{lines:#?}");
        for (row, suite) in table[2..].iter().zip(["sphere", "hermite", "hair"]) {
            assert!(row.starts_with(suite) && row.matches("ok ").count() == 2, "{row}\n{lines:#?}");
        }
        assert!(table.iter().all(|line| line.chars().count() <= columns.min(100)), "{table:#?}");
        assert!(lines.last().unwrap().starts_with("pass: "), "{lines:#?}");
    }
}

#[test]
fn a_finding_is_reported_below_the_table_in_few_lines() {
    let args = "check sphere --shader fixtures/alarms/sphere_off.vert --samples 64 --lane embedded";
    let Some((text, status)) = on_terminal(100, args) else { return };
    assert_eq!(status, 1, "{text}");
    let lines = lines(&text);
    assert!(lines.iter().any(|line| line.starts_with("sphere  FAIL")), "{lines:#?}");
    let begin = lines.iter().position(|line| line.starts_with("sphere on embedded/compute: ")).unwrap();
    let end = begin + lines[begin..].iter().position(|line| line.starts_with("  reproduce  ")).unwrap();
    assert!(end - begin < 30, "{lines:#?}");
    for label in ["  file  ", "  computed ", "  smallest ", "  formula ", "  lane ", "  off by ", "  fault "] {
        assert!(lines[begin..end].iter().any(|line| line.starts_with(label)), "{label}\n{lines:#?}");
    }
}

#[test]
fn plain_text_is_the_same_on_a_terminal() {
    let Some((text, status)) = on_terminal(80, &format!("{SUITES} --plain")) else { return };
    assert_eq!(status, 0, "{text}");
    assert!(!text.contains('\u{1b}'), "{text:?}");
    assert_eq!(text.replace("\r\n", "\n"), run(SUITES).expect(0).out);
}
