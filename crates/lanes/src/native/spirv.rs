//! SPIR-V as words: what a translator made of a shader, read as far as feeding and capturing need it.

use std::collections::{HashMap, HashSet};

/// Instructions that are looked at, by number.
pub(super) mod op {
    pub const NAME: u32 = 5;
    pub const MEMBER_NAME: u32 = 6;
    pub const ENTRY_POINT: u32 = 15;
    pub const EXECUTION_MODE: u32 = 16;
    pub const CAPABILITY: u32 = 17;
    pub const TYPE_BOOL: u32 = 20;
    pub const TYPE_INT: u32 = 21;
    pub const TYPE_FLOAT: u32 = 22;
    pub const TYPE_VECTOR: u32 = 23;
    pub const TYPE_MATRIX: u32 = 24;
    pub const TYPE_ARRAY: u32 = 28;
    pub const TYPE_STRUCT: u32 = 30;
    pub const TYPE_POINTER: u32 = 32;
    pub const CONSTANT: u32 = 43;
    pub const CONSTANT_COMPOSITE: u32 = 44;
    pub const CONSTANT_NULL: u32 = 46;
    pub const FUNCTION: u32 = 54;
    pub const FUNCTION_END: u32 = 56;
    pub const FUNCTION_CALL: u32 = 57;
    pub const VARIABLE: u32 = 59;
    pub const LOAD: u32 = 61;
    pub const STORE: u32 = 62;
    pub const DECORATE: u32 = 71;
    pub const MEMBER_DECORATE: u32 = 72;
    pub const I_ADD: u32 = 128;
    pub const SHIFT_LEFT: u32 = 196;
    pub const BITWISE_OR: u32 = 197;
    pub const EMIT_VERTEX: u32 = 218;
    pub const END_PRIMITIVE: u32 = 219;
    pub const BRANCH_CONDITIONAL: u32 = 250;
    pub const SWITCH: u32 = 251;
}

/// Storage classes.
pub(super) mod storage {
    pub const INPUT: u32 = 1;
    pub const UNIFORM: u32 = 2;
    pub const OUTPUT: u32 = 3;
    pub const PRIVATE: u32 = 6;
    pub const STORAGE_BUFFER: u32 = 12;
}

/// Decorations.
pub(super) mod decoration {
    pub const ROW_MAJOR: u32 = 4;
    pub const ARRAY_STRIDE: u32 = 6;
    pub const MATRIX_STRIDE: u32 = 7;
    pub const BUILT_IN: u32 = 11;
    pub const NON_WRITABLE: u32 = 24;
    pub const LOCATION: u32 = 30;
    pub const BINDING: u32 = 33;
    pub const DESCRIPTOR_SET: u32 = 34;
    pub const OFFSET: u32 = 35;
    pub const XFB_BUFFER: u32 = 36;
    pub const XFB_STRIDE: u32 = 37;
}

/// The number with which a module begins.
pub(super) const MAGIC: u32 = 0x0723_0203;
/// Words before the first instruction.
pub(super) const HEADER: usize = 5;

/// Packs an instruction.
pub(super) fn instruction(opcode: u32, operands: &[u32]) -> Vec<u32> {
    let mut words = vec![(operands.len() as u32 + 1) << 16 | opcode];
    words.extend(operands);
    words
}

/// The instructions of a module: number and operands. Stops at words that are none.
pub(super) fn instructions(words: &[u32]) -> impl Iterator<Item = (u32, &[u32])> {
    let mut rest = words.get(HEADER..).unwrap_or_default();
    std::iter::from_fn(move || {
        let &first = rest.first()?;
        let length = (first >> 16) as usize;
        let (this, behind) = rest.split_at_checked(length.max(1))?;
        rest = behind;
        Some((first & 0xffff, &this[1..]))
    })
}

/// True for a module that decides anything when it runs.
pub(super) fn branches(words: &[u32]) -> bool {
    instructions(words).any(|(opcode, _)| matches!(opcode, op::BRANCH_CONDITIONAL | op::SWITCH))
}

/// A string at the start of operands, and the operands behind it.
pub(super) fn text(operands: &[u32]) -> (String, &[u32]) {
    let end = operands.iter().position(|w| w.to_le_bytes().contains(&0)).map_or(operands.len(), |at| at + 1);
    let bytes: Vec<u8> = operands[..end].iter().flat_map(|w| w.to_le_bytes()).take_while(|&b| b != 0).collect();
    (String::from_utf8_lossy(&bytes).into_owned(), &operands[end..])
}

