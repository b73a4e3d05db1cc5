//! SPIR-V, read by naga: a binary as a list of its instructions, or its assembly.
//!
//! A list has one line for each instruction, with its words in hexadecimal and behind `;` what they are. So a binary is a
//! text like any other, whose lines are named, and the words can be read from it again.

use std::fmt::Write;

use naga::{Arena, Block, Function, Module};

use super::switches;
use crate::capabilities::known_to_reader;
use crate::front::{NAGA, UNSUPPORTED, validate_text};
use crate::{ProgramError, contain};
use base::diagnostic::{Diagnostic, Severity};
use base::text::{SourceFile, Span, printable};

/// Words before the first instruction (SPIR-V 1.6, 2.3).
const HEADER: usize = 5;
const MAGIC: u32 = spirv::MAGIC_NUMBER;

/// The instructions of a binary: the index of the first word of each, and the words.
fn instructions(words: &[u32]) -> Result<Vec<(usize, &[u32])>, String> {
    match words.first() {
        Some(&MAGIC) => {}
        Some(first) if first.swap_bytes() == MAGIC => {
            return Err(
                "the module is written for machines of the other byte order; swap the bytes of each word".into()
            );
        }
        _ => return Err("this is no SPIR-V: it does not begin with the number 0x07230203".into()),
    }
    let mut at = HEADER;
    let mut all = Vec::new();
    while at < words.len() {
        let length = (words[at] >> 16) as usize;
        let left = words.len() - at;
        if length == 0 || length > left {
            let name = name_of(words[at]);
            return Err(format!(
                "the module is cut short: {name} at word {at} has {length} words, and {left} are left"
            ));
        }
        all.push((at, &words[at..at + length]));
        at += length;
    }
    match words.len() {
        0..HEADER => Err("the module is cut short within its header".to_owned()),
        HEADER => Err("the module has no instruction".to_owned()),
        _ => Ok(all),
    }
}

fn name_of(first: u32) -> String {
    let code = first & 0xffff;
    spirv::Op::from_u32(code).map_or_else(|| format!("instruction {code}"), |op| format!("Op{op:?}"))
}

/// The string that begins with these words.
fn string(words: &[u32]) -> String {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).take_while(|&byte| byte != 0).collect();
    printable(&String::from_utf8_lossy(&bytes))
}

