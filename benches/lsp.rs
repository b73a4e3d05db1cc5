//! From a key to what is found: types an edit script into a shader of 2,000 lines, in a workspace of 200 files, over the
//! real transport of the real binary. Goals: 50 ms for 95 of 100 keys, and 300 MB.
//!
//! `cargo bench --bench lsp`

#[expect(dead_code, reason = "tests use more of it")]
#[path = "../tests/it/binary.rs"]
mod binary;
#[expect(dead_code, reason = "tests use more of it")]
#[path = "../tests/it/lsp/client.rs"]
mod client;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::time::{Duration, Instant};

use client::Client;

/// Lines of the shader that is typed into.
const LINES: usize = 2_000;
/// Files of the workspace, that one and its program included.
const FILES: usize = 200;
/// Between two keys: a fast typist.
const PAUSE: Duration = Duration::from_millis(80);
/// Behind a statement: the next key comes while all files are linted.
const THOUGHT: Duration = Duration::from_millis(540);

/// A fragment shader of many functions, and a `main` that calls them all.
fn shader(functions: usize, seed: usize) -> String {
    let mut text = "#version 330 core\nuniform vec3 lamp;\nuniform mat4 view;\nuniform float shininess;\nin vec3 place;\nin vec3 normal;\nout vec4 color;\n\n".to_owned();
    for n in 0..functions {
        let k = (n * 7 + seed) % 13;
        let _ = write!(
            text,
            "// Light number {n}.\nvec3 light{n}(vec3 at, vec3 n)\n{{\n  vec3 toward = lamp - at * {k}.5;\n  float far = max(length(toward), 0.001);\n  vec3 l = toward / far;\n  float lit = max(dot(n, l), 0.0);\n  if (lit > 0.5)\n    lit = mix(lit, 1.0, smoothstep(0.5, 1.0, lit));\n  for (int i = 0; i < 4; ++i)\n    lit += 0.1 * exp(-far * float(i));\n  return vec3(lit) * float({k});\n}}\n\n"
        );
    }
    text.push_str("void main()\n{\n  vec3 n = normalize(normal + vec3(0.0, 0.0, 0.001));\n  vec3 sum = vec3(0.0);\n");
    for n in 0..functions {
        let _ = writeln!(text, "  sum += light{n}(place, n);");
    }
    text.push_str("  color = vec4(sum, 1.0);\n}\n");
    text
}

const VERTEX: &str = "#version 330 core\nuniform mat4 view;\nuniform mat4 projection;\nlayout(location = 0) in vec3 position;\nlayout(location = 1) in vec3 direction;\nout vec3 place;\nout vec3 normal;\nvoid main()\n{\n  vec4 eye = view * vec4(position, 1.0);\n  place = eye.xyz;\n  normal = mat3(view) * direction;\n  gl_Position = projection * eye;\n}\n";

fn workspace(folder: &Path) {
    let host = |name: &str| {
        format!(
            "void draw_{name}(const float *m)\n{{\n  GLuint p = load(\"{name}.vert\", \"{name}.frag\");\n  glUniformMatrix4fv(glGetUniformLocation(p, \"view\"), 1, GL_FALSE, m);\n  glUniformMatrix4fv(glGetUniformLocation(p, \"projection\"), 1, GL_FALSE, m);\n  glUniform3fv(glGetUniformLocation(p, \"lamp\"), 1, m);\n}}\n"
        )
    };
    // Each function takes 14 lines and one in `main`.
    let functions = |lines: usize| (lines - 14) / 15;
    for program in 0..FILES / 4 {
        let name = format!("p{program}");
        let lines = if program == 0 { LINES } else { 120 + program };
        let write = |ending: &str, text: &str| std::fs::write(folder.join(format!("{name}.{ending}")), text).unwrap();
        write("vert", VERTEX);
        write("frag", &shader(functions(lines), program));
        write("cpp", &host(&name));
        write("h", &format!("void draw_{name}(const float *m);\n"));
    }
}

