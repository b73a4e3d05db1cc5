//! The files of one run, read once: shaders with their interface, host files with their tree.

mod filled;
mod kept;
mod printed;
mod shader;
mod template;
mod words;

use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use base::text::{SourceFile, Span};
use syntax::{Looks, Stage};

use super::composed::Composer;
use super::config::Config;
use super::open;
use super::prelude::Wanted;
use super::program::{self, Program};
use hosts::Origin;
use hosts::cpp::{Fed, named_shaders, wrappers_of_project};
use hosts::document::{Document, Listing};
use hosts::language::{Language, SHADER_EXTENSIONS, language_of, language_of_file, stage_of};
use hosts::paths::{beside, extension, file_name, normalise, stem};
use hosts::script::Given;
use hosts::sections::{sections, template};
use hosts::{HostFile, HostTree, ShaderRef};

use filled::ByPath;

pub use shader::ShaderFile;

/// True for a text that other tools write in another language under an ending that GLSL shares with them: engines
/// their own `.shader`, assembly programs `.vp` and `.fp`, anyone `.cont` and `.eval`; and HLSL in a folder of that name.
fn is_other_language(path: &str, text: &str) -> bool {
    // Programs in assembly begin so: `!!ARBvp1.0`.
    if text.trim_start().starts_with("!!") {
        return true;
    }
    match extension(path).to_ascii_lowercase().as_str() {
        "shader" => true,
        // Shells have scripts with this ending.
        "csh" => !hosts::marks::has_main(text),
        "vp" | "fp" | "cont" | "eval" => !hosts::marks::has_main(text) && !text.contains("#version"),
        // F# has the ending of fragment shaders, and ends no statement.
        "fs" | "vs" | "gs" if !hosts::marks::has_main(text) => ends_nothing(text),
        _ => {
            let of_hlsl = path.split(['/', '\\']).any(|folder| folder.eq_ignore_ascii_case("hlsl"));
            of_hlsl && syntax::looks_like(text, Looks::Glsl).is_some_and(|(other, _)| other == Looks::Hlsl)
        }
    }
}

/// True for a text with code in which no semicolon ends a line or a block.
fn ends_nothing(text: &str) -> bool {
    let code = hosts::marks::without_comments(text);
    let lines = || code.lines().map(str::trim).filter(|line| !line.is_empty());
    lines().any(|line| !line.starts_with('#')) && !lines().any(|line| line.ends_with(';') || line.contains("; }"))
}

/// What is known of the hosts of a project before its texts are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct KnownHosts {
    /// The prelude that texts get.
    wanted: Wanted,
    /// Whether something in the project gives texts to OpenGL.
    given: Given,
}

/// A text to lint. Its name is its path, with `/` between the parts.
#[derive(Clone, Debug)]
pub struct Input {
    /// Name and text.
    pub file: SourceFile,
    /// False when the file is only there to be looked things up in.
    pub reported: bool,
    /// True when the file was named by itself, and not found in a folder.
    pub named: bool,
    /// The stage that is stated for it: it is a shader then, whatever its name says.
    pub stage: Option<Stage>,
    /// Macros that are defined from outside, with their values.
    defines: Arc<[(String, String)]>,
    /// The syntax tree of a host file, once it has been asked for: companions are looked for before
    /// rules run, and the text is parsed once for both.
    tree: HostTree,
    /// What joins a text with what it imports or includes.
    composer: Option<Composer>,
    /// What has been read of it, where that is kept for further runs.
    kept: Option<Arc<kept::Kept>>,
}

impl Input {
    /// A text whose diagnostics are wanted.
    pub fn new(file: SourceFile) -> Self {
        let (defines, tree) = (Arc::default(), HostTree::default());
        Self { file, reported: true, named: false, stage: None, defines, tree, composer: None, kept: None }
    }

    /// A text that others refer to; nothing is reported on it.
    pub fn context(file: SourceFile) -> Self {
        Self { reported: false, ..Self::new(file) }
    }

    /// The same text, named by itself: files that are named together belong together.
    #[must_use]
    pub fn named(self) -> Self {
        Self { named: true, ..self }
    }

