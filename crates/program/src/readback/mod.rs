//! A translation read back into a module, with the shader's interface found again in it.
//!
//! A vertex, fragment or compute stage is found by what a host sees: attributes and varyings by location, buffers
//! by binding and the places of their words. A geometry stage and a function are ordinary functions
//! inside the kernel that is translated; they are run there, by themselves, and what they read and
//! write is found by name.

mod alone;
mod feed;
pub(super) mod glsl;
mod kernel;
mod names;
mod stage;

use std::sync::Arc;

use naga::compact::KeepUnused;
use naga::valid::ModuleInfo;
use naga::{BuiltIn, Handle, Module, Type};

use feed::Feed;

use super::translate::{Language, TranslateError, Translation, read_back};
use super::{Entry, PortAt, Program, ProgramError, Texture, Written, contain, validate};
use crate::lower::Role;
use base::text::{Edited, PositionMap};
use base::value::{Batch, Field, Record, Scalar, Shape};

/// A value of the interface in the module that was read back.
#[derive(Clone, Debug)]
pub struct Place {
    /// Name, for messages.
    pub name: String,
    /// Its type in that module.
    pub ty: Handle<Type>,
    /// Where it lies.
    pub at: PortAt,
}

/// A translation as it is read.
#[derive(Clone, Debug)]
pub struct ReadBack {
    /// Language that was read.
    pub language: Language,
    /// The module; variables and functions that have a meaning by their name bear the author's.
    pub module: Module,
    /// What the validator found out about it.
    pub info: ModuleInfo,
    /// What is run.
    pub entry: Entry,
    /// What one invocation takes.
    pub inputs: Vec<Place>,
    /// What one case takes.
    pub uniforms: Vec<Place>,
    /// What one vertex, primitive vertex or call gives, in the order of the program's outputs.
    pub outputs: Vec<Place>,
    /// Built-in arguments of the entry point, by argument index.
    pub built_ins: Vec<(u32, BuiltIn)>,
    /// What its images and samplers are bound to.
    pub textures: Vec<Texture>,
    /// For a geometry stage, the number of vertices that are stored.
    pub max_vertices: Option<u32>,
    /// What one vertex or call gives, the same for the program and all its translations.
    pub record: Arc<Record>,
    /// For each word that an invocation takes here, where it comes from.
    invocation: Vec<Feed>,
    /// For each word of the buffers here, where it comes from.
    case: Vec<Feed>,
}

impl Program {
    /// Translates the program and reads it back; for [`Language::NagaGlsl`], has naga read the author's own text.
    /// `None` for a language that naga does not read, or a construct of it.
    ///
    /// # Errors
    /// [`TranslateError`]: the language lacks something, naga refuses what it wrote, or what it wrote
    /// has another interface.
    pub fn retranslate(&self, language: Language) -> Result<Option<ReadBack>, TranslateError> {
        if language == Language::NagaGlsl {
            // What the dialect lacks is nothing that its reader gets wrong.
            let Ok(edited) = self.in_dialect() else { return Ok(None) };
            return self.read_by_naga(&edited)?.map(|module| self.bind(language, module)).transpose();
        }
        if !Language::READ_BACK.contains(&language) {
            return Ok(None);
        }
        self.read_back(&self.translate(language)?, language)
    }

    /// The program itself, bound as a translation to this language is. `None` for one that is run as it is: a
    /// geometry stage or a function.
    ///
    /// # Errors
    /// [`TranslateError`]: it takes or gives what cannot be bound.
    pub fn bound(&self, language: Language) -> Result<Option<ReadBack>, TranslateError> {
        match self.role {
            Role::Vertex | Role::Fragment | Role::Compute => stage::own(self, language).map(Some),
            Role::Geometry(_) | Role::Function { .. } => Ok(None),
        }
    }

    /// Reads back any text or words that claim to be a translation of this program. `None` for a
    /// language that is not read.
    ///
    /// # Errors
    /// [`TranslateError`]: its reader refuses it, or it has another interface.
    pub fn read_back(&self, translation: &Translation, language: Language) -> Result<Option<ReadBack>, TranslateError> {
        if let (Translation::Text(text), Language::NagaGlsl) = (translation, language) {
            let edited = Edited { text: text.clone(), map: PositionMap::identity(text.len()) };
            return self.read_by_naga(&edited)?.map(|module| self.bind(language, module)).transpose();
        }
        let Some(mut module) = read_back(translation, language, &self.role)? else { return Ok(None) };
        // A reader puts an access to every block into every function. What has no effect is left out.
        contain(|| naga::compact::compact(&mut module, KeepUnused::No))
            .map_err(|panic| ProgramError::internal(format!("naga panicked: {panic}")))?;
        self.bind(language, module).map(Some)
    }

    /// Finds the interface of this program in another module of it.
    fn bind(&self, language: Language, module: Module) -> Result<ReadBack, TranslateError> {
        match self.role {
            Role::Vertex | Role::Fragment | Role::Compute => stage::resolve(self, language, module),
            Role::Geometry(_) | Role::Function { .. } => {
                let info = validate(&module)?;
                kernel::resolve(self, language, module, info)
            }
        }
    }
}

impl ReadBack {
    /// The same inputs, laid out as the module that was read back takes them: each invocation is a case of its own.
    pub fn feed(&self, batch: &Batch) -> Batch {
        let count = batch.invocation_count();
        let laid = |words: &[Feed]| -> Vec<u32> {
            let of = |k: usize| words.iter().map(move |feed| feed.word(k, batch.invocation(k), batch.case_of(k)));
            if words.is_empty() { Vec::new() } else { (0..count).flat_map(of).collect() }
        };
        Batch {
            invocation_record: record(self.invocation.len()),
            case_record: record(self.case.len()),
            // With no words at all, the number of invocations is the one of a case.
            per_case: if self.case.is_empty() && self.invocation.is_empty() { count } else { 1 },
            invocations: laid(&self.invocation),
            cases: laid(&self.case),
        }
    }
}

/// The program's textures in a module that was read back: those whose image has the same binding.
fn textures(program: &Program, module: &Module, grouped: bool) -> Vec<Texture> {
    let binding = |module: &Module, handle: naga::Handle<naga::GlobalVariable>| module.global_variables[handle].binding;
    // The module of a text that naga reads keeps the author's bindings beside those of kernels.
    let host = program.stage_module.as_deref().filter(|_| program.written != Written::Glsl);
    let host = host.map_or(&program.module, |(module, _)| module);
    let mut all = Vec::new();
    for texture in &program.textures {
        let find = |own: naga::Handle<naga::GlobalVariable>| {
            let wanted = binding(host, own)?;
            let mut found = module.global_variables.iter();
            let here = |b: naga::ResourceBinding| b.binding == wanted.binding && (!grouped || b.group == wanted.group);
            let same = |v: &naga::GlobalVariable| v.space == naga::AddressSpace::Handle && v.binding.is_some_and(here);
            found.find(|(_, v)| same(v)).map(|(handle, _)| handle)
        };
        if let Some(image) = find(texture.image) {
            all.push(Texture { image, sampler: texture.sampler.and_then(find), ..texture.clone() });
        }
    }
    all
}

/// A record of so many words.
fn record(words: usize) -> Arc<Record> {
    let shape = Shape::vector(Scalar::U32, 1).array_of(words as u32);
    let field = (words > 0).then(|| Field { name: "words".to_owned(), shape });
    Arc::new(Record::new(field.into_iter().collect()))
}
