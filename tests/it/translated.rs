//! Translations against the shaders that they are made from: what is right agrees on every shipped
//! suite, and what is edited into a wrong one is caught.

use std::fmt::Write as _;

use base::text::SourceFile;
use base::value::Batch;
use engine::shard::Shard;
use engine::suite::run::{
    FindingKind, Part, Prepared, Request, Share, check_translations, check_translations_with, prepare, run_part,
};
use engine::suite::{parse, shipped};
use judge::profile::Promises;
use judge::verdict::{Comparison, Difference, Translations, Unread};
use lanes::{Api, Stage, embedded};
use program::{Language, Program, Translation};
use property::Sampler;

use crate::lowering::{UNIFORMS, stage};
use crate::support::{self, prepared};

const SEED: u64 = 11;

fn compare(prepared: &Prepared, translations: &Translations, cases: usize) -> Vec<Comparison> {
    let per_case = prepared.suite.strands.map_or(prepared.suite.per_case, |s| s.primitives()).max(1);
    translations.compare(&Sampler::new(prepared.plan.clone(), SEED).batch(0, cases, per_case)).unwrap()
}

#[test]
fn every_shipped_shader_means_the_same_in_every_language_that_reads_back() {
    let mut reported = String::new();
    for suite in shipped() {
        let prepared = prepared(suite.name);
        let translations = Translations::of(&prepared.program);
        for (language, why) in translations.unread() {
            writeln!(reported, "{}: {language}: {why:?}", suite.name).unwrap();
        }
        let compared = compare(&prepared, &translations, 128);
        // naga reads the author's own text as well.
        assert!(compared.len() == 4 || !reported.is_empty(), "{}: {}", suite.name, compared.len());
        for one in compared {
            if let Some(first) = one.first {
                writeln!(reported, "{}: {first}; {} agree", suite.name, one.agreed).unwrap();
            }
            assert_eq!(one.undetermined, 0, "{}", suite.name);
            assert!(one.agreed >= 128 || !one.deviating.is_empty());
        }
    }
    assert_eq!(reported, "");
}

/// A translation with a part of its text replaced.
fn edited(program: &Program, language: Language, from: &str, to: &str) -> Translation {
    let Translation::Text(text) = program.translate(language).unwrap() else { panic!("{language} has no text") };
    assert!(text.contains(from), "{language}: no `{from}` in {text}");
    Translation::Text(text.replacen(from, to, 1))
}

/// A SPIR-V translation with its first instruction of this kind changed, of those that `edit` changes.
fn edited_words(program: &Program, edit: impl Fn(&mut Vec<u32>) -> bool) -> Translation {
    let Translation::Words(mut words) = program.translate(Language::SpirV).unwrap() else { panic!("text") };
    let mut at = 5;
    while at < words.len() {
        let len = (words[at] >> 16) as usize;
        let mut instruction = words[at..at + len].to_vec();
        if edit(&mut instruction) {
            words.splice(at..at + len, instruction);
            return Translation::Words(words);
        }
        at += len;
    }
    panic!("nothing was changed");
}

/// What came of one given translation.
fn beside(program: &Program, language: Language, translation: &Translation) -> Translations {
    Translations::new(program, vec![(language, program.read_back(translation, language))])
}

/// The first difference on a suite's samples, with the message that tells it.
#[track_caller]
fn caught(prepared: &Prepared, language: Language, translation: &Translation) -> (Difference, String) {
    let translations = beside(&prepared.program, language, translation);
    let unread: Vec<_> = translations.unread().collect();
    assert!(unread.is_empty(), "{unread:?}");
    let mut compared = compare(prepared, &translations, 16);
    let first = compared.remove(0).first.unwrap_or_else(|| panic!("{language}: nothing was found"));
    assert_eq!(first.language, language);
    (first.what.clone(), first.to_string())
}

#[track_caller]
fn rings(suite: &str, language: Language, from: &str, to: &str, said: &str) {
    let prepared = prepared(suite);
    let (_, message) = caught(&prepared, language, &edited(&prepared.program, language, from, to));
    assert!(message.starts_with(&format!("the {language} translation deviates from the shader: ")), "{message}");
    assert!(message.contains(said), "{message}");
}

const OP_CONSTANT: u32 = 43;
const OP_FUNCTION_CALL: u32 = 57;
const OP_COMPOSITE_CONSTRUCT: u32 = 80;
const OP_COPY_OBJECT: u32 = 83;
const OP_F_ADD: u32 = 129;

fn op(instruction: &[u32]) -> u32 {
    instruction[0] & 0xffff
}

