//! Several functions in one suite: each is a variant with a name of its own.

use super::{check, finding, folder};
use crate::binary::{command, run_in, run_reported};

const SHADER: &str = "float twice(float x) { return 2.0 * x; }\n\
    float sum(float x, float y) { return x + y; }\nfloat last(float y) { return y * STEP; }\n";
const SUITE: &str = "suite = \"own\"\nshader = \"f.glsl\"\nstage = \"function\"\n\
    entry = [\"twice\", \"sum\", \"last\"]\nreference = \"r.glsl\"\ndefines = { STEP = [1.0, 3.0] }\nsamples = 512\n\
    [[inputs]]\nnames = [\"x\"]\ngenerator = \"interval\"\nrange = [-2.0, 2.0]\n\
    [[inputs]]\nnames = [\"y\"]\ngenerator = \"interval\"\nrange = [0.0, 2.0]\n";

#[test]
fn each_function_takes_its_own_inputs_and_its_own_reference() {
    let ran = check(&[("f.glsl", SHADER), ("r.glsl", SHADER), ("f.suite.toml", SUITE)], &[]).expect(0);
    let names: Vec<&str> =
        ran.out.lines().filter(|l| l.starts_with("ok ")).map(|l| l.split_whitespace().nth(1).unwrap()).collect();
    assert_eq!(
        names,
        [
            "own[twice,STEP=1.0]",
            "own[twice,STEP=3.0]",
            "own[sum,STEP=1.0]",
            "own[sum,STEP=3.0]",
            "own[last,STEP=1.0]",
            "own[last,STEP=3.0]"
        ]
    );
    let wrong = SHADER.replace("x + y", "x - y");
    let files = [("f.glsl", &*wrong), ("r.glsl", SHADER), ("f.suite.toml", SUITE)];
    let ran = check(&files, &[]).expect(1);
    assert_eq!(finding(&ran).1, ["float x = 0.0", "float y = 1.0"]);
    assert_eq!(ran.out.lines().filter(|l| l.starts_with("FAIL ")).count(), 2, "{}", ran.out);
    let line = ran.out.lines().find_map(|line| line.strip_prefix("  reproduce  ")).unwrap();
    assert!(line.contains("'./f.suite.toml[sum,STEP=1.0]'"), "{line}");
    run_reported(folder(&files).path(), line, &[]).expect(1);
}

#[test]
fn lists_that_are_wrong_are_reported_at_their_place() {
    for (entry, reported) in [
        ("[\"twice\", \"twice\"]", "f.suite.toml:4:19: `twice` stands twice in `entry`"),
        ("[]", "f.suite.toml:4:9: `entry` names no function"),
        ("[1]", "f.suite.toml:4:"),
    ] {
        let text = SUITE.replace("[\"twice\", \"sum\", \"last\"]", entry);
        let ran = check(&[("f.glsl", SHADER), ("r.glsl", SHADER), ("f.suite.toml", &text)], &[]).expect(2);
        assert!(ran.err.contains(reported), "{reported}\n{}", ran.err);
    }
    // A group for no parameter at all leaves the parameter without values.
    let text = SUITE.replace("names = [\"y\"]", "names = [\"z\"]");
    let ran = check(&[("f.glsl", SHADER), ("r.glsl", SHADER), ("f.suite.toml", &text)], &[]).expect(2);
    assert!(format!("{}{}", ran.out, ran.err).contains("`y`"), "{ran:?}");
}

#[test]
fn a_first_suite_is_not_written_for_what_a_list_names() {
    let shader = SHADER.replace("STEP", "3.0");
    let folder = folder(&[("f.glsl", &*shader), ("r.glsl", ""), ("f.suite.toml", SUITE)]);
    let ran: crate::binary::Ran = command(folder.path(), "init").output().unwrap().into();
    assert!(ran.err.contains("`sum` of f.glsl has a suite already"), "{ran:?}");
    run_in(folder.path(), "explain suite").expect(0);
}
