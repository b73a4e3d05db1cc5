//! Front end for GLSL 1.10 to 4.60, GLSL ES 1.00 to 3.20 and WGSL: text to tokens, syntax tree, symbols, types
//! and the exact stage interface, with byte spans for everything. Broken input gives diagnostics and as
//! much of the rest as can be read.
//!
//! It is our own because a linter needs many errors per file, exact spans and typed expressions. naga's reader of
//! GLSL accepts text that is not GLSL, and other front ends stop at the first error.

pub mod ast;
mod builtin;
mod check;
mod constructor;
mod dialect;
pub mod errors;
mod fitting;
mod fold;
mod hole;
pub mod include;
pub mod interface;
pub mod known;
mod language;
mod lexer;
pub mod link;
pub mod memory;
mod names;
mod number;
pub mod offered;
mod opaque;
mod other_language;
mod parser;
pub mod precision;
mod preprocess;
mod reach;
mod readings;
pub mod real;
mod scalar;
mod sink;
mod stage;
pub mod swizzle;
pub mod symbols;
#[cfg(test)]
mod tests;
pub mod types;
pub mod vanishing;
mod vast;
pub mod walk;
pub mod wgsl;
pub mod words;
mod workgroup;

use ast::{Arena, Expr, ExprId, Unit};
use base::diagnostic::{Diagnostic, Severity};
use base::text::{SourceFile, Span};
pub use builtin::{BuiltinFunction, is_given_by_a_stage};
pub use constructor::{Constructor, Fit, constructor_needs};
pub use fitting::{fitting, stated};
pub use fold::Const;
pub use hole::Hole;
use interface::Interface;
pub use names::{MOST_SLIPS, nearest};
pub use other_language::{Looks, is_wgsl, looks_like, other_language};
pub use parser::words::{is_keyword, is_late_keyword};
use preprocess::InFront;
pub use preprocess::plain;
pub use preprocess::setting::Setting;
pub use readings::{Readings, Seen};
pub use stage::Stage;
use std::collections::BTreeSet;
use symbols::{CallTarget, FunctionId, FunctionInfo, Symbol, SymbolId, Use};
use types::Type;

/// Profile of a `#version` line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Profile {
    /// `core`, or nothing from 1.50 on.
    Core,
    /// `compatibility`, or nothing before 1.50.
    Compatibility,
    /// `es`, or version 100.
    Es,
}

/// Version of the language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Version {
    /// The number: 110 to 460; 110 without a directive.
    pub number: u32,
    /// Core, compatibility or ES.
    pub profile: Profile,
    /// From `#` to the last token of the directive, without blanks and comments around it; none
    /// without a directive.
    pub span: Option<Span>,
}

/// `#extension name : behaviour`
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Extension {
    /// The name, such as `GL_ARB_explicit_attrib_location`, or `all`.
    pub name: String,
    /// `require`, `enable`, `warn` or `disable`, as written.
    pub behavior: String,
    /// From `#` to the last token of the directive.
    pub span: Span,
}

/// A comment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Comment {
    /// Its place, with `//` or `/*` and `*/`, without the line break.
    pub span: Span,
    /// True for `/* … */`.
    pub block: bool,
}

/// Kind of a token of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TokenKind {
    /// A name or keyword.
    Word,
    /// A number.
    Number,
    /// An operator or other punctuation, `#` and `##` included.
    Punctuation,
    /// Something that is no token of the language.
    Unknown,
}

/// Where a token of the text stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TokenPlace {
    /// In text that is compiled.
    Text,
    /// In a directive, macro bodies included.
    Directive,
    /// In text or a directive that an `#if` leaves out.
    Inactive,
}

/// A token of the original text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// Word, number, operator and the like.
    pub kind: TokenKind,
    /// Its place; `SourceFile::slice` gives the text.
    pub span: Span,
    /// Where it stands.
    pub place: TokenPlace,
}

/// True for a word in capitals.
pub fn is_macro(word: &str) -> bool {
    let in_capitals = word.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_');
    word.len() > 1 && in_capitals && !word.starts_with(|c: char| c.is_ascii_digit())
}

/// What a name is used as that nothing declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Lacks {
    /// A type.
    Type,
    /// A function.
    Function,
    /// A variable or constant.
    Value,
}

