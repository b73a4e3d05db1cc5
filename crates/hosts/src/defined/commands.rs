//! Options of compilers of shaders in scripts and build files.

use super::{HostMacros, SHADERS, is_name};

/// Words that tell a command which compiles shaders.
const COMPILERS: [&str; 5] = ["glslc", "glslang", "dxc", "slangc", "shaderc"];

/// Reads the commands of a text; lines that end in `\` or `^` go on.
pub fn read(text: &str, found: &mut HostMacros) {
    let mut start = 0;
    let mut statement = 0;
    let mut command = String::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let trimmed = line.trim_end();
        let goes_on = trimmed.ends_with(['\\', '^']);
        command.push_str(trimmed.trim_end_matches(['\\', '^']));
        command.push(' ');
        at += line.len();
        if !goes_on {
            one(&command, start, statement, found);
            statement += 1;
            start = at;
            command.clear();
        }
    }
    one(&command, start, statement, found);
}

fn one(command: &str, at: usize, statement: usize, found: &mut HostMacros) {
    let tells = COMPILERS.iter().chain(&SHADERS).any(|word| command.contains(word));
    if !tells || command.trim_start().starts_with("//") {
        return;
    }
    for word in command.split(|c: char| c.is_whitespace() || matches!(c, '"' | '\'' | '(' | ')')) {
        found.note_shader(word, statement);
        let Some(definition) = word.strip_prefix("-D").or_else(|| word.strip_prefix("/D")) else { continue };
        let (name, value) = definition.split_once('=').unwrap_or((definition, "1"));
        if is_name(name) && !value.contains(['$', '%', '{', '<', '@']) {
            found.add(name, value, at, statement);
        }
    }
}
