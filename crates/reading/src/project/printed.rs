//! What belongs together because it is printed together: in one document, in one folder, on one command line.

use std::collections::BTreeMap;

use syntax::Stage;

use super::{Project, ShaderFile};
use hosts::HostFile;
use hosts::paths::{file_name, folder, normalise, stem};

impl Project {
    /// The whole shaders of each document, in the order of the text, as sets of different stages that stand one
    /// after the other.
    pub fn document_programs(&self) -> BTreeMap<&str, Vec<Vec<&ShaderFile>>> {
        let mut documents: BTreeMap<&str, Vec<Vec<&ShaderFile>>> = BTreeMap::new();
        for shader in self.embedded.values().filter(|s| !s.partial) {
            let Some(place) = &shader.place else { continue };
            let sets = documents.entry(place.document.as_str()).or_default();
            let stage = shader.shader.stage();
            match sets.last_mut() {
                Some(set) if stage != Stage::Library && set.iter().all(|s| s.shader.stage() != stage) => {
                    set.push(shader)
                }
                _ => sets.push(vec![shader]),
            }
        }
        documents
    }

    /// Sets of shaders that a host file may be about when it names none: those of its document; those that were
    /// named together with it; or, for statements as a book prints them, those in its folder.
    pub fn around(&self, host: &HostFile) -> Vec<Vec<&ShaderFile>> {
        if let Some(place) = &host.place {
            return self.document_programs().remove(place.document.as_str()).unwrap_or_default();
        }
        let path = normalise(host.file.name());
        let mut sets: BTreeMap<(&str, &str), Vec<&ShaderFile>> = BTreeMap::new();
        let fragment = host.is_fragment();
        for (at, shader) in &self.shaders.by_path {
            if (host.named && shader.named) || (fragment && folder(at) == folder(&path)) {
                sets.entry((folder(at), stem(at))).or_default().push(shader);
            }
        }
        let sets: Vec<Vec<&ShaderFile>> = sets.into_values().collect();
        let all: Vec<&ShaderFile> = sets.concat();
        let stages: Vec<Stage> = all.iter().map(|s| s.shader.stage()).collect();
        if stages.iter().enumerate().all(|(i, s)| *s != Stage::Library && !stages[..i].contains(s)) {
            return if all.is_empty() { Vec::new() } else { vec![all] };
        }
        // Of several programs only what is surely no file of its own is given one.
        if fragment { sets } else { Vec::new() }
    }

    /// The shader that the document of a host listing calls so.
    pub(super) fn shader_called(&self, host: &HostFile, name: &str) -> Option<&ShaderFile> {
        let document = &host.place.as_ref()?.document;
        let same = |s: &&ShaderFile| s.place.as_ref().is_some_and(|p| p.document == *document);
        let called = |s: &&ShaderFile| s.called.as_deref().is_some_and(|c| file_name(c) == file_name(name));
        let mut found = self.embedded.values().map(|s| &**s).filter(same).filter(called);
        found.next().filter(|_| found.next().is_none())
    }
}