/// True when the version and stage of a shader have a built-in function of that name.
pub fn is_builtin_function(shader: &Shader, name: &str) -> bool {
    let language = language::Language::new(shader.version(), shader.extensions());
    !builtin::functions(name).is_empty() && builtin::function_absent(name, shader.stage(), &language).is_none()
}

/// True for a name or literal that only an extension brings which no text can enable that states no version: its extension needs
/// a later one than the first.
pub fn needs_stated_version(word: &str) -> bool {
    builtin::is_late(word) || word.starts_with(|c: char| c.is_ascii_digit() || c == '.')
}

/// A function that prints a string and numbers, and changes nothing (GL_EXT_debug_printf).
pub const PRINTS: &str = "debugPrintfEXT";

/// A shader and what is wrong with it.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// The shader, as far as it could be read.
    pub shader: Shader,
    /// Errors of the front end, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
}

impl Parsed {
    /// Where the text is in another language than the one that it is read as, that is all that is wrong.
    fn unless_in_another(mut self, own: Looks) -> Self {
        // A module that cannot be read gives no errors: its other readers do.
        if own == Looks::Wgsl || self.diagnostics.iter().any(|d| d.severity == Severity::Error) {
            self.diagnostics = other_language(&self.shader.file, own).map_or(self.diagnostics, |found| vec![found]);
        }
        self
    }
}

/// A shader that has been read.
#[derive(Clone, Debug)]
pub struct Shader {
    file: SourceFile,
    stage: Stage,
    version: Version,
    extensions: Vec<Extension>,
    comments: Vec<Comment>,
    tokens: Vec<Token>,
    holes: Vec<Hole>,
    unit: Unit,
    arena: Arena,
    types: Vec<Type>,
    values: Vec<Option<Const>>,
    names: Vec<Option<SymbolId>>,
    calls: Vec<Option<CallTarget>>,
    symbols: Vec<Symbol>,
    functions: Vec<FunctionInfo>,
    uses: Vec<Use>,
    unknown: bool,
    lacking: Vec<(String, Lacks)>,
    absent: usize,
    interface: Interface,
    defines: Vec<(String, String)>,
    wgsl: Option<Box<wgsl::Module>>,
}

/// Macros from outside, and lines that define others.
type Given<'a> = (&'a [(String, String)], &'a [Setting]);

fn lexed(file: &SourceFile) -> lexer::Pieces {
    let mut pieces = lexer::lex(file.text());
    pieces.pieces = hole::join(file.text(), pieces.pieces);
    pieces
}

impl Shader {
    /// Reads a shader. Broken input gives diagnostics, not an error: reading goes on behind the
    /// next `;` or `}`.
    pub fn parse(file: &SourceFile, stage: Stage) -> Parsed {
        Self::read(file, stage, (&[], &[]), None)
    }

    /// Reads a shader that a host puts behind another text, which states this version and may declare
    /// names that this one does not.
    pub fn parse_behind(file: &SourceFile, stage: Stage, before: Version) -> Parsed {
        Self::read(file, stage, (&[], &[]), Some(InFront { version: before, names: true }))
    }

    /// Reads a shader with macros that are given from outside: names and values.
    pub fn parse_with(file: &SourceFile, stage: Stage, defines: &[(String, String)]) -> Parsed {
        Self::read(file, stage, (defines, &[]), None)
    }

    /// Reads the text once more, with macros that are given from outside.
    pub fn with_defines(&self, defines: &[(String, String)]) -> Parsed {
        if self.wgsl.is_some() {
            return Self::parse_wgsl(&self.file);
        }
        Self::read(&self.file, self.stage, (defines, &[]), self.assumed())
    }

    /// The version that is taken to stand in front of the text.
    fn assumed(&self) -> Option<InFront> {
        // GLSL 1.10 is what a text is that states nothing.
        let assumed = self.version.span.is_none() && self.version.number != 110;
        assumed.then(|| InFront { version: self.version.clone(), names: true })
    }

    fn read(file: &SourceFile, stage: Stage, given: Given<'_>, before: Option<InFront>) -> Parsed {
        let mut sink = sink::Sink::new(file);
        let pieces = lexed(file);
        let left = preprocess::run(&pieces, given, before, &mut sink);
        Self::checked(stage, given, pieces.comments, left, sink)
    }

