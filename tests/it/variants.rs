//! `lint` reads shaders with the options that they state set otherwise.

use std::path::Path;

use tempfile::TempDir;

use crate::binary::{Ran, run_in};

/// A pack: two shaders that share their options and a library. The library is wrong where `GLOW` is on.
const PACK: [(&str, &str); 4] = [
    (
        "shaders/lib/settings.glsl",
        "#define FOG\n//#define GLOW\n#define STEPS 8 // [4 8 16]\n#define TINT 0.5 // [0.0 0.5 1.0]\n",
    ),
    (
        "shaders/lib/light.glsl",
        "vec3 lit(vec3 c) {\n#ifdef GLOW\n  c += glow(c);\n#endif\n#if STEPS > 8\n  c *= 2.0;\n#endif\n  return c * TINT;\n}\n",
    ),
    (
        "shaders/final.fsh",
        "#version 330 core\n#include \"/lib/settings.glsl\"\n#include \"/lib/light.glsl\"\nout vec4 c;\n\
         void main() {\n  c = vec4(lit(vec3(1.0)), 1.0);\n}\n",
    ),
    (
        "shaders/world/fog.fsh",
        "#version 330 core\n#include \"/lib/settings.glsl\"\n#include \"/lib/light.glsl\"\nout vec4 c;\n\
         void main() {\n#ifdef FOG\n  vec3 fog = vec3(0.5);\n#endif\n  c = vec4(lit(fog), 1.0);\n}\n",
    ),
];

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    folder
}

fn lint(folder: &Path, args: &str) -> Ran {
    run_in(folder, &format!("lint --format concise --select E {args}"))
}

fn lines(ran: &Ran) -> Vec<&str> {
    ran.out.lines().collect()
}

#[test]
fn an_option_that_breaks_a_pack_is_told_once_and_where_the_fault_stands() {
    let pack = folder(&PACK);
    let ran = lint(pack.path(), ".").expect(1);
    let found = lines(&ran);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(
        found[0].starts_with("shaders/lib/light.glsl:3:8")
            && found[0].contains("where `GLOW` is defined: function `glow`"),
        "{found:?}"
    );
    assert!(
        found[1].starts_with("shaders/world/fog.fsh:9:16") && found[1].contains("where `FOG` is not defined: `fog`"),
        "{found:?}"
    );
    // The line that makes the difference is shown.
    let whole = run_in(pack.path(), "lint shaders/final.fsh").expect(1).out;
    assert!(whole.contains("shaders/lib/settings.glsl:2:1") && whole.contains("with this line"), "{whole}");
    assert!(lines(&lint(pack.path(), ". --no-variants").expect(0)).is_empty());
    // The same pack in order.
    let light = PACK[1].1.replace("glow(c)", "c * c");
    let fog = PACK[3].1.replace("lit(fog)", "lit(vec3(0.0))");
    let twin = folder(&[PACK[0], (PACK[1].0, &light), PACK[2], (PACK[3].0, &fog)]);
    assert!(lines(&lint(twin.path(), ".").expect(0)).is_empty());
}

#[test]
fn what_a_host_defines_is_stated_on_the_command_line_or_in_the_configuration() {
    let text = "#version 330 core\nout vec4 c;\nvoid main() {\n#if MODE == 1\n  c = vec4(1.0);\n#elif MODE == 2\n  c = fog;\n#else\n  c = vec4(WIDTH);\n#endif\n}\n";
    let shader = folder(&[("a.frag", text)]);
    let told = |args: &str| lint(shader.path(), &format!("a.frag {args}")).out;
    // The name is the host's.
    assert_eq!(told(""), "");
    assert_eq!(told("--define WIDTH=2.0 -D MODE=1"), "");
    assert!(told("--define MODE=2").starts_with("a.frag:7:7"), "{}", told("--define MODE=2"));
    let stated = "[[variant]]\nname = \"MODE\"\nvalues = [\"1\", \"2\"]\n";
    std::fs::write(shader.path().join("shadercheck.toml"), stated).unwrap();
    let found = told("");
    assert!(found.starts_with("a.frag:7:7") && found.contains("where `MODE` is 2: "), "{found}");
    std::fs::write(shader.path().join("shadercheck.toml"), stated.replace(", \"2\"", "")).unwrap();
    assert_eq!(told(""), "");
    let wrong = stated.replace("values", "value");
    std::fs::write(shader.path().join("shadercheck.toml"), wrong).unwrap();
    let ran = lint(shader.path(), "a.frag").expect(2);
    assert!(ran.err.contains("shadercheck.toml:3:1") && ran.err.contains("values"), "{}", ran.err);
}

#[test]
fn stages_in_one_file_are_linted_each_with_what_stands_in_front() {
    let text = "#version 450\n//#define INT_OPS\n#include \"half.inc\"\n#pragma stage vertex\nlayout(location = 0) in vec4 p;\n\
                void main() { gl_Position = p * HALF; }\n#pragma stage fragment\nlayout(location = 0) out vec4 c;\n\
                void main() {\n  c = vec4(HALF);\n#ifdef INT_OPS\n  int r = (int)c.r;\n#endif\n}\n";
    let files =
        [("a.slang", text), ("half.inc", "#define HALF 0.5\n"), ("b.slang", "[shader(\"compute\")]\nvoid main() {}\n")];
    let folder = folder(&files);
    let ran = lint(folder.path(), ".").expect(1);
    let found = lines(&ran);
    assert!(found.len() == 1 && found[0].starts_with("a.slang:12:"), "{found:?}");
    assert!(found[0].contains("where `INT_OPS` is defined: "), "{found:?}");
    assert!(ran.err.contains("b.slang: there are no rules for HLSL and Slang"), "{}", ran.err);
}
