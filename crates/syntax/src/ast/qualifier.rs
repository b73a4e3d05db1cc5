//! Qualifiers of declarations.

use super::{ExprId, Ident};
use base::text::Span;

/// The qualifiers before a type, in the order of the text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Qualifiers {
    /// Each with its place.
    pub list: Vec<Qualifier>,
}

/// A qualifier with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Qualifier {
    /// Which one.
    pub kind: QualifierKind,
    /// Its place; for `layout(…)` up to the closing parenthesis.
    pub span: Span,
}

/// Qualifiers.
#[derive(Clone, Debug, PartialEq)]
pub enum QualifierKind {
    /// `layout(key = value, …)`.
    Layout(Vec<LayoutEntry>),
    /// Where the variable lives.
    Storage(StorageQualifier),
    /// `centroid`, `sample`, `patch`.
    Auxiliary(AuxiliaryQualifier),
    /// `smooth`, `flat`, `noperspective`.
    Interpolation(Interpolation),
    /// `lowp`, `mediump`, `highp`.
    Precision(Precision),
    /// `invariant`.
    Invariant,
    /// `precise`.
    Precise,
    /// `coherent`, `volatile`, `restrict`, `readonly`, `writeonly`.
    Memory(MemoryQualifier),
    /// `subroutine` or `subroutine(types)`.
    Subroutine(Vec<Ident>),
}

/// One entry of a `layout(…)`.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutEntry {
    /// The key, such as `location` or `triangles`.
    pub key: Ident,
    /// The value behind `=`.
    pub value: Option<ExprId>,
    /// Key and value together.
    pub span: Span,
}

/// Storage qualifiers as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StorageQualifier {
    /// `const`
    Const,
    /// `in`
    In,
    /// `out`
    Out,
    /// `inout`
    InOut,
    /// `attribute` (vertex input before 1.30)
    Attribute,
    /// `varying` (vertex output, fragment input before 1.30)
    Varying,
    /// `uniform`
    Uniform,
    /// `buffer`
    Buffer,
    /// `shared`
    Shared,
}

impl StorageQualifier {
    /// The spelling.
    pub fn text(self) -> &'static str {
        match self {
            Self::Const => "const",
            Self::In => "in",
            Self::Out => "out",
            Self::InOut => "inout",
            Self::Attribute => "attribute",
            Self::Varying => "varying",
            Self::Uniform => "uniform",
            Self::Buffer => "buffer",
            Self::Shared => "shared",
        }
    }
}

/// Auxiliary storage qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AuxiliaryQualifier {
    /// `centroid`
    Centroid,
    /// `sample`
    Sample,
    /// `patch`
    Patch,
}

/// Interpolation qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// `smooth`
    Smooth,
    /// `flat`
    Flat,
    /// `noperspective`
    NoPerspective,
}

/// Precision qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Precision {
    /// `lowp`
    Low,
    /// `mediump`
    Medium,
    /// `highp`
    High,
}

/// Memory qualifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MemoryQualifier {
    /// `coherent`
    Coherent,
    /// `volatile`
    Volatile,
    /// `restrict`
    Restrict,
    /// `readonly`
    ReadOnly,
    /// `writeonly`
    WriteOnly,
}

impl Qualifiers {
    /// From the first to the last qualifier; none when there is no qualifier.
    pub fn span(&self) -> Option<Span> {
        Some(self.list.first()?.span.to(self.list.last()?.span))
    }

    /// The storage qualifier that decides, with its place: the last one that is not `const`, or
    /// `const`.
    pub fn storage(&self) -> Option<(StorageQualifier, Span)> {
        let mut all = self.list.iter().filter_map(|q| match q.kind {
            QualifierKind::Storage(s) => Some((s, q.span)),
            _ => None,
        });
        let first = all.next()?;
        Some(all.chain([first]).find(|(s, _)| *s != StorageQualifier::Const).unwrap_or(first))
    }

    /// True when `const` is among them.
    pub fn is_const(&self) -> bool {
        self.list.iter().any(|q| q.kind == QualifierKind::Storage(StorageQualifier::Const))
    }

    /// True for a subroutine type, a function of one, and a uniform that chooses among them.
    pub fn is_subroutine(&self) -> bool {
        self.list.iter().any(|q| matches!(q.kind, QualifierKind::Subroutine(_)))
    }

    /// The interpolation qualifier with its place.
    pub fn interpolation(&self) -> Option<(Interpolation, Span)> {
        self.list.iter().find_map(|q| match q.kind {
            QualifierKind::Interpolation(i) => Some((i, q.span)),
            _ => None,
        })
    }

    /// The precision qualifier with its place.
    pub fn precision(&self) -> Option<(Precision, Span)> {
        self.list.iter().find_map(|q| match q.kind {
            QualifierKind::Precision(p) => Some((p, q.span)),
            _ => None,
        })
    }

    /// Place of `invariant`.
    pub fn invariant(&self) -> Option<Span> {
        self.list.iter().find(|q| q.kind == QualifierKind::Invariant).map(|q| q.span)
    }

    /// All `layout(…)` qualifiers: entries and the place of the whole qualifier.
    pub fn layouts(&self) -> impl Iterator<Item = (&[LayoutEntry], Span)> {
        self.list.iter().filter_map(|q| match &q.kind {
            QualifierKind::Layout(entries) => Some((entries.as_slice(), q.span)),
            _ => None,
        })
    }

    /// The last layout entry with that key.
    pub fn layout_entry(&self, key: &str) -> Option<&LayoutEntry> {
        self.layouts().flat_map(|(entries, _)| entries).filter(|e| e.key.name == key).last()
    }
}