/// The list of instructions of a binary module.
///
/// # Errors
/// What is no module of SPIR-V, in words.
pub fn listing(name: &str, bytes: &[u8]) -> Result<SourceFile, String> {
    if !bytes.len().is_multiple_of(4) {
        return Err(format!(
            "{name}: {} bytes are no whole words: the module is cut short, or is no SPIR-V",
            bytes.len()
        ));
    }
    let words: Vec<u32> = bytes.chunks_exact(4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    let all = instructions(&words).map_err(|why| format!("{name}: {why}"))?;
    let mut text = String::new();
    let mut line = |words: &[u32], about: &str| {
        let hex: Vec<String> = words.iter().map(|word| format!("{word:08x}")).collect();
        let _ = writeln!(text, "{} ; {about}", hex.join(" "));
    };
    line(&words[..HEADER], "SPIR-V");
    let (mut names, mut place) = (std::collections::HashMap::new(), String::new());
    for (_, instruction) in all {
        let op = spirv::Op::from_u32(instruction[0] & 0xffff);
        let name = name_of(instruction[0]);
        let about = match (op, instruction) {
            (Some(spirv::Op::EntryPoint), [_, _, _, rest @ ..]) => format!("{name} \"{}\"", string(rest)),
            (Some(spirv::Op::Name), [_, _, rest @ ..]) => format!("{name} \"{}\"", string(rest)),
            (Some(spirv::Op::String), [_, id, rest @ ..]) => {
                names.insert(*id, string(rest));
                format!("{name} \"{}\"", string(rest))
            }
            (Some(spirv::Op::Line), &[_, file, at, column]) => {
                place = format!(" {}:{at}:{column}", names.get(&file).map_or("?", String::as_str));
                name
            }
            (Some(spirv::Op::NoLine), _) => {
                place.clear();
                name
            }
            _ => format!("{name}{place}"),
        };
        line(instruction, &about);
    }
    Ok(SourceFile::new(name, text))
}

/// The words of a list, and the place of each line.
fn listed(file: &SourceFile) -> Option<(Vec<u32>, Vec<Span>)> {
    let (mut words, mut lines, mut start) = (Vec::new(), Vec::new(), 0);
    for line in file.text().split_inclusive('\n') {
        let hex = line.split(';').next().unwrap_or_default();
        for word in hex.split_whitespace() {
            words.push(u32::from_str_radix(word, 16).ok()?);
        }
        lines.push(Span::new(start, start + line.trim_end().len()));
        start += line.len();
    }
    Some((words, lines.split_off(1)))
}

/// The lines of a text in assembly on which its instructions begin.
fn assembly(text: &str) -> Vec<Span> {
    let (mut lines, mut start) = (Vec::new(), 0);
    for line in text.split_inclusive('\n') {
        let code = line.split(';').next().unwrap_or_default();
        let is_op = |word: &str| word.strip_prefix("Op").is_some_and(|rest| rest.starts_with(char::is_uppercase));
        if code.split_whitespace().any(is_op) {
            lines.push(Span::new(start, start + line.trim_end().len()));
        }
        start += line.len();
    }
    lines
}

/// Reads and validates a module that was listed.
pub(super) fn read_listing(file: &SourceFile) -> Result<Module, ProgramError> {
    let (words, lines) =
        listed(file).ok_or_else(|| wrong(file, Span::at(0), "this is no list of instructions".into()))?;
    read(file, &words, &lines)
}

/// Reads and validates what a text in assembly stands for.
pub(super) fn read_assembly(file: &SourceFile, words: &[u32]) -> Result<Module, ProgramError> {
    read(file, words, &assembly(file.text()))
}

fn wrong(file: &SourceFile, span: Span, message: String) -> ProgramError {
    ProgramError::Source(vec![Diagnostic::new(NAGA, Severity::Error, file, span, message)])
}

/// Reads and validates a module whose instructions have these places.
pub(super) fn read(file: &SourceFile, words: &[u32], lines: &[Span]) -> Result<Module, ProgramError> {
    instructions(words).map_err(|why| wrong(file, Span::at(0), why))?;
    let (words, lines) = switches::taken_away(words, lines).map_err(|k| {
        let what = "this switch leaves a loop, which naga's reader of SPIR-V takes for the end of the switch; a loop \
                    without `continue` is read";
        let span = lines.get(k).copied().unwrap_or_default();
        let found = Diagnostic::new(UNSUPPORTED, Severity::Error, file, span, what.to_owned());
        ProgramError::Source(vec![found.at_origin()])
    })?;
    let all = instructions(&words).map_err(|why| wrong(file, Span::at(0), why))?;
    let options = naga::front::spv::Options { adjust_coordinate_space: false, ..Default::default() };
    let parsed = contain(|| naga::front::spv::Frontend::new(known_to_reader(&words).into_iter(), &options).parse());
    let unread = |why: String| {
        // The reader names an instruction, and not where it stands.
        let named = all.iter().position(|(_, words)| why.contains(&name_of(words[0])["Op".len()..]));
        let span = named.and_then(|k| lines.get(k)).copied().unwrap_or_default();
        wrong(file, span, format!("naga's reader of SPIR-V refuses the module: {why}"))
    };
    let module = parsed.map_err(|panic| unread(format!("it fails: {panic}")))?.map_err(|e| unread(e.to_string()))?;
    // Places of the reader are bytes of the binary.
    let place = |span: naga::Span| {
        let word = span.to_range().map(|range| range.start / 4);
        let at = word.map(|word| all.partition_point(|(first, _)| *first <= word));
        let line = at.and_then(|at| lines.get(at.checked_sub(1)?)).filter(|_| lines.len() == all.len());
        line.map_or(naga::Span::UNDEFINED, |line| naga::Span::new(line.start as u32, line.end as u32))
    };
    let module = placed(module, &place);
    validate_text(file, &module)?;
    Ok(module)
}

/// The module with other places.
fn placed(mut module: Module, place: &dyn Fn(naga::Span) -> naga::Span) -> Module {
    module.global_variables = moved(&module.global_variables, place);
    module.global_expressions = moved(&module.global_expressions, place);
    module.constants = moved(&module.constants, place);
    module.functions = moved(&module.functions, place);
    let points = module.entry_points.iter_mut().map(|point| &mut point.function);
    for function in module.functions.iter_mut().map(|(_, function)| function).chain(points) {
        let Function { expressions, local_variables, body, .. } = function;
        *expressions = moved(expressions, place);
        *local_variables = moved(local_variables, place);
        *body = moved_block(std::mem::take(body), place);
    }
    module
}

fn moved<T: Clone>(arena: &Arena<T>, place: &dyn Fn(naga::Span) -> naga::Span) -> Arena<T> {
    let mut new = Arena::new();
    for (handle, value) in arena.iter() {
        new.append(value.clone(), place(arena.get_span(handle)));
    }
    new
}

fn moved_block(block: Block, place: &dyn Fn(naga::Span) -> naga::Span) -> Block {
    let mut new = Block::new();
    for (mut statement, span) in block.span_into_iter() {
        for inner in crate::fuel::blocks_mut(&mut statement) {
            *inner = moved_block(std::mem::take(inner), place);
        }
        new.push(statement, place(span));
    }
    new
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(words: &[u32]) -> Vec<u8> {
        words.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    /// A header, a capability and the memory model.
    const SMALL: [u32; 10] = [MAGIC, 0x1_0000, 0, 4, 0, 2 << 16 | 17, 1, 3 << 16 | 14, 0, 1];

    #[test]
    fn a_list_gives_its_words_again() {
        let file = listing("a.spv", &bytes(&SMALL)).unwrap();
        let (words, lines) = listed(&file).unwrap();
        assert_eq!(words, SMALL);
        assert_eq!(file.slice(lines[1]), "0003000e 00000000 00000001 ; OpMemoryModel");
    }

    #[test]
    fn what_is_no_module_is_told() {
        let why = |words: &[u32]| listing("a.spv", &bytes(words)).unwrap_err();
        assert!(why(&SMALL.map(u32::swap_bytes)).contains("other byte order"));
        assert!(why(&SMALL[..9]).contains("OpMemoryModel at word 7 has 3 words, and 2 are left"));
        assert!(why(&SMALL[..3]).contains("cut short"));
        assert!(why(&[1, 2, 3]).contains("no SPIR-V"));
        assert!(listing("a.spv", &bytes(&SMALL)[..39]).unwrap_err().contains("no whole words"));
        assert!(listing("a.spv", &[]).unwrap_err().contains("no SPIR-V"));
    }

    #[test]
    fn lines_of_assembly_are_those_with_an_instruction() {
        let lines = assembly("; OpNop\nOpCapability Shader ; x\n\n%1 = OpTypeVoid\n");
        assert_eq!(lines, [Span::new(8, 31), Span::new(33, 48)]);
    }
}
