//! Paths as seen from elsewhere.

use std::path::{Component, Path};

/// The path of `to` as seen from the folder `from`, with `/`. Both are absolute and without `..`.
pub fn relative(from: &Path, to: &Path) -> String {
    let (mut from, mut to) = (from.components().peekable(), to.components().peekable());
    while from.peek().is_some() && from.peek() == to.peek() {
        from.next();
        to.next();
    }
    let up = from.map(|_| "..".to_owned());
    let down = to.filter(|c| !matches!(c, Component::RootDir)).map(|c| c.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_the_folder_of_the_baseline() {
        let from = |a: &str, b: &str| relative(Path::new(a), Path::new(b));
        assert_eq!(from("/p", "/p/s/a.vert"), "s/a.vert");
        assert_eq!(from("/p/ci", "/p/s/a.vert"), "../s/a.vert");
        assert_eq!(from("/p", "/q/a.vert"), "../q/a.vert");
    }
}
