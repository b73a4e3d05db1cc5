//! From a test to a program, a batch and the colors that are expected.

use std::sync::Arc;

use anyhow::{Result, bail};
use base::text::SourceFile;
use base::value::{Batch, Record, Scalar};
use program::lower::Target;
use program::{Program, ProgramError, contain};
use syntax::Stage;

use super::format::{Case, Section, ShaderTest, Values};

/// A test made ready to run: one case for each draw, one invocation a case.
pub struct Converted {
    /// The stage under test.
    pub stage: Stage,
    /// What is run.
    pub program: Program,
    /// Inputs of all cases.
    pub batch: Batch,
    /// Words of the output that holds the color.
    pub color: std::ops::Range<usize>,
    /// The color of each case.
    pub expected: Vec<Vec<f32>>,
}

/// Why a test is not run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped(pub String);

fn skip<T>(why: impl Into<String>) -> std::result::Result<T, Skipped> {
    Err(Skipped(why.into()))
}

/// Name of the function that a compute stage becomes.
const FUNCTION: &str = "piglit_main";
/// Name of its output.
const COLOR: &str = "piglit_color";

/// The stage whose built-in functions a test is about: the last one before the colors are handed on.
pub fn tested(test: &ShaderTest) -> Option<Section> {
    let has = |section| test.stages.contains_key(&section);
    if has(Section::Compute) {
        return Some(Section::Compute);
    }
    let fragment = test.stages.get(&Section::Fragment)?;
    match handed_on(fragment) {
        Some(_) if has(Section::Geometry) => Some(Section::Geometry),
        Some(_) if has(Section::Vertex) => Some(Section::Vertex),
        _ => Some(Section::Fragment),
    }
}

/// The input that a fragment stage hands on as its color and does nothing else.
fn handed_on(text: &str) -> Option<String> {
    let body = text.split_once("main")?.1.split_once('{')?.1;
    let inner = body.rsplit_once('}')?.0.trim().strip_suffix(';')?;
    let (to, from) = inner.split_once('=')?;
    let name = |s: &str| s.trim().chars().all(|c| c.is_alphanumeric() || c == '_').then(|| s.trim().to_owned());
    name(to)?;
    name(from)
}

/// A compute stage that stores its color in an image, as a function that gives it back.
fn without_image(text: &str) -> std::result::Result<String, Skipped> {
    let mut out = String::new();
    let mut stored = false;
    for line in text.lines() {
        let code = line.trim();
        if code.contains("uniform image2D") || code.starts_with("ivec2 coord") {
            out.push('\n');
            continue;
        }
        if let Some(rest) = code.strip_prefix("imageStore(") {
            let Some(color) = rest.strip_suffix(");").and_then(|r| r.splitn(3, ',').nth(2)) else {
                return skip("a compute stage that stores its color in another way");
            };
            out.push_str(&format!("  {COLOR} = {};\n", color.trim()));
            stored = true;
            continue;
        }
        out.push_str(&line.replace("void main()", &format!("void {FUNCTION}(out vec4 {COLOR})")));
        out.push('\n');
    }
    // The stage has to have a `main`, whatever is run of it.
    out.push_str("void main() {}\n");
    if stored { Ok(out) } else { skip("a compute stage that stores its color in another way") }
}

/// Makes a test ready.
///
/// # Errors
/// Why it cannot run.
pub fn convert(name: &str, test: &ShaderTest) -> std::result::Result<Converted, Skipped> {
    if test.cases.is_empty() {
        return skip("nothing is probed");
    }
    let wide = |v: &Values| v.ty.starts_with('d') || v.ty.contains("64");
    if test.cases.iter().any(|c| c.uniforms.values().any(wide)) {
        return skip("numbers of 64 bits");
    }
    let Some(section) = tested(test) else { return skip("no stage whose color is seen") };
    let Some(text) = test.text(section) else { return skip("no stage whose color is seen") };
    let (text, target) = match section {
        Section::Compute => (without_image(&text)?, Target::Function(FUNCTION.to_owned())),
        Section::Vertex | Section::Geometry | Section::Fragment => (text, Target::Stage),
    };
    let color = match section {
        Section::Compute => Some(COLOR.to_owned()),
        Section::Fragment => None,
        Section::Vertex | Section::Geometry => test.stages.get(&Section::Fragment).and_then(|t| handed_on(t)),
    };
    let file = SourceFile::new(name, text);
    let program = contain(|| Program::from_source(&file, section.stage(), |_| Ok(target)))
        .map_err(|panic| Skipped(format!("panic: {panic}")))?
        .map_err(|e| Skipped(reason(e)))?;
    if let Some(found) = program.unfed.first() {
        return skip(found.message.to_string());
    }
    let output = program.output_layout().vertex;
    let index = match color {
        Some(name) => output.index_of(&name),
        // The only output of the fragment stage, whatever its name.
        None => (output.fields().len() == 1).then_some(0),
    };
    let Some(index) = index else { return skip("no output that holds the color") };
    let color = output.range(index);
    let batch = batch(&program, test).map_err(|e| Skipped(format!("{e:#}")))?;
    let expected = test.cases.iter().map(|c| c.color.clone()).collect();
    Ok(Converted { stage: section.stage(), program, batch, color, expected })
}