/// A type, as far as values are fed and captured.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Bool,
    /// An integer or binary32 number of 32 bits.
    Number,
    Vector {
        component: u32,
        count: u32,
    },
    Matrix {
        column: u32,
        count: u32,
    },
    Array {
        element: u32,
        count: u32,
    },
    Struct(Vec<u32>),
    Pointer {
        storage: u32,
        to: u32,
    },
}

/// A variable outside of functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Variable {
    pub id: u32,
    /// What it points to.
    pub ty: u32,
    pub storage: u32,
}

/// What a module says about its interface.
#[derive(Debug, Default)]
pub(super) struct Reflection {
    names: HashMap<u32, String>,
    members: HashMap<(u32, u32), String>,
    decorations: HashMap<(u32, Option<u32>, u32), u32>,
    pub types: HashMap<u32, Type>,
    pub variables: Vec<Variable>,
    pub entry: u32,
}

impl Reflection {
    pub fn of(words: &[u32]) -> Self {
        let mut this = Self::default();
        let mut constants: HashMap<u32, u32> = HashMap::new();
        for (opcode, o) in instructions(words) {
            match (opcode, o) {
                (op::NAME, [id, rest @ ..]) => {
                    this.names.insert(*id, text(rest).0);
                }
                (op::MEMBER_NAME, [id, member, rest @ ..]) => {
                    this.members.insert((*id, *member), text(rest).0);
                }
                (op::ENTRY_POINT, [_, id, ..]) => this.entry = *id,
                (op::DECORATE, [id, what, rest @ ..]) => {
                    this.decorations.insert((*id, None, *what), rest.first().copied().unwrap_or(0));
                }
                (op::MEMBER_DECORATE, [id, member, what, rest @ ..]) => {
                    this.decorations.insert((*id, Some(*member), *what), rest.first().copied().unwrap_or(0));
                }
                (op::TYPE_BOOL, [id]) => {
                    this.types.insert(*id, Type::Bool);
                }
                (op::TYPE_INT, [id, 32, _]) | (op::TYPE_FLOAT, [id, 32]) => {
                    this.types.insert(*id, Type::Number);
                }
                (op::TYPE_VECTOR, &[id, component, count]) => {
                    this.types.insert(id, Type::Vector { component, count });
                }
                (op::TYPE_MATRIX, &[id, column, count]) => {
                    this.types.insert(id, Type::Matrix { column, count });
                }
                (op::TYPE_ARRAY, &[id, element, length]) => {
                    let count = constants.get(&length).copied().unwrap_or(0);
                    this.types.insert(id, Type::Array { element, count });
                }
                (op::TYPE_STRUCT, [id, members @ ..]) => {
                    this.types.insert(*id, Type::Struct(members.to_vec()));
                }
                (op::TYPE_POINTER, &[id, storage, to]) => {
                    this.types.insert(id, Type::Pointer { storage, to });
                }
                (op::CONSTANT, &[_, id, word]) => {
                    constants.insert(id, word);
                }
                (op::VARIABLE, &[pointer, id, storage, ..]) => {
                    if let Some(&Type::Pointer { to, .. }) = this.types.get(&pointer) {
                        this.variables.push(Variable { id, ty: to, storage });
                    }
                }
                // Bodies say nothing about the interface.
                (op::FUNCTION, _) => break,
                _ => {}
            }
        }
        this
    }

    pub fn name(&self, id: u32) -> &str {
        self.names.get(&id).map_or("", String::as_str)
    }

    pub fn member_name(&self, id: u32, member: u32) -> &str {
        self.members.get(&(id, member)).map_or("", String::as_str)
    }

    pub fn decoration(&self, id: u32, what: u32) -> Option<u32> {
        self.decorations.get(&(id, None, what)).copied()
    }

    pub fn member_decoration(&self, id: u32, member: u32, what: u32) -> Option<u32> {
        self.decorations.get(&(id, Some(member), what)).copied()
    }

    /// Variables of a storage class.
    pub fn of_storage(&self, storage: u32) -> impl Iterator<Item = Variable> {
        self.variables.iter().copied().filter(move |v| v.storage == storage)
    }

    /// The variable of this name.
    pub fn find(&self, storage: u32, name: &str) -> Option<Variable> {
        self.of_storage(storage).find(|v| self.name(v.id) == name)
    }

