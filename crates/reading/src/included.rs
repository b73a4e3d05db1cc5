//! Names that nothing declares in files which other texts include.
//!
//! A file of functions is a piece: nobody knows what stands around it. Where all that includes it is read as a whole, that is known,
//! and what is missing in it is told in it.

use std::collections::{BTreeMap, BTreeSet};

use base::diagnostic::{Code, Diagnostic, Severity, message};
use base::text::{SourceFile, Span};
use syntax::{Parsed, errors, include};

use super::open;
use super::project::{Project, ShaderFile};
use crate::Level;
use hosts::marks;
use hosts::suggest::{list, list_in_japanese};

/// True for a text with all of its includes that lacks nothing but names: with a version and a `main` of its own, and every
/// file that it asks for, it is what a compiler gets.
pub(super) fn lacks_names_alone(author: &SourceFile, joined: &Parsed) -> bool {
    let file = joined.shader.file();
    let own = |at: Span| file.origin(at).0.name() == author.name();
    let asks = |line: &str| line.trim_start().strip_prefix('#').is_some_and(include::takes_in);
    joined.shader.version().span.is_some_and(own)
        && marks::has_main(author.text())
        && !file.text().lines().any(asks)
        && joined.diagnostics.iter().all(|d| open::leaves_in_order(d) || errors::is_name(d.code))
}

/// A place in an included file, and what is wrong there.
type Place = (String, Span, Code);

/// Tells names that joined texts lack in other files where these stand, each once: in files of the run that no piece and no host code
/// names, but for pieces that are in whole texts themselves.
pub fn tell_in_included(project: &Project, all: &mut Vec<(Level, Diagnostic)>) {
    let mut lacking: BTreeMap<Place, (BTreeSet<&str>, Diagnostic)> = BTreeMap::new();
    let roots: Vec<&ShaderFile> = project.shaders().filter(|s| s.author.is_some() && !s.is_wgsl()).collect();
    for (_, error) in all.iter().filter(|(level, d)| *level == Level::Default && errors::is_name(d.code)) {
        let of = |root: &&&ShaderFile| root.file.name() == error.file.name() && error.file.is_assembled();
        let Some(root) = roots.iter().find(of) else { continue };
        let (file, span) = error.file.origin(error.span);
        if file.name() != root.file.name() && !file.is_assembled() {
            let place = (file.name().to_owned(), span, error.code);
            let told = || Diagnostic { file, span, fix: None, related: Vec::new(), ..error.clone() };
            lacking.entry(place).or_insert_with(|| (BTreeSet::new(), told())).0.insert(root.file.name());
        }
    }
    if lacking.is_empty() {
        return;
    }
    let parts: Vec<(&str, BTreeSet<&str>)> =
        roots.iter().map(|root| (root.file.name(), root.file.sources().into_keys().collect())).collect();
    for ((name, span, code), (failing, error)) in lacking {
        let own = project.shaders().find(|s| s.reported && s.author.is_none() && s.file.name() == name);
        let Some(own) = own.filter(|own| own.file.text() == error.file.text()) else { continue };
        if is_named_elsewhere(project, &name, &parts) {
            continue;
        }
        let whole = parts.iter().filter(|(_, parts)| parts.contains(name.as_str())).count();
        let texts: Vec<&str> = failing.iter().copied().collect();
        let (en, ja) = (list(&texts), list_in_japanese(&texts));
        let why = if failing.len() == whole {
            message!(
                "no text that includes this file declares it: {en}",
                "このファイルを取り込むどのテキストも宣言していません: {ja}"
            )
        } else {
            message!(
                "it is missing where this file is included by {en}",
                "{ja} から取り込まれたときに、宣言がありません"
            )
        };
        all.retain(|(_, d)| (d.file.name(), d.span, d.code) != (name.as_str(), span, code));
        all.push((
            Level::Default,
            Diagnostic { file: own.file.clone(), severity: Severity::Error, ..error }.with_why(why),
        ));
    }
}

/// True for a file that a text asks for which is not read as a whole, nor a part of one that is, and for one that host code names.
fn is_named_elsewhere(project: &Project, name: &str, parts: &[(&str, BTreeSet<&str>)]) -> bool {
    let last = name.rsplit('/').next().unwrap_or(name);
    let asks = |text: &str| {
        let mut lines = text.lines().filter(|line| line.contains(last));
        lines.any(|line| line.trim_start().strip_prefix('#').is_some_and(include::takes_in))
    };
    let in_whole = |own: &str| parts.iter().any(|(_, parts)| parts.contains(own));
    project.hosts().any(|host| host.file.text().contains(last))
        || project.shaders().filter(|s| s.author.is_none()).any(|s| asks(s.file.text()) && !in_whole(s.file.name()))
}
