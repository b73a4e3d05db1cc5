//! Matrices of buffers that lie by rows (SPIR-V, decoration `RowMajor`): those by columns of HLSL, whose rows are the
//! columns of SPIR-V.
//!
//! naga's reader loads such a matrix transposed where a chain of indices leads to it, and knows nothing of it
//! elsewhere. What it would take the wrong way is refused here.

use std::collections::{HashMap, HashSet};

use crate::capabilities::instructions;

const OP_TYPE_VECTOR: u32 = 23;
const OP_TYPE_MATRIX: u32 = 24;
const OP_TYPE_ARRAY: u32 = 28;
const OP_TYPE_RUNTIME_ARRAY: u32 = 29;
const OP_TYPE_STRUCT: u32 = 30;
const OP_TYPE_POINTER: u32 = 32;
const OP_CONSTANT: u32 = 43;
const OP_VARIABLE: u32 = 59;
const OP_LOAD: u32 = 61;
const OP_STORE: u32 = 62;
const OP_ACCESS_CHAIN: u32 = 65;
const OP_IN_BOUNDS_ACCESS_CHAIN: u32 = 66;
const OP_MEMBER_DECORATE: u32 = 72;
const ROW_MAJOR: u32 = 4;

/// Types of a module, by id: what each is made of.
#[derive(Default)]
struct Types {
    members: HashMap<u32, Vec<u32>>,
    elements: HashMap<u32, u32>,
    pointees: HashMap<u32, u32>,
    vectors: HashMap<u32, (u32, u32)>,
    matrices: HashMap<u32, (u32, u32)>,
}

/// The module with members that are not square in the shape of their memory, which is how naga's reader needs them; or
/// the index of an instruction that it would take the wrong way, with the reason.
pub(super) fn rows(words: &[u32]) -> Result<Vec<u32>, (usize, &'static str)> {
    let decorated: HashSet<(u32, u32)> = instructions(words)
        .filter_map(|i| match *i {
            [first, ty, member, ROW_MAJOR] if first & 0xffff == OP_MEMBER_DECORATE => Some((ty, member)),
            _ => None,
        })
        .collect();
    if decorated.is_empty() {
        return Ok(words.to_vec());
    }
    let mut types = Types::default();
    let mut constants = HashMap::new();
    // Types that hold such a matrix; pointers by what they lead to, and those that lead past such a member.
    let (mut holding, mut pointers, mut led) = (HashSet::new(), HashMap::new(), HashSet::new());
    let mut narrow = HashSet::new();
    let mut new = words[..5].to_vec();
    let mut free = words[3];
    for (k, instruction) in instructions(words).enumerate() {
        let mut own = instruction.to_vec();
        match (instruction[0] & 0xffff, &instruction[1..]) {
            (OP_TYPE_VECTOR, &[id, of, count]) => drop(types.vectors.insert(id, (of, count))),
            (OP_TYPE_MATRIX, &[id, column, count]) => drop(types.matrices.insert(id, (column, count))),
            (OP_TYPE_ARRAY | OP_TYPE_RUNTIME_ARRAY, &[id, of, ..]) => {
                types.elements.insert(id, of);
                if holding.contains(&of) {
                    holding.insert(id);
                }
            }
            (OP_TYPE_STRUCT, [id, members @ ..]) => {
                types.members.insert(*id, members.to_vec());
                let is_decorated = |m: usize| decorated.contains(&(*id, m as u32));
                if members.iter().enumerate().any(|(m, ty)| is_decorated(m) || holding.contains(ty)) {
                    holding.insert(*id);
                }
                for (m, ty) in members.iter().enumerate().filter(|(m, _)| is_decorated(*m)) {
                    let Some(&(column, count)) = types.matrices.get(ty) else { continue };
                    let Some(&(scalar, height)) = types.vectors.get(&column) else { continue };
                    if height == count {
                        continue;
                    }
                    // Columns of two numbers lie closer in naga's matrices than in a buffer.
                    if count == 2 {
                        narrow.insert(*ty);
                        continue;
                    }
                    let known = |(of, n): (u32, u32)| move |(_, v): &(&u32, &(u32, u32))| **v == (of, n);
                    let vector = types.vectors.iter().find(known((scalar, count))).map(|(id, _)| *id);
                    let vector = vector.unwrap_or_else(|| {
                        new.extend([4 << 16 | OP_TYPE_VECTOR, free, scalar, count]);
                        types.vectors.insert(free, (scalar, count));
                        free += 1;
                        free - 1
                    });
                    let matrix = types.matrices.iter().find(known((vector, height))).map(|(id, _)| *id);
                    own[2 + m] = matrix.unwrap_or_else(|| {
                        new.extend([4 << 16 | OP_TYPE_MATRIX, free, vector, height]);
                        types.matrices.insert(free, (vector, height));
                        free += 1;
                        free - 1
                    });
                }
            }
            (OP_TYPE_POINTER, &[id, _, of]) => drop(types.pointees.insert(id, of)),
            (OP_CONSTANT, &[_, id, value]) => drop(constants.insert(id, value)),
            (OP_VARIABLE, &[ty, id, ..]) => drop(pointers.insert(id, types.pointees.get(&ty).copied())),
            (OP_ACCESS_CHAIN | OP_IN_BOUNDS_ACCESS_CHAIN, [_, id, base, indices @ ..]) => {
                let mut ty = pointers.get(base).copied().flatten();
                let mut past = led.contains(base);
                for index in indices {
                    ty = ty.and_then(|of| match (types.members.get(&of), constants.get(index)) {
                        (Some(members), Some(&member)) => {
                            past |= decorated.contains(&(of, member));
                            members.get(member as usize).copied()
                        }
                        _ => types.elements.get(&of).or_else(|| Some(&types.matrices.get(&of)?.0)).copied(),
                    });
                }
                pointers.insert(*id, ty);
                if past {
                    led.insert(*id);
                }
            }
            (OP_LOAD, &[ty, ..]) if holding.contains(&ty) => {
                return Err((k, "a structure that holds a matrix is read as a whole; read the matrix itself"));
            }
            (OP_LOAD, &[ty, _, from, ..]) if led.contains(&from) && narrow.contains(&ty) => {
                return Err((k, "columns of two numbers lie apart in a buffer; declare the matrix `row_major`"));
            }
            (OP_LOAD, &[ty, _, from, ..]) if led.contains(&from) && types.elements.contains_key(&ty) => {
                return Err((k, "an array of matrices is read as a whole; read its elements"));
            }
            (OP_STORE, &[to, ..]) if led.contains(&to) => {
                return Err((k, "a matrix of a buffer is written; declare it `row_major`"));
            }
            _ => {}
        }
        new.extend(own);
    }
    new[3] = free;
    Ok(new)
}