#[test]
fn swapped_components_are_caught() {
    let (from, to) = ("(_e15 * cos(_e16)), cos(_e19),", "cos(_e19), (_e15 * cos(_e16)),");
    rings("sphere", Language::Wgsl, from, to, "`gl_Position.");
    rings("sphere", Language::Glsl450, from, to, "`gl_Position.");
    let sphere = prepared("sphere");
    let swapped = edited_words(&sphere.program, |instruction| {
        let vector = op(instruction) == OP_COMPOSITE_CONSTRUCT && instruction.len() == 7;
        if vector {
            instruction.swap(3, 4);
        }
        vector
    });
    assert!(caught(&sphere, Language::SpirV, &swapped).1.contains("the spirv translation"));
}

#[test]
fn a_constant_that_is_off_by_its_last_bit_is_caught() {
    rings("sphere", Language::Wgsl, "6.2831855f", "6.283186f", "`gl_Position.");
    rings("sphere", Language::Glsl450, "6.2831855", "6.283186", "`gl_Position.");
    let sphere = prepared("sphere");
    let off = edited_words(&sphere.program, |instruction| {
        let tau = op(instruction) == OP_CONSTANT && instruction[3] == std::f32::consts::TAU.to_bits();
        if tau {
            instruction[3] += 1;
        }
        tau
    });
    assert!(caught(&sphere, Language::SpirV, &off).1.contains("the spirv translation"));
}

#[test]
fn a_term_that_is_dropped_is_caught() {
    rings("hair", Language::Wgsl, "+ _e39) + _e41)", "+ _e39))", "of vertex ");
    rings("hair", Language::Glsl450, "+ _e39) + _e41)", "+ _e39))", "of vertex ");
    rings("cardinal", Language::Wgsl, "+ _e24) + _e26)", "+ _e24))", "`return.");
    for suite in ["hair", "cardinal", "skinning"] {
        let prepared = prepared(suite);
        let float_sum = |instruction: &mut Vec<u32>| {
            let sum = op(instruction) == OP_F_ADD;
            if sum {
                instruction[0] = 4 << 16 | OP_COPY_OBJECT;
                instruction.truncate(4);
            }
            sum
        };
        let dropped = edited_words(&prepared.program, float_sum);
        assert!(caught(&prepared, Language::SpirV, &dropped).1.contains("the spirv translation"));
    }
}

#[test]
fn a_vertex_that_is_not_emitted_is_caught() {
    let hair = prepared("hair");
    let count = Difference::VertexCount { shader: 5, translation: 0 };
    let wgsl = edited(&hair.program, Language::Wgsl, "        EmitVertex();\n", "");
    assert_eq!(caught(&hair, Language::Wgsl, &wgsl).0, count);
    let glsl = edited(&hair.program, Language::Glsl450, "        EmitVertex_();\n", "");
    assert_eq!(caught(&hair, Language::Glsl450, &glsl).0, count);
    let name = std::cell::Cell::new(0);
    let spirv = edited_words(&hair.program, |instruction| {
        const OP_NAME: u32 = 5;
        if op(instruction) == OP_NAME && instruction[2] == u32::from_le_bytes(*b"Emit") {
            name.set(instruction[1]);
        }
        let call = op(instruction) == OP_FUNCTION_CALL && instruction[3] == name.get();
        if call {
            instruction.clear();
        }
        call
    });
    assert_eq!(caught(&hair, Language::SpirV, &spirv).0, count);
}

#[test]
fn a_strip_that_is_cut_is_caught() {
    let cut = ("        EmitVertex();\n", "EmitVertex(); EndPrimitive();\n");
    rings("hair", Language::Wgsl, cut.0, cut.1, "vertex 1 is in strip 1 there and in strip 0 in the shader");
}

#[test]
fn an_output_that_is_not_written_is_caught() {
    rings("hair", Language::Wgsl, "        v = -(normalize(_e88.xyz));\n", "", "`v.x` of vertex 0 is not written");
}

#[test]
fn uniforms_that_changed_places_are_caught() {
    let exchange = |text: &str, a: &str, b: &str| text.replace(a, "\u{1}").replace(b, a).replace('\u{1}', b);
    let skinning = prepared("skinning");
    for (language, a, b) in
        [(Language::Wgsl, "@binding(0)", "@binding(1)"), (Language::Glsl450, "binding = 0)", "binding = 1)")]
    {
        let Translation::Text(text) = skinning.program.translate(language).unwrap() else { panic!() };
        let moved = Translation::Text(exchange(&text, a, b));
        assert!(matches!(caught(&skinning, language, &moved).0, Difference::Value { .. }));
    }
}