    /// The same text as a shader of this stage.
    #[must_use]
    pub fn with_stage(self, stage: Stage) -> Self {
        Self { stage: Some(stage), ..self }
    }

    /// The same text, with macros that are defined from outside.
    #[must_use]
    pub fn defining(self, defines: &[(String, String)]) -> Self {
        Self { defines: defines.into(), ..self }
    }

    /// The same text, with what joins it with its imports or includes.
    #[must_use]
    pub fn composed_by(self, composer: Composer) -> Self {
        Self { composer: Some(composer), ..self }
    }

    /// The same text, reported or not.
    #[must_use]
    pub fn with_reported(&self, reported: bool) -> Self {
        Self { reported, ..self.clone() }
    }

    /// Another text under the same name.
    #[must_use]
    pub fn with_file(&self, file: SourceFile) -> Self {
        let (composer, kept) = (self.composer.clone(), self.kept.as_ref().map(|_| Arc::default()));
        let (named, stage, defines) = (self.named, self.stage, self.defines.clone());
        Self { reported: self.reported, named, stage, defines, composer, kept, ..Self::new(file) }
    }

    fn host(&self) -> HostFile {
        let mut host = HostFile::with_tree(&self.file, self.reported, self.tree.clone());
        host.named = self.named;
        host
    }
}

/// Files by normalised path, and the paths by the name of the file.
struct Files<T> {
    by_path: BTreeMap<String, T>,
    by_name: HashMap<String, Vec<String>>,
}

impl<T> Files<T> {
    fn insert(&mut self, path: String, file: T) {
        if !self.by_path.contains_key(&path) {
            self.by_name.entry(file_name(&path).to_owned()).or_default().push(path.clone());
        }
        self.by_path.insert(path, file);
    }
}

impl<T> Default for Files<T> {
    fn default() -> Self {
        Self { by_path: BTreeMap::new(), by_name: HashMap::new() }
    }
}

/// All files of a run.
pub struct Project {
    shaders: Files<Arc<ShaderFile>>,
    /// Shaders in literals of host files and in files with several, by the path and their index there.
    embedded: BTreeMap<(String, usize), Arc<ShaderFile>>,
    hosts: Files<HostFile>,
    config: Config,
    /// Words of all shaders, once they have been asked for.
    words: OnceLock<HashSet<u64>>,
    /// What host code feeds, once it has been asked for.
    fed: OnceLock<Fed>,
}

/// An input, read by what its name says it is.
enum Read {
    Shader(Arc<ShaderFile>),
    Sections(Vec<ShaderFile>),
    Host(Box<HostFile>),
    Document(Vec<ShaderFile>, Vec<HostFile>),
}

impl Read {
    fn new(input: &Input, known: KnownHosts) -> (String, Option<Self>) {
        let KnownHosts { wanted, given } = known;
        let path = normalise(input.file.name());
        let language = language_of_file(&input.file);
        if let Some(stage) = input.stage.filter(|_| language != Some(Language::Wgsl)) {
            let shader = input.shader(known, || ShaderFile::of_file(input, stage, known));
            return (path, Some(Self::Shader(shader)));
        }
        let read = match language {
            Some(Language::Shader(_)) if open::is_raw_string_file(input.file.text()) => {
                Some(Self::Host(Box::new(input.host())))
            }
            Some(Language::Shader(stage)) => {
                let parts = sections(&input.file);
                if !parts.is_empty() {
                    Some(Self::Sections(parts.into_iter().map(|p| ShaderFile::part(input, p)).collect()))
                } else if let Some(literal) = template(&input.file) {
                    Some(Self::Sections(vec![ShaderFile::filled_in(input, (stage, literal), wanted)]))
                } else if is_other_language(&path, input.file.text()) {
                    None
                } else {
                    let stage = stage_of(&input.file).unwrap_or(stage);
                    Some(Self::Shader(input.shader(known, || ShaderFile::of_file(input, stage, known))))
                }
            }
            Some(Language::Wgsl) => Some(Self::Shader(input.shader(known, || ShaderFile::wgsl(input)))),
            Some(Language::Host) => Some(Self::Host(Box::new(input.host()))),
            Some(Language::Script) => Some(Self::Host(Box::new(input.script()))),
            None => Document::read(&input.file).map(|document| Self::document(input, document, given)),
        };
        (path, read)
    }

