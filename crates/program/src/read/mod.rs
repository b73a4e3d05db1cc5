//! Texts whose front end is a reader of naga: WGSL, SPIR-V in its two forms, and what a compiler of HLSL or Slang makes
//! SPIR-V of.
//!
//! A text in GLSL is built from our own syntax tree, because naga's reader of GLSL takes text that is not GLSL. Its
//! reader of WGSL refuses what the language refuses, so that it is the front end here: from its module come the
//! entry points, the interface and the places in the author's text. A module has several entry points and functions;
//! what is run is chosen from it, and everything that this does not use is left out.
//!
//! Tint, which reads the author's text on the lane `webgpu`, is the second opinion on WGSL. The module as written is
//! kept for translations; the syntax tree of the same text supplies what a module lacks: digits of literals,
//! comments, and places for edits.

mod choose;
mod compiled;
mod digits;
mod flat;
mod function;
mod language;
mod lines;
mod outline;
mod ports;
mod program;
mod ranges;
mod registers;
mod rows;
mod sampled;
mod spirv;
mod stops;
mod switches;
mod values;
mod wgsl;

use naga::{Module, ShaderStage};

use std::sync::Arc;

use crate::{Constants, Parameter, ProgramError};
use base::text::{SourceFile, Span};
use syntax::{Shader, Stage, Token};

pub use choose::Chosen;
pub use compiled::OWN;
pub use outline::{Head, Outline, Param, Way};

use compiled::Compiled;

pub(crate) use flat::flat_if_needed;
pub use language::Written;
pub(crate) use ports::{Elements, parts_of};
pub use spirv::listing;
pub use wgsl::holds_in_any_version;

/// A text as naga reads it.
#[derive(Clone, Debug)]
pub struct ModuleText {
    module: Module,
    file: SourceFile,
    written: Written,
    /// The syntax tree of a text that has one.
    tree: Option<Arc<Shader>>,
    constants: Arc<Constants>,
    /// What is known of a text that a compiler made a module of.
    compiled: Compiled,
}

/// Something of a module that can be run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Runnable {
    /// Its name.
    pub name: String,
    /// The stage of an entry point; [`Stage::Library`] for a function.
    pub stage: Stage,
    /// The place of its name.
    pub span: Span,
    /// The parameters of a function; none of an entry point, which a host feeds.
    pub parameters: Vec<Parameter>,
}

impl ModuleText {
    /// Reads a text. All places are those of `file`: where it was put together from others
    /// ([`base::text::Assembly`]), errors are told at the author's places by [`base::diagnostic::Diagnostic::at_origin`].
    ///
    /// # Errors
    /// [`ProgramError::Source`] with the place of what the language does not allow.
    pub fn read(file: &SourceFile, written: Written) -> Result<Self, ProgramError> {
        let module = match written {
            Written::Wgsl => wgsl::read(file)?,
            Written::SpirV => spirv::read_listing(file)?,
            Written::SpirVAssembly | Written::Glsl | Written::Hlsl | Written::Slang => {
                return Err(ProgramError::internal(format!("{} is not read as a module", written.name())));
            }
        };
        let tree = (written == Written::Wgsl).then(|| Arc::new(Shader::parse_wgsl(file).shader));
        let constants = tree.as_ref().map_or_else(Arc::default, |tree| Arc::new(Constants::new(tree.clone())));
        Ok(Self { module, file: file.clone(), written, tree, constants, compiled: Compiled::default() })
    }

    /// Reads a text in assembly, whose words an assembler gave.
    ///
    /// # Errors
    /// As of [`ModuleText::read`].
    pub fn read_assembly(file: &SourceFile, words: &[u32]) -> Result<Self, ProgramError> {
        let module = spirv::read_assembly(file, words)?;
        let (tree, constants) = (None, Arc::default());
        let (written, compiled) = (Written::SpirVAssembly, Compiled::default());
        Ok(Self { module, file: file.clone(), written, tree, constants, compiled })
    }

    /// The syntax tree; none for SPIR-V. It may lack what only naga reads.
    pub fn tree(&self) -> Option<&Shader> {
        self.tree.as_deref()
    }

    /// The text.
    pub fn file(&self) -> &SourceFile {
        &self.file
    }

    /// What it is written in.
    pub fn written(&self) -> Written {
        self.written
    }

    /// What a name means: a function, or else an entry point. Without a name, the only function of a text that has no
    /// entry point.
    pub fn meant<'a>(&'a self, stage: Option<Stage>, name: Option<&'a str>) -> Chosen<'a> {
        if self.written.is_compiled() {
            let functions = &self.compiled.functions;
            return match (name, &functions[..]) {
                (Some(name), _) if self.functions().iter().any(|own| own.name == name) => Chosen::Function(name),
                (None, [(only, _)]) if self.points().is_empty() => Chosen::Function(only),
                _ => Chosen::Point { stage, name },
            };
        }
        let mut names = self.module.functions.iter().filter_map(|(_, function)| function.name.as_deref());
        match name {
            Some(name) if names.any(|own| own == name) => Chosen::Function(name),
            None if self.module.entry_points.is_empty() && self.module.functions.len() == 1 => {
                names.next().map_or(Chosen::Point { stage, name }, Chosen::Function)
            }
            _ => Chosen::Point { stage, name },
        }
    }

