//! What a host puts around a text: errors that may be right with its help are told on request.
//!
//! A text without `main` and `#version` is a piece of a shader; one with an `#include`, or with characters of another
//! preprocessor, is put together before it is compiled; what an `#if` asks may be set from outside; and a name that
//! nothing declares may be declared in a piece, or in a text that host code writes.

use std::collections::{BTreeSet, HashSet};

use base::diagnostic::{Code, Diagnostic};
use base::text::{SourceFile, Span};
use syntax::ast::ItemKind;
use syntax::{BuiltinFunction, Profile, Shader, Stage, TokenKind, TokenPlace, Version, errors};

use super::dialect;
use super::project::Project;

/// Errors about names, which something in front of the text can declare.
const NAMES: &[Code] = &[errors::UNKNOWN_NAME, errors::UNKNOWN_FUNCTION, errors::UNKNOWN_TYPE];

/// Errors that a text in front of this one can repair: names, macros, extensions and versions.
const REPAIRED_IN_FRONT: &[Code] = &[
    errors::TOKEN,
    errors::UNKNOWN_DIRECTIVE,
    errors::ERROR_DIRECTIVE,
    errors::UNKNOWN_NAME,
    errors::UNKNOWN_FUNCTION,
    errors::UNKNOWN_TYPE,
    errors::MISSING_MAIN,
    errors::LAYOUT,
    errors::VARIABLE_TYPE,
    errors::NEEDS_VERSION,
    errors::EXTENSION,
    errors::IMPLICIT_FLOAT,
    errors::FLOAT_SUFFIX,
    errors::PRECISION,
];

/// Errors that depend on the stage.
const OF_THE_STAGE: &[Code] =
    &[errors::QUALIFIER, errors::LAYOUT, errors::NEEDS_VERSION, errors::EXTENSION, errors::PLACEMENT];

/// Errors inside of functions that hold in every shader that the function is put into.
const OF_A_FUNCTION: &[Code] = &[
    errors::NO_OVERLOAD,
    errors::ASSIGN_TYPE,
    errors::OPERAND_TYPE,
    errors::INDEX,
    errors::CONDITION_TYPE,
    errors::RETURN_TYPE,
    errors::NOT_A_PLACE,
    errors::TOO_MANY,
    errors::TOO_FEW,
    errors::ASSIGN_SIZE,
    errors::MATRIX_SIZE,
    errors::SCALAR_SWIZZLE,
    errors::SWIZZLE,
    errors::VECTOR_RELATION,
    errors::INDEX_RANGE,
    errors::READ_ONLY,
];

/// Errors that stay whatever an unknown extension brings: numbers of components, the grammar, and its own name.
const WITH_ANY_EXTENSION: &[Code] = &[
    errors::SYNTAX,
    errors::EXTENSION,
    errors::TOO_MANY,
    errors::TOO_FEW,
    errors::ASSIGN_SIZE,
    errors::MATRIX_SIZE,
    errors::SWIZZLE,
    errors::LATE_VERSION,
];

