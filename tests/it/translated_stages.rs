//! Translations of whole stages against the shaders that they are made from, in every language that is read back: what
//! is right agrees, and what is edited into a wrong one is caught.

use base::text::SourceFile;
use base::value::{Batch, Record, Scalar};
use judge::verdict::{Comparison, Translations, Unread};
use program::lower::Target;
use program::{Language, Program, TranslateError, Translation};
use syntax::Stage;

const SAMPLES: usize = 64;
const GLSL: [Language; 3] = [Language::Glsl330, Language::Glsl450, Language::GlslEs310];

fn program(name: &str, text: &str) -> Program {
    let file = SourceFile::new(name, text);
    Program::from_source(&file, Stage::from_path(name).unwrap(), |_| Ok(Target::Stage))
        .unwrap_or_else(|e| panic!("{e}"))
}

/// Any ordinary words for a program.
fn batch(program: &Program) -> Batch {
    let (invocation, case) = (program.invocation_record(), program.case_record());
    // A stage that takes nothing from the host has as many samples as its one case.
    let per_case = if invocation.words() == 0 && case.words() == 0 { SAMPLES } else { 1 };
    let mut batch = Batch::with_capacity(invocation.into(), case.into(), per_case, SAMPLES);
    let mut seed = 1_u32;
    let mut words = |record: &Record| -> Vec<u32> {
        let scalars = record.fields().iter().flat_map(|f| std::iter::repeat_n(f.shape.scalar, f.shape.words()));
        let word = |scalar| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            match scalar {
                Scalar::F32 => ((seed >> 8) as f32 / 4_194_304.0 - 2.0).to_bits(),
                Scalar::I32 | Scalar::U32 => seed >> 30,
                Scalar::Bool => seed >> 31,
            }
        };
        scalars.map(word).collect()
    };
    for _ in 0..SAMPLES {
        batch.invocations.extend(words(&batch.invocation_record.clone()));
        batch.cases.extend(words(&batch.case_record.clone()));
    }
    batch
}

/// All samples agree in these languages.
#[track_caller]
fn agrees(program: &Program, languages: &[Language]) {
    let translations = Translations::to(program, languages);
    assert_eq!(translations.unread().collect::<Vec<_>>(), []);
    for one in translations.compare(&batch(program)).unwrap() {
        assert_eq!((one.agreed, &one.first), (SAMPLES as u64, &None), "{}", one.language);
    }
}

fn text(program: &Program, language: Language) -> String {
    match program.translate(language).unwrap() {
        Translation::Text(text) => text,
        Translation::Words(_) => panic!("{language} has no text"),
    }
}

fn compared(program: &Program, language: Language, text: String) -> Comparison {
    let read = program.read_back(&Translation::Text(text), language);
    let translations = Translations::new(program, vec![(language, read)]);
    assert_eq!(translations.unread().collect::<Vec<_>>(), [], "{language}");
    translations.compare(&batch(program)).unwrap().remove(0)
}

/// The translation with a part of its text replaced means something else.
#[track_caller]
fn rings(program: &Program, language: Language, from: &str, to: &str) {
    let right = text(program, language);
    assert!(right.contains(from), "{language}: no `{from}` in {right}");
    let found = compared(program, language, right.replacen(from, to, 1));
    assert!(!found.deviating.is_empty(), "{language}: nothing was found");
}

fn refused(program: &Program, language: Language) -> String {
    match program.translate(language) {
        Err(TranslateError::Inexpressible { reason, .. }) => reason,
        other => panic!("{language}: {other:?}"),
    }
}

const LIT: &str = "#version 330 core
in vec3 normal; flat in int kind; centroid in vec2 uv;
uniform vec3 light; uniform float powers[4]; uniform sampler2D map;
out vec4 color; layout(location = 1) out vec4 extra;
void main()
{
  float lambert = max(dot(normalize(normal), light), 0.40625);
  if (uv.x < 0.0) discard;
  color = texture(map, uv) * lambert * powers[kind & 3];
  extra = vec4(dFdx(uv), fwidth(normal.z), gl_FragCoord.x);
}
";

#[test]
fn a_fragment_stage_means_the_same_in_every_language() {
    agrees(&program("lit.frag", LIT), &Language::READ_BACK);
}