/// Why there is no program, without what differs from test to test.
fn reason(error: ProgramError) -> String {
    match error {
        ProgramError::Source(found) => found.first().map_or_else(String::new, |d| format!("{} {}", d.code, d.message)),
        ProgramError::Unsupported { what } => what,
        ProgramError::Internal(what) => format!("internal: {}", what.chars().take(120).collect::<String>()),
    }
}

/// One case for each draw. Inputs of the stage are those of the first vertex.
fn batch(program: &Program, test: &ShaderTest) -> Result<Batch> {
    let cases = &test.cases;
    let (invocation, case) = (Arc::new(program.invocation_record()), Arc::new(program.case_record()));
    let mut batch = Batch::with_capacity(invocation.clone(), case.clone(), 1, cases.len());
    for values in cases {
        for (index, field) in invocation.fields().iter().enumerate() {
            let given = test.vertex.get(&field.name);
            for k in 0..invocation.range(index).len() {
                batch.invocations.push(match given.and_then(|v| Some((v, v.components.get(k)?))) {
                    Some((values, text)) => word(&values.ty, field.shape.scalar, text)?,
                    // What the fetch fills in.
                    None if k == 3 && field.shape.scalar == Scalar::F32 => 1.0_f32.to_bits(),
                    None => 0,
                });
            }
        }
        batch.cases.extend(uniforms(&case, values)?);
    }
    Ok(batch)
}

/// The words of the uniforms of a draw. What is not set is 0.
fn uniforms(record: &Record, case: &Case) -> Result<Vec<u32>> {
    let mut words = vec![0; record.words()];
    for (k, field) in record.fields().iter().enumerate() {
        let range = record.range(k);
        // An array is set whole or element by element.
        let size = field.shape.element_words();
        let elements = range.clone().step_by(size).enumerate();
        let parts = elements.map(|(e, at)| (format!("{}[{e}]", field.name), at..at + size));
        for (name, range) in std::iter::once((field.name.clone(), range)).chain(parts) {
            let Some(values) = case.uniforms.get(&name) else { continue };
            if values.components.len() != range.len() {
                bail!("`{name}` of type `{}` is set with {} numbers", field.shape, values.components.len());
            }
            for (at, text) in range.zip(&values.components) {
                words[at] = word(&values.ty, field.shape.scalar, text)?;
            }
        }
    }
    Ok(words)
}

/// A component as the runner reads it: bits where it begins with `0x`, else a number of the type that is named.
fn word(ty: &str, scalar: Scalar, text: &str) -> Result<u32> {
    let bad = || anyhow::anyhow!("`{text}` is no number of type `{ty}`");
    let digits = text.trim_end_matches(['u', 'U']);
    let word = if let Some(hex) = digits.strip_prefix("0x") {
        u32::from_str_radix(hex, 16)?
    } else if ty.starts_with("int") || ty.starts_with("ivec") {
        i32::try_from(digits.parse::<i64>()?)?.cast_unsigned()
    } else if ty.starts_with('u') {
        // As strtoul does, negative numbers wrap around.
        u32::try_from(digits.parse::<i64>()?.rem_euclid(1 << 32))?
    } else if ty == "float" || ty.starts_with("vec") || ty.starts_with("mat") {
        digits.parse::<f32>().map_err(|_| bad())?.to_bits()
    } else {
        return Err(bad());
    };
    let zero = word == 0 || (ty.starts_with(['f', 'v', 'm']) && f32::from_bits(word) == 0.0);
    Ok(if scalar == Scalar::Bool { u32::from(!zero) } else { word })
}
