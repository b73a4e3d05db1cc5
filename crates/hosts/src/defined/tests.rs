use super::*;

fn of(name: &str, text: &str) -> HostMacros {
    host_macros(&SourceFile::new(name, text))
}

fn pairs(found: &HostMacros) -> Vec<(&str, &str)> {
    found.macros.iter().map(|one| (one.name.as_str(), one.value.as_str())).collect()
}

#[test]
fn pairs_of_calls_lists_and_tables_are_read() {
    let text = r#"
        void f() {
            if (packed) { defs.append("store", "uint"); } else { defs.append("store", "vec4"); }
            defs.append("load( buffer, i )", "buffer[i]");
            defs.append("kind", wide ? "vec4" : "float");
            defs.append("ROUNDS", 4);
            defs["SCALE"] = "2.5";
            defs.append("LIMIT", 1.5f);
        }
    "#;
    let found = of("gpu.cpp", text);
    let wanted = [
        ("store", "uint"),
        ("store", "vec4"),
        ("load(buffer,i)", "buffer[i]"),
        ("kind", "vec4"),
        ("kind", "float"),
        ("ROUNDS", "4"),
        ("SCALE", "2.5"),
        ("LIMIT", "1.5"),
    ];
    assert_eq!(pairs(&found), wanted);
    for (name, text) in [
        ("a.py", "d = {'WIDTH': 32, 'TYPE': 'float'}\n"),
        ("a.ts", "const d = { \"WIDTH\": 32, 'TYPE': `float` };\n"),
        ("a.rs", "let d = [(\"WIDTH\", \"32\".to_string()), (\"TYPE\", String::from(\"float\"))];\n"),
        ("a.go", "m := map[string]string{\"WIDTH\": \"32\", \"TYPE\": `float`}\n"),
    ] {
        assert_eq!(pairs(&of(name, text)), [("WIDTH", "32"), ("TYPE", "float")], "{name}");
    }
}

#[test]
fn what_the_host_computes_is_left_out() {
    let text = "void f() {\n defs.append(\"A\", std::to_string(n));\n defs.append(\"B\", n);\n\
                text += \"#define C \" + std::to_string(n);\n sprintf(t, \"#define D %d\\n\", n);\n\
                g(\"E\", x ? \"1\" : name);\n text += std::string(\"F=\") + n; }\n";
    assert_eq!(pairs(&of("gpu.cpp", text)), []);
    assert_eq!(pairs(&of("a.ts", "const t = `#define A ${n}\\n#define B 4\\n`;")), []);
    assert_eq!(pairs(&of("a.py", "t = f'#define A {n}\\n'\nu = '#define B {}\\n'.format(n)\n")), []);
}

#[test]
fn lines_of_texts_that_stand_in_front_are_read() {
    let text = "const char* front = \"#version 450\\n\"\n  \"#define WIDTH 32 // lanes\\n\"\n  \"#define at(i) data[(i)]\\n\";\n\
                text += \"#define ROUNDS \" << 4;\nconst char* raw = R\"x(#define TYPE vec4\n)x\";\n";
    let found = of("gpu.cpp", text);
    assert_eq!(pairs(&found), [("WIDTH", "32"), ("at(i)", "data[(i)]"), ("ROUNDS", "4"), ("TYPE", "vec4")]);
}

#[test]
fn one_build_is_a_statement_with_its_shader() {
    let text = "void f() {\n build(\"sum_f32\", \"sum.comp\", {{\"TYPE\", \"float\"}, {\"WIDTH\", \"32\"}});\n\
                build(\"max_f32\", \"max.comp\", {{\"TYPE\", \"vec4\"}});\n}\n";
    let found = of("build.cpp", text);
    let of_shader = |shader: &str| {
        let own = found.macros.iter().filter(|one| found.names(one.statement, shader));
        own.map(|one| (one.name.as_str(), one.value.as_str())).collect::<Vec<_>>()
    };
    assert_eq!(of_shader("shaders/sum.comp"), [("TYPE", "float"), ("WIDTH", "32")]);
    assert_eq!(of_shader("max.comp"), [("TYPE", "vec4")]);
    assert_eq!(of_shader("a.comp"), []);
    let python = "build('sum.comp', TYPE='float')\nbuild('sum.comp', ['-DWIDTH=64',\n  '-DTYPE=uint'])\n";
    assert_eq!(pairs(&of("build.py", python)), [("WIDTH", "64"), ("TYPE", "uint")]);
}

#[test]
fn commands_that_compile_shaders_are_read() {
    let text = "cc -DN=3 main.c\nglslc -DWIDTH=32 -DFAST \\\n  sum.comp -o sum.spv\nglslc -DN=$(N) sum.comp\n";
    let found = of("Makefile", text);
    assert_eq!(pairs(&found), [("WIDTH", "32"), ("FAST", "1")]);
    assert!(found.names(found.macros[0].statement, "sum.comp"));
}

#[test]
fn strings_of_a_list_are_no_pairs() {
    let text = "['position', 'normal', 'uv'].forEach(one);\nbuild([['WIDTH', '4'], ['TYPE', 'vec2']]);\n";
    assert_eq!(pairs(&of("shaders.js", text)), [("WIDTH", "4"), ("TYPE", "vec2")]);
}
