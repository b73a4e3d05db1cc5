//! Texts of several files, and those that a compiler reads, for commands that run them.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;

use super::check::shell_word;
use super::chunks::Chunks;
use super::translate::read;
use base::text::SourceFile;
use compose::Options;
use engine::suite::{Asked, Joined};
use syntax::Stage;

/// What is stated about texts in WGSL that are parts of others, and about those that a compiler reads.
#[derive(Args, Clone, Debug, Default)]
pub struct ComposeArgs {
    /// File that the host puts before a text in WGSL; it supplies names that the text does not declare; repeatable
    #[arg(long = "with", value_name = "FILE")]
    pub with: Vec<PathBuf>,
    /// Give the resources of a text in WGSL a group and a binding if none of them has one, as its host does
    #[arg(long)]
    pub assign_bindings: bool,
    /// Compiler for HLSL and Slang: a `slangc` or `glslangValidator` [default: `SHADERCHECK_COMPILER`, or the first one
    /// that is found]
    #[arg(long, value_name = "PROGRAM")]
    pub compiler: Option<PathBuf>,
}

impl ComposeArgs {
    /// The same as words of a command line, each with a blank in front.
    pub fn words(&self) -> String {
        let mut words = String::new();
        let mut add =
            |option: &str, path: &Path| words += &format!(" {option} {}", shell_word(&path.to_string_lossy()));
        self.with.iter().for_each(|file| add("--with", file));
        self.compiler.iter().for_each(|program| add("--compiler", program));
        if self.assign_bindings {
            words += " --assign-bindings";
        }
        words
    }
}

/// What is stated about the texts of a command.
#[derive(Clone, Copy, Default)]
pub struct Given<'a> {
    /// Folders that are searched.
    pub folders: &'a [PathBuf],
    /// Names with values.
    pub defines: &'a [(String, String)],
    /// What concerns some languages; none where a command has no options for it.
    pub compose: Option<&'a ComposeArgs>,
    /// The entry point and the stage that are asked for.
    pub entry: Option<&'a str>,
    /// Its stage.
    pub stage: Option<Stage>,
    /// Where strings are looked for that texts include by name; none where they are not.
    pub chunks: Option<&'a RefCell<Chunks>>,
}

impl Given<'_> {
    /// The text of a file in WGSL with what it imports; none for other languages.
    ///
    /// # Errors
    /// When a file that is there cannot be read.
    pub fn joined(&self, file: &SourceFile) -> anyhow::Result<Option<Joined>> {
        let stated = self.compose.cloned().unwrap_or_default();
        let options = Options {
            defines: self.defines.to_vec(),
            preludes: stated.with.iter().map(|path| read(path)).collect::<anyhow::Result<_>>()?,
            assign_bindings: stated.assign_bindings,
            ..Options::default()
        };
        let asked = Asked { entry: self.entry.map(str::to_owned), stage: self.stage, compiler: stated.compiler };
        Joined::of(file, self.folders, &options, &asked).with_context(|| file.name().to_owned())
    }
}