#[test]
fn a_wrong_fragment_stage_is_caught_in_every_language() {
    let lit = program("lit.frag", LIT);
    for language in GLSL.into_iter().chain([Language::Wgsl]) {
        rings(&lit, language, "0.40625", "0.40635");
        rings(&lit, language, "discard;", "");
        let (x, y) = if language == Language::Wgsl { ("dpdx(", "dpdy(") } else { ("dFdx(", "dFdy(") };
        rings(&lit, language, x, y);
    }
}

#[test]
fn derivatives_in_branches_are_allowed_in_wgsl_and_nothing_else() {
    let text_of = |body: &str| {
        let source = format!(
            "#version 330 core\nuniform sampler2D map; in vec2 uv; out vec4 c;\nvoid main() {{ c = vec4(0.0); {body} }}\n"
        );
        let branch = program("branch.frag", &source);
        agrees(&branch, &[Language::Wgsl]);
        text(&branch, Language::Wgsl)
    };
    let reported = "diagnostic(off, derivative_uniformity);\n";
    assert!(text_of("if (uv.x > 0.25) c = texture(map, uv);").starts_with(reported));
    assert!(text_of("for (int i = 0; i < int(uv.x); ++i) c += vec4(dFdx(uv.y));").starts_with(reported));
    assert!(!text_of("c = texture(map, uv);").contains("diagnostic"));
    assert!(!text_of("if (uv.x > 0.25) c = textureLod(map, uv, 0.0);").contains("diagnostic"));
}

#[test]
fn varyings_without_words_for_locations_are_known_by_their_names() {
    let lit = program("lit.frag", LIT);
    let right = text(&lit, Language::Glsl330);
    assert!(right.contains("_vs2fs_location0") && !right.contains("layout(location = 0) in"), "{right}");
    let moved = right.replace("_vs2fs_location0", "_vs2fs_location7");
    let read = lit.read_back(&Translation::Text(moved), Language::Glsl330);
    let translations = Translations::new(&lit, vec![(Language::Glsl330, read)]);
    let unread: Vec<_> = translations.unread().collect();
    assert!(matches!(&unread[..], [(_, Unread::Interface(why))] if why.contains("location 7")), "{unread:?}");
}

const LIGHTS: &str = "#version 330 core
struct Light { vec3 position; float range; vec2 k[3]; float last; };
struct Fog { float start; float end; };
layout(std140) uniform Scene {
  mat4 view; Light lights[12]; float a; Light one; float b; int flags[4]; bool on; Fog fog[2]; float c; Fog last; float d;
};
in vec3 p;
out vec3 sum;
void main()
{
  sum = one.position * one.last * a;
  for (int i = 0; i < 12; ++i) sum += lights[i].position * lights[i].range + vec3(lights[i].k[i % 3], lights[i].last);
  sum += vec3(fog[1].start, fog[1].end, c) * last.end + d;
  gl_Position = view * vec4(p, on ? b : float(flags[1]));
}
";

#[test]
fn structures_in_uniform_buffers_keep_their_places() {
    let lights = program("lights.vert", LIGHTS);
    agrees(&lights, &Language::READ_BACK);
    let wgsl = text(&lights, Language::Wgsl);
    let gap = wgsl.lines().find(|line| line.contains("sc_gap_")).unwrap_or_else(|| panic!("no gap in {wgsl}"));
    // Without one of the words that fill a gap, all behind it stands elsewhere.
    let found = lights.read_back(&Translation::Text(wgsl.replacen(gap, "", 1)), Language::Wgsl);
    let translations = Translations::new(&lights, vec![(Language::Wgsl, found)]);
    let deviates = translations.compare(&batch(&lights)).unwrap().iter().any(|one| !one.deviating.is_empty());
    assert!(deviates || translations.unread().count() > 0);
}

const DRAW: &str = "#version 460 core
layout(location = 0) in vec4 p;
layout(location = 0) flat out int id;
void main() { id = gl_DrawID + 2 * gl_BaseVertex + 4 * gl_BaseInstance; gl_Position = p; }
";

#[test]
fn the_parameters_of_a_draw_are_declared_or_refused_by_name() {
    let draw = program("draw.vert", DRAW);
    agrees(&draw, &[Language::SpirV, Language::Glsl450]);
    let glsl = text(&draw, Language::Glsl450);
    assert!(glsl.contains("#extension GL_ARB_shader_draw_parameters : require"), "{glsl}");
    for (language, name) in
        [(Language::Wgsl, "WGSL"), (Language::GlslEs310, "GLSL ES 3.10"), (Language::Glsl330, "GLSL 3.30")]
    {
        let said = refused(&draw, language);
        assert!(said.starts_with(&format!("{name} has no `gl_")) && said.contains("`gl_BaseVertex`"), "{said}");
    }
}

