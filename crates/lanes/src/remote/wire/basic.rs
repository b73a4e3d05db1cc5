//! Numbers, texts, lists, and what naga keeps its lists in.

use std::hash::Hash;
use std::sync::Arc;

use naga::{
    Arena, Block, Constant, Expression, FastIndexMap, Function, GlobalVariable, Handle, Literal, LocalVariable,
    Override, Range, Span, Type, TypeInner, UniqueArena,
};

/// Takes words.
#[derive(Debug, Default)]
pub struct Writer {
    words: Vec<u32>,
    refused: Option<&'static str>,
}

impl Writer {
    /// The words; the name of something that cannot be written, where there is any.
    pub fn finish(self) -> Result<Vec<u32>, &'static str> {
        match self.refused {
            None => Ok(self.words),
            Some(what) => Err(what),
        }
    }

    pub(super) fn word(&mut self, word: u32) {
        self.words.push(word);
    }

    pub(super) fn refuse(&mut self, what: &'static str) {
        self.refused.get_or_insert(what);
    }
}

/// Gives words back. Whatever they are, nothing panics.
#[derive(Debug)]
pub struct Reader<'a> {
    words: &'a [u32],
    handles: Handles,
}

impl<'a> Reader<'a> {
    /// A reader of these words.
    pub fn new(words: &'a [u32]) -> Self {
        Self { words, handles: Handles::default() }
    }

    pub(super) fn word(&mut self) -> Option<u32> {
        let (&first, rest) = self.words.split_first()?;
        self.words = rest;
        Some(first)
    }

    /// A number of things of which each has a word at least.
    fn count(&mut self) -> Option<usize> {
        let count = self.word()? as usize;
        (count <= self.words.len()).then_some(count)
    }

    /// True at the end.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Makes handles for a module with so many of each kind.
    pub(super) fn make_handles(&mut self, counts: Counts) -> Option<()> {
        self.handles = Handles::new(counts, self.words.len())?;
        Some(())
    }
}

/// How many of each kind a module has; of expressions and local variables the most of one function.
pub(super) type Counts = [u32; 7];

/// Handles by their number. naga gives out handles for what stands in an arena alone, so they are taken from arenas of
/// stand-ins.
#[derive(Debug, Default)]
struct Handles {
    types: Vec<Handle<Type>>,
    constants: Vec<Handle<Constant>>,
    overrides: Vec<Handle<Override>>,
    globals: Vec<Handle<GlobalVariable>>,
    functions: Vec<Handle<Function>>,
    locals: Vec<Handle<LocalVariable>>,
    expressions: Vec<Handle<Expression>>,
    of_expressions: Arena<Expression>,
}

impl Handles {
    fn new(
        [types, constants, overrides, globals, functions, locals, expressions]: Counts,
        most: usize,
    ) -> Option<Self> {
        fn filled<T: Clone>(count: u32, value: &T, most: usize) -> Option<(Vec<Handle<T>>, Arena<T>)> {
            let mut arena = Arena::new();
            let count = (count as usize <= most).then_some(count)?;
            Some(((0..count).map(|_| arena.append(value.clone(), Span::UNDEFINED)).collect(), arena))
        }
        let ty = Type { name: None, inner: TypeInner::Sampler { comparison: false } };
        let one_type = filled(1, &ty, 1)?.0[0];
        let literal = Expression::Literal(Literal::U32(0));
        let init = filled(1, &literal, 1)?.0[0];
        let constant = Constant { name: None, ty: one_type, init };
        let over = Override { name: None, id: None, ty: one_type, init: None };
        let global = GlobalVariable {
            name: None,
            space: naga::AddressSpace::Private,
            binding: None,
            ty: one_type,
            init: None,
            memory_decorations: naga::MemoryDecorations::empty(),
        };
        let local = LocalVariable { name: None, ty: one_type, init: None };
        let (expressions, of_expressions) = filled(expressions, &literal, most)?;
        Some(Self {
            types: filled(types, &ty, most)?.0,
            constants: filled(constants, &constant, most)?.0,
            overrides: filled(overrides, &over, most)?.0,
            globals: filled(globals, &global, most)?.0,
            functions: filled(functions, &Function::default(), most)?.0,
            locals: filled(locals, &local, most)?.0,
            expressions,
            of_expressions,
        })
    }
}