    fn document(input: &Input, document: Document, given: Given) -> Self {
        let shaders = document.shaders.into_iter().map(|l| ShaderFile::of_document(input, l, given)).collect();
        let host = |listing: Listing, script: bool| {
            let text = input.with_file(SourceFile::new(listing.name, listing.literal.text.as_str()));
            let mut host = if script { text.script() } else { text.host() };
            host.origin = Some(Origin { host: input.file.clone(), literal: listing.literal });
            host.place = Some(listing.place);
            host
        };
        let mut hosts: Vec<HostFile> = document.hosts.into_iter().map(|listing| host(listing, false)).collect();
        hosts.extend(document.script.map(|listing| host(listing, true)));
        Self::Document(shaders, hosts)
    }
}

impl Project {
    /// Reads all inputs. Of two with the same path, the reported one counts.
    pub fn new(files: &[Input], config: &Config) -> Self {
        let mut project = Self {
            shaders: Files::default(),
            embedded: BTreeMap::new(),
            hosts: Files::default(),
            config: config.clone(),
            words: OnceLock::new(),
            fed: OnceLock::new(),
        };
        let (context, reported): (Vec<&Input>, Vec<&Input>) = files.iter().partition(|f| !f.reported);
        let inputs: Vec<&Input> = context.into_iter().chain(reported).collect();
        let wanted = config.prelude.in_project(inputs.iter().map(|i| i.file.text()));
        let known = KnownHosts { wanted, given: Given::of(inputs.iter().map(|input| &input.file)) };
        let read: Vec<(String, Option<Read>)> = inputs.into_par_iter().map(|input| Read::new(input, known)).collect();
        for (path, read) in read {
            match read {
                Some(Read::Shader(shader)) => {
                    project.shaders.insert(path, shader);
                }
                Some(Read::Sections(parts)) => {
                    let keyed = parts.into_iter().enumerate().map(|(i, part)| ((path.clone(), i), Arc::new(part)));
                    project.embedded.extend(keyed);
                }
                Some(Read::Host(host)) => {
                    project.hosts.insert(path, host.with_wrappers(&config.wrappers));
                }
                Some(Read::Document(shaders, hosts)) => {
                    let keyed = shaders.into_iter().enumerate().map(|(i, part)| ((path.clone(), i), Arc::new(part)));
                    project.embedded.extend(keyed);
                    for host in hosts {
                        project.hosts.insert(normalise(host.file.name()), host.with_wrappers(&config.wrappers));
                    }
                }
                None => {}
            }
        }
        let wrappers = wrappers_of_project(project.hosts.by_path.values());
        project.hosts.by_path.values_mut().for_each(|h| h.add_wrappers(&wrappers));
        let by_path: ByPath<'_> = files.iter().map(|input| (normalise(input.file.name()), input)).collect();
        for (path, host) in &mut project.hosts.by_path {
            if let Some(input) = by_path.get(path) {
                input.recall(host);
            }
        }
        let hosts: Vec<(&String, &HostFile)> = project.hosts.by_path.iter().collect();
        let embedded: Vec<((String, usize), Arc<ShaderFile>)> = hosts
            .into_par_iter()
            .flat_map_iter(|(path, host)| {
                let all = kept::embedded(host, by_path.get(path).copied(), known);
                all.into_iter().enumerate().map(move |(index, shader)| ((path.clone(), index), shader))
            })
            .collect();
        project.embedded.extend(embedded);
        project.put_together(&by_path);
        project
    }

    /// Adds the modules that scripts put together of templates.
    fn put_together(&mut self, files: &ByPath<'_>) {
        let hosts: Vec<(&String, &HostFile)> = self.hosts.by_path.iter().collect();
        let found: Vec<((String, usize), Arc<ShaderFile>)> = hosts
            .into_par_iter()
            .flat_map_iter(|(path, host)| {
                let all = kept::put_together(host, files);
                let first = host.embedded().len();
                all.into_iter().enumerate().map(move |(index, shader)| ((path.clone(), first + index), shader))
            })
            .collect();
        self.embedded.extend(found);
    }

