//! Findings in shaders that stand in literals of host files: told at their place in the host file.

use std::collections::BTreeMap;

use base::diagnostic::{Diagnostic, message};
use base::text::Edit;

use hosts::Origin;

use super::project::Project;

/// Moves what was found in embedded shaders to their host files. A fix stays where all its edits lie
/// in the plain text of literals; otherwise its title becomes advice.
pub fn relocate<'d>(project: &Project, found: impl Iterator<Item = &'d mut Diagnostic>) {
    let origins: BTreeMap<&str, &Origin> =
        project.shaders().filter_map(|s| Some((s.file.name(), s.origin.as_ref()?))).collect();
    let hosts = project.hosts().filter_map(|h| Some((h.file.name(), h.origin.as_ref()?)));
    let origins: BTreeMap<&str, &Origin> = origins.into_iter().chain(hosts).collect();
    if origins.is_empty() {
        return;
    }
    for diagnostic in found {
        for label in &mut diagnostic.related {
            while let Some(origin) = origins.get(label.file.name()) {
                label.span = origin.literal.to_host(label.span);
                label.file = origin.host.clone();
            }
        }
        // A literal in host code of a document leads to the code, and that to the document.
        while let Some(origin) = origins.get(diagnostic.file.name()) {
            move_to(origin, diagnostic);
        }
    }
}

/// Moves a diagnostic to the text that its own stands in.
fn move_to(origin: &Origin, diagnostic: &mut Diagnostic) {
    diagnostic.span = origin.literal.to_host(diagnostic.span);
    diagnostic.file = origin.host.clone();
    let Some(fix) = diagnostic.fix.take() else { return };
    let edits: Option<Vec<Edit>> = fix.edits.iter().map(|e| origin.literal.edit(e)).collect();
    match edits {
        Some(edits) => diagnostic.fix = Some(base::diagnostic::Fix { edits, ..fix }),
        None if diagnostic.help.is_none() => {
            let (en, ja) = (fix.title.to_string(), fix.title.in_lang(base::diagnostic::Lang::Ja).to_owned());
            diagnostic.help = Some(message!("{en}", "{ja}"));
        }
        None => {}
    }
}
