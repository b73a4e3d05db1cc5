//! Comments that silence, those that do not, and those that are told.

use crate::fix::fix;
use crate::{Input, Level, Selection, Settings, by_code, run, run_with};
use base::diagnostic::Safety;
use base::text::SourceFile;

fn shader(body: &str) -> Vec<Input> {
    let text = format!("#version 150 core\nin float turn;\nvoid main()\n{{\n{body}\n  gl_Position = vec4(th);\n}}\n");
    vec![Input::new(SourceFile::new("a.vert", text))]
}

#[track_caller]
fn reported(body: &str, expected: &[&str]) {
    let found = run(&shader(body));
    assert_eq!(found.iter().map(|d| d.code.0).collect::<Vec<_>>(), expected, "{body}\n{found:#?}");
}

const LITERAL: &str = "  float th = 6.283185 * turn;";

#[test]
fn the_same_line_and_the_line_before_are_silenced() {
    reported(LITERAL, &["N014"]);
    reported(&format!("{LITERAL} // shadercheck: ignore[N014]"), &[]);
    reported(&format!("{LITERAL} /* shadercheck: ignore[N014] as told */"), &[]);
    reported(&format!("  /* shadercheck: ignore[N014] */{LITERAL}"), &[]);
    reported(&format!("  // shadercheck: ignore[N014] reason\n{LITERAL}"), &[]);
    reported(&format!("  /*\n   * shadercheck: ignore[N014] reason\n   */\n{LITERAL}"), &[]);
    reported(&format!("  //shadercheck:ignore [ n014 ]\n{LITERAL}"), &[]);
}

#[test]
fn comments_may_be_stacked_above_the_line() {
    let above = "  // shadercheck: ignore[N014] digits of the source\n  // the angle\n\n";
    reported(&format!("{above}{LITERAL}"), &[]);
}

#[test]
fn other_lines_and_other_codes_are_reported() {
    reported(&format!("  // shadercheck: ignore[N014]\n  float a = turn;\n{LITERAL}\n  th += a;"), &["X001", "N014"]);
    reported(&format!("  float a = turn; // shadercheck: ignore[N014]\n{LITERAL}\n  th += a;"), &["X001", "N014"]);
    reported(&format!("{LITERAL} // shadercheck: ignore[T001]"), &["N014", "X001"]);
    reported(&format!("{LITERAL} // see shadercheck: ignore[N014]"), &["N014"]);
}

#[test]
fn a_whole_file_is_silenced_from_anywhere() {
    reported(&format!("{LITERAL}\n  th *= 6.283185;\n  // shadercheck: ignore-file[N014] given digits"), &[]);
}

#[test]
fn a_rule_is_silenced_by_its_name_as_by_its_code() {
    for rule in ["N014", "n014", "low-precision-pi", "Low_Precision_Pi"] {
        reported(&format!("{LITERAL} // shadercheck: ignore[{rule}] digits of the data sheet"), &[]);
        reported(&format!("  // shadercheck: ignore-file[{rule}]\n{LITERAL}"), &[]);
    }
}

#[test]
fn errors_of_the_front_end_are_silenced_by_their_codes() {
    reported("  float th = turn + nowhere;", &["E020"]);
    reported("  float th = turn + nowhere; // shadercheck: ignore[E020] a macro of the loader", &[]);
}

#[test]
fn host_code_has_the_same_comments() {
    let example = by_code("H003").unwrap().pages.bad();
    let files = |comment: &str| {
        let above = |text: &str| text.replace("\n  glUniform", &format!("\n  {comment}\n  glUniform"));
        example.iter().map(|e| Input::new(SourceFile::new(e.name, above(e.text)))).collect::<Vec<_>>()
    };
    let codes = |comment: &str| run(&files(comment)).iter().map(|d| d.code.0).collect::<Vec<_>>();
    let plain = codes("");
    assert_eq!(plain.len(), 1, "{plain:?}");
    assert!(codes(&format!("// shadercheck: ignore[{}] tried on purpose", plain[0])).is_empty());
    assert!(codes(&format!("/* shadercheck: ignore[{}] */", plain[0])).is_empty());
    assert_eq!(codes(&format!("const char* s = \"// shadercheck: ignore[{}]\";", plain[0])), plain, "a string");
}

