//! What a compiler writes beside the instructions of a module: names, and where in the author's text each stands.

use std::collections::HashMap;

use crate::capabilities::instructions;

const OP_NAME: u32 = 5;
const OP_STRING: u32 = 7;
const OP_LINE: u32 = 8;
const OP_EXT_INST_IMPORT: u32 = 11;
const OP_EXT_INST: u32 = 12;
const OP_ENTRY_POINT: u32 = 15;
const OP_CONSTANT: u32 = 43;
const OP_UNDEF: u32 = 1;
const OP_CONSTANT_NULL: u32 = 46;
const OP_FUNCTION: u32 = 54;
const OP_FUNCTION_END: u32 = 56;
const OP_VARIABLE: u32 = 59;
const OP_DECORATE: u32 = 71;
const OP_NO_LINE: u32 = 317;
const LOCATION: u32 = 30;
const BUILT_IN: u32 = 11;
/// Instructions of `NonSemantic.Shader.DebugInfo.100`.
const DEBUG_FUNCTION: u32 = 20;
const DEBUG_SOURCE: u32 = 35;
const DEBUG_FUNCTION_DEFINITION: u32 = 101;
const DEBUG_LINE: u32 = 103;
const DEBUG_NO_LINE: u32 = 104;

/// Where an output of a stage goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Goes {
    /// To the location of this number.
    Location(u32),
    /// To the built-in value of this number (SPIR-V, 3.21).
    BuiltIn(u32),
}

/// A line of a source, with its column from 1, or 0 where only the line is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct At {
    pub source: String,
    pub line: usize,
    pub column: usize,
}

/// What is known about a module.
#[derive(Default)]
pub(super) struct Lines {
    /// Where each instruction stands, in order.
    pub places: Vec<Option<At>>,
    /// Functions: where each is declared.
    pub functions: HashMap<u32, Option<At>>,
    /// Storage classes of variables outside of functions.
    pub variables: HashMap<u32, u32>,
    /// Entry points by name, with the variables of their interfaces.
    pub points: Vec<(String, Vec<u32>)>,
    /// Where variables of interfaces come from or go.
    pub goes: HashMap<u32, Goes>,
    /// Names by what they name.
    pub names: HashMap<u32, String>,
    /// Which instructions a reader needs: all but those for debuggers.
    pub kept: Vec<bool>,
    /// The text of each source that the compiler wrote down.
    pub texts: Vec<(String, String)>,
}

/// The string that begins with these words.
fn string(words: &[u32]) -> String {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).take_while(|&byte| byte != 0).collect();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Words of a string.
fn literal(text: &str) -> Vec<u32> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize((bytes.len() + 1).next_multiple_of(4), 0);
    bytes.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect()
}

