//! Modules in WGSL that scripts put together of templates: as far as constants and imports of the project say what is filled
//! in, they are read as any other module. What rests on something that only the program knows is told on request.

use std::collections::HashMap;
use std::sync::Arc;

use base::diagnostic::Diagnostic;
use base::text::{SourceFile, Span};
use syntax::{Shader, errors};

use super::{Input, ShaderFile};
use crate::Composer;
use hosts::HostFile;
use hosts::paths::{beside, normalise};
use hosts::script::filled::{self, Filled};
use hosts::script::strings::has_entry_point;

/// The inputs of a project by their paths.
pub(super) type ByPath<'i> = HashMap<String, &'i Input>;

/// What was read of the templates of a script, and the files that it was read from.
#[derive(Clone, Default)]
pub(super) struct PutTogether {
    from: Vec<(String, Option<SourceFile>)>,
    pub shaders: Vec<Arc<ShaderFile>>,
}

impl PutTogether {
    /// True where the project still has the files that this was read from, and no others.
    pub(super) fn still_holds(&self, files: &ByPath<'_>) -> bool {
        self.from.iter().all(|(path, file)| files.get(path).map(|input| &input.file) == file.as_ref())
    }
}

/// The modules that templates of a script make.
pub(super) fn put_together(host: &HostFile, files: &ByPath<'_>, composer: Option<&Composer>) -> PutTogether {
    let text = host.file.text();
    let mut from = Vec::new();
    if !host.is_script() || !text.contains("${") || !has_entry_point(text) {
        return PutTogether::default();
    }
    let known: Vec<Span> = host.embedded().iter().map(|embedded| embedded.place).collect();
    let found = filled::filled(&host.file, &known, &mut |importing, path| {
        let candidates = filled::candidates(&beside(importing, path));
        candidates.iter().map(|path| normalise(path)).find_map(|path| {
            let file = files.get(&path).map(|input| input.file.clone());
            from.push((path, file.clone()));
            file
        })
    });
    let whole = found.into_iter().filter(|filled| !filled.part);
    let shaders = whole.map(|filled| Arc::new(ShaderFile::put_together(host, filled, composer))).collect();
    PutTogether { from, shaders }
}

impl ShaderFile {
    fn put_together(host: &HostFile, filled: Filled, composer: Option<&Composer>) -> Self {
        let Filled { text, open, resting, .. } = filled;
        let input = if host.reported { Input::new(text) } else { Input::context(text) };
        let mut shader = match composer.filter(|_| open.is_none()) {
            Some(composer) => Self::wgsl(&input.composed_by(composer.clone())),
            None => {
                let parsed = Shader::parse_wgsl(&input.file);
                Self::read(&input, parsed)
            }
        };
        (shader.conditional, shader.put_together) = (false, true);
        if open.is_some() {
            let items = shader.shader.unit().items.as_slice();
            let functions = shader.shader.functions().filter(|(_, own)| resting.contains(&own.name.name));
            shader.taken = functions.filter_map(|(_, own)| Some(items.get(own.definition?)?.span)).collect();
            // What is not seen may declare names, and stand where the grammar asks for more.
            let all = std::mem::take(&mut shader.front_end);
            let sure = |d: &Diagnostic| errors::is_of_types(d.code) && !shader.rests_on_what_is_taken(d.span);
            let (sure, asked) = all.into_iter().partition(sure);
            (shader.front_end, shader.on_request) = (sure, asked);
        }
        shader
    }

    /// True for a module that a script puts together of templates.
    pub fn is_put_together(&self) -> bool {
        self.put_together
    }

    /// True for a place in a function of which something is not known, and was taken for something.
    pub fn rests_on_what_is_taken(&self, place: Span) -> bool {
        self.taken.iter().any(|function| function.contains(place.start))
    }
}