    /// Its entry points, in the order of the text.
    pub fn points(&self) -> Vec<Runnable> {
        let one = |point: &naga::EntryPoint| Runnable {
            name: point.name.clone(),
            stage: stage_of(point.stage).unwrap_or(Stage::Library),
            span: self.place_of("fn", &point.name),
            parameters: Vec::new(),
        };
        let own = self.module.entry_points.iter().map(one);
        own.chain(self.compiled.beside.iter().flat_map(Self::points)).collect()
    }

    /// Its functions that are no entry points, in the order of the text.
    pub fn functions(&self) -> Vec<Runnable> {
        if self.written.is_compiled() {
            let one = |name: &String, span: Span| Runnable {
                name: name.clone(),
                stage: Stage::Library,
                span,
                parameters: self.head(name).map(Head::parameters).unwrap_or_default(),
            };
            let mut all: Vec<Runnable> = self.compiled.functions.iter().map(|(name, span)| one(name, *span)).collect();
            let left_out = self.compiled.left_out.iter().map(|(name, span, _)| one(name, *span));
            all.extend(
                left_out
                    .filter(|out| self.compiled.functions.iter().all(|(name, _)| *name != out.name))
                    .collect::<Vec<_>>(),
            );
            let points = self.points();
            all.retain(|function| points.iter().all(|point| point.name != function.name));
            all.sort_by_key(|function| function.span.start);
            return all;
        }
        let one = |(_, function): (_, &naga::Function)| {
            let name = function.name.clone()?;
            let parameters = function.arguments.iter().map(|a| Parameter::of_module(&self.module, a.ty)).collect();
            Some(Runnable { stage: Stage::Library, span: self.place_of("fn", &name), name, parameters })
        };
        let mut all: Vec<Runnable> = self.module.functions.iter().filter_map(one).collect();
        // naga has them in the order in which they call each other.
        all.sort_by_key(|function| function.span.start);
        // What a reader makes of an entry point is none of them.
        all.retain(|function| self.module.entry_points.iter().all(|point| point.name != function.name));
        all
    }

    /// Names of its `override` constants, with their places.
    pub fn overrides(&self) -> Vec<(String, Span)> {
        let names = self.module.overrides.iter().filter_map(|(_, constant)| constant.name.clone());
        names.map(|name| (name.clone(), self.place_of("override", &name))).collect()
    }

    /// Those of some values that are meant for its `override` constants.
    pub fn taken(&self, values: &[(String, String)]) -> Vec<(String, String)> {
        let constants = self.overrides();
        values.iter().filter(|(name, _)| constants.iter().any(|(constant, _)| constant == name)).cloned().collect()
    }

    /// The place of a name that is declared behind a keyword.
    fn place_of(&self, keyword: &str, name: &str) -> Span {
        if self.written.is_compiled() {
            let known = self.compiled.functions.iter().find(|(own, _)| own == name).map(|(_, span)| *span);
            return self.head(name).map(|head| head.span).or(known).unwrap_or_default();
        }
        let text = self.file.text();
        if let Some(tree) = &self.tree {
            // naga keeps no place for the name of an entry point.
            let is = |token: &Token, wanted: &str| &text[token.span.range()] == wanted;
            let found = tree.tokens().windows(2).find(|pair| is(&pair[0], keyword) && is(&pair[1], name));
            return found.map(|pair| pair[1].span).unwrap_or_default();
        }
        let quoted = format!("\"{name}\"");
        let names = |line: &&str| {
            let op = line.contains("OpEntryPoint") || line.contains("OpName");
            op && line.contains(&quoted)
        };
        let line = text.split_inclusive('\n').find(names);
        let start = line.map_or(0, |line| line.as_ptr() as usize - text.as_ptr() as usize);
        Span::new(start, start + line.map_or(0, |line| line.trim_end().len()))
    }
}

/// The stage of an entry point; `None` for those of meshes and rays.
fn stage_of(stage: ShaderStage) -> Option<Stage> {
    match stage {
        ShaderStage::Vertex => Some(Stage::Vertex),
        ShaderStage::Fragment => Some(Stage::Fragment),
        ShaderStage::Compute => Some(Stage::Compute),
        ShaderStage::Task
        | ShaderStage::Mesh
        | ShaderStage::RayGeneration
        | ShaderStage::Miss
        | ShaderStage::AnyHit
        | ShaderStage::ClosestHit => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_in_a_comment_is_no_declaration() {
        let text = "// fn main\nfn  main() {}";
        let read = ModuleText::read(&SourceFile::new("a.wgsl", text), Written::Wgsl).unwrap();
        assert_eq!(read.place_of("fn", "main"), Span::new(15, 19));
        assert_eq!(read.place_of("fn", "mai"), Span::default());
    }
}