impl Lines {
    /// Reads a module.
    pub fn of(words: &[u32]) -> Self {
        let mut found = Self::default();
        let (mut strings, mut numbers, mut sources) = (HashMap::new(), HashMap::new(), HashMap::new());
        let (mut declared, mut debug, mut within) = (HashMap::new(), None, None);
        let mut now: Option<At> = None;
        for instruction in instructions(words) {
            let at = |source: Option<&String>, line: usize, column: usize| {
                source.filter(|_| line > 0).map(|source| At { source: source.clone(), line, column })
            };
            match (instruction[0] & 0xffff, &instruction[1..]) {
                (OP_STRING, [id, text @ ..]) => drop(strings.insert(*id, string(text))),
                (OP_NAME, [id, text @ ..]) => drop(found.names.insert(*id, string(text))),
                (OP_ENTRY_POINT, [_, _, rest @ ..]) => {
                    let name = string(rest);
                    found.points.push((name.clone(), rest[(name.len() / 4 + 1).min(rest.len())..].to_vec()));
                }
                (OP_DECORATE, &[id, LOCATION, number, ..]) => drop(found.goes.insert(id, Goes::Location(number))),
                (OP_DECORATE, &[id, BUILT_IN, number, ..]) => drop(found.goes.insert(id, Goes::BuiltIn(number))),
                (OP_CONSTANT, [_, id, value]) => drop(numbers.insert(*id, *value as usize)),
                (OP_EXT_INST_IMPORT, [id, name @ ..]) if string(name) == "NonSemantic.Shader.DebugInfo.100" => {
                    debug = Some(*id);
                }
                (OP_LINE, &[file, line, column]) => now = at(strings.get(&file), line as usize, column as usize),
                (OP_NO_LINE, _) => now = None,
                (OP_VARIABLE, &[_, id, class, ..]) if within.is_none() => drop(found.variables.insert(id, class)),
                (OP_FUNCTION, &[_, id, ..]) => {
                    found.functions.insert(id, now.clone());
                    within = Some(id);
                }
                (OP_FUNCTION_END, _) => (within, now) = (None, None),
                (OP_EXT_INST, &[_, id, set, op, ref operands @ ..]) if Some(set) == debug => {
                    let number = |k: usize| operands.get(k).and_then(|id| numbers.get(id)).copied().unwrap_or(0);
                    let source = |k: usize| operands.get(k).and_then(|id| sources.get(id));
                    match op {
                        DEBUG_SOURCE => {
                            let name = operands.first().and_then(|id| strings.get(id)).cloned().unwrap_or_default();
                            let text = operands.get(1).and_then(|id| strings.get(id));
                            found.texts.extend(text.map(|text| (name.clone(), text.clone())));
                            sources.insert(id, name);
                        }
                        DEBUG_FUNCTION => drop(declared.insert(id, at(source(2), number(3), number(4)))),
                        DEBUG_FUNCTION_DEFINITION => {
                            let place = operands.first().and_then(|id| declared.get(id)).cloned().flatten();
                            found.functions.extend(operands.get(1).map(|function| (*function, place)));
                        }
                        DEBUG_LINE => now = at(source(0), number(1), number(3)),
                        DEBUG_NO_LINE => now = None,
                        _ => {}
                    }
                }
                _ => {}
            }
            let is_debug = |set: &u32| Some(*set) == debug;
            found.kept.push(match instruction {
                [first, _, _, set, ..] if first & 0xffff == OP_EXT_INST => !is_debug(set),
                [first, id, ..] if first & 0xffff == OP_EXT_INST_IMPORT => !is_debug(id),
                [first, _, _] if first & 0xffff == OP_UNDEF => false,
                // Its reader takes none between types.
                [first, ..] if matches!(first & 0xffff, OP_LINE | OP_NO_LINE) => false,
                _ => true,
            });
            found.places.push(now.clone());
        }
        found
    }
}

/// The module without the instructions that are not kept, and with undefined values in front of all functions, as zeros:
/// inside of one, naga's reader would have them come about twice.
pub(super) fn kept(words: &[u32], kept: &[bool]) -> Vec<u32> {
    let mut new = words.get(..5).unwrap_or(words).to_vec();
    let undefined = instructions(words).filter(|instruction| instruction[0] & 0xffff == OP_UNDEF);
    let mut nulls: Option<Vec<u32>> = Some(undefined.flat_map(|i| [3 << 16 | OP_CONSTANT_NULL, i[1], i[2]]).collect());
    for (instruction, _) in instructions(words).zip(kept).filter(|(_, kept)| **kept) {
        if instruction[0] & 0xffff == OP_FUNCTION {
            new.extend(nulls.take().unwrap_or_default());
        }
        new.extend(instruction);
    }
    new
}

/// The module with other names.
pub(super) fn renamed(words: &[u32], names: &HashMap<u32, String>) -> Vec<u32> {
    let mut new = words.get(..5).unwrap_or(words).to_vec();
    for instruction in instructions(words) {
        match (instruction[0] & 0xffff, instruction.get(1).and_then(|id| names.get(id))) {
            (OP_NAME, Some(name)) => {
                let text = literal(name);
                new.extend([(text.len() as u32 + 2) << 16 | OP_NAME, instruction[1]]);
                new.extend(text);
            }
            _ => new.extend(instruction),
        }
    }
    new
}