const STORE: &str = "#version 430 core
layout(local_size_x = 8) in;
struct Particle { vec3 position; float life; };
layout(std430, binding = 0) buffer Particles { Particle all[]; };
layout(std430, binding = 1) readonly buffer Step { float dt; vec3 wind; };
layout(std430, binding = 2) buffer Count { uint count; };
void main()
{
  Particle p = all[gl_GlobalInvocationID.x];
  p.position += wind * dt * 0.40625;
  p.life -= dt;
  all[gl_GlobalInvocationID.x] = p;
  atomicAdd(count, 3u);
}
";

#[test]
fn a_compute_stage_is_compared_by_what_its_buffers_hold_in_the_end() {
    let store = program("store.comp", STORE);
    agrees(&store, &[Language::SpirV, Language::Wgsl, Language::Glsl450, Language::GlslEs310]);
    for language in [Language::Wgsl, Language::Glsl450, Language::GlslEs310] {
        rings(&store, language, "0.40625", "0.40635");
        rings(&store, language, "3u", "2u");
    }
}

#[test]
fn a_vertex_stage_reads_storage_and_does_not_write_it_in_wgsl() {
    let reads = "#version 430 core\nlayout(std430, binding = 0) buffer B { vec4 v[]; };\n\
                 void main() { gl_Position = v[gl_VertexID & 3]; }\n";
    let reads = program("reads.vert", reads);
    agrees(&reads, &[Language::SpirV, Language::Wgsl, Language::Glsl450, Language::GlslEs310]);
    let wgsl = text(&reads, Language::Wgsl);
    assert!(wgsl.contains("var<storage>") && !wgsl.contains("read_write"), "{wgsl}");
    let writes = "#version 430 core\nlayout(std430, binding = 0) buffer B { uint n; };\n\
                  void main() { gl_Position = vec4(1.0); atomicAdd(n, 1u); }\n";
    let said = refused(&program("writes.vert", writes), Language::Wgsl);
    assert_eq!(said, "WGSL has no storage buffer that a vertex stage writes");
}

#[test]
fn what_a_language_lacks_is_said_in_its_words() {
    let frag = |body: &str| format!("#version 450 core\nlayout(location = 0) out vec4 c;\n{body}\n");
    let image = "layout(rgba16) uniform writeonly image2D i; void main() { imageStore(i, ivec2(0), vec4(1.0)); c = vec4(0.0); }";
    for (name, body, language, said) in [
        (
            "c.frag",
            frag("void main() { c = vec4(gl_PointCoord, 0.0, 1.0); }"),
            Language::Wgsl,
            "WGSL has no `gl_PointCoord`",
        ),
        (
            "d.frag",
            frag("uniform double d; void main() { c = vec4(float(d)); }"),
            Language::GlslEs310,
            "GLSL ES 3.10 has no `double`",
        ),
        (
            "d.frag",
            frag("uniform double d; void main() { c = vec4(float(d)); }"),
            Language::Wgsl,
            "WGSL has no `double`",
        ),
        ("i.frag", frag(image), Language::GlslEs310, "GLSL ES 3.10 has no image of the format rgba16unorm"),
    ] {
        assert_eq!(refused(&program(name, &body), language), said);
    }
}

#[test]
fn one_source_of_blending_is_an_output_like_others() {
    let one = "#version 330 core\nin vec4 v;\nlayout(location = 0, index = 0) out vec4 c;\n\
               layout(location = 1) out vec4 d;\nvoid main() { c = v; d = v * 0.40625; }\n";
    let one = program("one.frag", one);
    agrees(&one, &Language::READ_BACK);
    rings(&one, Language::Wgsl, "0.40625", "0.40635");
    let two = "#version 330 core\nin vec4 v;\nlayout(location = 0) out vec4 c;\n\
               layout(location = 0, index = 1) out vec4 d;\nvoid main() { c = v; d = v * 0.40625; }\n";
    let two = program("two.frag", two);
    agrees(&two, &[Language::SpirV, Language::Wgsl]);
    let wgsl = text(&two, Language::Wgsl);
    assert!(wgsl.contains("@blend_src(0)") && wgsl.contains("@blend_src(1)"), "{wgsl}");
}