/// Those of the errors of a text that its host may take away.
pub fn doubtful(shader: &Shader, found: &[Diagnostic]) -> Vec<bool> {
    if found.is_empty() {
        return Vec::new();
    }
    let file = shader.file();
    if found.iter().any(|d| dialect::is_mark(file, d)) {
        return vec![true; found.len()];
    }
    let has_main = shader.tokens().iter().any(|t| t.kind == TokenKind::Word && file.slice(t.span) == "main");
    let versioned = shader.version().span.is_some();
    // What holds nothing of a shader under the name of one is told as it is.
    let is_empty = shader.unit().items.iter().all(|i| i.kind == ItemKind::Error);
    if shader.stage() != Stage::Library && is_empty && found.iter().any(|d| d.code == errors::SYNTAX) {
        return vec![false; found.len()];
    }
    if !has_main && !versioned {
        // Where a piece is not whole by itself, everything may have another meaning.
        let whole = found.iter().all(|d| OF_A_FUNCTION.contains(&d.code) && !is_of_the_user(file, d));
        return vec![!whole; found.len()];
    }
    let joined = found.iter().any(|d| is_foreign(file, d)) || imports(file.text());
    let replaced = found.iter().any(|d| d.code != errors::INCLUDE && is_foreign(file, d));
    let mut kept = under_conditions(shader, found);
    if !versioned {
        under_es(shader, found, &mut kept);
    }
    let open = shader.requires_unknown_extension();
    let unknown_stage = shader.stage() == Stage::Library;
    let of = |(error, kept): (&Diagnostic, bool)| {
        !kept
            || (joined && (REPAIRED_IN_FRONT.contains(&error.code) || is_bindless(file, error)))
            || (joined && is_of_the_user(file, error))
            || (open && !WITH_ANY_EXTENSION.contains(&error.code))
            || (error.code == errors::MISSING_MAIN && error.span.is_empty())
            || is_at_unknown_macro(shader, error)
            // An engine calls this `main` from its own.
            || (!versioned && error.code == errors::FUNCTION && file.slice(error.span) == "main")
            || (joined && error.code == errors::SYNTAX && (replaced || at_macro(file, error)))
            || (unknown_stage && OF_THE_STAGE.contains(&error.code))
            // Who puts a version in front may put more there; a slip comes with what was meant.
            || (!versioned && NAMES.contains(&error.code) && error.help.is_none())
    };
    found.iter().zip(kept).map(of).collect()
}

/// True for a text into which directives of a tool bring others.
fn imports(text: &str) -> bool {
    ["#pragma glslify", "#pragma include", "#pragma import"].iter().any(|directive| text.contains(directive))
}

/// True for a call of a function of the text, of which another text may have further overloads.
fn is_of_the_user(file: &SourceFile, error: &Diagnostic) -> bool {
    error.code == errors::NO_OVERLOAD && BuiltinFunction::from_name(file.slice(error.span)).is_none()
}

/// True for what another preprocessor than that of GLSL reads.
fn is_foreign(file: &SourceFile, error: &Diagnostic) -> bool {
    match error.code {
        errors::INCLUDE => true,
        errors::UNKNOWN_DIRECTIVE => error.help.is_none(),
        errors::TOKEN => file.slice(error.span).starts_with(['@', '$', '`', '\\']),
        errors::SYNTAX => {
            let before = file.text()[..error.span.start].trim_end();
            is_template_name(&file.text()[error.span.start..])
                || ["{{", "[[", "##"].iter().any(|mark| file.text()[error.span.start..].starts_with(mark))
                || before.ends_with(['$', '@', '#'])
        }
        _ => false,
    }
}

