//! Paths as texts, with `/` between the parts.

/// The ending of a file's name, without its point; empty where there is none.
pub fn extension(name: &str) -> &str {
    file_name(name).rsplit_once('.').map_or("", |(stem, ending)| if stem.is_empty() { "" } else { ending })
}

/// The name of a file, without its folders.
pub fn file_name(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

/// The file's name up to the first point.
pub fn stem(name: &str) -> &str {
    let file = file_name(name);
    file.split_once('.').map_or(file, |(stem, _)| stem)
}

/// The path before the file's name; empty when there is none.
pub fn folder(name: &str) -> &str {
    name.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// Path of `name` as seen from the file `from`.
pub fn beside(from: &str, name: &str) -> String {
    match folder(&normalise(from)) {
        _ if name.starts_with('/') => normalise(name),
        "" if !from.starts_with('/') => normalise(name),
        folder => normalise(&format!("{folder}/{name}")),
    }
}

/// A path without `.`, empty parts and those `..` that can be resolved.
pub fn normalise(path: &str) -> String {
    let path = path.replace('\\', "/");
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|p| *p != "..") => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    let joined = parts.join("/");
    if path.starts_with('/') { format!("/{joined}") } else { joined }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_resolved_from_the_host_file() {
        assert_eq!(beside("src/main.cpp", "../shaders/a.vert"), "shaders/a.vert");
        assert_eq!(beside("main.cpp", "./a.vert"), "a.vert");
        assert_eq!(beside("/p/main.cpp", "a.vert"), "/p/a.vert");
        assert_eq!(beside("../p/main.cpp", "../../a.vert"), "../../a.vert");
        assert_eq!(beside("p/main.cpp", "/q/a.vert"), "/q/a.vert");
    }
}
