//! Shaders that the language refuses are refused by every command before anything runs, also where the fault is in code
//! that nothing uses, and with the diagnostics of `lint`.

use std::fs;

use crate::binary::run_in;

/// Text before a fault and behind it, and what the fault is in.
const UNUSED: [(&str, &str, &str); 2] =
    [("", "\n", "file scope"), ("float helper(float x) { ", " return x; }\n", "a function that nothing calls")];

/// A fault, and the code and the message of its diagnostic.
const FAULTS: [(&str, &str); 6] = [
    ("int z = vec3(1, 2, 3, 4);", "T001"),
    ("float z = float(1.0, 2.0);", "T001"),
    ("mat2 z = mat2(1, 2, 3, 4, 5);", "T001"),
    ("int z = vec3(1, 2, 3);", "E030"),
    ("vec3 z = vec3(1.0, 2.0);", "T002"),
    ("void z[3];", "E023"),
];

#[test]
fn every_command_refuses_what_the_language_refuses() {
    for (before, behind, place) in UNUSED {
        for (fault, code) in FAULTS {
            let folder = tempfile::tempdir().unwrap();
            let head = format!("#version 330\nin vec3 p;\n{before}");
            let text = format!("{head}{fault}{behind}void main() {{ gl_Position = vec4(p, 1.0); }}\n");
            fs::write(folder.path().join("a.vert"), &text).unwrap();
            let suite = "suite = \"a\"\ntitle = \"A\"\nshader = \"a.vert\"\nstage = \"vertex\"\nsamples = 64\n\
                         [[inputs]]\nnames = [\"p\"]\ngenerator = \"interval\"\nrange = [0.0, 1.0]\n";
            fs::write(folder.path().join("a.suite.toml"), suite).unwrap();
            let lint = run_in(folder.path(), "lint a.vert").expect(1);
            let reported = format!("error[{}]", lint::with_name(code));
            assert!(lint.out.contains(&reported), "{place}: {fault}\n{}", lint.out);
            let at = lint.out.lines().skip_while(|line| !line.contains(&reported)).nth(1).unwrap().trim().to_owned();
            assert!(at.starts_with("--> a.vert:3:"), "{at}");
            let message = lint.out.lines().find(|line| line.contains(&reported)).unwrap();
            for (command, status) in [
                ("check a.suite.toml --lane embedded", 1),
                ("translate a.vert --to wgsl", 1),
                ("fuzz a.vert --lane embedded", 1),
                ("mutate a.suite.toml --lane embedded", 2),
            ] {
                let ran = run_in(folder.path(), command).expect(status);
                let all = format!("{}{}", ran.out, ran.err);
                assert!(all.contains(message) && all.contains(&at), "{command}, {place}: {fault}\n{all}");
                assert!(!all.contains(" agreed") || all.contains(" 0 agreed"), "something ran: {all}");
            }
            // The twin: the same text without the fault.
            fs::write(folder.path().join("a.vert"), text.replace(fault, "float z = 1.0;")).unwrap();
            run_in(folder.path(), "check a.suite.toml --lane embedded").expect(0);
            run_in(folder.path(), "translate a.vert --to wgsl").expect(0);
        }
    }
}

#[test]
fn translate_goes_on_where_it_is_reported_to() {
    let folder = tempfile::tempdir().unwrap();
    let text = "#version 330\nin vec3 p;\nint z = vec3(1, 2, 3, 4);\nvoid main() { gl_Position = vec4(p, 1.0); }\n";
    fs::write(folder.path().join("a.vert"), text).unwrap();
    let ran = run_in(folder.path(), "translate a.vert --to wgsl").expect(1);
    assert!(ran.out.is_empty() && ran.err.contains("--lenient"), "{ran:?}");
    let ran = run_in(folder.path(), "translate a.vert --to wgsl --lenient").expect(0);
    assert!(ran.out.contains("fn main") && ran.err.contains("error[T001 constructor-too-many-args]"), "{ran:?}");
    // What cannot be translated is refused all the same.
    fs::write(folder.path().join("a.vert"), text.replace("vec4(p, 1.0)", "vec4(q, 1.0)")).unwrap();
    let ran = run_in(folder.path(), "translate a.vert --to wgsl --lenient").expect(1);
    assert!(ran.out.is_empty() && ran.err.contains("`q`"), "{ran:?}");
}
