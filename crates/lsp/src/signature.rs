//! The function that is being called at a place, and which argument is being written.

use ls_types::{ParameterInformation, ParameterLabel, SignatureHelp, SignatureInformation};
use syntax::BuiltinFunction;

use crate::hover::{direction, signature};
use crate::symbols::spelled;
use crate::workspace::Workspace;

/// How far back the beginning of a call is looked for.
const MOST_BYTES: usize = 4000;

impl Workspace {
    /// The ways to call the function whose arguments stand at a place.
    pub fn signature_help(&self, name: &str, offset: usize) -> Option<SignatureHelp> {
        let file = self.file(name)?;
        let before = file.text().get(..offset)?;
        let (called, argument) = call_at(before)?;
        let unit = self.units_of(name).into_iter().next()?;
        let shader = &unit.shader;
        let mut labels: Vec<String> = Vec::new();
        for (_, f) in shader.functions().filter(|(_, f)| f.name.name == called) {
            let param = |p: &syntax::symbols::ParamInfo| {
                let name = p.name.as_ref().map_or(String::new(), |n| format!(" {}", n.name));
                format!("{}{}{name}", direction(p.direction), spelled(shader, &p.ty))
            };
            let params = f.params.iter().map(param).collect::<Vec<_>>().join(", ");
            labels.push(format!("{} {called}({params})", spelled(shader, &f.return_type)));
        }
        if labels.is_empty() {
            let function = BuiltinFunction::from_name(called)?;
            labels.extend(shader.overloads(function).iter().map(|o| signature(shader, called, o)));
        }
        let count = |label: &String| params_of(label).len();
        let active = labels.iter().position(|l| count(l) > argument).unwrap_or(0);
        let signatures = labels.into_iter().map(|label| {
            let params = params_of(&label)
                .into_iter()
                .map(|p| ParameterInformation { label: ParameterLabel::Simple(p.to_owned()), documentation: None });
            let parameters = Some(params.collect());
            SignatureInformation { label, documentation: None, parameters, active_parameter: None }
        });
        let active_parameter = u32::try_from(argument).ok();
        Some(SignatureHelp {
            signatures: signatures.collect(),
            active_signature: u32::try_from(active).ok(),
            active_parameter,
        })
    }
}

fn params_of(label: &str) -> Vec<&str> {
    let inside = label.split_once('(').map_or("", |(_, rest)| rest.trim_end_matches(')'));
    if inside.is_empty() { Vec::new() } else { inside.split(", ").collect() }
}

/// The name before the open parenthesis that a text ends in, and the number of arguments before the last.
pub(crate) fn call_at(before: &str) -> Option<(&str, usize)> {
    let (mut depth, mut commas) = (0usize, 0usize);
    for (at, c) in before.char_indices().rev() {
        if before.len() - at > MOST_BYTES {
            return None;
        }
        match c {
            ')' | ']' => depth += 1,
            '(' | '[' if depth > 0 => depth -= 1,
            '(' => {
                let head = before[..at].trim_end();
                let start = head
                    .rfind(|c: char| !c.is_alphanumeric() && c != '_')
                    .map_or(0, |i| i + head[i..].chars().next().map_or(1, char::len_utf8));
                let name = &head[start..];
                return (!name.is_empty()).then_some((name, commas));
            }
            ',' if depth == 0 => commas += 1,
            ';' | '{' | '}' => return None,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::call_at;

    #[test]
    fn the_innermost_open_call_counts() {
        assert_eq!(call_at("x = mix(a, clamp(b, 0.0, 1.0), "), Some(("mix", 2)));
        assert_eq!(call_at("x = mix(a, clamp(b"), Some(("clamp", 0)));
        assert_eq!(call_at("x = a[f(1), 2"), None);
        assert_eq!(call_at("f(1); x"), None);
        assert_eq!(call_at("("), None);
    }
}