/// What can be written as words.
pub trait Wire: Sized {
    /// Writes it.
    fn put(&self, to: &mut Writer);
    /// Reads it; `None` for words that are none of its kind.
    fn take(from: &mut Reader<'_>) -> Option<Self>;
}

impl Wire for u32 {
    fn put(&self, to: &mut Writer) {
        to.word(*self);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        from.word()
    }
}

/// Numbers that fit into a word.
macro_rules! small {
    ($($name:ty),*) => { $(impl Wire for $name {
        fn put(&self, to: &mut Writer) {
            to.word((*self).into());
        }

        fn take(from: &mut Reader<'_>) -> Option<Self> {
            from.word()?.try_into().ok()
        }
    })* };
}
small!(u8, u16, std::num::NonZeroU32);

impl Wire for bool {
    fn put(&self, to: &mut Writer) {
        to.word((*self).into());
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        match from.word()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

impl Wire for u64 {
    fn put(&self, to: &mut Writer) {
        to.word(*self as u32);
        to.word((*self >> 32) as u32);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let low = from.word()?;
        Some(u64::from(low) | u64::from(from.word()?) << 32)
    }
}

/// Numbers whose bits are a number that can be written.
macro_rules! of_bits {
    ($($name:ty as $bits:ty: $to:ident, $from:expr;)*) => { $(impl Wire for $name {
        fn put(&self, to: &mut Writer) {
            self.$to().put(to);
        }

        fn take(from: &mut Reader<'_>) -> Option<Self> {
            <$bits>::take(from).map($from)
        }
    })* };
}
of_bits! {
    i16 as u16: cast_unsigned, u16::cast_signed;
    i32 as u32: cast_unsigned, u32::cast_signed;
    i64 as u64: cast_unsigned, u64::cast_signed;
    f32 as u32: to_bits, f32::from_bits;
    f64 as u64: to_bits, f64::from_bits;
}

impl Wire for String {
    fn put(&self, to: &mut Writer) {
        to.word(self.len() as u32);
        for bytes in self.as_bytes().chunks(4) {
            let mut word = [0; 4];
            word[..bytes.len()].copy_from_slice(bytes);
            to.word(u32::from_le_bytes(word));
        }
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let length = from.word()? as usize;
        let (words, rest) = from.words.split_at_checked(length.div_ceil(4))?;
        from.words = rest;
        let mut bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        bytes.truncate(length);
        Self::from_utf8(bytes).ok()
    }
}

impl<T: Wire> Wire for Option<T> {
    fn put(&self, to: &mut Writer) {
        self.is_some().put(to);
        if let Some(value) = self {
            value.put(to);
        }
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Some(if bool::take(from)? { Some(T::take(from)?) } else { None })
    }
}

impl<T: Wire> Wire for Vec<T> {
    fn put(&self, to: &mut Writer) {
        to.word(self.len() as u32);
        self.iter().for_each(|item| item.put(to));
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let count = from.count()?;
        (0..count).map(|_| T::take(from)).collect()
    }
}

impl Wire for Arc<[u32]> {
    fn put(&self, to: &mut Writer) {
        to.word(self.len() as u32);
        to.words.extend_from_slice(self);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let count = from.count()?;
        let (words, rest) = from.words.split_at_checked(count)?;
        from.words = rest;
        Some(words.into())
    }
}

impl<T: Wire, const N: usize> Wire for [T; N] {
    fn put(&self, to: &mut Writer) {
        self.iter().for_each(|item| item.put(to));
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let items: Option<Vec<T>> = (0..N).map(|_| T::take(from)).collect();
        items?.try_into().ok()
    }
}

/// Kinds that have handles.
trait Held: Sized + 'static {
    fn all(handles: &Handles) -> &[Handle<Self>];
}

macro_rules! held {
    ($($name:ty: $field:ident),*) => { $(impl Held for $name {
        fn all(handles: &Handles) -> &[Handle<Self>] {
            &handles.$field
        }
    })* };
}
held!(
    Type: types, Constant: constants, Override: overrides, GlobalVariable: globals, Function: functions,
    LocalVariable: locals, Expression: expressions
);

impl<T: Held> Wire for Handle<T> {
    fn put(&self, to: &mut Writer) {
        to.word(self.index() as u32);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let at = from.word()? as usize;
        T::all(&from.handles).get(at).copied()
    }
}

impl Wire for Range<Expression> {
    fn put(&self, to: &mut Writer) {
        let range = self.index_range();
        to.word(range.start);
        to.word(range.end);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let (start, end) = (from.word()?, from.word()?);
        let arena = &from.handles.of_expressions;
        (start <= end && end as usize <= arena.len()).then(|| Self::from_index_range(start..end, arena))
    }
}

impl<T: Wire> Wire for Arena<T> {
    fn put(&self, to: &mut Writer) {
        to.word(self.len() as u32);
        self.iter().for_each(|(_, item)| item.put(to));
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let mut arena = Self::new();
        for _ in 0..from.count()? {
            arena.append(T::take(from)?, Span::UNDEFINED);
        }
        Some(arena)
    }
}

impl Wire for UniqueArena<Type> {
    fn put(&self, to: &mut Writer) {
        to.word(self.len() as u32);
        self.iter().for_each(|(_, item)| item.put(to));
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let mut arena = Self::new();
        for _ in 0..from.count()? {
            arena.insert(Type::take(from)?, Span::UNDEFINED);
        }
        Some(arena)
    }
}

impl<K: Wire + Eq + Hash, V: Wire> Wire for FastIndexMap<K, V> {
    fn put(&self, to: &mut Writer) {
        to.word(self.len() as u32);
        for (key, value) in self {
            key.put(to);
            value.put(to);
        }
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let count = from.count()?;
        (0..count).map(|_| Some((K::take(from)?, V::take(from)?))).collect()
    }
}

impl Wire for Block {
    fn put(&self, to: &mut Writer) {
        to.word(self.len() as u32);
        self.iter().for_each(|statement| statement.put(to));
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Vec::take(from).map(Self::from_vec)
    }
}
