//! Capabilities of a SPIR-V module that its writer leaves out.

/// Words before the first instruction (SPIR-V 1.6, 2.3).
pub(super) const HEADER: usize = 5;
const OP_EXTENSION: u32 = 10;
const OP_CAPABILITY: u32 = 17;
const OP_DECORATE: u32 = 71;
const OP_MEMBER_DECORATE: u32 = 72;
const BUILT_IN: u32 = 11;
const OP_TYPE_BOOL: u32 = 20;
const OP_TYPE_VECTOR: u32 = 23;
const OP_TYPE_IMAGE: u32 = 25;
const OP_LOAD: u32 = 61;
const OP_IMAGE_QUERY_SIZE_LOD: u32 = 103;
const OP_IMAGE_QUERY_SIZE: u32 = 104;
const OP_LOGICAL_OR: u32 = 166;
const OP_LOGICAL_AND: u32 = 167;
const OP_BITWISE_OR: u32 = 197;
const OP_BITWISE_AND: u32 = 199;

/// Built-in values with the capability that declares each, and the extension that has it before SPIR-V 1.3 (SPIR-V 1.6,
/// 3.21).
const BUILT_INS: [(u32, u32, &str); 3] = [
    (4424, DRAW_PARAMETERS, "SPV_KHR_shader_draw_parameters"), // BaseVertex
    (4425, DRAW_PARAMETERS, "SPV_KHR_shader_draw_parameters"), // BaseInstance
    (4426, DRAW_PARAMETERS, "SPV_KHR_shader_draw_parameters"), // DrawIndex
];
const DRAW_PARAMETERS: u32 = 4427;

/// The module with every capability and extension that its built-in values need.
pub(super) fn declared(mut words: Vec<u32>) -> Vec<u32> {
    let (mut known, mut named, mut wanted) = (Vec::new(), Vec::new(), Vec::new());
    // Extensions stand behind all capabilities.
    let mut behind = HEADER;
    let mut at = HEADER;
    while let Some(&first) = words.get(at) {
        let (op, length) = (first & 0xffff, (first >> 16) as usize);
        let Some(instruction) = words.get(at..at + length).filter(|i| !i.is_empty()) else { break };
        match (op, instruction) {
            (OP_CAPABILITY, [_, capability]) => {
                known.push(*capability);
                behind = at + length;
            }
            (OP_EXTENSION, [_, name @ ..]) => named.push(name.to_vec()),
            (OP_DECORATE, [_, _, BUILT_IN, built_in]) | (OP_MEMBER_DECORATE, [_, _, _, BUILT_IN, built_in]) => {
                wanted.extend(BUILT_INS.iter().filter(|(b, ..)| b == built_in));
            }
            _ => {}
        }
        at += length;
    }
    let (mut capabilities, mut extensions) = (Vec::new(), Vec::new());
    for &(_, capability, extension) in wanted {
        if !known.contains(&capability) {
            known.push(capability);
            capabilities.extend([2 << 16 | OP_CAPABILITY, capability]);
        }
        let name = literal(extension);
        if !named.contains(&name) {
            extensions.push((name.len() as u32 + 1) << 16 | OP_EXTENSION);
            extensions.extend(&name);
            named.push(name);
        }
    }
    let behind = behind.min(words.len());
    words.splice(behind..behind, capabilities.into_iter().chain(extensions));
    words
}

/// The module without the declarations that naga's reader does not know; it knows what they declare.
pub(super) fn known_to_reader(words: &[u32]) -> Vec<u32> {
    let unknown = |instruction: &[u32]| match instruction {
        [first, DRAW_PARAMETERS] => first & 0xffff == OP_CAPABILITY,
        [first, name @ ..] => first & 0xffff == OP_EXTENSION && BUILT_INS.iter().any(|(.., e)| literal(e) == name),
        [] => false,
    };
    let mut kept = words.get(..HEADER).unwrap_or(words).to_vec();
    let (mut boolean, mut vectors) = (None, Vec::new());
    for instruction in instructions(words) {
        let mut instruction = instruction.to_vec();
        match instruction[..] {
            [first, id] if first & 0xffff == OP_TYPE_BOOL => boolean = Some(id),
            [first, id, of, _] if first & 0xffff == OP_TYPE_VECTOR && Some(of) == boolean => vectors.push(id),
            // The reader takes these for `&&` and `||`, which have no vectors.
            [ref mut first, ty, ..] if vectors.contains(&ty) => match *first & 0xffff {
                OP_LOGICAL_OR => *first = *first & !0xffff | OP_BITWISE_OR,
                OP_LOGICAL_AND => *first = *first & !0xffff | OP_BITWISE_AND,
                _ => {}
            },
            _ => {}
        }
        if !unknown(&instruction) {
            kept.extend(instruction);
        }
    }
    kept
}

