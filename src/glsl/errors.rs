//! Codes of the diagnostics that the front end gives by itself. Each cause is told once: what
//! depends on something unknown stays silent.

use crate::diagnostic::Code;

/// The text does not follow the grammar.
pub const SYNTAX: Code = Code("E001");
/// A character or comment that is no part of the language.
pub const TOKEN: Code = Code("E002");
/// A number that cannot be read or does not fit.
pub const LITERAL: Code = Code("E003");
/// Expressions, statements or types are nested too deeply to be read.
pub const TOO_DEEP: Code = Code("E004");
/// A directive that the language does not have.
pub const UNKNOWN_DIRECTIVE: Code = Code("E010");
/// An `#if` without `#endif`, or an `#else`, `#elif` or `#endif` without `#if`.
pub const CONDITIONAL: Code = Code("E011");
/// A directive that is written wrongly.
pub const DIRECTIVE: Code = Code("E012");
/// An `#error` that is reached.
pub const ERROR_DIRECTIVE: Code = Code("E013");
/// A macro used with a wrong number of arguments, or one that expands without end.
pub const MACRO: Code = Code("E014");
/// A name that nothing declares.
pub const UNKNOWN_NAME: Code = Code("E020");
/// A function that nothing declares.
pub const UNKNOWN_FUNCTION: Code = Code("E021");
/// A function exists, but not for these arguments.
pub const NO_OVERLOAD: Code = Code("E022");
/// A type that nothing declares.
pub const UNKNOWN_TYPE: Code = Code("E023");
/// A name is declared twice in one scope, or a function has two bodies.
pub const REDEFINITION: Code = Code("E024");
/// A stage without `main`.
pub const MISSING_MAIN: Code = Code("E025");
/// A value is assigned to, or initialises, something of another type.
pub const ASSIGN_TYPE: Code = Code("E030");
/// An operator does not take operands of these types.
pub const OPERAND_TYPE: Code = Code("E031");
/// `%` is used on floating-point operands.
pub const FLOAT_REMAINDER: Code = Code("E032");
/// A matrix is multiplied by a matrix or vector of a size that does not fit.
pub const MATRIX_SIZE: Code = Code("E033");
/// A structure has no such member.
pub const UNKNOWN_FIELD: Code = Code("E034");
/// A swizzle takes a component that is not there, mixes naming sets, or is too long.
pub const SWIZZLE: Code = Code("E035");
/// Something that has no elements is indexed, or the index is no integer.
pub const INDEX: Code = Code("E036");
/// A condition is not a `bool`.
pub const CONDITION_TYPE: Code = Code("E037");
/// `return` does not agree with the function's type.
pub const RETURN_TYPE: Code = Code("E038");
/// An array size or layout value is not a positive constant integer.
pub const CONSTANT: Code = Code("E039");
/// A constructor gets an argument that has no components, or cannot be built at all.
pub const CONSTRUCTOR: Code = Code("E040");

/// Something is written that is no variable.
pub const NOT_A_PLACE: Code = Code("E041");

/// Every code with one line about it, in order.
pub const ALL: &[(Code, &str)] = &[
    (SYNTAX, "the text does not follow the grammar"),
    (TOKEN, "a character or comment that is no part of the language"),
    (LITERAL, "a number that cannot be read or does not fit"),
    (TOO_DEEP, "expressions, statements or types are nested too deeply to be read"),
    (UNKNOWN_DIRECTIVE, "a directive that the language does not have"),
    (CONDITIONAL, "an #if without #endif, or an #else, #elif or #endif without #if"),
    (DIRECTIVE, "a directive that is written wrongly"),
    (ERROR_DIRECTIVE, "an #error that is reached"),
    (MACRO, "a macro used with a wrong number of arguments, or one that expands without end"),
    (UNKNOWN_NAME, "a name that nothing declares"),
    (UNKNOWN_FUNCTION, "a function that nothing declares"),
    (NO_OVERLOAD, "a function exists, but not for these arguments"),
    (UNKNOWN_TYPE, "a type that nothing declares"),
    (REDEFINITION, "a name is declared twice in one scope, or a function has two bodies"),
    (MISSING_MAIN, "a stage without main"),
    (ASSIGN_TYPE, "a value is assigned to, or initialises, something of another type"),
    (OPERAND_TYPE, "an operator does not take operands of these types"),
    (FLOAT_REMAINDER, "% is used on floating-point operands"),
    (MATRIX_SIZE, "a matrix is multiplied by a matrix or vector of a size that does not fit"),
    (UNKNOWN_FIELD, "a structure has no such member"),
    (SWIZZLE, "a swizzle takes a component that is not there, mixes naming sets, or is too long"),
    (INDEX, "something that has no elements is indexed, or the index is no integer"),
    (CONDITION_TYPE, "a condition is not a bool"),
    (RETURN_TYPE, "return does not agree with the function's type"),
    (CONSTANT, "an array size or layout value is not a positive constant integer"),
    (CONSTRUCTOR, "a constructor gets an argument that has no components, or cannot be built at all"),
    (NOT_A_PLACE, "something is written that is no variable"),
];
