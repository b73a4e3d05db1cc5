//! H033: an attribute that no host code gives its values.

use super::attributes::attributes;
use crate::rule::{Check, Findings, Level, Pages, Rule};
use base::diagnostic::{Code, Severity, message};
use hosts::HostFile;
use hosts::cpp::program::ShaderRef;
use reading::{Project, ShaderFile};
use syntax::interface::Variable;
use syntax::types::ScalarType;
use syntax::{Const, Stage};

/// The rule.
pub const RULE: Rule = Rule {
    code: Code("H033"),
    name: "attribute-not-fed",
    severity: Severity::Warning,
    level: Level::Strict,
    pages: Pages { en: include_str!("en.md"), ja: include_str!("ja.md") },
    check: Check::ShaderWith(check),
};

fn check(file: &ShaderFile, project: &Project, findings: &mut Findings<'_>) {
    let shader = &file.shader;
    if shader.stage() != Stage::Vertex || !file.is_sound() || project.hosts().next().is_none() {
        return;
    }
    if !project.fed().is_known() || !is_named(project, file) {
        return;
    }
    let inputs = &shader.interface().inputs;
    let used = |v: &&Variable| !v.name.starts_with("gl_") && shader.uses_of(v.symbol).next().is_some();
    let location = |v: &Variable| {
        let entry = v.qualifiers.layout_entry("location")?.value?;
        shader.fold(entry).and_then(Const::as_integer)
    };
    for variable in inputs.iter().filter(used) {
        let (name, fed) = (&variable.name, project.fed());
        let integer = matches!(variable.ty.scalar(), Some(ScalarType::Int | ScalarType::Uint));
        let said = match location(variable) {
            Some(at) if integer && fed.only_floats(at) && !is_pointed_at(project, file, variable) => message!(
                "`{name}` takes integers, and the host code gives floats to location {at}",
                "`{name}` は整数ですが、ホストのコードは location {at} に浮動小数点数を渡しています"
            ),
            Some(at) if fed.any() && !fed.location(at) => message!(
                "no host code gives values to `{name}` at location {at}",
                "location {at} の `{name}` に値を渡すホストのコードがありません"
            ),
            None if variable.qualifiers.layout_entry("location").is_none() && is_left_out(project, file, name) => {
                message!("no host code names `{name}`", "`{name}` を名指しするホストのコードがありません")
            }
            _ => continue,
        };
        findings.push(
            findings
                .at(&file.file, variable.name_span, said)
                .with_label(message!("reads what is not there", "ない値を読みます"))
                .with_why(message!(
                    "an attribute without an array has one constant value for all vertices, and an integer attribute \
                     that is given floats has an undefined one",
                    "配列のない頂点属性は全頂点で同じ値になり、整数の属性に浮動小数点数を渡すと値は不定です"
                ))
                .with_help(message!(
                    "give `{name}` a buffer with glVertexAttribPointer (glVertexAttribIPointer for integers)",
                    "glVertexAttribPointer（整数なら glVertexAttribIPointer）で `{name}` にバッファを渡してください"
                )),
        );
    }
}

/// True when host code speaks of another attribute of the shader by name, in a file that names the shader, and of this
/// one nowhere.
fn is_left_out(project: &Project, file: &ShaderFile, name: &str) -> bool {
    if project.fed().quotes(name) {
        return false;
    }
    let others: Vec<String> = file
        .shader
        .interface()
        .inputs
        .iter()
        .filter(|v| v.name != name && v.qualifiers.layout_entry("location").is_none())
        .map(|v| format!("\"{}\"", v.name))
        .collect();
    let speaks = |h: &HostFile| others.iter().any(|o| h.file.text().contains(o.as_str()));
    let quoted = format!("\"{name}");
    naming(project, file).any(speaks) && !project.hosts().any(|h| h.file.text().contains(&quoted))
}

/// True when a host file names the shader, or holds it.
fn is_named(project: &Project, file: &ShaderFile) -> bool {
    file.origin.is_some() || naming(project, file).next().is_some()
}

