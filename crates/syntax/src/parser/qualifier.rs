//! Qualifiers and type specifiers.

use super::super::ast::{
    ArrayDim, AuxiliaryQualifier, Interpolation, LayoutEntry, MemoryQualifier, Precision, Qualifier, QualifierKind,
    Qualifiers, StorageQualifier, StructSpecifier, TypeKind, TypeSpecifier,
};
use super::super::errors;
use super::super::lexer::Lex;
use super::{Ident, Message, Parser, Read};
use base::diagnostic::message;

impl Parser<'_> {
    pub(super) fn qualifiers(&mut self) -> Read<Qualifiers> {
        let mut list = Vec::new();
        loop {
            // What it says of a variable is not known, and the variable is read without it.
            if self.foreign_qualifier() || self.filled_in() {
                if let Some(kind) = self.named_by_hole() {
                    list.push(Qualifier { kind, span: self.span() });
                }
                self.advance();
                continue;
            }
            if !self.words.qualifier(self.word()) && !self.late_qualifier() {
                break;
            }
            let start = self.span();
            let word = self.word().to_owned();
            self.advance();
            let kind = match word.as_str() {
                "layout" => QualifierKind::Layout(self.layout()?),
                "subroutine" => QualifierKind::Subroutine(self.subroutine()?),
                "invariant" => QualifierKind::Invariant,
                "precise" => QualifierKind::Precise,
                "const" => QualifierKind::Storage(StorageQualifier::Const),
                // Compilers take `in out` for it.
                "in" if self.word() == "out" => {
                    self.advance();
                    QualifierKind::Storage(StorageQualifier::InOut)
                }
                "in" => QualifierKind::Storage(StorageQualifier::In),
                "out" => QualifierKind::Storage(StorageQualifier::Out),
                "inout" => QualifierKind::Storage(StorageQualifier::InOut),
                "attribute" => QualifierKind::Storage(StorageQualifier::Attribute),
                "varying" => QualifierKind::Storage(StorageQualifier::Varying),
                "uniform" => QualifierKind::Storage(StorageQualifier::Uniform),
                "buffer" => QualifierKind::Storage(StorageQualifier::Buffer),
                "shared" => QualifierKind::Storage(StorageQualifier::Shared),
                "centroid" => QualifierKind::Auxiliary(AuxiliaryQualifier::Centroid),
                "sample" => QualifierKind::Auxiliary(AuxiliaryQualifier::Sample),
                "patch" => QualifierKind::Auxiliary(AuxiliaryQualifier::Patch),
                "smooth" => QualifierKind::Interpolation(Interpolation::Smooth),
                "flat" => QualifierKind::Interpolation(Interpolation::Flat),
                "noperspective" => QualifierKind::Interpolation(Interpolation::NoPerspective),
                "lowp" => QualifierKind::Precision(Precision::Low),
                "mediump" => QualifierKind::Precision(Precision::Medium),
                "highp" => QualifierKind::Precision(Precision::High),
                "coherent"
                | "devicecoherent"
                | "queuefamilycoherent"
                | "workgroupcoherent"
                | "subgroupcoherent"
                | "shadercallcoherent" => QualifierKind::Memory(MemoryQualifier::Coherent),
                // Local variables may have it as well, of which it says nothing.
                "nonprivate" => continue,
                "volatile" => QualifierKind::Memory(MemoryQualifier::Volatile),
                "restrict" => QualifierKind::Memory(MemoryQualifier::Restrict),
                "readonly" => QualifierKind::Memory(MemoryQualifier::ReadOnly),
                _ => QualifierKind::Memory(MemoryQualifier::WriteOnly),
            };
            list.push(Qualifier { kind, span: self.since(start) });
        }
        Ok(Qualifiers { list })
    }

    /// True for a word of an extension that is not known here, such as `pervertexEXT` or `rayPayloadEXT`, that stands
    /// where only a qualifier can.
    fn foreign_qualifier(&self) -> bool {
        if !self.words.language().is_open() || self.peek_at(1) != Lex::Word {
            return false;
        }
        let word = self.word();
        if !["EXT", "NV", "KHR", "ARB", "AMD", "HUAWEI", "ARM"].iter().any(|vendor| word.ends_with(vendor)) {
            return false;
        }
        let next = self.word_at(1);
        self.words.qualifier(next) || self.words.built_in_type(next) || self.peek_at(2) == Lex::Word
    }

    /// True for a hole before a qualifier or a type.
    fn filled_in(&self) -> bool {
        let next = self.word_at(1);
        self.peek() == Lex::Hole && (self.words.qualifier(next) || self.words.built_in_type(next))
    }

    /// The qualifier that a hole has for its name: `$in`, `${out}`.
    fn named_by_hole(&self) -> Option<QualifierKind> {
        let hole = self.sink.file.slice(self.span());
        let storage = match hole.trim_matches(|c: char| !c.is_ascii_alphabetic()) {
            _ if self.peek() != Lex::Hole => return None,
            "in" => StorageQualifier::In,
            "out" => StorageQualifier::Out,
            "inout" => StorageQualifier::InOut,
            "uniform" => StorageQualifier::Uniform,
            "attribute" => StorageQualifier::Attribute,
            "varying" => StorageQualifier::Varying,
            _ => return None,
        };
        Some(QualifierKind::Storage(storage))
    }

    /// Tells a qualifier of a later version that stands where one can only be meant, and takes it as one.
    fn late_qualifier(&mut self) -> bool {
        let word = self.word().to_owned();
        let Some(since) = self.words.late_qualifier(&word) else { return false };
        let next = self.word_at(1);
        let meant = if word == "layout" {
            self.peek_at(1) == Lex::LParen
        } else {
            self.words.qualifier(next) || self.words.built_in_type(next)
        };
        if meant {
            let span = self.span();
            self.words.language().lacks(self.sink, &message!("`{word}`", "`{word}` "), since, span);
            self.words.enable(&[word.as_str()]);
        }
        meant
    }

    fn layout(&mut self) -> Read<Vec<LayoutEntry>> {
        let open = self.expect(Lex::LParen, "`(` after `layout`")?;
        let mut entries = Vec::new();
        while self.peek() != Lex::RParen {
            // `shared` is a keyword, but a key here.
            if !self.tok(0).is_word() {
                return self.expected("a layout key such as `location`");
            }
            let name = self.word().to_owned();
            let key = Ident { name, span: self.advance() };
            let value = match self.eat(Lex::Assign) {
                Some(_) => Some(self.ternary()?),
                None => None,
            };
            let span = self.since(key.span);
            entries.push(LayoutEntry { key, value, span });
            if self.eat(Lex::Comma).is_none() {
                break;
            }
        }
        self.close(Lex::RParen, ")", open)?;
        Ok(entries)
    }

    fn subroutine(&mut self) -> Read<Vec<Ident>> {
        let Some(open) = self.eat(Lex::LParen) else { return Ok(Vec::new()) };
        let mut names = vec![self.ident("a subroutine type")?];
        while self.eat(Lex::Comma).is_some() {
            names.push(self.ident("a subroutine type")?);
        }
        self.close(Lex::RParen, ")", open)?;
        Ok(names)
    }

    /// Zero or more `[size]`.
    pub(super) fn dims(&mut self) -> Read<Vec<ArrayDim>> {
        let mut dims = Vec::new();
        while let Some(open) = self.eat(Lex::LBracket) {
            let size = if self.peek() == Lex::RBracket { None } else { Some(self.ternary()?) };
            self.close(Lex::RBracket, "]", open)?;
            dims.push(ArrayDim { span: self.since(open), size });
        }
        Ok(dims)
    }

    pub(super) fn type_specifier(&mut self) -> Read<TypeSpecifier> {
        let start = self.span();
        let kind = if self.word() == "struct" {
            TypeKind::Struct(self.deeper(Self::structure)?)
        } else if self.words.built_in_type(self.word()) || self.is_name(0) {
            let name = self.word().to_owned();
            self.advance();
            TypeKind::Named(name)
        } else {
            return self.expected("a type");
        };
        let name_span = self.since(start);
        let dims = self.dims()?;
        Ok(TypeSpecifier { kind, name_span, dims, span: self.since(start) })
    }

    fn structure(&mut self) -> Read<StructSpecifier> {
        let start = self.advance();
        let name = if self.is_name(0) { Some(self.ident("the name of the structure")?) } else { None };
        let open = self.expect(Lex::LBrace, "`{` with the members of the structure")?;
        let members = self.members(open)?;
        Ok(StructSpecifier { name, members, span: self.since(start) })
    }

    /// Members up to and with the closing `}`.
    pub(super) fn members(&mut self, open: base::text::Span) -> Read<Vec<super::super::ast::Declaration>> {
        let mut members = Vec::new();
        while self.peek() != Lex::RBrace {
            if self.at_end() {
                self.sink.error(errors::SYNTAX, open, "this `{` is never closed", "opened here");
                return Err(Message);
            }
            let (from, told) = (self.at, self.sink.len());
            if self.hole() {
                continue;
            }
            match self.declaration() {
                Ok(member) => members.push(member),
                Err(Message) => self.skip(from, told),
            }
        }
        self.advance();
        Ok(members)
    }
}
