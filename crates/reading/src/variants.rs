//! What is wrong in parts of a text that only a macro from outside switches on: hosts define what an `#if` asks.

use std::cell::OnceCell;

use base::diagnostic::{Diagnostic, Lang, Message};
use base::text::Span;
use syntax::errors::Around;
use syntax::{Parsed, Shader, TokenPlace, errors};

use crate::conditions::{self, Conditions};
use crate::open::{self, Surroundings};

/// Names that are tried one by one at most.
const MOST: usize = 8;

/// Errors in parts that macros from outside switch on, with true for what is certain: each holds under every definition
/// that was tried and that switches its place on.
pub fn errors(shader: &Shader) -> Vec<(bool, Diagnostic)> {
    let conditions = Conditions::of(shader);
    let mut asked = conditions.undefined(false);
    asked.retain(|name| !shader.defines().iter().any(|(own, _)| own == name));
    if asked.is_empty() {
        return Vec::new();
    }
    // A piece is put into shaders of any version; conversions differ between versions.
    let stated = shader.version().span.is_some();
    let whole = shader.function("main").is_some();
    let outside = if stated { !Around::TYPES } else { Around::all() };
    // All at once may contradict each other.
    let many = asked.len() > MOST;
    let mut sets = conditions::each_and_all(&asked);
    if many {
        sets.drain(..asked.len());
    }
    let mut found: Vec<(bool, Diagnostic)> = Vec::new();
    let mut tried: Vec<Parsed> = Vec::new();
    for defines in sets {
        let parsed = shader.with_defines(&[&defines[..], shader.defines()].concat());
        let surroundings = Surroundings::new(&parsed.shader, &conditions, &parsed.diagnostics);
        // Read so, the text has the surroundings that it has as it stands.
        let doubtful = OnceCell::new();
        for (k, error) in parsed.diagnostics.iter().enumerate() {
            let told = |(_, d): &(bool, Diagnostic)| open::stands_in(std::slice::from_ref(d), error);
            if is_active(shader, error.span) || found.iter().any(told) {
                continue;
            }
            let name = error.file.slice(error.span);
            let unsure = open::is_of_unknown_value(&parsed.shader, &asked, error);
            let of_names = open::is_of_another(error) || errors::is_name(error.code);
            let open = unsure || of_names || surroundings.leave_open(error, outside);
            let is_doubtful = || {
                let all = doubtful.get_or_init(|| open::doubtful(&parsed.shader, &parsed.diagnostics, Around::empty()));
                all.get(k).copied().unwrap_or(false)
            };
            let certain = !many && whole && !open && !is_doubtful();
            let unknown = error.code == errors::UNKNOWN_NAME && !syntax::is_macro(name);
            let of_types = !errors::rests_on(error.code).intersects(!(Around::TYPES | Around::VALUES));
            // What guards a declaration has taken its name, unless the host defines it as another.
            let own = error.code == errors::SYNTAX && defines.iter().any(|(macro_name, _)| macro_name == name);
            let on_request = !many && (unknown || of_types || own);
            if certain || on_request {
                found.push((certain, where_defined(error.clone(), &defines)));
            }
        }
        tried.push(parsed);
    }
    found.retain(|(_, error)| {
        let holds = |p: &Parsed| !is_active(&p.shader, error.span) || open::stands_in(&p.diagnostics, error);
        tried.iter().all(holds)
    });
    found
}

/// The error, with the macros for which it stands.
fn where_defined(error: Diagnostic, defines: &[(String, String)]) -> Diagnostic {
    let names: Vec<String> = defines.iter().map(|(name, _)| format!("`{name}`")).collect();
    let [en, ja] = [Lang::En, Lang::Ja].map(|lang| error.message.in_lang(lang).to_owned());
    let (are, all) = (if names.len() == 1 { "is" } else { "are" }, names.join(", "));
    let message = Message::new(format!("where {all} {are} defined: {en}"), format!("{all} が定義されている場合：{ja}"));
    Diagnostic { message, fix: None, ..error }
}

/// True for a place that is compiled.
fn is_active(shader: &Shader, span: Span) -> bool {
    conditions::place_of(shader, span) == Some(TokenPlace::Text)
}