    /// A shader of what the preprocessor leaves.
    fn checked(
        stage: Stage,
        given: Given<'_>,
        comments: Vec<Comment>,
        left: preprocess::Preprocessed,
        mut sink: sink::Sink,
    ) -> Parsed {
        let preprocess::Preprocessed {
            tokens,
            version,
            mut extensions,
            raw,
            incomplete,
            mut holes,
            wanted,
            directives: _,
        } = left;
        let file = &sink.file.clone();
        // A macro that stands for a hole is one where it is used.
        sink.fill_in(tokens.iter().filter(|tok| tok.lex == lexer::Lex::Hole).map(|tok| tok.span));
        extensions.extend(dialect::vulkan(file, &raw, &version));
        let language = language::Language::new(&version, &extensions);
        let (unit, mut arena, whole) = parser::parse(tokens, &language, &mut sink);
        holes.extend(whole);
        let whole: BTreeSet<Span> = holes.into_iter().collect();
        let mut holes: Vec<Hole> =
            sink.holes.iter().map(|span| Hole { span: *span, whole: whole.contains(span) }).collect();
        // Directives of another tool, and what stands in a macro, are none of these.
        let others = whole.iter().filter(|span| sink.holes.binary_search(span).is_err());
        holes.extend(others.map(|span| Hole { span: *span, whole: true }));
        let check::Checked {
            types,
            values,
            names,
            calls,
            mut symbols,
            functions,
            mut uses,
            unknown,
            mut lacking,
            absent,
            interface,
        } = check::check(&unit, &arena, stage, language, incomplete, &mut sink);
        lacking.extend(wanted.into_iter().map(|name| (name, Lacks::Value)));
        // A project keeps thousands of these: what growing vectors hold in reserve adds up.
        arena.shrink();
        symbols.shrink_to_fit();
        uses.shrink_to_fit();
        let shader = Self {
            file: sink.file.clone(),
            stage,
            version,
            extensions,
            comments,
            tokens: raw,
            holes,
            unit,
            arena,
            types,
            values,
            names,
            calls,
            symbols,
            functions,
            uses,
            unknown,
            lacking,
            absent,
            interface,
            defines: given.0.to_vec(),
            wgsl: None,
        };
        Parsed { shader, diagnostics: sink.finish() }.unless_in_another(Looks::Glsl)
    }

    /// Reads a module of WGSL. It has no stage of its own: it counts as a library, and its entry points say theirs.
    pub fn parse_wgsl(file: &SourceFile) -> Parsed {
        wgsl::read(file).unless_in_another(Looks::Wgsl)
    }

    /// The same module, as one of several that an engine makes of a text.
    #[must_use]
    pub fn varying(mut self) -> Self {
        if let Some(module) = &mut self.wgsl {
            (module.composed, module.varies) = (true, true);
        }
        self
    }

    /// What a module of WGSL has beside its tree; none for GLSL.
    pub fn wgsl(&self) -> Option<&wgsl::Module> {
        self.wgsl.as_deref()
    }

    /// The file.
    pub fn file(&self) -> &SourceFile {
        &self.file
    }

    /// Macros that were given from outside.
    pub fn defines(&self) -> &[(String, String)] {
        &self.defines
    }

    /// The stage.
    pub fn stage(&self) -> Stage {
        self.stage
    }

    /// True when a name is used that nothing in this text declares.
    pub fn has_unknown_names(&self) -> bool {
        self.unknown
    }

    /// Names that nothing in this text in GLSL declares, each once, with what it is used as first.
    pub fn lacking(&self) -> &[(String, Lacks)] {
        &self.lacking
    }

    /// How often the text in GLSL uses what the language has, and neither its version nor its stage.
    pub fn absent(&self) -> usize {
        self.absent
    }

    /// The version, with the place of its directive.
    pub fn version(&self) -> &Version {
        &self.version
    }

    /// Active `#extension` lines.
    pub fn extensions(&self) -> &[Extension] {
        &self.extensions
    }

    /// True when the text requires an extension of which the front end knows nothing: it may bring words, types and rules.
    pub fn requires_unknown_extension(&self) -> bool {
        let required = |e: &&Extension| e.behavior == "require";
        let extensions: Vec<Extension> = self.extensions.iter().filter(required).cloned().collect();
        language::Language::new(&self.version, &extensions).is_open()
    }

    /// All comments in the order of the text.
    pub fn comments(&self) -> &[Comment] {
        &self.comments
    }

    /// All tokens of the original text in order, those in directives and in parts that an `#if`
    /// leaves out included; no comments.
    pub fn tokens(&self) -> &[Token] {
        &self.tokens
    }