fn main() {
    let folder = tempfile::tempdir().unwrap();
    workspace(folder.path());
    let text = std::fs::read_to_string(folder.path().join("p0.frag")).unwrap();
    let mut client = Client::new(folder.path());
    client.open("p0.frag");
    client.open("p0.cpp");
    client.until(|m| m["params"]["uri"].as_str().is_some_and(|u| u.ends_with("p0.cpp")));
    std::thread::sleep(Duration::from_secs(3));
    // A new statement is written in several functions, with slips that are taken back: brackets are open and names are
    // unknown meanwhile.
    let script = "vec3 halfway = normalize(l + n);\u{8}\u{8}\u{8}\u{8} n + 0.001);\n  lit += pow(max(dot(n, halfway), 0.0), shininess;\u{8});\n";
    let (mut times, mut version) = (Vec::new(), 1);
    for function in [3, 40, 90] {
        let at = text.find(&format!("vec3 light{function}(")).unwrap();
        let return_at = at + text[at..].find("  return").unwrap();
        let line = text[..return_at].matches('\n').count() + times.len() / 1000;
        let (mut line, mut column) = (line as u32 + 2 * u32::from(function > 3) + 2 * u32::from(function > 40), 0);
        for key in script.chars() {
            version += 1;
            let began = Instant::now();
            match key {
                '\u{8}' => {
                    client.change("p0.frag", version, [line, column - 1, line, column], "");
                    column -= 1;
                }
                key => {
                    client.change("p0.frag", version, [line, column, line, column], key.encode_utf8(&mut [0; 4]));
                    (line, column) = if key == '\n' { (line + 1, 0) } else { (line, column + 1) };
                }
            }
            let uri = client.uri("p0.frag");
            client.until(|m| m["params"]["uri"] == uri.as_str() && m["params"]["version"].as_i64() >= Some(version));
            times.push(began.elapsed());
            std::thread::sleep(if key == ';' { THOUGHT } else { PAUSE });
        }
    }
    report(&mut times, &client);
    // What was typed compiles: nothing was left out.
    assert_eq!(client.shown[&client.uri("p0.frag")], Vec::<serde_json::Value>::new());
    assert_eq!(client.end(), Some(0));
}

fn report(times: &mut [Duration], client: &Client) {
    times.sort();
    let ms = |t: Duration| t.as_secs_f64() * 1e3;
    let part = |p: usize| ms(times[(times.len() * p / 100).min(times.len() - 1)]);
    let mut out = format!("{} keys into {LINES} lines, {FILES} files\n", times.len());
    for (from, to) in [
        (0, 5),
        (5, 10),
        (10, 15),
        (15, 20),
        (20, 30),
        (30, 40),
        (40, 50),
        (50, 75),
        (75, 100),
        (100, 200),
        (200, 100_000),
    ] {
        let count = times.iter().filter(|t| ms(**t) >= f64::from(from) && ms(**t) < f64::from(to)).count();
        let bar = "#".repeat(count * 60 / times.len());
        let range = if to == 100_000 { format!("{from:>3} ms …    ") } else { format!("{from:>3} – {to:>3} ms") };
        let _ = writeln!(out, "{range} {count:>4} {bar}");
    }
    let _ = writeln!(
        out,
        "p50 {:.1} ms, p95 {:.1} ms, p99 {:.1} ms, most {:.1} ms",
        part(50),
        part(95),
        part(99),
        part(100)
    );
    let status = std::fs::read_to_string(format!("/proc/{}/status", client.child.id())).unwrap_or_default();
    let peak = status.lines().find(|l| l.starts_with("VmHWM")).unwrap_or("VmHWM: unknown");
    let _ = writeln!(out, "{peak}");
    std::io::stdout().write_all(out.as_bytes()).unwrap();
}