#[test]
fn another_interface_is_caught_without_a_sample() {
    let sphere = prepared("sphere");
    for (language, from, to, said) in [
        (Language::Wgsl, "@location(0)", "@location(1)", "an attribute at location 1"),
        (Language::Wgsl, "@binding(0)", "@binding(5)", "it takes `mc`"),
        (Language::Glsl450, "location = 0", "location = 3", "an attribute at location 3"),
        (Language::Glsl450, "binding = 0", "binding = 2", "at whose binding the shader takes nothing"),
    ] {
        let translations = beside(&sphere.program, language, &edited(&sphere.program, language, from, to));
        let unread: Vec<_> = translations.unread().collect();
        assert!(
            matches!(&unread[..], [(of, Unread::Interface(why))] if *of == language && why.contains(said)),
            "{unread:?}"
        );
    }
}

#[test]
fn another_spelling_is_the_same_translation() {
    let sphere = prepared("sphere");
    let Translation::Text(text) = sphere.program.translate(Language::Wgsl).unwrap() else { panic!() };
    let renamed = text.replace("th", "theta").replace("parameter_1", "held").replace("6.2831855f", "0x1.921fb6p+2f");
    let renamed = renamed.replace("gl_Position", "place");
    assert_ne!(renamed, text);
    let translations = beside(&sphere.program, Language::Wgsl, &Translation::Text(renamed));
    let compared = compare(&sphere, &translations, 16);
    assert!(compared[0].deviating.is_empty() && compared[0].agreed >= 16, "{:?}", compared[0].first);
}

#[test]
fn what_is_not_read_is_reported_with_its_reason() {
    let sphere = prepared("sphere");
    let text = Translation::Text("fn main( {".to_owned());
    let translations = beside(&sphere.program, Language::Wgsl, &text);
    let unread: Vec<_> = translations.unread().collect();
    assert!(matches!(unread[..], [(Language::Wgsl, Unread::Unsupported(why))] if why.contains("does not read back")));
    // A construct that the interpreter does not know.
    let shared =
        edited(&sphere.program, Language::Wgsl, "fn main_1() {", "var<workgroup> w: f32;\nfn main_1() {\n w = 1;");
    let translations = beside(&sphere.program, Language::Wgsl, &shared);
    let unread: Vec<_> = translations.unread().map(|(_, why)| why.clone()).collect();
    assert!(matches!(&unread[..], [Unread::Unsupported(why)] if why.contains("shared variable")), "{unread:?}");
    assert!(compare(&sphere, &translations, 2).is_empty());
}

/// Any words at all for a program.
fn any_batch(program: &Program, count: usize) -> Batch {
    let (invocation, case) = (program.invocation_record(), program.case_record());
    let mut seed = 1_u32;
    let mut word = |scalar| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        match scalar {
            base::value::Scalar::F32 => ((seed >> 8) as f32 / 65536.0 - 128.0).to_bits(),
            // Indices of arrays of two.
            _ => seed >> 31,
        }
    };
    let mut words = |record: &base::value::Record| -> Vec<u32> {
        let fields = record.fields().iter().flat_map(|f| std::iter::repeat_n(f.shape.scalar, f.shape.words()));
        fields.map(&mut word).collect()
    };
    let mut batch = Batch::with_capacity(invocation.into(), case.into(), 1, count);
    for _ in 0..count {
        batch.invocations.extend(words(&batch.invocation_record.clone()));
        batch.cases.extend(words(&batch.case_record.clone()));
    }
    batch
}

#[test]
fn padded_uniforms_are_read_at_the_bytes_where_the_host_puts_them() {
    let program = stage("uniforms.vert", UNIFORMS).program();
    let batch = any_batch(&program, 64);
    let translations = Translations::of(&program);
    assert_eq!(translations.unread().collect::<Vec<_>>(), []);
    for compared in translations.compare(&batch).unwrap() {
        assert_eq!((compared.agreed, compared.first), (64, None));
    }
    // The members are the same, and stand 16 bytes further on.
    let moved =
        edited(&program, Language::Wgsl, "near: array<vec4<f32>, 2>", "pad: vec4<f32>, near: array<vec4<f32>, 2>");
    let compared = beside(&program, Language::Wgsl, &moved).compare(&batch).unwrap();
    assert!(compared[0].deviating.len() > 32, "{compared:?}");
}

