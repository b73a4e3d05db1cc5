//! What host code of a project defines for its shaders, for commands that run them.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base::text::SourceFile;
use disk::{Budget, hosts_around};
use engine::completion::{Offer, Sibling, macro_name};
use hosts::defined::HostMacros;
use syntax::{Shader, Stage};

/// Words of which a file that builds shaders says at least one.
const TELLING: [&str; 8] = ["shader", "Shader", "SHADER", "glsl", "GLSL", "wgsl", "spv", "SPIR"];

/// Host code and libraries that were read. Each file is read once for a command.
#[derive(Default)]
pub struct Hosts {
    budget: Budget,
    read: HashMap<PathBuf, Option<Arc<Host>>>,
    libraries: HashMap<PathBuf, Library>,
}

/// A file of GLSL, with the functions that it defines once somebody asks.
struct Library {
    file: Option<SourceFile>,
    functions: Option<Vec<String>>,
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
    pub fn siblings(&mut self, shader: &Path, names: &[String]) -> Vec<Sibling> {
        let mut found: Vec<Sibling> = Vec::new();
        // Where a system has no other names of a file, its path is the only one.
        let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let own = real(shader);
        hosts_around(shader, &is_glsl, &mut |paths| {
            for path in paths.iter().filter(|path| real(path) != own) {
                let defines = |library: &Sibling| names.iter().any(|name| library.functions.contains(name));
                found.extend(self.library(path, names).filter(|library| defines(library)));
            }
            found.is_empty()
        });
        let times = |name: &String| found.iter().filter(|library| library.functions.contains(name)).count();
        let sure = |library: &Sibling| names.iter().any(|name| library.functions.contains(name) && times(name) == 1);
        found.iter().filter(|library| sure(library)).cloned().collect()
    }

    /// A file of GLSL that may define functions of some names; none for a shader by itself.
    fn library(&mut self, path: &Path, names: &[String]) -> Option<Sibling> {
        let budget = &mut self.budget;
        let known = self.libraries.entry(path.to_owned()).or_insert_with(|| Library {
            file: budget.read(path).filter(|file| !file.text().contains("#version")),
            functions: None,
        });
        let file = known.file.as_ref()?;
        // Most files need not be parsed.
        if known.functions.is_none() && !names.iter().any(|name| file.text().contains(&format!("{name}("))) {
            return None;
        }
        let functions = known.functions.get_or_insert_with(|| functions(file)).clone();
        (!functions.iter().any(|name| name == "main")).then(|| Sibling { file: file.clone(), functions })
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

/// The functions that a file defines.
fn functions(file: &SourceFile) -> Vec<String> {
    let shader = Shader::parse(file, Stage::Library).shader;
    let defined = shader.functions().filter(|(_, own)| own.definition.is_some());
    defined.map(|(_, own)| own.name.name.clone()).collect()
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
