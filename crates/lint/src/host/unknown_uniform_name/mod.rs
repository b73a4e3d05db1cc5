//! H003: a uniform is looked up by a name that no stage declares.

use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Safety, Severity, message};
use base::text::{Edit, Span};
use reading::{Project, ShaderFile};

use hosts::HostFile;
use hosts::cpp::group::is_shader_name;
use hosts::cpp::lookup::{Lookup, LookupKind, Missing};
use hosts::cpp::program::ProgramSource;
use hosts::cpp::tree::{descendants, plain_string};
use hosts::suggest::{list, list_in_japanese, nearest};
use reading::program::resolve;

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H003"),
    name: "unknown-uniform-name",
    severity: Severity::Warning,
    level: Level::Default,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::Host(check),
};

fn check(host: &HostFile, project: &Project, findings: &mut Findings<'_>) {
    for lookup in host.lookups() {
        if !matches!(lookup.kind, LookupKind::Uniform | LookupKind::Name) || lookup.is_reserved() {
            continue;
        }
        let name = lookup.base_name();
        let program = resolve(host, project, &lookup.source);
        let Some(program) = program.filter(|p| p.is_complete()) else {
            nowhere(host, project, lookup, findings);
            continue;
        };
        // A block's member has no location either, but its name is known.
        let declared = program.uniform(name).is_some() || program.in_block(name);
        let attribute = program.attribute(name).is_some() && (!lookup.wrapped || lookup.kind == LookupKind::Name);
        if declared || attribute {
            continue;
        }
        let place = program.names();
        let mut found = findings
            .at(
                &host.file,
                lookup.literal_span(),
                message!("no uniform of {place} is called `{name}`", "{place} に `{name}` という uniform はありません"),
            )
            .with_label(lookup.missing.label())
            .with_why(lookup.missing.why().unwrap_or_else(|| {
                message!(
                    "glGetUniformLocation gives -1 without a GL error, and glUniform functions ignore the location -1",
                    "glGetUniformLocation は GL エラーなしに -1 を返し、glUniform 系の関数は位置 -1 を無視します"
                )
            }));
        let meant = nearest(name, program.uniforms());
        // Objects keep values of shaders that have changed: a slip is told, the rest on request.
        let level = if lookup.missing == Missing::Ignored && meant.is_none() { Level::Strict } else { RULE.level };
        if let Some(meant) = meant {
            if let Some((shader, variable)) = program.uniform(meant) {
                found = found.with_related(
                    &shader.file,
                    variable.name_span,
                    message!("`{meant}` is declared here", "`{meant}` はここで宣言されています"),
                );
            }
            let place = Span::new(lookup.name_span.start, lookup.name_span.start + name.len());
            found = found.with_fix(
                message!("write `{meant}`", "`{meant}` と書く"),
                Safety::Unsafe,
                vec![Edit::replace(place, meant)],
            );
        }
        let mut all: Vec<&str> = program.uniforms().collect();
        all.sort_unstable();
        all.dedup();
        findings.push_at(
            level,
            found.with_help(match all.as_slice() {
                [] => {
                    message!(
                        "the program has no uniform outside blocks",
                        "プログラムにはブロックの外の uniform がありません"
                    )
                }
                all => {
                    let (en, ja) = (list(all), list_in_japanese(all));
                    message!("the uniforms are {en}", "uniform は {ja} です")
                }
            }),
        );
    }
}

/// Which program is meant is not known, but no shader of the project has the name, and what else is looked up with
/// the same object belongs to one of them.
fn nowhere(host: &HostFile, project: &Project, lookup: &Lookup, findings: &mut Findings<'_>) {
    // What other languages name may be an engine's.
    if host.is_script() {
        return;
    }
    let name = lookup.base_name();
    let all_there = match &lookup.source {
        ProgramSource::Named(shaders) => shaders.iter().all(|s| project.shader_of(host, s).is_some()),
        ProgramSource::Beside | ProgramSource::Unknown => true,
    };
    if !all_there || project.mentions(name) || names_what_is_not_here(host, project) {
        return;
    }
    let Some(shader) = shader_of(host, project, lookup) else { return };
    let place = shader.file.name();
    let names: Vec<&str> = shader.shader.interface().uniforms.iter().map(|v| v.name.as_str()).collect();
    let mut found = findings
        .at(
            &host.file,
            lookup.literal_span(),
            message!("no shader here declares `{name}`", "`{name}` を宣言するシェーダはここにありません"),
        )
        .with_label(message!("gives -1", "-1 になります"))
        .with_why(message!(
            "what else is looked up with this object stands in {place}, and glUniform functions ignore the location -1",
            "同じオブジェクトのほかの名前は {place} にあります。glUniform 系の関数は位置 -1 を無視します"
        ));
    if let Some(meant) = nearest(name, names.iter().copied()) {
        let place = Span::new(lookup.name_span.start, lookup.name_span.start + name.len());
        let edit = Edit::replace(place, meant);
        found = found.with_fix(message!("write `{meant}`", "`{meant}` と書く"), Safety::Unsafe, vec![edit]);
    }
    let (en, ja) = (list(&names), list_in_japanese(&names));
    findings.push(found.with_help(message!("the uniforms are {en}", "uniform は {ja} です")));
}

