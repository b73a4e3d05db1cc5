//! Codes of the diagnostics that the front end gives by itself, and what of the surroundings of a text each rests on.
//! Each cause is told once: what depends on something unknown stays silent.

use base::diagnostic::Code;

bitflags::bitflags! {
    /// What lies around a text and may decide whether something is wrong in it.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub struct Around: u16 {
        /// What other texts declare: variables, functions, types, `main`.
        const NAMES = 1;
        /// Which macros are defined.
        const MACROS = 1 << 1;
        /// What a macro stands for that is used at the place.
        const VALUES = 1 << 2;
        /// The stage that the text is compiled for.
        const STAGE = 1 << 3;
        /// What lines in front of the text may enable or state: extensions of the language, precisions.
        const ENABLED = 1 << 4;
        /// Types, conversions, overloads and rules of an extension or a version that is not known.
        const TYPES = 1 << 5;
        /// What a preprocessor other than that of the language, or a template engine, makes of the text.
        const GRAMMAR = 1 << 6;
        /// Whether the text is compiled as a whole: a piece may be cut, and put between others.
        const WHOLE = 1 << 7;
    }
}

impl Around {
    const NOTHING: Self = Self::empty();

    /// Each of them in a few words.
    pub fn words(self) -> impl Iterator<Item = &'static str> {
        let all = [
            (Self::NAMES, "names that other texts declare"),
            (Self::MACROS, "which macros are defined"),
            (Self::VALUES, "what a macro at the place stands for"),
            (Self::STAGE, "the stage"),
            (Self::ENABLED, "extensions and precisions that a line in front states"),
            (Self::TYPES, "the version, and extensions that are not known"),
            (Self::GRAMMAR, "what another preprocessor or a template makes of the text"),
            (Self::WHOLE, "the text being compiled as a whole"),
        ];
        all.into_iter().filter(move |(one, _)| self.contains(*one)).map(|(_, words)| words)
    }
}

