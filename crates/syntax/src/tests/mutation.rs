//! Damaged shaders: no panic, no hang, and the laws that hold for every text.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;
use crate::ast::ItemKind;

/// Laws of any parsed text.
fn laws(text: &str, stage: Stage) {
    let parsed = parse(text, stage);
    let shader = &parsed.shader;
    let inside = |span: Span| span.start <= span.end && span.end <= text.len() && text.is_char_boundary(span.start);
    assert!(parsed.diagnostics.iter().all(|d| inside(d.span) && !d.message.is_empty()), "{text}");
    assert!(parsed.diagnostics.windows(2).all(|w| w[0].span.start <= w[1].span.start));
    assert!(shader.arena().iter().all(|(_, e)| inside(e.span)));
    assert!(shader.tokens().windows(2).all(|w| w[0].span.end <= w[1].span.start));
    for variable in shader.interface().variables() {
        assert!(inside(variable.declaration_span) && variable.position < variable.siblings);
        let first = &text[variable.declarator_span.range()];
        assert!(variable.name_span.start >= variable.declarator_span.start && !first.is_empty());
    }
    for item in &shader.unit().items {
        assert!(inside(item.span), "{text}");
        // A syntax error is never silent.
        assert!(!matches!(item.kind, ItemKind::Error) || !parsed.diagnostics.is_empty());
    }
}

/// How many damaged shaders are read. `SHADERCHECK_MUTANTS=100000 cargo test --lib damaged_shaders` reads more.
fn rounds() -> usize {
    option_env!("SHADERCHECK_MUTANTS").and_then(|n| n.parse().ok()).unwrap_or(5000)
}

#[test]
fn damaged_shaders_are_survived() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(0x5eed);
    let mut below = |n: usize| usize::try_from(rng.next_u64() % n as u64).unwrap();
    const PIECES: &[&str] = &[
        "(",
        ")",
        "{",
        "}",
        "[",
        "]",
        ";",
        ",",
        ".",
        "#",
        "##",
        "\n",
        "\"",
        "//",
        "/*",
        "*/",
        "\\\n",
        "=",
        "0x",
        "1e",
        "#define A(",
        "#if",
        "#endif",
        "struct",
        "layout(",
        "in ",
        "頂",
        "?",
        ":",
        "float ",
        "gl_in",
        "return",
        "#version 300 es\n",
        "#version 110\n",
        "#extension GL_ARB_gpu_shader5 : enable\n",
        "switch (",
        "case 1:",
        "default:",
        "uniform U {",
        "out gl_PerVertex {",
        "precision highp float;",
        "invariant ",
        "const ",
        "flat ",
        "%",
        "1u",
        "[0]",
        "[-1]",
        ".xxx",
        "void main() {",
    ];
    for round in 0..rounds() {
        let (source, stage) = SHADERS[round % SHADERS.len()];
        let mut bytes = source.as_bytes().to_vec();
        for _ in 0..=below(4) {
            let at = below(bytes.len());
            match below(5) {
                0 => bytes[at] = u8::try_from(below(256)).unwrap(),
                1 => {
                    let end = (at + 1 + below(40)).min(bytes.len());
                    bytes.drain(at..end);
                }
                2 => {
                    let piece = PIECES[below(PIECES.len())];
                    bytes.splice(at..at, piece.bytes());
                }
                3 => {
                    let end = (at + below(80)).min(bytes.len());
                    let copy = bytes[at..end].to_vec();
                    let to = below(bytes.len());
                    bytes.splice(to..to, copy);
                }
                _ => bytes.truncate(at.max(1)),
            }
            if bytes.is_empty() {
                bytes.push(b' ');
            }
        }
        laws(&String::from_utf8_lossy(&bytes), stage);
    }
}

#[test]
fn every_prefix_of_a_shader_is_survived() {
    for (source, stage) in [(HAIR, Stage::Geometry), (GRAMMAR, Stage::Fragment)] {
        for (at, _) in source.char_indices() {
            laws(&source[..at], stage);
        }
    }
}

#[test]
fn a_shader_without_damage_keeps_the_laws() {
    for (source, stage) in SHADERS {
        laws(source, *stage);
    }
}