    /// What the project says about itself.
    pub fn config(&self) -> &Config {
        &self.config
    }

    /// All shaders: files by path, then those in literals of host files.
    pub fn shaders(&self) -> impl Iterator<Item = &ShaderFile> {
        self.shaders.by_path.values().chain(self.embedded.values()).map(|shader| &**shader)
    }

    /// The shader files, without those in literals, by path.
    pub fn shader_files(&self) -> impl Iterator<Item = (&str, &ShaderFile)> {
        self.shaders.by_path.iter().map(|(path, shader)| (path.as_str(), &**shader))
    }

    /// The shaders of each file that holds several.
    pub fn sections(&self) -> Vec<Vec<&ShaderFile>> {
        let mut files: BTreeMap<&str, Vec<&ShaderFile>> = BTreeMap::new();
        let is_shader = |path: &str| matches!(language_of(path), Some(Language::Shader(_)));
        for ((path, _), shader) in self.embedded.iter().filter(|((path, _), s)| is_shader(path) && s.place.is_none()) {
            files.entry(path).or_default().push(shader);
        }
        files.into_values().collect()
    }

    /// The shader that a host file means.
    pub fn shader_of(&self, host: &HostFile, shader: &ShaderRef) -> Option<&ShaderFile> {
        match shader {
            ShaderRef::File(name) => {
                self.shader_called(host, name).or_else(|| self.shader_named(host.file.name(), name))
            }
            ShaderRef::Embedded(index) => self.embedded_in(host, *index),
        }
    }

    /// The module in WGSL that is the string at a place of a host file.
    pub fn module_at(&self, host: &HostFile, place: Span) -> Option<&ShaderFile> {
        let index = host.embedded().iter().position(|e| e.wgsl && e.place == place)?;
        self.embedded_in(host, index)
    }

    fn embedded_in(&self, host: &HostFile, index: usize) -> Option<&ShaderFile> {
        self.embedded.get(&(normalise(host.file.name()), index)).map(|shader| &**shader)
    }

    /// All programs whose stages are known for certain.
    pub fn programs(&self) -> Vec<Program<'_>> {
        program::find(self)
    }

    /// The program that the configuration states for a host file, when it states one.
    pub fn configured_for(&self, host: &str) -> Option<Program<'_>> {
        let host = normalise(host);
        let has = |path: &String| host == normalise(path) || host.ends_with(&format!("/{}", normalise(path)));
        let mut entries = self.config.programs.iter().filter(|p| p.hosts.iter().any(has));
        match (entries.next(), entries.next()) {
            (Some(entry), None) => self.configured(&entry.shaders),
            _ => None,
        }
    }

    /// The program of shaders that the configuration names.
    pub fn configured(&self, paths: &[String]) -> Option<Program<'_>> {
        let found: Vec<Option<&ShaderFile>> = paths.iter().map(|p| self.shader_named("", p)).collect();
        let all = found.iter().all(Option::is_some);
        Program::new(found.into_iter().flatten().collect(), all)
    }

    /// All host files, by path.
    pub fn hosts(&self) -> impl Iterator<Item = &HostFile> {
        self.hosts.by_path.values()
    }

    /// The attributes that the host files feed.
    pub fn fed(&self) -> &Fed {
        self.fed.get_or_init(|| Fed::of(self.hosts()))
    }

    /// The shader that the host file called `from` means by `name`: the path from the host file, or
    /// the one shader of the run whose path ends so.
    pub fn shader_named(&self, from: &str, name: &str) -> Option<&ShaderFile> {
        lookup(&self.shaders, from, name).map(|shader| &**shader)
    }

    /// The host file that `from` means by `#include "name"`, found like a shader.
    pub fn host_named(&self, from: &str, name: &str) -> Option<&HostFile> {
        lookup(&self.hosts, from, name)
    }

    /// Shaders in the folder of `host` that bear its name.
    pub fn shaders_beside(&self, host: &str) -> Vec<&ShaderFile> {
        let host = normalise(host);
        let name = stem(&host);
        let start = format!("{}.", &host[..host.len() - file_name(&host).len() + name.len()]);
        let from = self.shaders.by_path.range(start.clone()..);
        from.take_while(|(path, _)| path.starts_with(&start)).map(|(_, shader)| &**shader).collect()
    }
}