/// Declares codes with what they rest on and one line about each, and the table of them.
macro_rules! errors {
    ($(#[$doc:meta])* $table:ident: $($name:ident = $code:literal [$($rests:ident)|+] $about:literal;)+) => {
        $(
            #[doc = concat!("`", $code, "`: ", $about, ".")]
            pub const $name: Code = Code($code);
        )+
        $(#[$doc])*
        const $table: &[(Code, Around, &str)] =
            &[$(($name, Around::empty()$(.union(Around::$rests))+, $about)),+];
    };
}

errors! {
    /// Errors of the front end alone.
    OWN:
    SYNTAX = "E001" [GRAMMAR | VALUES | WHOLE] "the text does not follow the grammar";
    TOKEN = "E002" [GRAMMAR | WHOLE] "a character or comment that is no part of the language";
    LITERAL = "E003" [GRAMMAR] "a number that cannot be read or does not fit";
    TOO_DEEP = "E004" [NOTHING] "the text is larger, or nested deeper, than what is read";
    UNKNOWN_DIRECTIVE = "E010" [GRAMMAR | WHOLE] "a directive that the language does not have";
    CONDITIONAL = "E011" [GRAMMAR | WHOLE] "an #if without #endif, or an #else, #elif or #endif without #if";
    DIRECTIVE = "E012" [GRAMMAR | MACROS | WHOLE] "a directive that is written wrongly";
    ERROR_DIRECTIVE = "E013" [MACROS | WHOLE] "an #error that is reached";
    MACRO = "E014" [MACROS | TYPES | WHOLE] "a macro used with a wrong number of arguments, or one that expands without end";
    INCLUDE = "E015" [NAMES | WHOLE] "an #include, which compilers do not know; hosts often resolve it";
    VALUELESS = "E016" [MACROS | WHOLE] "a name in a condition, or marked for replacement, that has no value";
    UNKNOWN_NAME = "E020" [NAMES | VALUES] "a name that nothing declares";
    UNKNOWN_FUNCTION = "E021" [NAMES | VALUES] "a function that nothing declares";
    NO_OVERLOAD = "E022" [TYPES | VALUES] "a function exists, but not for these arguments";
    UNKNOWN_TYPE = "E023" [NAMES | VALUES | WHOLE] "a type that nothing declares";
    REDEFINITION = "E024" [GRAMMAR | VALUES | WHOLE | TYPES] "a name is declared twice in one scope, or a function has two bodies";
    MISSING_MAIN = "E025" [NAMES | WHOLE] "a stage without main";
    ASSIGN_TYPE = "E030" [TYPES | VALUES] "a value is assigned to, or initialises, something of another type";
    OPERAND_TYPE = "E031" [TYPES | VALUES] "an operator does not take operands of these types";
    UNKNOWN_FIELD = "E034" [TYPES] "a structure has no such member";
    INDEX = "E036" [TYPES] "something that has no elements is indexed, or the index is no integer";
    CONDITION_TYPE = "E037" [TYPES] "a condition is not a bool";
    RETURN_TYPE = "E038" [TYPES | VALUES] "return does not agree with the function's type";
    CONSTANT = "E039" [TYPES | WHOLE] "an array size or layout value is not a positive constant integer";
    CONSTRUCTOR = "E040" [TYPES | VALUES] "a constructor gets an argument that has no components, or cannot be built at all";
    NOT_A_PLACE = "E041" [TYPES] "something is written that is no variable";
    QUALIFIER = "E042" [STAGE | TYPES | WHOLE] "a qualifier that does not belong here, stands there twice, or excludes another";
    LAYOUT = "E043" [STAGE | ENABLED | TYPES | VALUES | WHOLE] "a layout qualifier that does not exist, does not belong here, or has a wrong value";
    INITIALISER = "E044" [GRAMMAR | TYPES | WHOLE] "an initialiser that must be constant and is not, or one that is missing or must not be there";
    PLACEMENT = "E045" [STAGE | TYPES | WHOLE] "break, continue, discard, case or default where it means nothing, or twice";
    FUNCTION = "E046" [TYPES | WHOLE] "a function that is declared against the rules, or calls itself";
    VARIABLE_TYPE = "E047" [ENABLED | TYPES | WHOLE] "a variable, parameter or member of a type that it cannot have";
    ARRAY = "E048" [TYPES | WHOLE] "an array whose size is not known where it must be, or that is used against the rules";
    REDECLARATION = "E049" [GRAMMAR | TYPES | WHOLE] "a block or a redeclaration of a built-in variable against the rules";
    CONSTANT_ARGUMENT = "E050" [TYPES] "an argument that must be a constant expression and is not";
    PARENTHESES = "E051" [NOTHING] "operators of WGSL that do not stand together without parentheses";
    IMPORT = "E070" [NOTHING] "an import of something that is not there";
    IMPORT_CYCLE = "E071" [NOTHING] "files that import or include each other in a circle";
    TRANSLATE_TIME = "E072" [NOTHING] "an @if, @elif or @else that is written wrongly, or stands where it means nothing";
    TEMPLATE = "E073" [NOTHING] "a placeholder of a template without a value, or a template that is not read";
    FRAGMENT = "E074" [NOTHING] "a text that is one part of several: a name is declared neither in it nor in what it imports";
    IMPORTED_TWICE = "E075" [NOTHING] "a name that is imported twice, or imported and declared";
    EARLY_DRAFT = "E076" [NOTHING] "a text in an early draft of WGSL, or what only such drafts have";
    OTHER_LANGUAGE = "E077" [GRAMMAR | WHOLE] "a text in another language than the one that it is read as";
}

errors! {
    /// Errors whose codes are those of rules of the lint tool: the rule has the page and adds the fix.
    OF_RULES:
    TOO_MANY = "T001" [NOTHING] "a constructor gets an argument behind the last component that it needs";
    TOO_FEW = "T002" [NOTHING] "a constructor gets too few components";
    ASSIGN_SIZE = "T003" [VALUES] "a vector or scalar is assigned to one of another size";
    MATRIX_SIZE = "T004" [NOTHING] "a matrix is multiplied by a matrix or vector of a size that does not fit";
    IMPLICIT_FLOAT = "T006" [TYPES | VALUES] "an integer stands where a `float` is needed, in a version without implicit conversions";
    FLOAT_SUFFIX = "T007" [TYPES] "the suffix `f` in a version that does not have it";
    SCALAR_SWIZZLE = "T008" [TYPES] "a scalar is swizzled";
    SWIZZLE = "T009" [NOTHING] "a swizzle takes a component that is not there, mixes naming sets, or is too long";
    VECTOR_RELATION = "T010" [TYPES] "`<` and the like on vectors";
    HLSL_NAME = "T011" [NAMES | VALUES] "a name of HLSL";
    FLOAT_REMAINDER = "T012" [TYPES] "`%` is used on floating-point operands";
    INDEX_RANGE = "T016" [TYPES] "a constant index that no element has";
    READ_ONLY = "T018" [STAGE | TYPES] "something is written that can only be read";
    LATE_VERSION = "V001" [WHOLE] "`#version` is not the first thing in the text";
    NEEDS_VERSION = "V002" [STAGE | ENABLED | TYPES | WHOLE] "something that the version does not have";
    RESERVED = "V004" [TYPES | WHOLE] "a name that the language keeps for itself";
    PRECISION = "V009" [NAMES | ENABLED | TYPES | WHOLE] "a `float` in a fragment shader of GLSL ES without a precision";
    EXTENSION = "V010" [STAGE | ENABLED | WHOLE] "something that an extension would bring, which is not enabled";
    GEOMETRY_INPUT = "G007" [TYPES | WHOLE] "an input of a geometry shader that is no array";
    MISSING_LAYOUT = "G008" [TYPES | WHOLE] "a geometry shader without the layout of its input or output";
    OUTPUT_PRIMITIVE = "G009" [TYPES | WHOLE] "a geometry shader whose output primitive is none";
    NOT_FLAT = "I005" [TYPES | WHOLE] "an integer input of a fragment shader that is not `flat`";
}

/// Every code that the front end has for itself, with one line about it, in order.
pub fn all() -> impl ExactSizeIterator<Item = (Code, &'static str)> {
    OWN.iter().map(|&(code, _, about)| (code, about))
}

/// True for the code of a value that has another type than its place takes.
pub fn is_of_types(code: Code) -> bool {
    [ASSIGN_TYPE, OPERAND_TYPE, RETURN_TYPE, CONDITION_TYPE, NO_OVERLOAD].contains(&code)
}

/// True for an error of characters, directives and the grammar: what stands behind it may be read otherwise than it is meant.
pub fn is_of_the_text(code: Code) -> bool {
    matches!(code.0.get(..3), Some("E00" | "E01"))
}

/// True for an error about a name that nothing declares.
pub fn is_name(code: Code) -> bool {
    rests_on(code).contains(Around::NAMES | Around::VALUES)
}

/// What the surroundings of a text may decide about an error of the front end; nothing for other codes.
pub fn rests_on(code: Code) -> Around {
    let rows = OWN.iter().chain(OF_RULES);
    rows.into_iter().find(|row| row.0 == code).map_or(Around::NOTHING, |row| row.1)
}