#[test]
fn what_cannot_be_read_is_reported_with_its_place() {
    for (comment, message) in [
        ("shadercheck: ignore", "names no rule"),
        ("shadercheck: ignore[]", "names no rule"),
        ("shadercheck: ignore N014", "names no rule"),
        ("shadercheck: ignore[N014", "not closed"),
        ("shadercheck: ignroe[N014]", "`ignroe`"),
        ("shadercheck: ignore[N999]", "`N999`"),
        ("shadercheck: ignore[N]", "`N`"),
        ("shadercheck:", "says nothing"),
    ] {
        let found = run(&shader(&format!("  float th = turn; // {comment}")));
        assert_eq!(found.len(), 1, "{comment}: {found:#?}");
        assert_eq!(found[0].code.0, "X002");
        assert!(found[0].message.contains(message), "{comment}: {}", found[0].message);
        assert!(found[0].file.slice(found[0].span).len() <= comment.len());
    }
    let found = run(&shader("  float th = turn; // shadercheck: ignore[low-precission-pi]"));
    assert_eq!(found[0].file.slice(found[0].span), "low-precission-pi");
    let help = found[0].help.as_ref().unwrap();
    assert!(help.contains("did you mean N014 low-precision-pi"), "{help}");
}

#[test]
fn a_code_of_a_rule_that_did_not_run_is_not_called_unused() {
    let files = shader("  float th = turn; // shadercheck: ignore[N014]");
    let with = |select: &[&str], ignore: &[&str]| {
        let own = |l: &[&str]| l.iter().map(|&s| s.to_owned()).collect::<Vec<_>>();
        let selection = Selection::new(&own(select), &own(ignore)).unwrap().at(Level::Default);
        run_with(&files, &Settings { selection, ..Settings::default() }).len()
    };
    assert_eq!(with(&[], &[]), 1);
    assert_eq!(with(&[], &["N014"]), 0, "the rule did not run");
    assert_eq!(with(&["X"], &[]), 0, "only X ran");
    assert_eq!(with(&["X", "N"], &[]), 1);
}

#[test]
fn what_is_silenced_is_not_fixed_and_unused_codes_leave_the_list() {
    let fixed = |body: &str, safety| {
        let outcome = fix(&shader(body), &Settings::default(), safety);
        assert!(outcome.remaining.is_empty() || safety == Safety::Safe, "{:#?}", outcome.remaining);
        outcome.files.first().map(|f| f.after.line_text(5).to_owned())
    };
    let silenced = format!("{LITERAL} // shadercheck: ignore[N014]");
    assert_eq!(fixed(&silenced, Safety::Unsafe), None);
    let both = format!("{LITERAL} // shadercheck: ignore[T001, N014] x");
    assert_eq!(fixed(&both, Safety::Unsafe).unwrap(), format!("{LITERAL} // shadercheck: ignore[N014] x"));
    assert_eq!(fixed("  float th = turn; /* shadercheck: ignore[N014] */", Safety::Safe), None);
    assert_eq!(fixed("  float th = turn; // shadercheck: ignore[N014]", Safety::Unsafe).unwrap(), "  float th = turn;");
    assert_eq!(
        fixed("  /* shadercheck: ignore[N014] */ float th = turn;", Safety::Unsafe).unwrap(),
        "  float th = turn;"
    );
    let named = format!("{LITERAL} // shadercheck: ignore[low-precision-pi, Integer_Division_Literal]");
    assert_eq!(fixed(&named, Safety::Unsafe).unwrap(), format!("{LITERAL} // shadercheck: ignore[low-precision-pi]"));
}

#[test]
fn comments_that_state_domains_are_left_alone() {
    for hint in ["turn in [0, 1], normalised n", "t > 0", "nonzero v", "n normalised"] {
        reported(&format!("  // shadercheck: {hint}\n{LITERAL}"), &["N014"]);
    }
    reported(&format!("  // shadercheck: ignored in [0, 1]\n{LITERAL}"), &["X002", "N014"]);
}
