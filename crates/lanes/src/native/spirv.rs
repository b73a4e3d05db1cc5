//! SPIR-V as words: what a translator made of a shader, read as far as feeding and capturing need it.

use std::collections::{HashMap, HashSet};

use ::spirv::{Decoration, MAGIC_NUMBER, Op, StorageClass};

/// Words before the first instruction.
pub(super) const HEADER: usize = 5;

/// Packs an instruction.
pub(super) fn instruction(op: Op, operands: &[u32]) -> Vec<u32> {
    let mut words = vec![(operands.len() as u32 + 1) << 16 | op as u32];
    words.extend(operands);
    words
}

/// The instructions of a module, each with all its words. Stops at words that are none.
pub(super) fn instructions(words: &[u32]) -> impl Iterator<Item = &[u32]> {
    let mut rest = words.get(HEADER..).unwrap_or_default();
    std::iter::from_fn(move || {
        let length = (rest.first()? >> 16) as usize;
        let (this, behind) = rest.split_at_checked(length.max(1))?;
        rest = behind;
        Some(this)
    })
}

/// What an instruction does, and its operands; `Nop` for one that is not known, which nothing here looks at.
pub(super) fn parts(instruction: &[u32]) -> (Op, &[u32]) {
    let (first, operands) = instruction.split_first().unwrap_or((&0, &[]));
    (Op::from_u32(first & 0xffff).unwrap_or(Op::Nop), operands)
}

/// True for a module that decides anything when it runs.
pub(super) fn branches(words: &[u32]) -> bool {
    instructions(words).map(parts).any(|(op, _)| matches!(op, Op::BranchConditional | Op::Switch))
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
        for (op, o) in instructions(words).map(parts) {
            match (op, o) {
                (Op::Name, [id, rest @ ..]) => {
                    this.names.insert(*id, text(rest).0);
                }
                (Op::MemberName, [id, member, rest @ ..]) => {
                    this.members.insert((*id, *member), text(rest).0);
                }
                (Op::EntryPoint, [_, id, ..]) => this.entry = *id,
                (Op::Decorate, [id, what, rest @ ..]) => {
                    this.decorations.insert((*id, None, *what), rest.first().copied().unwrap_or(0));
                }
                (Op::MemberDecorate, [id, member, what, rest @ ..]) => {
                    this.decorations.insert((*id, Some(*member), *what), rest.first().copied().unwrap_or(0));
                }
                (Op::TypeBool, [id]) => {
                    this.types.insert(*id, Type::Bool);
                }
                (Op::TypeInt, [id, 32, _]) | (Op::TypeFloat, [id, 32]) => {
                    this.types.insert(*id, Type::Number);
                }
                (Op::TypeVector, &[id, component, count]) => {
                    this.types.insert(id, Type::Vector { component, count });
                }
                (Op::TypeMatrix, &[id, column, count]) => {
                    this.types.insert(id, Type::Matrix { column, count });
                }
                (Op::TypeArray, &[id, element, length]) => {
                    let count = constants.get(&length).copied().unwrap_or(0);
                    this.types.insert(id, Type::Array { element, count });
                }
                (Op::TypeStruct, [id, members @ ..]) => {
                    this.types.insert(*id, Type::Struct(members.to_vec()));
                }
                (Op::TypePointer, &[id, storage, to]) => {
                    this.types.insert(id, Type::Pointer { storage, to });
                }
                (Op::Constant, &[_, id, word]) => {
                    constants.insert(id, word);
                }
                (Op::Variable, &[pointer, id, storage, ..]) => {
                    if let Some(&Type::Pointer { to, .. }) = this.types.get(&pointer) {
                        this.variables.push(Variable { id, ty: to, storage });
                    }
                }
                // Bodies say nothing about the interface.
                (Op::Function, _) => break,
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

    pub fn decoration(&self, id: u32, what: Decoration) -> Option<u32> {
        self.decorations.get(&(id, None, what as u32)).copied()
    }

    pub fn member_decoration(&self, id: u32, member: u32, what: Decoration) -> Option<u32> {
        self.decorations.get(&(id, Some(member), what as u32)).copied()
    }

    /// Variables of a storage class.
    pub fn of_storage(&self, storage: StorageClass) -> impl Iterator<Item = Variable> {
        self.variables.iter().copied().filter(move |v| v.storage == storage as u32)
    }

    /// The variable of this name.
    pub fn find(&self, storage: StorageClass, name: &str) -> Option<Variable> {
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
    let at = output.windows(4).position(|four| four == MAGIC_NUMBER.to_le_bytes())?;
    let words: Vec<u32> =
        output[at..].chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect();
    // Behind the end of a function stands another function, or the end: a letter is no instruction of 5 words.
    let mut end = HEADER;
    let mut last = None;
    let mut inside = false;
    while let Some(&first) = words.get(end) {
        let (length, opcode) = ((first >> 16) as usize, first & 0xffff);
        let begins = opcode == Op::Function as u32 && length == 5;
        if length == 0 || end + length > words.len() || (last.is_some() && !inside && !begins) {
            break;
        }
        inside |= begins;
        end += length;
        if opcode == Op::FunctionEnd as u32 {
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
    for (op, operands) in instructions(module).map(parts) {
        match (op, operands) {
            (Op::Function, [_, result, ..]) => drop(defined.insert(*result)),
            (Op::FunctionCall, [_, _, function, ..]) | (Op::EntryPoint, [_, function, ..]) => named.push(*function),
            _ => {}
        }
    }
    named.iter().all(|function| defined.contains(function))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> Vec<u32> {
        let mut words = vec![MAGIC_NUMBER, 0x0001_0300, 0, 9, 0];
        words.extend(instruction(Op::Name, &[7, u32::from_le_bytes(*b"abc\0")]));
        words.extend(instruction(Op::TypeFloat, &[1, 32]));
        words.extend(instruction(Op::TypeVector, &[2, 1, 4]));
        words.extend(instruction(Op::TypePointer, &[3, StorageClass::Input as u32, 2]));
        words.extend(instruction(Op::Decorate, &[7, Decoration::Location as u32, 5]));
        words.extend(instruction(Op::Variable, &[3, 7, StorageClass::Input as u32]));
        words.extend(instruction(Op::Function, &[1, 8, 0, 4]));
        words.extend(instruction(Op::FunctionEnd, &[]));
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
        let variable = reflection.find(StorageClass::Input, "abc").unwrap();
        assert_eq!(reflection.decoration(variable.id, Decoration::Location), Some(5));
        assert_eq!(reflection.words(variable.ty), 4);
        assert_eq!(reflection.find(StorageClass::Output, "abc"), None);
    }
}