/// The host files that load the shader, and those that bear its name.
fn naming<'p>(project: &'p Project, file: &ShaderFile) -> impl Iterator<Item = &'p HostFile> {
    let path = file.origin.as_ref().map_or(file.file.name(), |o| o.host.name()).to_owned();
    project.hosts().filter(move |h| {
        let host = h.file.name();
        let ending = format!(".{}\"", path.rsplit('.').next().unwrap_or_default());
        let beside =
            || h.file.text().contains(&ending) && project.shaders_beside(host).iter().any(|s| s.file.name() == path);
        let loads = |r: &ShaderRef| project.shader_of(h, r).is_some_and(|s| s.file.name() == path);
        host == path || h.programs().named.iter().any(loads) || beside()
    })
}

/// True when a call is known to feed this attribute: the rule on pointers speaks of it.
fn is_pointed_at(project: &Project, file: &ShaderFile, variable: &Variable) -> bool {
    let feeds = |h: &HostFile| {
        attributes(h, project)
            .iter()
            .any(|p| p.shader.file.name() == file.file.name() && p.variable.name == variable.name)
    };
    project.hosts().any(feeds)
}

#[cfg(test)]
mod tests {
    use crate::{Input, Level, Selection, Settings, run_with};
    use base::text::SourceFile;

    fn reported(vertex: &str, host: &str) -> Vec<String> {
        let files = [("a.vert", vertex), ("m.cpp", host)];
        let selection = Selection::default().at(Level::Strict);
        let settings = Settings { selection, ..Settings::default() };
        let found = run_with(&files.map(|(n, t)| Input::new(SourceFile::new(n, t))), &settings);
        found.into_iter().filter(|d| d.code.0 == "H033").map(|d| d.message.to_string()).collect()
    }

    const PLACED: &str = "#version 330 core\nlayout(location = 0) in vec4 p;\nlayout(location = 3) in ivec4 bones;\n\
                          void main() { gl_Position = p * float(bones.x); }\n";
    const NAMED: &str = "#version 330 core\nin vec4 p0, p1;\nvoid main() { gl_Position = p0 + p1; }\n";

    #[test]
    fn a_location_that_no_call_names_is_reported() {
        let first = "glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, 0);";
        let load = "GLuint p = load(\"a.vert\"); GLuint q = load(\"b.vert\");";
        let with = |more: &str| reported(PLACED, &format!("void f(GLuint n) {{ {load} {first} {more} }}"));
        assert_eq!(with(""), ["no host code gives values to `bones` at location 3"]);
        let floats = "glVertexAttribPointer(3, 4, GL_INT, GL_FALSE, 0, 0);";
        assert_eq!(with(floats), ["`bones` takes integers, and the host code gives floats to location 3"]);
        for more in
            ["glVertexAttribIPointer(3, 4, GL_INT, 0, 0);", "glVertexAttribPointer(n, 4, GL_FLOAT, GL_FALSE, 0, 0);"]
        {
            assert_eq!(with(more), [""; 0], "{more}");
        }
        assert_eq!(reported(PLACED, &format!("void f() {{ {load} draw(); }}")), [""; 0], "nothing is fed here");
        assert_eq!(reported(PLACED, &format!("void f() {{ {first} }}")), [""; 0], "no file names the shader");
        assert_eq!(reported(PLACED, &format!("{load} {first}")), [""; 0], "a listing leaves things out");
        let unused = PLACED.replace(" * float(bones.x)", "");
        assert_eq!(reported(&unused, &format!("void f() {{ {load} {first} }}")), [""; 0]);
    }

    #[test]
    fn a_name_that_no_call_has_is_reported() {
        let bind = |names: &str| format!("void f() {{ GLuint q = load(\"a.vert\"); {names} }}");
        let one = "glBindAttribLocation(q, 0, \"p0\");";
        assert_eq!(reported(NAMED, &bind(one)), ["no host code names `p1`"]);
        assert_eq!(reported(NAMED, &bind("load(q, \"p0\");")).len(), 0, "no file feeds attributes");
        let both = format!("{one} glBindAttribLocation(q, 1, \"p1\");");
        assert_eq!(reported(NAMED, &bind(&both)), [""; 0]);
        assert_eq!(reported(NAMED, &bind("glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, 0);")), [""; 0]);
        assert_eq!(reported(NAMED, &format!("void f() {{ {one} }}")), [""; 0], "the file names no shader");
    }
}
