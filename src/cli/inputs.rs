//! Options about a shader and its inputs, which commands share that run functions.

use std::path::PathBuf;

use clap::Args;

use super::StageName;
use super::check::shell_word;
use super::compose::{ComposeArgs, Given};
use engine::fuzz::{self, Stated};
use engine::suite::run::DEFAULT_SEED;

/// What is said of shaders and their inputs.
#[derive(Args, Clone, Debug, Default)]
pub struct InputArgs {
    /// Stage of the files, if their extensions do not give it or give another
    #[arg(long, value_enum, value_name = "STAGE")]
    pub stage: Option<StageName>,
    /// Values that an input takes: `x=[0,1]`, `f.x=(0,inf)`, `n=normalised`, `m=rotation`; repeatable
    #[arg(long, value_name = "INPUT=DOMAIN", allow_hyphen_values = true)]
    pub domain: Vec<String>,
    /// Value of a macro, or of an `override` constant of WGSL: `--define WIDTH=8`; repeatable
    #[arg(short = 'D', long, value_name = "NAME=VALUE", value_parser = super::definition::definition)]
    pub define: Vec<(String, String)>,
    /// Folders to search for included files
    #[arg(short = 'I', long = "include", value_name = "FOLDER")]
    pub include: Vec<PathBuf>,
    /// Seed of the inputs: the same seed gives the same inputs everywhere
    #[arg(long, value_name = "S", default_value_t = DEFAULT_SEED)]
    pub seed: u64,
}

impl InputArgs {
    /// The stage that is stated.
    pub fn stage(&self) -> Option<syntax::Stage> {
        self.stage.map(syntax::Stage::from)
    }

    /// How a file is read.
    pub fn reading<'a>(&'a self, compose: Option<&'a ComposeArgs>, entry: Option<&'a str>) -> Given<'a> {
        Given { folders: &self.include, defines: &self.define, compose, entry, stage: self.stage(), chunks: None }
    }

    /// The domains that are stated.
    ///
    /// # Errors
    /// One that cannot be read.
    pub fn domains(&self) -> anyhow::Result<Vec<Stated>> {
        domains(&self.domain)
    }

    /// The same as words of a command line, each after a space; without the seed.
    pub fn words(&self) -> String {
        let mut words = String::new();
        let mut add = |option: &str, value: &str| words.push_str(&format!(" {option} {}", shell_word(value)));
        self.include.iter().for_each(|folder| add("-I", &folder.display().to_string()));
        self.define.iter().for_each(|(name, value)| add("--define", &format!("{name}={value}")));
        if let Some(stage) = self.stage {
            add("--stage", &stage.word());
        }
        self.domain.iter().for_each(|domain| add("--domain", domain));
        words
    }
}

/// What `--domain` states.
///
/// # Errors
/// One that cannot be read.
pub fn domains(options: &[String]) -> anyhow::Result<Vec<Stated>> {
    let mut stated = Vec::new();
    for text in options {
        stated.extend(fuzz::option(text).map_err(|why| anyhow::anyhow!("--domain `{text}`: {why}"))?);
    }
    Ok(stated)
}
