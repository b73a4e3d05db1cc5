//! Which files of two folders belong together: a library in GLSL and the same in WGSL.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context as _;

use base::text::Shown as _;

use crate::cli::below;
use crate::cli::lint::config::{self, FileConfig, TwinPatterns};
use crate::cli::lint::groups::shortened;
use syntax::Stage;

/// Two files that are to mean the same.
pub(super) struct Twin {
    pub paths: [PathBuf; 2],
    /// Functions that are known to differ.
    pub except: Vec<String>,
}

/// The twins of a run, and the files without one.
#[derive(Default)]
pub(super) struct Twins {
    pub twins: Vec<Twin>,
    pub alone: [Vec<PathBuf>; 2],
}

/// True for an argument that means several files: a folder, or a pattern of paths.
pub(super) fn means_several(argument: &str) -> bool {
    let path = Path::new(argument);
    path.is_dir() || (argument.contains(['*', '?', '{', '[']) && !path.exists())
}

/// The twins among the files of two folders or patterns.
///
/// # Errors
/// When a pattern is none, a folder cannot be searched, or no file of one has a twin in the other.
pub(super) fn of_arguments(arguments: [&str; 2]) -> anyhow::Result<Twins> {
    let [first, second] = arguments.map(pattern);
    let patterns = TwinPatterns { first, second, except: Vec::new() };
    of_patterns(Path::new("."), std::slice::from_ref(&patterns))
}

/// The twins that the nearest configuration states.
///
/// # Errors
/// When there is none, it states none, or as [`of_arguments`].
pub(super) fn configured() -> anyhow::Result<Twins> {
    let here = std::env::current_dir().context("the folder of the run cannot be told")?;
    let found = here.ancestors().map(|folder| folder.join(config::FILE_NAME)).find(|path| path.is_file());
    let add = "name two files, folders or patterns, or state them in shadercheck.toml: \
               [compare] pairs = [{ first = \"glsl/**\", second = \"wgsl/**\" }]";
    let Some(path) = found else { anyhow::bail!("nothing to compare: {add}") };
    let FileConfig { folder, twins, .. } = config::read(&path)?;
    anyhow::ensure!(!twins.is_empty(), "{} states no pairs: {add}", shortened(&path).shown());
    let folder = if folder == here { PathBuf::from(".") } else { folder };
    of_patterns(&folder, &twins).with_context(|| shortened(&path).shown().to_string())
}

/// A folder as the pattern of all that is in it.
fn pattern(argument: &str) -> String {
    let plain = argument.trim_start_matches("./").trim_end_matches('/');
    match (Path::new(argument).is_dir(), plain) {
        (true, "" | ".") => "**".to_owned(),
        (true, folder) => format!("{folder}/**"),
        (false, _) => plain.to_owned(),
    }
}

fn of_patterns(folder: &Path, patterns: &[TwinPatterns]) -> anyhow::Result<Twins> {
    let files = below::files(folder)?;
    let mut all = Twins::default();
    for TwinPatterns { first, second, except } in patterns {
        let [firsts, seconds] = [matching(folder, &files, first)?, matching(folder, &files, second)?];
        let pairs = paired(&firsts, &seconds);
        let without = |own: &[Candidate], side: usize| -> Vec<PathBuf> {
            let has = |k: &usize| pairs.iter().any(|pair| pair[side] == *k);
            (0..own.len()).filter(|k| !has(k)).map(|k| own[k].path.clone()).collect()
        };
        anyhow::ensure!(
            !pairs.is_empty(),
            "no file that `{first}` means ({}) has a twin that `{second}` means ({}): twins have one path behind what the patterns \
             begin with, or one name, whatever their endings are",
            firsts.len(),
            seconds.len()
        );
        for (all, some) in all.alone.iter_mut().zip([without(&firsts, 0), without(&seconds, 1)]) {
            all.extend(some);
        }
        all.twins.extend(
            pairs.into_iter().map(|[a, b]| Twin {
                paths: [firsts[a].path.clone(), seconds[b].path.clone()],
                except: except.clone(),
            }),
        );
    }
    Ok(all)
}

/// A file, by its path without the ending, from where its pattern varies.
struct Candidate {
    path: PathBuf,
    key: String,
}

