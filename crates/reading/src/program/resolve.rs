//! The program that a look-up in host code is about.

use hosts::HostFile;
use hosts::cpp::program::{ProgramSource, distinct};
use syntax::Stage;

use super::Program;
use super::around::around;
use crate::project::{Project, ShaderFile};

/// The program of a look-up, when it is known.
pub fn resolve<'p>(host: &HostFile, project: &'p Project, source: &ProgramSource) -> Option<Program<'p>> {
    let found: Vec<Option<&ShaderFile>> = match source {
        ProgramSource::Named(names) => names.iter().map(|n| project.shader_of(host, n)).collect(),
        ProgramSource::Beside => {
            if let Some(configured) = project.configured_for(host.file.name()) {
                return Some(configured);
            }
            let beside = if host.place.is_some() { Vec::new() } else { project.shaders_beside(host.file.name()) };
            if beside.is_empty() {
                return around(host, project);
            }
            let stages: Vec<Stage> = beside.iter().map(|s| s.shader.stage()).collect();
            if !distinct(&stages) {
                return None;
            }
            beside.into_iter().map(Some).collect()
        }
        ProgramSource::Unknown => return project.configured_for(host.file.name()),
    };
    // A document prints what it names without saying which is which.
    if host.place.is_some() && found.iter().all(Option::is_none) {
        return around(host, project);
    }
    let all = found.iter().all(Option::is_some);
    let found: Vec<&ShaderFile> = found.into_iter().flatten().collect();
    // Scripts name files whose names say no stage.
    let stages: Vec<Stage> = found.iter().map(|s| s.shader.stage()).collect();
    if host.is_script() && !distinct(&stages) {
        return None;
    }
    Program::new(found, all)
}

#[cfg(test)]
mod tests {
    use crate::{Input, Project};
    use base::text::SourceFile;

    /// Names of the shaders of the first look-up's program, and whether it is complete.
    fn resolve(host: &str, shaders: &[(&str, &str)]) -> Option<(String, bool)> {
        let mut inputs = vec![Input::new(SourceFile::new("m.cpp", host))];
        inputs.extend(shaders.iter().map(|(n, t)| Input::new(SourceFile::new(*n, *t))));
        let project = Project::new(&inputs, &crate::Config::default());
        let host = project.hosts().next().unwrap();
        super::resolve(host, &project, &host.lookups()[0].source).map(|p| (p.names(), p.is_complete()))
    }

    const V: &str = "#version 150 core\nin vec4 p;\nvoid main() { gl_Position = p; }\n";
    const F: &str = "#version 150 core\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n";
    const LOOK: &str = "glGetAttribLocation(program, \"p\");";

    #[test]
    fn a_program_is_what_its_loader_names() {
        let host = format!(
            "void f() {{ GLuint q = load(\"b.vert\"); GLuint program = load(\"a.vert\", \"a.frag\"); {LOOK} }}"
        );
        let all = [("a.vert", V), ("a.frag", F), ("b.vert", V)];
        assert_eq!(resolve(&host, &all), Some(("a.vert, a.frag".to_owned(), true)));
        assert_eq!(resolve(&host, &[("a.vert", V)]), Some(("a.vert".to_owned(), false)), "a stage is not there");
        assert_eq!(resolve(&host, &[("b.vert", V)]), None, "no stage of it is there");
    }

    #[test]
    fn two_values_of_the_program_are_not_guessed_between() {
        let host = format!("void f() {{ GLuint program = load(\"a.vert\"); program = load(\"b.vert\"); {LOOK} }}");
        assert_eq!(resolve(&host, &[("a.vert", V), ("b.vert", V)]), None);
    }

    #[test]
    fn a_branch_of_a_condition_knows_its_own_program() {
        let host = |look: &str, after: &str| {
            format!(
                "void f() {{\n#if A\nGLuint program = load(\"a.vert\");\n{look}\n#else\nGLuint program = load(\"b.vert\");\n#endif\n{after}\n}}"
            )
        };
        let all = [("a.vert", V), ("b.vert", V)];
        assert_eq!(resolve(&host(LOOK, ""), &all).map(|p| p.0).as_deref(), Some("a.vert"));
        assert_eq!(resolve(&host("", LOOK), &all), None, "either may be meant");
    }

    #[test]
    fn a_pointer_is_the_object_that_it_is_set_to() {
        let look = "glGetAttribLocation(p->id, \"p\");";
        let host = |more: &str| {
            format!(
                "Shader* p; void g() {{ Shader q(\"b.vert\"); Shader s(\"a.vert\"); p = &s; {more} }} void f() {{ {look} }}"
            )
        };
        let all = [("a.vert", V), ("b.vert", V)];
        assert_eq!(resolve(&host(""), &all).map(|p| p.0).as_deref(), Some("a.vert"));
        assert_eq!(resolve(&host("p = &q;"), &all), None, "it is set twice");
    }

    #[test]
    fn a_variable_of_another_function_does_not_count() {
        let host = format!(
            "void g() {{ GLuint program = load(\"b.vert\"); }} void f() {{ GLuint program = load(\"a.vert\"); {LOOK} }}"
        );
        assert_eq!(resolve(&host, &[("a.vert", V), ("b.vert", V)]).map(|p| p.0).as_deref(), Some("a.vert"));
    }

    #[test]
    fn a_parameter_is_not_the_variable_of_its_name_elsewhere() {
        let host = format!(
            "void f(GLuint program) {{ {LOOK} }} void g() {{ GLuint program = load(\"a.vert\"); GLuint q = load(\"b.vert\"); }}"
        );
        assert_eq!(resolve(&host, &[("a.vert", V), ("b.vert", V)]), None);
    }

