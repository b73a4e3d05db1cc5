//! Files that a suite or a shader names and that lie elsewhere. Messages quote lines of shaders, and a suite of somebody
//! else may name any file of the machine: only what is a shader by its ending is read from there.

use std::path::{Component, Path, PathBuf};

use syntax::Stage;

/// Endings of files with parts of shaders, besides those that tell a stage.
const PARTS: [&str; 16] = [
    "wgsl", "wesl", "tmpl", "shader", "inc", "incl", "include", "h", "hpp", "hlsl", "hlsli", "fxh", "cginc", "glslh",
    "glsli", "glslinc",
];

/// Why a file is not read that lies in none of these folders, and is no shader by its ending. Links count as what they
/// lead to.
pub fn refusal(path: &Path, folders: &[&Path]) -> Option<&'static str> {
    let here = |folder: &Path| if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.to_owned();
    let named_inside = |folder: &&Path| {
        let rest = if folder.as_os_str().is_empty() { Ok(path) } else { path.strip_prefix(folder) };
        rest.is_ok_and(|rest| rest.components().all(|part| matches!(part, Component::CurDir | Component::Normal(_))))
    };
    if !is_shader(path) && !folders.iter().any(named_inside) {
        return Some(WHY);
    }
    // What is not there is told when it is read.
    let target = path.canonicalize().ok()?;
    let lies_inside = |folder: &&Path| here(folder).canonicalize().is_ok_and(|folder| target.starts_with(folder));
    (!is_shader(&target) && !folders.iter().any(lies_inside)).then_some(WHY)
}

/// The name of a file: its path without `.` and without `..` behind a folder, so that it has one.
pub fn plain(path: &Path) -> String {
    plain_path(path).display().to_string()
}

/// The same as a path.
pub fn plain_path(path: &Path) -> PathBuf {
    use std::path::Component;
    let mut parts = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(parts.components().next_back(), Some(Component::Normal(_))) => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts
}

fn is_shader(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    Stage::from_path(&path.to_string_lossy()).is_some() || ending.is_some_and(|ending| PARTS.contains(&&*ending))
}

const WHY: &str = "its ending is that of no shader, such as .vert, .frag, .geom, .comp, .glsl or .inc, and it lies \
                   elsewhere than the file that names it";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_have_one_name() {
        assert_eq!(plain(Path::new("./a/../b/./c.glsl")), "b/c.glsl");
        assert_eq!(plain(Path::new("../a.glsl")), "../a.glsl");
    }

    #[test]
    fn what_lies_elsewhere_is_a_shader_by_its_ending() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir_all(at("suite/parts")).unwrap();
        for file in ["secret", "a.vert", "b.INC", "suite/notes", "suite/parts/x"] {
            std::fs::write(at(file), "").unwrap();
        }
        let suite = at("suite");
        let refused = |name: &str| refusal(&suite.join(name), &[&suite]).is_some();
        let asked =
            ["notes", "parts/x", "./parts/../notes", "../a.vert", "../b.INC", "../secret", "../absent", "absent"];
        assert_eq!(asked.map(refused), [false, false, true, false, false, true, true, false]);
        assert!(refused("/etc/passwd"));
        assert!(refusal(&at("secret"), &[&suite, folder.path()]).is_none(), "a folder that the user names");
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("secret"), at("suite/link.vert")).unwrap();
            std::os::unix::fs::symlink(at("a.vert"), at("suite/good")).unwrap();
            assert!(refused("link.vert") && !refused("good"));
        }
    }
}