/// The shaders that a pattern means.
fn matching(folder: &Path, files: &[PathBuf], pattern: &str) -> anyhow::Result<Vec<Candidate>> {
    let pattern = pattern.trim_start_matches("./");
    let glob = config::glob(pattern).with_context(|| format!("`{pattern}` is no pattern of paths"))?;
    let fixed = pattern.split('/').take_while(|part| !part.contains(['*', '?', '{', '['])).map(|part| part.len() + 1);
    let fixed: usize = fixed.sum();
    let own = files.iter().filter_map(|path| {
        let inside = path.strip_prefix(folder).unwrap_or(path);
        let shader = below::stage_of(path).is_some() && glob.is_match(inside);
        let inside = inside.to_string_lossy().replace('\\', "/");
        shader.then(|| Candidate { path: path.clone(), key: plain(inside.get(fixed..).unwrap_or(&inside)) })
    });
    Ok(own.collect())
}

/// A path without its endings, however its words are put together. The ending of a stage stays: `blur.frag.hlsl`.
fn plain(path: &str) -> String {
    let (folder, name) = path.rsplit_once('/').map_or(("", path), |(folder, name)| (folder, name));
    let of_language = |name: &str| below::stage_of(Path::new(name)).is_some_and(|stage| stage == Stage::Library);
    let stem = match name.rsplit_once('.') {
        Some((stem, _)) if of_language(name) => stem,
        _ => name,
    };
    let letters = |text: &str| text.chars().filter(|c| !matches!(c, '_' | '-')).flat_map(char::to_lowercase).collect();
    let (folder, stem): (String, String) = (letters(folder), letters(stem));
    if folder.is_empty() { stem } else { format!("{folder}/{stem}") }
}

/// What belongs together: by the path, or else by the name where it is that of one file on either side.
fn paired(firsts: &[Candidate], seconds: &[Candidate]) -> Vec<[usize; 2]> {
    let mut pairs: Vec<[usize; 2]> = Vec::new();
    let stageless = |key: &str| match below::stage_of(Path::new(key)) {
        Some(_) => key.rsplit_once('.').map_or(key, |(stem, _)| stem).to_owned(),
        None => key.to_owned(),
    };
    let name = |key: &str| key.rsplit_once('/').map_or(key, |(_, name)| name).to_owned();
    let ways: [&dyn Fn(&str) -> String; 4] = [&str::to_owned, &stageless, &name, &|key: &str| stageless(&name(key))];
    for way in ways {
        let open = |all: &[Candidate], side: usize, pairs: &[[usize; 2]]| {
            let mut by_key: BTreeMap<String, Vec<usize>> = BTreeMap::new();
            for k in (0..all.len()).filter(|k| !pairs.iter().any(|pair| pair[side] == *k)) {
                by_key.entry(way(&all[k].key)).or_default().push(k);
            }
            by_key
        };
        let (left, right) = (open(firsts, 0, &pairs), open(seconds, 1, &pairs));
        for (key, own) in &left {
            if let ([a], Some([b])) = (&own[..], right.get(key).map(Vec::as_slice))
                && firsts[*a].path != seconds[*b].path
            {
                pairs.push([*a, *b]);
            }
        }
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn candidates(keys: &[&str]) -> Vec<Candidate> {
        keys.iter().map(|key| Candidate { path: PathBuf::from(key), key: plain(key) }).collect()
    }

    #[test]
    fn files_are_paired_by_path_and_else_by_a_name_of_one_file() {
        let stages = [&["x.frag", "x.vert", "y.frag"], &["x.frag.hlsl", "x.vert.hlsl", "y.wgsl"]];
        assert_eq!(paired(&candidates(stages[0]), &candidates(stages[1])), [[0, 0], [1, 1], [2, 2]]);
        let firsts = candidates(&["a/noise.glsl", "b/noise.glsl", "light/phongModel.glsl", "only.glsl", "two/x.glsl"]);
        let seconds = candidates(&["a/noise.wgsl", "b/noise.wgsl", "phong_model.wgsl", "p/x.wgsl", "q/x.wgsl"]);
        assert_eq!(paired(&firsts, &seconds), [[0, 0], [1, 1], [2, 2]]);
    }

    #[test]
    fn patterns_and_folders_mean_the_shaders_below() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["glsl/a.glsl", "glsl/in/b.frag", "wgsl/a.wgsl", "wgsl/in/b.wgsl", "wgsl/notes.md", "glsl/c.glsl"] {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        }
        let patterns = [TwinPatterns { first: "glsl/**".to_owned(), second: "wgsl/**".to_owned(), except: Vec::new() }];
        let found = of_patterns(folder.path(), &patterns).unwrap();
        assert_eq!((found.twins.len(), found.alone[0].len(), found.alone[1].len()), (2, 1, 0));
        let none =
            [TwinPatterns { first: "glsl/*.glsl".to_owned(), second: "wgsl/in/*".to_owned(), except: Vec::new() }];
        let why = of_patterns(folder.path(), &none).err().unwrap().to_string();
        assert!(why.contains("`glsl/*.glsl` means (2)"), "{why}");
    }
}