const STRIP: &str = "#version 330 core
layout(triangles) in; layout(triangle_strip, max_vertices = 3) out;
struct Light { vec4 at; float range[2]; };
layout(std140) uniform Scene { Light lights[2]; float shrink; };
void main()
{
  for (int i = 0; i < 3; ++i) {
    gl_Position = gl_in[i].gl_Position * shrink + lights[1].at * lights[0].range[1] * 0.40625;
    EmitVertex();
  }
}
";

#[test]
fn a_geometry_stage_finds_members_of_structures_in_its_buffers() {
    let strip = program("strip.geom", STRIP);
    let languages = [Language::SpirV, Language::Wgsl, Language::Glsl450, Language::GlslEs310];
    agrees(&strip, &languages);
    rings(&strip, Language::Wgsl, "0.40625", "0.40635");
    rings(&strip, Language::Glsl450, "0.40625", "0.40635");
}

/// `inverse` as WGSL has it from naga's writer, and as it is supplied in MSL and HLSL, which nobody reads back.
#[test]
fn an_inverse_is_supplied_where_the_writer_has_none() {
    let supplied = include_str!("../../crates/program/src/supply.wgsl");
    for n in 2..=4 {
        let zeros = if n == 4 { "" } else { ", 0.0" };
        let zeros = zeros.repeat(4 - n);
        let source = format!(
            "#version 330 core\nuniform mat{n} m; in vec{n} v;\n\
             vec{n} of(vec{n} v) {{ return inverse(m + mat{n}(5.0)) * v; }}\n\
             void main() {{ gl_Position = vec4(of(v){zeros}); }}\n"
        );
        let inverse = program("inverse.vert", &source);
        agrees(&inverse, &Language::READ_BACK);
        let wgsl = text(&inverse, Language::Wgsl);
        let call = format!("(_naga_inverse_{n}x{n}_f32(");
        assert!(wgsl.contains(&call), "{wgsl}");
        let wgsl = wgsl.replace(&call, &format!("(sc_inverse_{n}(")) + supplied;
        let found = compared(&inverse, Language::Wgsl, wgsl.clone());
        assert_eq!((found.agreed, &found.first), (SAMPLES as u64, &None));
        let faults =
            [("m[1].y, -m", "m[1].y, m"), ("(m[1], m[2])", "(m[2], m[1])"), ("+ cd * m[1].w", "- cd * m[1].w")];
        let wrong = wgsl.replacen(faults[n - 2].0, faults[n - 2].1, 1);
        assert!(!compared(&inverse, Language::Wgsl, wrong).deviating.is_empty(), "mat{n}");
        for language in [Language::Msl, Language::Hlsl] {
            let text = text(&inverse, language);
            assert!(text.matches(&format!("sc_inverse_{n}_(")).count() == 2, "{language}: {text}");
        }
    }
}

#[test]
fn nan_and_infinity_are_reported_by_their_bits_in_wgsl() {
    let source = "#version 330 core\nin vec3 v; in float s; flat out int found;\n\
                  void main() { vec3 x = v.x > 0.0 ? v : vec3(intBitsToFloat(0x7fc00000));\n\
                  bvec3 n = isnan(x); found = int(any(n)) + 2 * int(isinf(s / 0.0)); \n\
                  gl_Position = vec4(v, 1.0); }\n";
    let reported = program("told.vert", source);
    let wgsl = text(&reported, Language::Wgsl);
    assert!(!wgsl.contains("isNan(") && wgsl.matches("2139095040u").count() >= 2, "{wgsl}");
    agrees(&reported, &[Language::Wgsl]);
    rings(&reported, Language::Wgsl, "2139095040u", "2149095040u");
}

#[test]
fn built_in_values_that_are_varyings_to_be_run_are_no_varyings_of_a_translation() {
    let layer = "#version 460 core\n#extension GL_ARB_shader_viewport_layer_array : require\n\
                 void main() { gl_Layer = gl_InstanceID; gl_Position = vec4(1.0); }\n";
    let helper = "#version 450 core\nlayout(location = 0) out vec4 c;\n\
                  void main() { c = vec4(gl_SamplePosition, gl_HelperInvocation, gl_FragCoord.x); }\n";
    for language in Language::ALL {
        assert_eq!(refused(&program("layer.vert", layer), language), "the translator has no `gl_Layer`");
        let said = "the translator has no `gl_SamplePosition` and no `gl_HelperInvocation`";
        assert_eq!(refused(&program("helper.frag", helper), language), said);
    }
}
