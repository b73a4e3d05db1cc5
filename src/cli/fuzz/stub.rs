//! A first suite beside a shader, for `--write-suite`.

use std::fmt::Write as _;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::IncludedText;
use base::text::Shown;
use base::value::{Field, Scalar, Shape};
use disk::fresh;
use engine::fuzz::{FunctionReport, Law};
use engine::guess::{self, Guess, Role};

/// Range of an input for which none is stated.
const RANGE: (f64, f64) = (-2.0, 2.0);

/// Writes a suite file for a function that ran, beside its file. A file that is there already is told and left alone.
///
/// # Errors
/// When a file cannot be written.
pub fn write(source: &IncludedText, function: &FunctionReport, err: &mut dyn Write) -> anyhow::Result<()> {
    if function.not_run.is_some() {
        return Ok(());
    }
    let name = &function.function;
    let text = match suite(source, function) {
        Ok(text) => text,
        Err(why) => return Ok(writeln!(err, "note: no suite for `{name}`: {why}")?),
    };
    let path = beside(&source.path, name);
    // Made new or not at all, whatever comes in between.
    match fresh::create(&path, text.as_bytes()) {
        Ok(()) => writeln!(err, "note: wrote {}", path.shown())?,
        Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
            writeln!(err, "note: `{}` is there already and stays as it is", path.shown())?;
        }
        Err(error) => return Err(error).with_context(|| format!("cannot write `{}`", path.shown())),
    }
    Ok(())
}

/// `lib.glsl` and `blend` give `lib.blend.suite.toml`.
fn beside(path: &Path, function: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}.{function}.suite.toml"))
}

fn suite(source: &IncludedText, function: &FunctionReport) -> Result<String, String> {
    let name = &function.function;
    if name.contains('(') {
        return Err("the file has several functions of this name".to_owned());
    }
    let shader = source.path.file_name().unwrap_or_default().to_string_lossy();
    let mut text = format!(
        "# A first suite: say what the function should give (`shadercheck explain suite` lists every key), and\n\
         # narrow the ranges of its inputs. Until then lanes are held against what the function itself means.\n\
         suite = {}\ntitle = {}\nshader = {}\n",
        quoted(name),
        quoted(&format!("{name} of {shader}")),
        quoted(&shader)
    );
    if name == "main" {
        let _ = writeln!(text, "stage = {}", quoted(source.stage.name()));
    } else {
        let _ = writeln!(text, "stage = \"function\"\nentry = {}", quoted(name));
    }
    text.push_str("# reference = { file = \"reference.glsl\", function = \"expected\" }\n# recorded = \"values.csv\"\n# relations = []\n");
    for (input, laws) in &function.inputs {
        let (ty, input) = input.split_once(' ').unwrap_or(("", input));
        if input.contains(['.', '[']) {
            return Err(format!("its input `{input}` is a part of a structure, which suites do not feed"));
        }
        let shape: Shape = ty.parse().map_err(|_| format!("its input `{input}` is of type `{ty}`"))?;
        let guess = laws.is_empty().then(|| guess::of(&Field { name: input.into(), shape }, Role::Parameter));
        let about = guess.as_ref().map_or_else(String::new, |guess| format!(" # taken for {}", guess.taken_for));
        let _ = writeln!(text, "\n[[inputs]]{about}\nnames = [{}]", quoted(input));
        match guess {
            Some(Guess { generator, range, .. }) => {
                let _ = writeln!(text, "generator = \"{generator}\"");
                range.iter().for_each(|[low, high]| {
                    let _ = writeln!(text, "range = [{low:?}, {high:?}]");
                });
            }
            None => text.push_str(&generator(shape, laws)),
        }
    }
    Ok(text)
}

/// The generator that comes nearest to what is stated.
fn generator(shape: Shape, laws: &[Law]) -> String {
    let interval = laws.iter().find_map(|law| match law {
        Law::Within(interval) => Some(*interval),
        Law::Normalised | Law::NonZero | Law::Rotation | Law::Whole => None,
    });
    let end = |x: f64, other: f64| if x.is_finite() { x } else { other };
    let (low, high) = interval.map_or(RANGE, |i| {
        let low = end(i.low, (i.high - 4.0).min(RANGE.0));
        (low, end(i.high, (low + 4.0).max(RANGE.1)))
    });
    let ranged = |name: &str| format!("generator = \"{name}\"\nrange = [{low:?}, {high:?}]\n");
    if shape.scalar == Scalar::Bool {
        return "generator = \"index\"\nrange = [0.0, 1.0]\n".to_owned();
    }
    if shape.scalar != Scalar::F32 {
        let (low, high) = if interval.is_some() { (low.ceil(), high.floor()) } else { (0.0, 8.0) };
        return format!("generator = \"index\"\nrange = [{low:?}, {high:?}]\n");
    }
    match (shape.columns > 1, laws.contains(&Law::Normalised), laws.contains(&Law::Rotation)) {
        (true, _, true) => "generator = \"rigid\"\n".to_owned(),
        (true, _, false) => "generator = \"affine\"\n".to_owned(),
        (false, true, _) => "generator = \"direction\"\n".to_owned(),
        (false, false, _) => ranged("interval"),
    }
}

/// A text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
