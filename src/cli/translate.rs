//! `shadercheck translate`: a shader in another language.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;

use crate::cli::StageName;
use crate::cli::compose::{ComposeArgs, Given};
use crate::cli::includes::IncludedText;
use crate::cli::status::ExitStatus;
use base::diagnostic::{Diagnostic, Lang};
use base::text::{Shown, SourceFile, decode_western};
use disk::{fresh, read_source};
use program::lower::Target;
use program::{Language, Program, ProgramError, TranslateError, Translation, Written, listing, read_back};
use report::diagnostics;
use syntax::{Shader, Stage};

/// Arguments of `shadercheck translate`.
#[derive(Args, Clone, Debug)]
pub struct TranslateArgs {
    /// Shader file; the extension gives the stage (.vert, .frag, .geom, .comp). A .glsl file gives it by its text and
    /// name, or else is a function library. Host code with one shader, or the line of one in it (`pass.ts:12`)
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Language: spirv, wgsl, glsl330 (or glsl), glsl450, glsl-es310, msl, hlsl
    #[arg(long, value_name = "LANGUAGE")]
    pub to: Language,
    /// Stage of the shader, if its extension does not give it or gives another
    #[arg(long, value_enum, value_name = "STAGE")]
    pub stage: Option<StageName>,
    /// Function of a library to translate [default: the only one]
    #[arg(long, value_name = "NAME")]
    pub entry: Option<String>,
    /// Value of a macro, or of an `override` constant of WGSL: `--define WIDTH=8`; repeatable
    #[arg(short = 'D', long, value_name = "NAME=VALUE", value_parser = super::definition::definition)]
    pub define: Vec<(String, String)>,
    /// Folder to search for included files, after that of the file that includes them
    #[arg(short = 'I', long = "include", value_name = "FOLDER")]
    pub include: Vec<PathBuf>,
    /// What is stated about parts of texts in WGSL
    #[command(flatten)]
    pub compose: ComposeArgs,
    /// Host whose code surrounds the shader [default: recognised from the text]
    #[arg(long, value_name = "NAME", value_parser = super::preludes())]
    pub prelude: Option<String>,
    /// Continue after errors in code that the translation does not use; they are still printed
    #[arg(long)]
    pub lenient: bool,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Runs the command: the translation goes to `out` or to the file, diagnostics to `err`.
///
/// # Errors
/// When a file cannot be read or written.
pub fn run(args: &TranslateArgs, out: &mut dyn Write, err: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let (folders, defines, entry) = (&args.include[..], &args.define[..], args.entry.as_deref());
    let stage = args.stage.map(Stage::from);
    let stated = Given { folders, defines, compose: Some(&args.compose), entry, stage, chunks: None };
    let source = super::includes::read_one(&args.file, &stated)?;
    for note in source.notes() {
        writeln!(err, "note: {note}")?;
    }
    let written = Written::of(&source.file);
    let program = match written {
        Written::Glsl => of_glsl(args, source, err)?,
        Written::Wgsl | Written::SpirV | Written::SpirVAssembly | Written::Hlsl | Written::Slang => {
            of_module(args, &source, err)?
        }
    };
    let Some(program) = program else { return Ok(ExitStatus::Findings) };
    let name = program.file.name().to_owned();
    let translation = match program.translate(args.to) {
        Ok(translation) => translation,
        Err(error @ TranslateError::Inexpressible { .. }) => {
            writeln!(err, "error: {name}: {error}")?;
            return Ok(ExitStatus::Findings);
        }
        Err(TranslateError::Program(ProgramError::Source(found))) => {
            for diagnostic in found {
                write!(err, "{}", diagnostics::text(&diagnostic.at_origin(), Lang::En, false))?;
            }
            return Ok(ExitStatus::Findings);
        }
        Err(error) => return Err(error).with_context(|| name),
    };
    // What naga writes and does not read back is not handed out as if it were right.
    read_back(&translation, args.to, &program.role).with_context(|| name)?;
    match &args.output {
        Some(path) => write_file(path, translation)?,
        None if args.to == Language::SpirV && std::io::IsTerminal::is_terminal(&std::io::stdout()) => {
            anyhow::bail!("SPIR-V is binary; name a file with `-o FILE.spv`");
        }
        None => out.write_all(&translation.into_bytes())?,
    }
    Ok(ExitStatus::Clean)
}

/// The program of a text that is read as a module; none where diagnostics say what is wrong with it.
fn of_module(args: &TranslateArgs, source: &IncludedText, err: &mut dyn Write) -> anyhow::Result<Option<Program>> {
    let stage = args.stage.map(Stage::from);
    let program = source
        .module()
        .and_then(|text| text.program(text.meant(stage, args.entry.as_deref()), &source.values(&text, &args.define)));
    match program {
        Ok(program) => Ok(Some(program)),
        Err(ProgramError::Source(found)) => {
            report(source, found, err)?;
            Ok(None)
        }
        Err(error) => Err(error).with_context(|| source.name.clone()),
    }
}

fn report(source: &IncludedText, found: Vec<Diagnostic>, err: &mut dyn Write) -> std::io::Result<()> {
    found.into_iter().try_for_each(|diagnostic| {
        write!(err, "{}", diagnostics::text(&source.explained(diagnostic.at_origin()), Lang::En, false))
    })
}

/// The program of a text in GLSL; none where diagnostics say what is wrong with it.
fn of_glsl(args: &TranslateArgs, source: IncludedText, err: &mut dyn Write) -> anyhow::Result<Option<Program>> {
    if args.stage.is_none() && !source.printed && hosts::stage_of(&source.file).is_none() {
        anyhow::bail!(
            "{}: the extension does not tell the stage; name it with --stage, or use .vert, .frag, .geom, .comp, or .glsl \
             for a function library",
            source.name
        );
    }
    let source = source.with_prelude(super::prelude(args.prelude.as_deref()));
    let stage = args.stage.map_or(source.stage, Stage::from);
    // Hosts put a version in front of a text that states none.
    let fitted = match stage {
        Stage::Library => source.file.clone(),
        _ => syntax::fitting(&source.file, stage, &[], || None),
    };
    let file = &fitted;
    let target = |shader: &Shader| target(shader, stage, args.entry.as_deref());
    match Program::from_source_with(file, stage, &args.define, target) {
        Ok(program) => Ok(Some(program)),
        Err(ProgramError::Source(found)) => {
            report(&source, found, err)?;
            match Program::from_faulty(file, stage, &args.define, target) {
                Ok(program) if args.lenient => Ok(Some(program)),
                Ok(_) => {
                    writeln!(err, "help: `--lenient` translates the rest, which does not use this")?;
                    Ok(None)
                }
                Err(_) => Ok(None),
            }
        }
        Err(error) => Err(error).with_context(|| file.name().to_owned()),
    }
}

/// What is translated of a shader.
fn target(shader: &Shader, stage: Stage, entry: Option<&str>) -> Result<Target, ProgramError> {
    match (entry, stage) {
        (Some(name), _) => Ok(Target::Function(name.to_owned())),
        (None, Stage::Library) => {
            let mut names = shader.functions().map(|(_, f)| f.name.name.clone());
            match (names.next(), names.next()) {
                (Some(only), None) => Ok(Target::Function(only)),
                (None, _) => Ok(Target::Stage),
                (Some(first), Some(second)) => {
                    let rest: Vec<String> = names.collect();
                    let all = [vec![first, second], rest].concat().join(", ");
                    Err(ProgramError::Unsupported {
                        what: format!("a library of several functions as a whole; choose one with --entry: {all}"),
                    })
                }
            }
        }
        (None, _) => Ok(Target::Stage),
    }
}

/// Reads a text file for a command.
pub(super) fn read(path: &Path) -> anyhow::Result<SourceFile> {
    let name = path.shown();
    if path.is_dir() {
        anyhow::bail!("`{name}` is a folder; name a file in it");
    }
    decoded(&name, &read_source(path).with_context(|| format!("cannot read `{name}`"))?)
}

/// A text from its bytes.
pub(super) fn decoded(name: &str, bytes: &[u8]) -> anyhow::Result<SourceFile> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        anyhow::bail!("`{name}` is empty");
    }
    if Written::of_path(name) == Written::SpirV {
        return listing(name, bytes).map_err(|why| anyhow::anyhow!(why));
    }
    Ok(decode_western(name, bytes)?.file)
}

fn write_file(path: &Path, translation: Translation) -> anyhow::Result<()> {
    let context = || format!("cannot write `{}`", path.shown());
    fresh::write(path, &translation.into_bytes()).with_context(context)
}