#[test]
fn the_number_of_the_vertex_is_the_same_in_every_language() {
    let text = "#version 150 core\nin vec4 p;\nvoid main() { gl_Position = p + vec4(gl_VertexID); }\n";
    let program = stage("number.vert", text).program();
    let batch = any_batch(&program, 300);
    let compared = Translations::of(&program).compare(&batch).unwrap();
    assert_eq!(compared.len(), 4);
    assert!(compared.iter().all(|one| one.agreed == 300), "{compared:?}");
    for (language, from) in [(Language::Wgsl, "p_1 = p;"), (Language::Glsl450, "p_1 = p;")] {
        let moved = edited(&program, language, from, "p_1 = p.yxzw;");
        let compared = beside(&program, language, &moved).compare(&batch).unwrap();
        assert!(compared[0].deviating.len() > 250, "{compared:?}");
    }
}

#[test]
fn a_remainder_is_the_same_in_the_steps_that_define_it() {
    let suite = "suite = \"r\"\nshader = \"r.wgsl\"\nstage = \"function\"\nentry = \"f\"\n\
                 [[inputs]]\nnames = [\"a\"]\ngenerator = \"vector\"\nrange = [-1.0, 1.0]\n";
    let suite = parse(&SourceFile::new("r.suite.toml", suite)).unwrap();
    let text = "fn f(a: vec4f) -> vec3f {\n\
                return vec3f(a.z % a.w + a.x % (a.y * 1e-15), bitcast<vec2f>(bitcast<vec2u>(a.zw % vec2f(1.0, a.x * 1e-20))));\n}\n";
    let program = prepare(&suite, &SourceFile::new("r.wgsl", text)).unwrap().program;
    let batch = any_batch(&program, 300);
    let compared = Translations::of(&program).compare(&batch).unwrap();
    assert!(compared.len() > 1 && compared.iter().all(|one| one.deviating.is_empty()), "{compared:?}");
    // Rounded to the nearest instead of towards zero it is another function.
    let moved = edited(&program, Language::Glsl450, "trunc(", "round(");
    let compared = beside(&program, Language::Glsl450, &moved).compare(&batch).unwrap();
    assert!(compared[0].deviating.len() > 50, "{compared:?}");
}

/// What a run of a suite that passes found, before its translations are looked at.
fn part(prepared: &Prepared, request: &Request) -> Part {
    let mut save = |_: &_| std::ops::ControlFlow::Continue(());
    let share = Share { shard: Shard::WHOLE, resume: None, save: &mut save, partial: false };
    let lane = embedded::open().unwrap();
    run_part(prepared, &*lane, (Stage::Compute, None), request, share, &mut |_| {}).unwrap().unwrap()
}

fn request(prepared: &Prepared) -> Request {
    Request { quick: false, ..support::request(prepared, Some(4096), Promises::of_api(Api::Binary32)) }
}

#[test]
fn a_wrong_translation_is_a_finding_with_a_shrunk_case() {
    for (suite, from, to) in [("sphere", "6.2831855f", "6.283186f"), ("hair", "4f, 1f) - (_e98", "4f, 1f) + (_e98")] {
        let prepared = prepared(suite);
        let request = request(&prepared);
        let mut part = part(&prepared, &request);
        let before = part.clone().report();
        assert!(before.findings.is_empty() && before.translations.is_empty());
        let wrong = edited(&prepared.program, Language::Wgsl, from, to);
        let right = |language| (language, prepared.program.retranslate(language));
        let mut all = vec![right(Language::SpirV), right(Language::Glsl450)];
        all.push((Language::Wgsl, prepared.program.read_back(&wrong, Language::Wgsl)));
        check_translations_with(&prepared, &Translations::new(&prepared.program, all), &request, &mut part);
        let report = part.report();
        let reported: Vec<_> =
            report.translations.iter().map(|t| (t.language, t.deviated > 0, t.agreed >= 2048)).collect();
        let [spirv, wgsl, glsl] = reported[..] else { panic!("{reported:?}") };
        assert_eq!((spirv, glsl), ((Language::SpirV, false, true), (Language::Glsl450, false, true)));
        assert_eq!((wgsl.0, wgsl.1), (Language::Wgsl, true));
        let [finding] = &report.findings[..] else { panic!("{:?}", report.findings) };
        assert_eq!((finding.kind, finding.count), (FindingKind::Translation, report.translations[1].deviated));
        assert!(finding.message.starts_with("the wgsl translation deviates from the shader: `"), "{}", finding.message);
        assert!(finding.case.as_ref().is_some_and(|case| case.rounds > 0 && case.tried > 0));
        // The case is given back as a saved one, and shows the same by itself.
        let again = Request { replay: report.failing.clone(), replay_only: true, ..request };
        assert_eq!(again.replay.len(), 1);
        let mut second = self::part(&prepared, &again);
        let wrong = vec![(Language::Wgsl, prepared.program.read_back(&wrong, Language::Wgsl))];
        check_translations_with(&prepared, &Translations::new(&prepared.program, wrong), &again, &mut second);
        let second = second.report();
        assert!(second.findings.iter().any(|f| f.message == finding.message), "{:?}", second.findings);
        let command = finding.reproduce.as_ref().unwrap();
        assert!(command.starts_with(&format!("shadercheck check {suite} --lane embedded --stage compute --case '")));
    }
}