/// True for text that begins with a name between marks: `%BoneCount%`.
fn is_template_name(text: &str) -> bool {
    let name = text.strip_prefix('%').and_then(|rest| rest.split_once('%')).map(|(name, _)| name);
    name.is_some_and(|name| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'))
}

/// True for an error at a word in capitals: a macro that another text defines.
fn at_macro(file: &SourceFile, error: &Diagnostic) -> bool {
    let before = file.text()[..error.span.start].trim_end();
    let last = before.rsplit(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or("");
    is_macro(file.slice(error.span)) || is_macro(last)
}

/// True for an error at a word in capitals that no text in sight defines: a qualifier or a type, as an engine calls it.
fn is_at_unknown_macro(shader: &Shader, error: &Diagnostic) -> bool {
    if ![errors::SYNTAX, errors::REDEFINITION].contains(&error.code) {
        return false;
    }
    let file = shader.file();
    let tokens = shader.tokens();
    let last = tokens[..tokens.partition_point(|t| t.span.end <= error.span.start)].last();
    let last = last.map_or("", |token| file.slice(token.span));
    let defined = conditions(shader).1;
    let undefined = |word: &str| is_macro(word) && !defined.contains(word);
    // Where the macro is defined, what it stands for may use one that is not.
    let body = file.expansion(error.span).and_then(|e| e.definition);
    let body = body.map_or("", |at| file.text()[at.end..].lines().next().unwrap_or(""));
    let mut words = body.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    // A slip happens once.
    let again = |word: &str| tokens.iter().filter(|t| file.slice(t.span) == word).nth(1).is_some();
    let wanted = |word: &str| undefined(word) && again(word);
    wanted(file.slice(error.span)) || wanted(last) || words.any(undefined)
}

/// True for a text in a shader's file that is C++: shaders in raw strings, which host code includes.
pub fn is_raw_string_file(text: &str) -> bool {
    let opens =
        |at: usize| text[at + 2..].find(['(', '"', '\n']).is_some_and(|end| text[at + 2 + end..].starts_with('('));
    let in_front = |at: usize| text[..at].rsplit('\n').next().unwrap_or("").trim();
    text.match_indices("R\"")
        .any(|(at, _)| opens(at) && (in_front(at).is_empty() || in_front(at).ends_with(['=', '('])))
}

/// True for a word in capitals.
pub fn is_macro(word: &str) -> bool {
    let in_capitals = word.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_');
    word.len() > 1 && in_capitals && !word.starts_with(|c: char| c.is_ascii_digit())
}

/// True for a macro that nothing defines where the text defines one with nearly its name.
pub fn is_slip(shader: &Shader, name: &str) -> bool {
    let (_, defined) = conditions(shader);
    base::nearest(name, defined.iter().map(String::as_str)).is_some()
}

/// True for a sampler that is made of a handle, which an extension in front brings.
fn is_bindless(file: &SourceFile, error: &Diagnostic) -> bool {
    const OPAQUE: [&str; 6] = ["sampler", "isampler", "usampler", "image", "iimage", "uimage"];
    let at = &file.text()[error.span.start..];
    error.code == errors::CONSTRUCTOR && OPAQUE.iter().any(|word| at.starts_with(word))
}

/// Names that one text asks for at most: each is tried by itself.
const MOST_ASKED: usize = 12;

/// For each error, whether it stays whatever is defined from outside of that which an `#if` asks and the text does not
/// define: each name by itself, and all of them. Where a definition leaves the place of an error out, it says nothing.
fn under_conditions(shader: &Shader, found: &[Diagnostic]) -> Vec<bool> {
    let (mut asked, set) = conditions(shader);
    // What the language defines is known.
    asked.retain(|name| !set.contains(name) && !name.starts_with("GL_") && !name.starts_with("__"));
    let each = asked.iter().take(MOST_ASKED).map(|name| vec![(name.clone(), "1".to_owned())]);
    let all = (asked.len() > 1).then(|| asked.iter().map(|name| (name.clone(), "1".to_owned())).collect());
    let mut kept = vec![true; found.len()];
    for defines in each.chain(all) {
        let other = Shader::parse_with(shader.file(), shader.stage(), &defines);
        let same = |a: &Diagnostic| other.diagnostics.iter().any(|b| a.code == b.code && a.span.start == b.span.start);
        let left_out = |span: Span| {
            let all = other.shader.tokens();
            let at = all.partition_point(|t| t.span.end <= span.start);
            all.get(at).is_some_and(|t| t.place == TokenPlace::Inactive)
        };
        for (kept, error) in kept.iter_mut().zip(found).filter(|(kept, _)| **kept) {
            *kept = same(error) || left_out(error.span);
        }
    }
    kept
}

/// Takes out what is in order in GLSL ES, which a text without a version may be as well.
fn under_es(shader: &Shader, found: &[Diagnostic], kept: &mut [bool]) {
    const OF_VERSIONS: &[Code] = &[errors::INITIALISER, errors::CONSTANT, errors::NO_OVERLOAD];
    if !found.iter().any(|d| OF_VERSIONS.contains(&d.code)) {
        return;
    }
    let es = Version { number: 100, profile: Profile::Es, span: None };
    let other = Shader::parse_behind(shader.file(), shader.stage(), es);
    for (kept, error) in kept.iter_mut().zip(found).filter(|(_, d)| OF_VERSIONS.contains(&d.code)) {
        *kept &= other.diagnostics.iter().any(|b| error.code == b.code && error.span.start == b.span.start);
    }
}

/// Names that directives `#if`, `#ifdef`, `#ifndef` and `#elif` ask for, and those that a `#define` of the text sets.
fn conditions(shader: &Shader) -> (BTreeSet<String>, BTreeSet<String>) {
    let (mut asked, mut set) = (BTreeSet::new(), BTreeSet::new());
    for line in shader.file().text().lines() {
        let Some(directive) = line.trim_start().strip_prefix('#') else { continue };
        let mut words = directive.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|w| !w.is_empty());
        match words.next() {
            Some("define") => set.extend(words.next().map(str::to_owned)),
            Some("if" | "ifdef" | "ifndef" | "elif") => {
                let name = |w: &&str| !w.starts_with(|c: char| c.is_ascii_digit()) && *w != "defined";
                asked.extend(words.filter(name).map(str::to_owned));
            }
            _ => {}
        }
    }
    (asked, set)
}

/// Names that hosts can put in front of the shaders of a project: words of pieces, and those of texts that host code
/// writes and that are no whole shader.
pub fn names_in_front(project: &Project) -> HashSet<String> {
    let mut names = HashSet::new();
    let mut add = |text: &str| {
        let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        names.extend(words.filter(|w| w.len() > 1).map(str::to_owned));
    };
    for (_, shader) in project.shader_files() {
        if shader.shader.function("main").is_none() {
            let shader = &shader.shader;
            let code =
                shader.tokens().iter().filter(|t| t.kind == TokenKind::Word).map(|t| shader.file().slice(t.span));
            code.for_each(&mut add);
        }
    }
    for host in project.hosts() {
        let mut at = 0;
        for line in host.file.text().split_inclusive('\n') {
            // What a whole shader in a literal declares is its own.
            if let Some(text) = written(line).filter(|_| !host.embedded().iter().any(|e| e.place.contains(at))) {
                add(text);
            }
            at += line.len();
        }
    }
    names
}

/// The part of a line of host code that is GLSL in quotes: a definition or a declaration.
fn written(line: &str) -> Option<&str> {
    let quoted = &line[line.find('"')? + 1..];
    let starts =
        ["#define ", "uniform ", "const ", "in ", "out ", "varying ", "attribute ", "layout", "struct ", "\\n#define "];
    let declares = |start: &&str| quoted.trim_start().starts_with(*start) && quoted.len() > start.len();
    starts.iter().any(declares).then_some(quoted)
}

/// True for an error that is about a name, or at a macro: something in front may declare it.
pub fn is_about_a_name(error: &Diagnostic) -> bool {
    NAMES.contains(&error.code) || (error.code == errors::SYNTAX && is_macro(error.file.slice(error.span)))
}

#[cfg(test)]
mod tests {
    use base::text::SourceFile;

    use crate::{Input, Level, Selection, Settings, run_with};

    /// Codes of what is found by default in files, and of what is found beyond it.
    fn found(files: &[(&str, &str)]) -> (Vec<String>, Vec<String>) {
        let inputs: Vec<Input> = files.iter().map(|(name, text)| Input::new(SourceFile::new(*name, *text))).collect();
        let codes = |level: Level| -> Vec<String> {
            let selection = Selection::new(&[], &[]).unwrap().at(level);
            let found = run_with(&inputs, &Settings { selection, ..Settings::default() });
            found
                .iter()
                .filter(|d| d.severity == base::diagnostic::Severity::Error)
                .map(|d| d.code.0.to_owned())
                .collect()
        };
        let default = codes(Level::Default);
        let mut strict = codes(Level::Strict);
        for code in &default {
            strict.remove(strict.iter().position(|c| c == code).unwrap());
        }
        (default, strict)
    }

    fn only_on_request(files: &[(&str, &str)], code: &str) {
        let (default, strict) = found(files);
        assert!(default.is_empty() && strict.iter().any(|c| c == code), "{files:?}: {default:?}, {strict:?}");
    }

    fn by_default(files: &[(&str, &str)], code: &str) {
        let (default, _) = found(files);
        assert!(default.iter().any(|c| c == code), "{files:?}: {default:?}");
    }

    #[test]
    fn a_piece_is_judged_where_it_is_whole() {
        only_on_request(&[("light.glsl", "color += shade(n, l) * lamps[i].color;\n")], "E001");
        only_on_request(&[("noise.glsl", "float f(vec2 p) { return hash(p); }\n")], "E021");
        only_on_request(&[("facade.vert", "#define varying out\n")], "E025");
        let overload = "float ao(vec2 p, float x) { return min(x, ao(p)); }\n";
        only_on_request(&[("ao.glsl", overload)], "E022");
        by_default(&[("ao.glsl", &overload.replace("ao(p)", "dot(p)"))], "E022");
        only_on_request(&[("surface.frag", "vec3 main() { return vec3(1.0); }\n")], "E046");
        by_default(&[("noise.glsl", "vec2 f(vec2 p) { vec3 q = p; return q.xy; }\n")], "T003");
        by_default(&[("junk.frag", "placeholder")], "E001");
    }

    #[test]
    fn what_another_preprocessor_reads_is_left_to_it() {
        let shader =
            |line: &str, body: &str| format!("#version 330\n{line}\nout vec4 c;\nvoid main() {{ c = {body}; }}\n");
        only_on_request(&[("a.frag", &shader("@import light;", "light()"))], "E002");
        only_on_request(&[("a.frag", &shader("#pragma glslify: light = require('light')", "light()"))], "E021");
        only_on_request(&[("a.frag", &shader("[[INPUTS]]", "vec4(1.0)"))], "E001");
        only_on_request(&[("a.frag", &shader("##INPUTS##", "vec4(1.0)"))], "E001");
        only_on_request(&[("a.frag", &shader("in %Bones% b;", "vec4(1.0)"))], "E001");
        by_default(&[("a.frag", &shader("in % b;", "vec4(1.0)"))], "E001");
        only_on_request(&[("a.frag", &shader("#include \"light.glsl\"\nHIGH_PRECISION;", "vec4(1.0)"))], "E001");
        only_on_request(&[("a.frag", &shader("const int n = $COUNT;", "vec4(n)"))], "E002");
        by_default(&[("a.frag", &shader("#include \"light.glsl\"", "vec3(1.0)"))], "T003");
        by_default(&[("a.frag", &shader("", "light()"))], "E021");
        by_default(&[("a.frag", &shader("#include \"light.glsl\"\nout vec2 d", "vec4(1.0)"))], "E001");
        by_default(&[("a.frag", &shader("#include \"light.glsl\"\nconst int n = 10", "vec4(n)"))], "E001");
        let handle = "#include \"light.glsl\"\nuniform uvec2 handle;";
        only_on_request(&[("a.frag", &shader(handle, "texture(sampler2D(handle), vec2(0.5))"))], "E040");
        let sampler = "#include \"light.glsl\"\nuniform sampler2D shadow;";
        by_default(&[("a.frag", &shader(sampler, "vec4(shadow)"))], "E040");
    }

    #[test]
    fn an_error_that_a_definition_from_outside_takes_away_is_told_on_request() {
        let shader = |condition: &str| {
            format!("#version 330\n{condition}\nin vec3 t;\n#endif\nout vec4 c;\nvoid main() {{ c = vec4(t, 1.0); }}\n")
        };
        only_on_request(&[("a.frag", &shader("#ifdef TANGENTS"))], "E020");
        by_default(&[("a.frag", &shader("#define TANGENTS 0\n#if TANGENTS"))], "E020");
        // Another definition may leave the place out.
        let two = shader("#ifdef TANGENTS")
            .replace("void main() {", "#ifdef DEPTH\nvoid main() { c = vec4(0.0); }\n#else\nvoid main() {");
        only_on_request(&[("a.frag", &format!("{two}#endif\n"))], "E020");
        // What the definition leaves out stays wrong.
        let other =
            "#version 330\nout vec4 c;\nvoid main() {\n#ifdef FLAT\nc = vec4(1.0);\n#else\nc = vec3(1.0);\n#endif\n}\n";
        by_default(&[("a.frag", other)], "T003");
    }

    #[test]
    fn names_of_pieces_and_of_texts_in_host_code_may_stand_in_front() {
        let shader = "#version 330\nout vec4 c;\n//%lamps%\nvoid main() { c = vec4(ambient); }\n";
        by_default(&[("a.frag", shader)], "E020");
        only_on_request(&[("a.frag", shader), ("lamps.glsl", "uniform float ambient;\n")], "E020");
        only_on_request(&[("a.frag", shader), ("lamps.glsl", "#version 330\nuniform float ambient;\n")], "E020");
        let host = "void f() { text = \"uniform float ambient;\\n\" + text; }\n";
        only_on_request(&[("a.frag", shader), ("a.cpp", host)], "E020");
        // Another whole shader declares its names for itself, in a file or in a literal.
        let whole = "#version 330\nuniform float ambient;\nvoid main() { gl_Position = vec4(ambient); }\n";
        by_default(&[("a.frag", shader), ("b.vert", whole)], "E020");
        let literal = format!("const char* t = R\"({whole})\";\nvoid f() {{ glShaderSource(s, 1, &t, 0); }}\n");
        by_default(&[("a.frag", shader), ("b.cpp", &literal)], "E020");
    }

    #[test]
    fn a_text_in_another_language_is_left_to_its_tool() {
        let shader = |line: &str| format!("#version 330\n{line}\nout vec4 c;\nvoid main() {{ c = vec3(1.0); }}\n");
        for line in [
            "const vec3 tint = #9CF0C0;",
            "struct Sun { const mat4* matrix; };",
            "uniform Sun* const sun = suns;",
            "[FragmentShader]",
            "Texture2D map : register(t0);",
            "vec4 shade(vec2 t) : COLOR0 { return t.xyxy; }",
        ] {
            only_on_request(&[("a.frag", &shader(line))], "T003");
        }
        only_on_request(&[("a.frag", "float4 main(float2 t : TEXCOORD0) : COLOR\n{ return t.xyxy; }\n")], "E001");
        by_default(&[("a.frag", &shader("float f(float x) { return x * * x; }"))], "T003");
        by_default(&[("a.frag", &shader("float f(bool b) { return b ? 1.0 : ; }"))], "E001");
        by_default(&[("a.frag", &shader("float f[2] = [1.0, 2.0];"))], "E001");
    }

    #[test]
    fn an_unknown_extension_may_bring_types_and_rules() {
        let shader = |extension: &str, body: &str| {
            format!("#version 460\n{extension}\nout vec4 c;\nvoid main() {{ float f[2]; c = {body}; }}\n")
        };
        let (unknown, length) = ("#extension GL_NV_gpu_shader5 : require", "vec4(f.length)");
        only_on_request(&[("a.frag", &shader(unknown, length))], "E034");
        by_default(&[("a.frag", &shader("", length))], "E034");
        // What is only enabled may be missing.
        by_default(&[("a.frag", &shader(&unknown.replace("require", "enable"), length))], "E034");
        by_default(&[("a.frag", &shader(unknown, "vec4(1.0).xyz"))], "T003");
    }

    #[test]
    fn a_qualifier_in_capitals_may_be_defined_in_front() {
        let text = |first: &str| format!("{first}FUNC float a() {{ return 1.0; }}\nFUNC float b() {{ return a(); }}\n");
        let shader = |first: &str| format!("#version 330\n{}void main() {{}}\n", text(first));
        only_on_request(&[("a.frag", &shader(""))], "E001");
        only_on_request(
            &[("a.frag", "#version 330\nFUNC_END\n/* A ray */\nstruct Ray { vec3 at; };\nFUNC_END\nvoid main() {}\n")],
            "E001",
        );
        assert!(found(&[("a.frag", &shader("#define FUNC\n"))]).0.is_empty());
        by_default(&[("a.frag", "#version 330\nHELLO WORLD\nin vec3 p;\nvoid main() {}\n")], "E001");
        let missing = "#version 330\n#define TINT vec4(1.0)\nout vec4 c;\nvoid main() { c = TINT c += c; }\n";
        by_default(&[("a.frag", missing)], "E001");
        let unknown = "#version 330\n#define STACK STACK_OF(vec3)\nSTACK s;\nvoid main() {}\n";
        only_on_request(&[("a.frag", unknown)], "E001");
    }

    #[test]
    fn a_text_without_a_version_may_be_of_either_language() {
        let constant =
            "const vec3 LIGHT = normalize(vec3(1.0, 2.0, 3.0));\nvoid main() { gl_FragColor = LIGHT.xyzz; }\n";
        only_on_request(&[("a.frag", constant)], "E044");
        by_default(&[("a.frag", &format!("#version 110\n{constant}"))], "E044");
        let varying = "varying float x;\nconst float y = x;\nvoid main() { gl_FragColor = vec4(y); }\n";
        by_default(&[("a.frag", varying)], "E044");
    }

    #[test]
    fn a_shader_without_main_may_be_joined_to_others() {
        let text = |name: &str| format!("#version 330\nout vec4 c;\nvoid {name}() {{ c = vec4(1.0); }}\n");
        only_on_request(&[("a.frag", &text("shade"))], "E025");
        by_default(&[("a.frag", &text("mian"))], "E025");
    }

    #[test]
    fn a_file_of_raw_strings_is_host_code() {
        let shader = |value: &str| {
            format!(
                "static const char a_frag[] = R\"(\n#version 330\nout vec4 c;\nvoid main() {{ c = {value}; }}\n)\";\n"
            )
        };
        let two = shader("vec4(1.0)").repeat(2);
        assert!(found(&[("shaders.glsl", &two)]).0.is_empty());
        assert!(
            found(&[("shader.frag", "R\"zz(\nvarying vec2 p;\nvoid main() { gl_FragColor = vec4(p, p); }\n)zz\"\n")])
                .0
                .is_empty()
        );
        by_default(&[("quoted.frag", "#version 330\nout vec4 c;\nvoid main() { c = R\"; }\n")], "E002");
    }

    #[test]
    fn a_macro_may_be_defined_in_front_and_a_slip_in_one_is_told() {
        let text = |name: &str| {
            format!("#version 330\n#define LAMP_COUNT 4\nout vec4 c;\nvoid main() {{ c = vec4({name}); }}\n")
        };
        only_on_request(&[("a.frag", &text("FOG_LIMIT"))], "E020");
        by_default(&[("a.frag", &text("LAMP_COUNTS"))], "E020");
    }

    #[test]
    fn nothing_is_said_that_depends_on_an_unknown_stage() {
        let text = "#version 330\nlayout(location = 0) in vec3 p;\nout vec3 q;\nvoid main() { q = p; }\n";
        only_on_request(&[("shader.glsl", text)], "V002");
        by_default(&[("shader_fs.glsl", text)], "V002");
        assert!(found(&[("shader_vs.glsl", text)]).0.is_empty());
    }

    #[test]
    fn a_name_in_a_text_without_a_version_is_told_where_it_is_a_slip() {
        let text = |name: &str| format!("varying vec3 normal;\nvoid main() {{ gl_FragColor = vec4({name}, 1.0); }}\n");
        only_on_request(&[("a.frag", &text("sceneTint"))], "E020");
        by_default(&[("a.frag", &text("normol"))], "E020");
    }
}
