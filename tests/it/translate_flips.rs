//! naga can turn positions upside down for other APIs while it writes. The author's `gl_Position`
//! stays as it is: a shader test that compares positions would otherwise compare something else.

use naga::back::{glsl, spv};
use naga::proc::BoundsCheckPolicies;
use naga::{Block, Constant, Expression, Function, Handle, Literal, Module, ShaderStage, Statement, UnaryOperator};
use program::lower::Role;
use program::{Language, Program, Translation, read_back};

use crate::lowering::{names, shipped};

/// True when a translation ends with a flip of the position.
fn flips(translation: &Translation, language: Language, role: &Role) -> bool {
    match translation {
        Translation::Text(text) => text.contains("-gl_Position.y") || text.contains("gl_Position.yz ="),
        Translation::Words(_) => {
            let module = read_back(translation, language, role).unwrap().unwrap();
            let functions =
                module.functions.iter().map(|(_, f)| f).chain(module.entry_points.iter().map(|e| &e.function));
            functions.into_iter().any(|f| stores_negated_y(&module, f, &f.body))
        }
    }
}

/// `x.y = -…` of anything: no shipped shader does that by itself. A label of SPIR-V becomes a block.
fn stores_negated_y(module: &Module, function: &Function, body: &Block) -> bool {
    let expression = |handle: Handle<Expression>| &function.expressions[handle];
    let is_one = |constant: Handle<Constant>| {
        let value = &module.global_expressions[module.constants[constant].init];
        *value == Expression::Literal(Literal::U32(1))
    };
    body.iter().any(|statement| match statement {
        Statement::Store { pointer, value } => {
            let to_y = match expression(*pointer) {
                Expression::AccessIndex { index, .. } => *index == 1,
                Expression::Access { index, .. } => {
                    matches!(expression(*index), Expression::Constant(constant) if is_one(*constant))
                }
                _ => false,
            };
            to_y && matches!(expression(*value), Expression::Unary { op: UnaryOperator::Negate, .. })
        }
        Statement::Block(inner) => stores_negated_y(module, function, inner),
        _ => false,
    })
}

#[test]
fn no_translation_flips_the_position() {
    for name in names() {
        let program = shipped(name).program();
        for language in Language::ALL {
            if let Ok(translation) = program.translate(language) {
                assert!(!flips(&translation, language, &program.role), "{name} as {language}");
            }
        }
    }
}

/// The same program, written with naga's flip. WGSL, MSL and HLSL have no such option.
fn flipped(program: &Program, language: Language) -> Translation {
    let (module, info): (&Module, _) = (&program.module, &program.info);
    if language == Language::SpirV {
        let flags = spv::WriterFlags::DEBUG | spv::WriterFlags::ADJUST_COORDINATE_SPACE;
        let options = spv::Options { flags, ..spv::Options::default() };
        return Translation::Words(spv::write_vec(module, info, &options, None).unwrap());
    }
    let version = if language == Language::Glsl330 {
        glsl::Version::Desktop(330)
    } else {
        glsl::Version::Embedded { version: 310, is_webgl: false }
    };
    let writer_flags = glsl::WriterFlags::ADJUST_COORDINATE_SPACE;
    let options = glsl::Options { version, writer_flags, ..glsl::Options::default() };
    let pipeline =
        glsl::PipelineOptions { shader_stage: ShaderStage::Vertex, entry_point: "main".to_owned(), multiview: None };
    let mut text = String::new();
    let policies = BoundsCheckPolicies::default();
    glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies).unwrap().write().unwrap();
    Translation::Text(text)
}

#[test]
fn a_flip_is_found() {
    for name in ["sphere", "two_bones", "hair_vert"] {
        let program = shipped(name).program();
        for language in [Language::SpirV, Language::Glsl330, Language::GlslEs310] {
            let translation = flipped(&program, language);
            assert!(flips(&translation, language, &program.role), "{name} as {language}: {translation:?}");
        }
    }
}
