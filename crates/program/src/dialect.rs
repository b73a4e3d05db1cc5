//! naga's own GLSL reader as a front end under test: the author's text in its dialect, and the module that it makes of
//! that text. Nothing else is made from this module.
//!
//! A text that this reader refuses is no failure. Constants that it folds step by step in binary32 count as the
//! numbers that the author means.

use naga::compact::KeepUnused;
use naga::front::glsl;
use naga::valid::ShaderStages;
use naga::{AddressSpace, Binding, Module, ShaderStage, TypeInner};

use super::translate::{TranslateError, chain};
use super::{Entry, Language, Program, contain, validator};
use crate::lower::{Places, Refused, Role, Target, lower};
use base::text::{Edited, Span};
use syntax::Stage;

impl Program {
    /// The author's text with the interface that naga's reader takes.
    ///
    /// # Errors
    /// What the dialect lacks.
    pub(super) fn in_dialect(&self) -> Result<Edited, String> {
        let shader = self.constants.glsl().ok_or("no program of GLSL")?;
        let target = match &self.role {
            Role::Function { name } => Target::Function(name.clone()),
            Role::Vertex | Role::Fragment | Role::Compute | Role::Geometry(_) => Target::Stage,
        };
        let first = |refused: Vec<Refused>| refused.into_iter().next().map_or_else(String::new, |first| first.why);
        lower(shader, &target, &self.places()).map_err(first)
    }

    /// The text with the interface that naga reads, for translators that refuse the author's; none where that is the
    /// same, or does not exist.
    pub fn rewritten(&self) -> Option<String> {
        self.in_dialect().ok().map(|edited| edited.text).filter(|text| text != self.file.text())
    }

    /// Where the interface of this program lies, so that another module of the text is bound alike.
    fn places(&self) -> Places {
        let mut places = Places::default();
        let location = |binding: &Option<Binding>| match binding {
            Some(Binding::Location { location, .. }) => Some(*location),
            Some(Binding::BuiltIn(_)) | None => None,
        };
        if let Entry::Point(index) = self.entry {
            let function = &self.module.entry_points[index].function;
            let inputs = function.arguments.iter().filter_map(|a| Some((a.name.clone()?, location(&a.binding)?)));
            places.inputs = Some(inputs.collect());
            let result = function.result.as_ref().map(|result| &self.module.types[result.ty].inner);
            let members = match result {
                Some(TypeInner::Struct { members, .. }) => members.as_slice(),
                _ => &[],
            };
            let outputs = members.iter().filter_map(|m| Some((m.name.clone()?, location(&m.binding)?)));
            places.outputs = Some(outputs.collect());
        }
        let uniforms = self.module.global_variables.iter().filter(|(_, v)| v.space == AddressSpace::Uniform);
        places.uniforms =
            uniforms.filter_map(|(_, v)| Some((v.name.clone()?, v.binding.map(|b| (b.group, b.binding))?))).collect();
        places
    }

    /// What naga's reader makes of a text in its dialect; `None` where it leaves out what only a device can do, which
    /// then cannot be compared.
    ///
    /// # Errors
    /// [`TranslateError::ReadBack`] when it refuses the text, with the author's place where it gives one.
    pub(super) fn read_by_naga(&self, edited: &Edited) -> Result<Option<Module>, TranslateError> {
        let language = Language::NagaGlsl;
        let fails = |reason: String| TranslateError::ReadBack { language, reason };
        let stage = if self.stage == Stage::Vertex { ShaderStage::Vertex } else { ShaderStage::Compute };
        let options = glsl::Options { stage, defines: self.defines.iter().cloned().collect() };
        let mut module = contain(|| glsl::Frontend::default().parse(&options, &edited.text))
            .map_err(|panic| fails(format!("naga panicked: {panic}")))?
            .map_err(|errors| fails(errors.errors.first().map_or_else(String::new, |e| self.refusal(edited, e))))?;
        // What the entry point does not reach stays: a function may be what is run.
        contain(|| naga::compact::compact(&mut module, KeepUnused::Yes))
            .map_err(|panic| fails(format!("naga panicked: {panic}")))?;
        let info = contain(|| validator().validate(&module).map_err(Box::new))
            .map_err(|panic| fails(format!("naga panicked: {panic}")))?
            .map_err(|error| fails(chain(error.as_inner())))?;
        // A function alone runs as compute: one that discards or takes derivatives does not.
        let alone =
            |function: naga::Handle<naga::Function>| info[function].available_stages.contains(ShaderStages::COMPUTE);
        let runs = matches!(self.entry, Entry::Point(_)) || module.functions.iter().all(|(f, _)| alone(f));
        Ok(runs.then_some(module))
    }

    /// An error of naga's reader at its place in the author's text.
    fn refusal(&self, edited: &Edited, error: &glsl::Error) -> String {
        let place = error.meta.to_range().map(|range| edited.map.span_to_original(Span::new(range.start, range.end)));
        let place = place.map_or_else(String::new, |span| format!("{}: ", self.file.locate(span.start)));
        format!("{place}{}", error.kind)
    }
}