    /// What a template engine, or another preprocessor, puts something in the place of.
    pub fn holes(&self) -> &[Hole] {
        &self.holes
    }

    /// The syntax tree.
    pub fn unit(&self) -> &Unit {
        &self.unit
    }

    /// The expressions of the syntax tree.
    pub fn arena(&self) -> &Arena {
        &self.arena
    }

    /// An expression.
    pub fn expr(&self, id: ExprId) -> &Expr {
        self.arena.get(id)
    }

    /// The text of an expression's span.
    pub fn text_of(&self, id: ExprId) -> &str {
        self.file.slice(self.expr(id).span)
    }

    /// The stage interface.
    pub fn interface(&self) -> &Interface {
        &self.interface
    }

    /// Type of an expression; [`Type::Error`] when it is unknown because of an error told
    /// elsewhere.
    pub fn type_of(&self, id: ExprId) -> &Type {
        self.types.get(id.index()).unwrap_or(&Type::Error)
    }

    /// Value of a constant scalar expression.
    pub fn fold(&self, id: ExprId) -> Option<Const> {
        self.values.get(id.index()).copied().flatten()
    }

    /// The variable that a name expression means.
    pub fn symbol_of(&self, id: ExprId) -> Option<SymbolId> {
        self.names.get(id.index()).copied().flatten()
    }

    /// What a call expression means; none when no function fits.
    pub fn callee(&self, id: ExprId) -> Option<&CallTarget> {
        self.calls.get(id.index())?.as_ref()
    }

    /// Components that a constructor call needs and gets; none when the expression is no
    /// constructor call. The type of an ill-formed one is [`Type::Error`] by [`Shader::type_of`],
    /// so that nothing that depends on it is told; here it is the type that is written.
    pub fn constructor(&self, id: ExprId) -> Option<Constructor> {
        let (Some(CallTarget::Constructor(ty)), ast::ExprKind::Call { callee: _, args }) =
            (self.callee(id), &self.expr(id).kind)
        else {
            return None;
        };
        let args: Vec<Type> = args.iter().map(|a| self.type_of(*a).clone()).collect();
        Some(Constructor::new(ty, &args))
    }

    /// A variable.
    pub fn symbol(&self, id: SymbolId) -> &Symbol {
        &self.symbols[id.index()]
    }

    /// All variables, and the built-in ones that are used.
    pub fn symbols(&self) -> impl Iterator<Item = (SymbolId, &Symbol)> {
        self.symbols.iter().enumerate().map(|(i, s)| (SymbolId(u32::try_from(i).unwrap_or(u32::MAX)), s))
    }

    /// All uses of variables in the order of the text.
    pub fn uses(&self) -> &[Use] {
        &self.uses
    }

    /// The uses of one variable.
    pub fn uses_of(&self, symbol: SymbolId) -> impl Iterator<Item = &Use> {
        self.uses.iter().filter(move |u| u.symbol == symbol)
    }

    /// The built-in variable of that name, when the shader uses it.
    pub fn builtin(&self, name: &str) -> Option<SymbolId> {
        self.symbols().find(|(_, s)| s.kind == symbols::SymbolKind::Builtin && s.name == name).map(|(id, _)| id)
    }

    /// True when the variable is written anywhere, in part or as a whole.
    pub fn is_written(&self, symbol: SymbolId) -> bool {
        self.uses_of(symbol).any(|u| u.access.writes())
    }

    /// All functions of the shader with their signatures.
    pub fn functions(&self) -> impl Iterator<Item = (FunctionId, &FunctionInfo)> {
        self.functions.iter().enumerate().map(|(i, f)| (FunctionId(u32::try_from(i).unwrap_or(u32::MAX)), f))
    }

    /// The first function of that name.
    pub fn function(&self, name: &str) -> Option<&FunctionInfo> {
        self.functions.iter().find(|f| f.name.name == name)
    }

    /// A function by its identity.
    pub fn function_info(&self, id: FunctionId) -> &FunctionInfo {
        &self.functions[id.index()]
    }

    /// The syntax of a function's definition, if it has one.
    pub fn function_syntax(&self, function: &FunctionInfo) -> Option<&ast::Function> {
        match &self.unit.items.get(function.definition?)?.kind {
            ast::ItemKind::Function(f) => Some(f),
            _ => None,
        }
    }
}