/// True for a module that asks for the number of layers of a texture, which naga's reader takes for one more size.
pub(super) fn asks_for_layers(words: &[u32]) -> bool {
    let (mut arrayed, mut loaded) = (Vec::new(), Vec::new());
    instructions(words).any(|instruction| {
        match *instruction {
            [first, id, _, _, _, 1, ..] if first & 0xffff == OP_TYPE_IMAGE => arrayed.push(id),
            [first, ty, id, ..] if first & 0xffff == OP_LOAD && arrayed.contains(&ty) => loaded.push(id),
            [first, _, _, image, ..] if matches!(first & 0xffff, OP_IMAGE_QUERY_SIZE_LOD | OP_IMAGE_QUERY_SIZE) => {
                return loaded.contains(&image);
            }
            _ => {}
        }
        false
    })
}

/// The instructions of a module, each with its first word.
pub(super) fn instructions(words: &[u32]) -> impl Iterator<Item = &[u32]> {
    let mut rest = words.get(HEADER..).unwrap_or_default();
    std::iter::from_fn(move || {
        let length = ((*rest.first()? >> 16) as usize).clamp(1, rest.len());
        let (instruction, behind) = rest.split_at(length);
        rest = behind;
        Some(instruction)
    })
}

/// A string as words: UTF-8 in little endian, ended by zero.
fn literal(text: &str) -> Vec<u32> {
    let mut bytes = text.as_bytes().to_vec();
    bytes.resize((bytes.len() + 1).next_multiple_of(4), 0);
    bytes.chunks_exact(4).map(|c| u32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect()
}

#[cfg(test)]
mod tests {
    use super::{declared, known_to_reader, literal};

    /// A module with these instructions.
    fn module(instructions: &[&[u32]]) -> Vec<u32> {
        let mut words = vec![0x0723_0203, 0x0001_0100, 0, 9, 0];
        words.extend(instructions.concat());
        words
    }

    const SHADER: [u32; 2] = [2 << 16 | 17, 1];
    const DRAW: [u32; 2] = [2 << 16 | 17, 4427];
    const BASE_VERTEX: [u32; 4] = [4 << 16 | 71, 7, 11, 4424];

    #[test]
    fn a_base_vertex_declares_the_parameters_of_a_draw_once() {
        let found = declared(module(&[&SHADER, &BASE_VERTEX, &BASE_VERTEX]));
        let mut extension = literal("SPV_KHR_shader_draw_parameters");
        extension.insert(0, (extension.len() as u32 + 1) << 16 | 10);
        assert_eq!(found, module(&[&SHADER, &DRAW, &extension, &BASE_VERTEX, &BASE_VERTEX]));
        assert_eq!(declared(found.clone()), found);
    }

    #[test]
    fn what_the_reader_does_not_know_is_left_out() {
        let plain = module(&[&SHADER, &BASE_VERTEX]);
        assert_eq!(known_to_reader(&declared(plain.clone())), plain);
        assert_eq!(known_to_reader(&module(&[&SHADER, &DRAW, &BASE_VERTEX])), plain);
        assert_eq!(known_to_reader(&plain), plain);
    }

    #[test]
    fn other_modules_stay_as_they_are() {
        let position = [4 << 16 | 71, 7, 11, 0];
        let plain = module(&[&SHADER, &position]);
        assert_eq!(declared(plain.clone()), plain);
    }

    #[test]
    fn what_is_cut_off_is_no_panic() {
        for end in 0..7 {
            let cut = module(&[&BASE_VERTEX])[..end].to_vec();
            assert_eq!((declared(cut.clone()), known_to_reader(&cut)), (cut.clone(), cut));
        }
    }
}
