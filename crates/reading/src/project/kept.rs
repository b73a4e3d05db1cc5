//! What has been read of an input, for further runs over the same text: an editor lints a project again after each key,
//! and one file of it has changed.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use base::text::SourceFile;

use super::filled::{self, ByPath, PutTogether};
use super::{Input, KnownHosts, ShaderFile};
use hosts::Origin;
use hosts::Wrapper;
use hosts::language::{Language, language_of_file};
use hosts::paths::normalise;
use hosts::script::Script;
use hosts::{Found, HostFile};

/// What has been read of one text. Clones of its input share it.
#[derive(Default)]
pub(super) struct Kept(Mutex<Readings>);

impl fmt::Debug for Kept {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Kept")
    }
}

/// Whether a text is reported, and the hosts with which it is read.
type Reading = (bool, KnownHosts);

#[derive(Default)]
struct Readings {
    /// The text as a shader, reported or not, in a project with this prelude.
    shaders: Vec<(Reading, Arc<ShaderFile>)>,
    script: Option<Arc<Script>>,
    /// What a host file holds, in a project with these wrappers.
    found: Option<(Vec<Wrapper>, Arc<Found>)>,
    /// The shaders in its literals, reported or not, in a project with this prelude.
    embedded: Vec<(Reading, Vec<Arc<ShaderFile>>)>,
    /// The modules that its templates make, reported or not.
    put_together: Vec<(bool, PutTogether)>,
}

impl Kept {
    fn with<T>(&self, change: impl FnOnce(&mut Readings) -> T) -> T {
        change(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Input {
    /// The same text, of which everything that is read is kept for as long as the input and its clones live.
    #[must_use]
    pub fn kept(self) -> Self {
        Self { kept: Some(Arc::default()), ..self }
    }

    /// What a composer joins to a text may change while the text does not.
    fn keeps_itself(&self) -> Option<&Kept> {
        let text = self.file.text();
        let joins = || match language_of_file(&self.file) {
            Some(Language::Wgsl) => ["import", "#", "package::", "super::"].iter().any(|word| text.contains(word)),
            Some(Language::Shader(_) | Language::Host | Language::Script) | None => syntax::include::may_include(text),
        };
        self.kept.as_deref().filter(|_| self.composer.is_none() || !joins())
    }

    /// The text as a shader.
    pub(super) fn shader(&self, known: KnownHosts, read: impl FnOnce() -> ShaderFile) -> Arc<ShaderFile> {
        let Some(kept) = self.keeps_itself() else { return Arc::new(read()) };
        let key = (self.reported, known);
        let known = kept.with(|r| r.shaders.iter().find(|(k, _)| *k == key).map(|(_, shader)| shader.clone()));
        known.unwrap_or_else(|| {
            let shader = Arc::new(read());
            kept.with(|r| r.shaders.push((key, shader.clone())));
            shader
        })
    }

    /// The text as code of another language than C++.
    pub(super) fn script(&self) -> HostFile {
        let known = self.kept.as_ref().and_then(|kept| kept.with(|r| r.script.clone()));
        let script = known.unwrap_or_else(|| {
            let script = Arc::new(Script::read(&self.file));
            if let Some(kept) = &self.kept {
                kept.with(|r| r.script = Some(script.clone()));
            }
            script
        });
        let mut host = HostFile::of_script(&self.file, self.reported, script);
        host.named = self.named;
        host
    }

    /// Gives a host file of a project, whose wrappers are known by now, what has been found in this text.
    pub(super) fn recall(&self, host: &mut HostFile) {
        let Some(kept) = &self.kept else { return };
        kept.with(|r| match &r.found {
            Some((wrappers, found)) if wrappers == host.wrappers() => host.take_found(found.clone()),
            _ => {
                r.found = Some((host.wrappers().to_vec(), host.found()));
                r.embedded.clear();
            }
        });
    }
}

/// The shaders in the literals of a host file, which is this input where it is a file by itself.
pub(super) fn embedded(host: &HostFile, input: Option<&Input>, known: KnownHosts) -> Vec<Arc<ShaderFile>> {
    let kept = input.and_then(|i| i.kept.as_deref());
    let key = (host.reported, known);
    let read = kept.and_then(|k| k.with(|r| r.embedded.iter().find(|(k, _)| *k == key).map(|(_, all)| all.clone())));
    read.unwrap_or_else(|| {
        let all: Vec<Arc<ShaderFile>> =
            host.embedded().iter().map(|e| Arc::new(shader_in(host, e, input, known))).collect();
        if let Some(kept) = kept {
            kept.with(|r| r.embedded.push((key, all.clone())));
        }
        all
    })
}

/// The modules that templates of a script make.
pub(super) fn put_together(host: &HostFile, files: &ByPath<'_>) -> Vec<Arc<ShaderFile>> {
    let input = files.get(&normalise(host.file.name())).filter(|input| input.file == host.file);
    let kept = input.and_then(|input| input.kept.as_deref());
    let holds = |(reported, read): &&(bool, PutTogether)| *reported == host.reported && read.still_holds(files);
    let known = kept.and_then(|k| k.with(|r| r.put_together.iter().find(holds).map(|(_, read)| read.clone())));
    let read = known.unwrap_or_else(|| {
        let read = filled::put_together(host, files, input.and_then(|input| input.composer.as_ref()));
        if let Some(kept) = kept {
            kept.with(|r| {
                r.put_together.retain(|(reported, _)| *reported != host.reported);
                r.put_together.push((host.reported, read.clone()));
            });
        }
        read
    });
    read.shaders
}

fn shader_in(host: &HostFile, embedded: &hosts::Embedded, whole: Option<&Input>, known: KnownHosts) -> ShaderFile {
    // What joins a text with its imports, and reads it as naga does, knows its language by its name.
    let ending = if embedded.wgsl { ".wgsl" } else { "" };
    let file = SourceFile::new(format!("{}{ending}", embedded.name), embedded.literal.text.as_str());
    let input = if host.reported { Input::new(file) } else { Input::context(file) };
    let input = input.defining(whole.map_or(&[], |whole| &whole.defines));
    let composer = whole.and_then(|whole| whole.composer.clone()).filter(|_| embedded.wgsl);
    let input = composer.map_or(input.clone(), |composer| input.composed_by(composer));
    let mut shader = if embedded.wgsl {
        ShaderFile::wgsl(&input)
    } else if host.is_script() {
        ShaderFile::in_script(host, &input, embedded, known)
    } else {
        ShaderFile::new(&input, embedded.stage)
    };
    // One rule tells what is wrong; all else follows from it.
    shader.reported &= embedded.run_on().is_none();
    if shader.origin.is_none() {
        shader.origin = Some(Origin { host: host.file.clone(), literal: embedded.literal.clone() });
    }
    shader
}