/// True when the file names a shader that is not there, or whose ending is that of other files too.
fn names_what_is_not_here(host: &HostFile, project: &Project) -> bool {
    const SHARED: [&str; 9] = ["cs", "es", "tc", "te", "txt", "fx", "prog", "program", "shader"];
    let missing = |name: &str| {
        let ending = name.rsplit_once('.').filter(|(stem, _)| !stem.is_empty()).map(|(_, ending)| ending);
        let path = ending.is_some() && !name.contains([' ', '\n', '%', '{', '(']);
        path && (is_shader_name(name) || ending.is_some_and(|e| SHARED.contains(&e)))
            && project.shader_named(host.file.name(), name).is_none()
    };
    let nodes = host.root().into_iter().flat_map(descendants);
    nodes.filter_map(|n| plain_string(n, &host.file)).any(|(text, _)| missing(text))
}

/// The shader that most of the names belong to which are looked up with the same object.
fn shader_of<'p>(host: &HostFile, project: &'p Project, lookup: &Lookup) -> Option<&'p ShaderFile> {
    let same = |l: &&Lookup| l.kind == LookupKind::Uniform && l.object == lookup.object && !l.is_reserved();
    let mut names: Vec<&str> = host.lookups().iter().filter(same).map(Lookup::base_name).collect();
    names.sort_unstable();
    names.dedup();
    let known = names.iter().filter(|n| project.mentions(n)).count();
    let has = |s: &ShaderFile| names.iter().filter(|n| s.shader.interface().uniform(n).is_some()).count();
    let (count, shader) = project.shaders().map(|s| (has(s), s)).max_by_key(|(count, _)| *count)?;
    // With one name in common, or with many that are nowhere, the shader is one that is not here.
    (count > 1 && 3 * known >= 2 * names.len()).then_some(shader)
}

#[cfg(test)]
mod tests {
    use crate::{Input, run};
    use base::text::SourceFile;

    const VERTEX: &str = "#version 330 core\nin vec4 p;\nuniform mat4 model;\nuniform mat4 view;\n\
                          out Data { vec3 tint; } data;\n\
                          void main() { data.tint = p.xyz; gl_Position = view * model * p; }\n";
    const FRAGMENT: &str = "#version 330 core\nin Data { vec3 tint; } data;\nuniform float gain; // of the lamp\n\
                            out vec4 c;\nvoid main() { c = vec4(data.tint * gain, 1.0); }\n";

    fn reported(host: &str) -> Vec<String> {
        let files = [("a.vert", VERTEX), ("a.frag", FRAGMENT), ("m.cpp", host)];
        let found = run(&files.map(|(n, t)| Input::new(SourceFile::new(n, t))));
        found.into_iter().filter(|d| d.code.0 == "H003").map(|d| d.message.to_string()).collect()
    }

    #[test]
    fn a_name_that_no_shader_has_is_reported_whatever_the_program() {
        let draw = |more: &str| {
            reported(&format!(
                "void draw(Shader& s) {{ s.setMat4(\"model\", m); s.setMat4(\"view\", m); s.setFloat(\"gain\", 1.0f); {more} }}"
            ))
        };
        assert_eq!(draw("s.setFloat(\"gian\", 1.0f);"), ["no shader here declares `gian`"]);
        for more in ["", "s.setFloat(\"lamp\", 1.0f);", "other.setFloat(\"gian\", 1.0f);"] {
            assert_eq!(draw(more), [""; 0], "{more}");
        }
        let missing = "s.setFloat(\"gian\", 1.0f); load(\"b.tese\");";
        assert_eq!(draw(missing), [""; 0], "a shader that is not here may have it");
        let many = "s.setFloat(\"a\", 1.0f); s.setFloat(\"b\", 1.0f); s.setFloat(\"d\", 1.0f);";
        assert_eq!(draw(many), [""; 0], "it is another shader's");
    }

    #[test]
    fn a_member_of_what_stages_hand_on_is_no_uniform() {
        let host = "void f() { GLuint p = load(\"a.vert\", \"a.frag\"); glGetUniformLocation(p, \"tint\"); }";
        assert_eq!(reported(host), ["no uniform of a.vert, a.frag is called `tint`"]);
    }
}