    #[test]
    fn stages_attached_one_by_one_are_one_program_when_each_is_named_once() {
        let host = |second: &str| {
            format!(
                "void f() {{ GLuint program = glCreateProgram(); attach(program, \"a.vert\"); attach(program, \"a.frag\"); {second} {LOOK} }}"
            )
        };
        let all = [("a.vert", V), ("a.frag", F), ("b.vert", V)];
        assert_eq!(resolve(&host(""), &all), Some(("a.vert, a.frag".to_owned(), true)));
        assert_eq!(resolve(&host("attach(other, \"b.vert\");"), &all), None, "two vertex stages");
        assert_eq!(resolve(&host("GLuint o = glCreateProgram();"), &all), None, "two programs");
        assert_eq!(resolve(&host("load(dir + \".vert\");"), &all), None, "a name put together at run time");
        assert_eq!(resolve(&host("source = \"#version 150\";"), &all), None, "shader text of its own");
    }

    #[test]
    fn a_program_with_a_name_of_its_own_is_not_known() {
        let host = format!("void f() {{ GLuint program = load(\"phong\"); {LOOK} }}");
        assert_eq!(resolve(&host, &[("m.vert", V), ("m.frag", F)]), None);
    }

    #[test]
    fn a_loader_that_is_called_without_names_too_makes_the_file_unknown() {
        let host = |first: &str| {
            format!(
                "{first} void f() {{ GLuint program = load(VERT, FRAG); GLuint q = load(\"a.vert\", \"a.frag\"); {LOOK} }}"
            )
        };
        let all = [("a.vert", V), ("a.frag", F)];
        assert_eq!(resolve(&host(""), &all), None);
        let method = format!("void f() {{ x.load(name); y.load(\"a.vert\", \"a.frag\"); {LOOK} }}");
        assert_eq!(resolve(&method, &all), None);
        let object = format!("void f() {{ Shader x(name); Shader y(\"a.vert\", \"a.frag\"); {LOOK} }}");
        assert_eq!(resolve(&object, &all), None);
        let one = format!("void f(GLuint program) {{ Shader y(\"a.vert\", \"a.frag\"); {LOOK} }}");
        assert_eq!(resolve(&one, &all), Some(("a.vert, a.frag".to_owned(), true)));
        let in_macro =
            format!("#define VERT \"b.vert\"\nvoid f(GLuint program) {{ other(VERT); {LOOK} load(\"a.vert\"); }}");
        assert_eq!(resolve(&in_macro, &all), None);
    }

    #[test]
    fn without_names_the_shaders_beside_count() {
        let host = format!("void f() {{ {LOOK} }}");
        assert_eq!(resolve(&host, &[("m.vert", V), ("m.frag", F)]), Some(("m.vert, m.frag".to_owned(), true)));
        assert_eq!(resolve(&host, &[("sub/m.vert", V), ("n.vert", V)]), None);
    }

    #[test]
    fn names_come_from_constants_and_shader_objects() {
        let all = [("a.vert", V), ("a.frag", F), ("b.vert", V), ("b.frag", F)];
        let other = "GLuint q = load(\"b.vert\", \"b.frag\");";
        for body in [
            "const char* v = \"a.vert\"; std::string w = dir + \"a.frag\"; GLuint program = load(v, w);",
            "Shader v(\"a.vert\"); Shader w(\"a.frag\"); Program program(&v, &w);",
            "Shader v(\"a.vert\"); Shader w(\"a.frag\"); Program program(v, w);",
            "std::vector<GLuint> list; list.push_back(load(\"a.vert\")); list.push_back(load(\"a.frag\")); \
             GLuint program = link(list);",
            "auto v = make<Shader>(\"a.vert\", 1); auto w = make<Shader>(\"a.frag\", 1); auto program = make<P>(v, w);",
        ] {
            let host = format!("void f() {{ {body} {other} {LOOK} }}");
            assert_eq!(resolve(&host, &all).map(|p| p.0).as_deref(), Some("a.vert, a.frag"), "{body}");
        }
        let member = format!(
            "struct S {{ Program program; S() : program(\"a.vert\", \"a.frag\") {{}} void f() {{ {other} {LOOK} }} }};"
        );
        assert_eq!(resolve(&member, &all).map(|p| p.0).as_deref(), Some("a.vert, a.frag"));
        let several = format!(
            "void f() {{ Shader v(\"a.vert\"); v = Shader(\"b.vert\"); Shader w(\"a.frag\"); Program program(&v, &w); {other} {LOOK} }}"
        );
        assert_eq!(resolve(&several, &all), None, "one of them is either");
        let piece = format!("void f() {{ GLuint program = load(\"a.vert\", \"noise.glsl\", \"a.frag\"); {LOOK} }}");
        assert_eq!(resolve(&piece, &all), None, "a piece may have more");
    }

    #[test]
    fn resources_of_qt_are_found_by_the_end_of_their_path() {
        let host = format!(
            "void f() {{ program->addShader(Q::Vertex, \":/gl/a.vert\"); program->addShader(Q::Fragment, \"qrc:/gl/a.frag\"); {LOOK} }}"
        );
        let found = resolve(&host, &[("res/a.vert", V), ("res/a.frag", F)]);
        assert_eq!(found, Some(("res/a.vert, res/a.frag".to_owned(), true)));
    }

    #[test]
    fn a_shader_with_conditions_is_not_taken_for_known() {
        let host = format!("void f() {{ GLuint program = load(\"a.vert\", \"a.frag\"); {LOOK} }}");
        let conditional = "#version 150 core\n#ifdef A\nin vec4 q;\n#endif\nvoid main() {}\n";
        assert_eq!(resolve(&host, &[("a.vert", conditional), ("a.frag", F)]).map(|p| p.1), Some(false));
    }
}