#[test]
fn another_reading_of_naga_is_a_finding_that_names_it() {
    for (suite, from, to) in [
        ("sphere", "cos(ph)", "cos(th)"),
        ("hair", "EmitVertex();", "EmitVertex(); EndPrimitive();"),
        ("cardinal", "+ q1;", "+ q0;"),
        ("skinning", "v1 * clamp", "v2 * clamp"),
    ] {
        let prepared = prepared(suite);
        let request = request(&prepared);
        let program = &prepared.program;
        let Translation::Text(right) = program.translate(Language::NagaGlsl).unwrap() else { panic!("{suite}") };
        let body = right.rfind(from).unwrap_or_else(|| panic!("{suite}: no `{from}` in {right}"));
        let wrong = [&right[..body], &right[body..].replacen(from, to, 1)].concat();
        for (text, deviates) in [(wrong, true), (right, false)] {
            let read = program.read_back(&Translation::Text(text), Language::NagaGlsl);
            let mut part = part(&prepared, &request);
            let translations = Translations::new(program, vec![(Language::NagaGlsl, read)]);
            check_translations_with(&prepared, &translations, &request, &mut part);
            let report = part.report();
            assert_eq!(report.findings.len(), usize::from(deviates), "{suite}: {:?}", report.findings);
            for finding in &report.findings {
                assert_eq!(finding.kind, FindingKind::Translation);
                let said = "naga's GLSL reader gives the shader another meaning: ";
                assert!(finding.message.starts_with(said), "{}", finding.message);
            }
            let [read] = &report.translations[..] else { panic!("{:?}", report.translations) };
            assert_eq!((read.language, read.deviated > 0), (Language::NagaGlsl, deviates), "{suite}");
        }
    }
}

#[test]
fn right_translations_are_no_finding() {
    let prepared = prepared("sphere");
    let request = request(&prepared);
    let mut part = part(&prepared, &request);
    check_translations(&prepared, &request, &mut part);
    let report = part.report();
    assert!(report.findings.is_empty() && report.failing.is_empty());
    assert!(report.translations.len() == 4 && report.translations.iter().all(|t| t.unsupported.is_none()));
}

#[test]
fn another_interface_is_a_finding_without_a_case() {
    let prepared = prepared("sphere");
    let request = request(&prepared);
    let mut part = part(&prepared, &request);
    let moved = edited(&prepared.program, Language::Wgsl, "@location(0)", "@location(1)");
    let translations = beside(&prepared.program, Language::Wgsl, &moved);
    check_translations_with(&prepared, &translations, &request, &mut part);
    let report = part.report();
    let [finding] = &report.findings[..] else { panic!("{:?}", report.findings) };
    assert!(finding.kind == FindingKind::Translation && finding.message.contains("has another interface"));
    assert!(report.translations[0].unsupported.as_ref().is_some_and(|why| why.contains("location 1")));
}

#[test]
#[ignore = "a measurement, for release builds: cargo test --release --test it -- --ignored --nocapture time_of_all"]
fn time_of_all_shipped_suites() {
    let prepared: Vec<Prepared> = shipped().map(|suite| prepared(suite.name)).collect();
    let mut parts: Vec<_> = prepared.iter().map(|p| (p, request(p), part(p, &request(p)))).collect();
    let start = std::time::Instant::now();
    for (prepared, request, part) in &mut parts {
        check_translations(prepared, request, part);
    }
    let time = start.elapsed();
    let reports: Vec<_> = parts.into_iter().map(|(.., part)| part.report()).collect();
    let samples: u64 = reports.iter().flat_map(|report| &report.translations).map(|t| t.agreed).sum();
    let message = format!("translations of all suites: {samples} samples in {time:.1?}\n");
    assert!(time.as_secs() < 10, "{message}");
    std::io::Write::write_all(&mut std::io::stderr(), message.as_bytes()).unwrap();
}