fn lookup<'p, T>(files: &'p Files<T>, from: &str, name: &str) -> Option<&'p T> {
    if let Some(found) = files.by_path.get(&beside(from, name)) {
        return Some(found);
    }
    let tail = normalise(name);
    let mut tail = tail.trim_start_matches("../");
    // A path in Qt's resources begins with what stands in no folder.
    if let Some(resource) = tail.strip_prefix("qrc:").or(tail.strip_prefix(':')) {
        tail = resource.trim_start_matches('/');
        let known = |t: &str| files.by_name.get(file_name(t)).is_some_and(|all| all.iter().any(|p| p.ends_with(t)));
        while let Some((_, rest)) = tail.split_once('/').filter(|_| !known(tail)) {
            tail = rest;
        }
    }
    let mut ending = files
        .by_name
        .get(file_name(tail))?
        .iter()
        .filter(|path| path.strip_suffix(tail).is_some_and(|rest| rest.is_empty() || rest.ends_with('/')));
    match (ending.next(), ending.next()) {
        (Some(only), None) => files.by_path.get(only),
        _ => None,
    }
}

/// Paths of files that `input` refers to and that help to judge it: the shaders that a host file
/// names or bears the name of, and the headers it includes with quotation marks. They need not exist.
pub fn companions(input: &Input) -> Vec<String> {
    let name = input.file.name();
    match language_of_file(&input.file) {
        Some(Language::Shader(_) | Language::Wgsl | Language::Script) => Vec::new(),
        Some(Language::Host) => companions_of(&input.host(), name),
        None => {
            let hosts = Document::read(&input.file).map(|d| d.hosts).unwrap_or_default();
            let text = |l: &Listing| SourceFile::new(l.name.as_str(), l.literal.text.as_str());
            hosts.iter().flat_map(|l| companions_of(&HostFile::new(&text(l), true), name)).collect()
        }
    }
}

fn companions_of(host: &HostFile, name: &str) -> Vec<String> {
    let mut paths: Vec<String> = named_shaders(host).into_iter().map(|s| beside(name, &s)).collect();
    if paths.is_empty() {
        let base = beside(name, stem(name));
        paths.extend(SHADER_EXTENSIONS.iter().map(|ending| format!("{base}.{ending}")));
    }
    paths.extend(hosts::cpp::quoted_includes(host).into_iter().map(|i| beside(name, i)));
    paths.sort();
    paths.dedup();
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(name: &str, text: &str) -> Input {
        Input::new(SourceFile::new(name, text))
    }

    #[test]
    fn a_shader_elsewhere_is_found_only_when_there_is_one() {
        let files = [input("x/a.vert", ""), input("y/a.vert", ""), input("y/b.vert", "")];
        let project = Project::new(&files, &Config::default());
        let name = |from: &str, shader: &str| project.shader_named(from, shader).map(|s| s.file.name().to_owned());
        assert_eq!(name("x/m.cpp", "a.vert").as_deref(), Some("x/a.vert"));
        assert_eq!(name("m.cpp", "a.vert"), None, "two of them");
        assert_eq!(name("m.cpp", "b.vert").as_deref(), Some("y/b.vert"));
        assert_eq!(name("m.cpp", "../y/b.vert").as_deref(), Some("y/b.vert"));
        assert_eq!(name("m.cpp", ".vert"), None, "a part of a name is no name");
    }

    #[test]
    fn companions_are_what_the_host_file_names() {
        let host = input("src/m.cpp", "#include \"gg.h\"\n#include <x.h>\nint p = load(\"../a.vert\", \"b.frag\");");
        assert_eq!(companions(&host), ["a.vert", "src/b.frag", "src/gg.h"]);
        assert!(companions(&input("src/m.cpp", "")).contains(&"src/m.vert".to_owned()));
        assert!(companions(&input("a.vert", "")).is_empty());
    }
}