    /// Numbers in a value of a type, one after the other.
    pub fn words(&self, ty: u32) -> u32 {
        match self.types.get(&ty) {
            Some(Type::Bool | Type::Number) => 1,
            Some(Type::Vector { component: part, count } | Type::Matrix { column: part, count })
            | Some(Type::Array { element: part, count }) => count * self.words(*part),
            Some(Type::Struct(members)) => members.iter().map(|&m| self.words(m)).sum(),
            Some(Type::Pointer { .. }) | None => 0,
        }
    }

    /// The structure with built-in members behind a variable, through an array over vertices.
    pub fn block_of(&self, variable: Variable) -> Option<u32> {
        match self.types.get(&variable.ty)? {
            Type::Struct(_) => Some(variable.ty),
            Type::Array { element, .. } => matches!(self.types.get(element)?, Type::Struct(_)).then_some(*element),
            _ => None,
        }
    }
}

/// The module in what a translator printed, which may have messages before and behind it.
pub(super) fn module_in(output: &[u8]) -> Option<Vec<u32>> {
    let at = output.windows(4).position(|four| four == MAGIC.to_le_bytes())?;
    let words: Vec<u32> =
        output[at..].chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect();
    // Behind the end of a function stands another function, or the end: a letter is no instruction of 5 words.
    let mut end = HEADER;
    let mut last = None;
    let mut inside = false;
    while let Some(&first) = words.get(end) {
        let (length, opcode) = ((first >> 16) as usize, first & 0xffff);
        let begins = opcode == op::FUNCTION && length == 5;
        if length == 0 || end + length > words.len() || (last.is_some() && !inside && !begins) {
            break;
        }
        inside |= begins;
        end += length;
        if opcode == op::FUNCTION_END {
            (inside, last) = (false, Some(end));
        }
    }
    let module = &words[..last.filter(|_| !inside)?];
    is_whole(module).then(|| module.to_vec())
}

/// True when every function of a module is there that is called, or that an entry point names.
fn is_whole(module: &[u32]) -> bool {
    let mut defined = HashSet::new();
    let mut named = Vec::new();
    for (opcode, operands) in instructions(module) {
        match (opcode, operands) {
            (op::FUNCTION, [_, result, ..]) => drop(defined.insert(*result)),
            (op::FUNCTION_CALL, [_, _, function, ..]) | (op::ENTRY_POINT, [_, function, ..]) => named.push(*function),
            _ => {}
        }
    }
    named.iter().all(|function| defined.contains(function))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Vec<u32> {
        let mut words = vec![MAGIC, 0x0001_0300, 0, 9, 0];
        words.extend(instruction(op::NAME, &[7, u32::from_le_bytes(*b"abc\0")]));
        words.extend(instruction(op::TYPE_FLOAT, &[1, 32]));
        words.extend(instruction(op::TYPE_VECTOR, &[2, 1, 4]));
        words.extend(instruction(op::TYPE_POINTER, &[3, storage::INPUT, 2]));
        words.extend(instruction(op::DECORATE, &[7, decoration::LOCATION, 5]));
        words.extend(instruction(op::VARIABLE, &[3, 7, storage::INPUT]));
        words.extend(instruction(op::FUNCTION, &[1, 8, 0, 4]));
        words.extend(instruction(op::FUNCTION_END, &[]));
        words
    }

    #[test]
    fn a_module_is_found_among_messages() {
        let module = small();
        let bytes: Vec<u8> = module.iter().flat_map(|w| w.to_le_bytes()).collect();
        for (before, behind) in
            [("", ""), ("", "stdin\n"), ("stdin\nWARNING: 0:3: odd\n", ""), ("a", "stdin\nLinked\n")]
        {
            let output = [before.as_bytes(), &bytes, behind.as_bytes()].concat();
            assert_eq!(module_in(&output).as_ref(), Some(&module), "{before:?} {behind:?}");
        }
        assert_eq!(module_in(b"ERROR: 0:1: no"), None);
        assert_eq!(module_in(&bytes[..bytes.len() - 4]), None);
    }

    #[test]
    fn the_interface_is_read() {
        let reflection = Reflection::of(&small());
        let variable = reflection.find(storage::INPUT, "abc").unwrap();
        assert_eq!(reflection.decoration(variable.id, decoration::LOCATION), Some(5));
        assert_eq!(reflection.words(variable.ty), 4);
        assert_eq!(reflection.find(storage::OUTPUT, "abc"), None);
    }
}
