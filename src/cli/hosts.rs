//! What host code of a project defines for its shaders, for commands that run them.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base::text::SourceFile;
use disk::{Budget, hosts_around};
use engine::completion::{Offer, macro_name};
use hosts::defined::HostMacros;
use syntax::{Shader, Stage};

/// Words of which a file that builds shaders says at least one.
const TELLING: [&str; 8] = ["shader", "Shader", "SHADER", "glsl", "GLSL", "wgsl", "spv", "SPIR"];

/// Host code that was read. Each file is read once for a command.
#[derive(Default)]
pub struct Hosts {
    budget: Budget,
    read: HashMap<PathBuf, Option<Arc<Host>>>,
}

struct Host {
    file: SourceFile,
    macros: HostMacros,
}

impl Hosts {
    /// What is said about names, the nearest file first and the last of several in a file first; and all of the builds that
    /// name the shader.
    pub fn offers(&mut self, shader: &Path, names: &[String]) -> Vec<Offer> {
        let mut found: Vec<Offer> = Vec::new();
        let own = shader.to_string_lossy().into_owned();
        hosts_around(shader, &is_host, &mut |paths| {
            for path in paths {
                let Some(host) = self.host(path) else { continue };
                for one in host.macros.macros.iter().rev() {
                    let named = host.macros.names(one.statement, &own);
                    if named || names.iter().any(|name| name == macro_name(&one.name)) {
                        found.push(Offer {
                            name: one.name.clone(),
                            value: one.value.clone(),
                            file: host.file.name().to_owned(),
                            line: host.file.position(one.at).line,
                            statement: one.statement,
                            named,
                        });
                    }
                }
            }
            !names.iter().all(|name| found.iter().any(|offer| macro_name(&offer.name) == name))
        });
        found
    }

    /// Files around a shader that define functions of some of these names, and have no `main`: of the nearest folder that has
    /// such a file, and for each name only where one file defines it.
    pub fn siblings(&mut self, shader: &Path, names: &[String]) -> Vec<SourceFile> {
        let mut found: Vec<(SourceFile, Vec<String>)> = Vec::new();
        let own = shader.canonicalize().ok();
        hosts_around(shader, &is_glsl, &mut |paths| {
            for path in paths.iter().filter(|path| path.canonicalize().ok() != own) {
                let Some(file) = self.budget.read(path) else { continue };
                let Some(defined) = defined(&file, names) else { continue };
                found.push((file, defined));
            }
            found.is_empty()
        });
        let times = |name: &String| found.iter().filter(|(_, defined)| defined.contains(name)).count();
        let sure: Vec<bool> = found.iter().map(|(_, defined)| defined.iter().any(|name| times(name) == 1)).collect();
        found.into_iter().zip(sure).filter(|(_, sure)| *sure).map(|((file, _), _)| file).collect()
    }

    fn host(&mut self, path: &Path) -> Option<Arc<Host>> {
        if let Some(known) = self.read.get(path) {
            return known.clone();
        }
        let telling = |file: &SourceFile| TELLING.iter().any(|word| file.text().contains(word));
        let file = self.budget.read(path).filter(telling);
        let host = file.map(|file| Host { macros: hosts::defined::host_macros(&file), file });
        let host = host.filter(|host| !host.macros.macros.is_empty()).map(Arc::new);
        self.read.insert(path.to_owned(), host.clone());
        host
    }
}

/// The functions of some names that a library defines; none where it defines none of them, or is a shader by itself.
fn defined(file: &SourceFile, names: &[String]) -> Option<Vec<String>> {
    let text = file.text();
    if !names.iter().any(|name| text.contains(&format!("{name}("))) || text.contains("#version") {
        return None;
    }
    let shader = Shader::parse(file, Stage::Library).shader;
    let is_defined = |name: &&String| shader.function(name).is_some_and(|own| own.definition.is_some());
    let defined: Vec<String> = names.iter().filter(is_defined).cloned().collect();
    (!defined.is_empty() && shader.function("main").is_none()).then_some(defined)
}

/// True for a file of GLSL.
fn is_glsl(path: &Path) -> bool {
    matches!(hosts::language_of(&path.to_string_lossy()), Some(hosts::Language::Shader(_)))
}

/// True for a file of host code, or with commands.
fn is_host(path: &Path) -> bool {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
    let code = hosts::HOST_EXTENSIONS.iter().chain(hosts::script::SCRIPT_EXTENSIONS).any(|known| *known == ending);
    let commands = hosts::defined::COMMAND_EXTENSIONS.iter().any(|known| *known == ending && ending != "txt");
    code || commands || hosts::defined::COMMAND_FILES.contains(&name.as_str())
}
