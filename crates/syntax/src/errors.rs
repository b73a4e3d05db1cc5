//! Codes of the diagnostics that the front end gives by itself. Each cause is told once: what
//! depends on something unknown stays silent.

use base::diagnostic::Code;

/// The text does not follow the grammar.
pub const SYNTAX: Code = Code("E001");
/// A character or comment that is no part of the language.
pub const TOKEN: Code = Code("E002");
/// A number that cannot be read or does not fit.
pub const LITERAL: Code = Code("E003");
/// Expressions, statements or types are nested too deeply to be read, or the text has too many tokens.
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
/// An `#include`, which compilers do not know; hosts often resolve it.
pub const INCLUDE: Code = Code("E015");
/// A name in a condition, or marked for replacement, that has no value.
pub const VALUELESS: Code = Code("E016");
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
/// A structure has no such member.
pub const UNKNOWN_FIELD: Code = Code("E034");
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

/// A qualifier that does not belong here, stands there twice, or excludes another.
pub const QUALIFIER: Code = Code("E042");
/// A layout qualifier that does not exist, does not belong here, or has a wrong value.
pub const LAYOUT: Code = Code("E043");
/// An initialiser that must be constant and is not, or one that is missing or must not be there.
pub const INITIALISER: Code = Code("E044");
/// `break`, `continue`, `discard`, `case` or `default` where it means nothing, or twice.
pub const PLACEMENT: Code = Code("E045");
/// A function that is declared against the rules, or calls itself.
pub const FUNCTION: Code = Code("E046");
/// A variable, parameter or member of a type that it cannot have.
pub const VARIABLE_TYPE: Code = Code("E047");
/// An array whose size is not known where it must be, or one without end.
pub const ARRAY: Code = Code("E048");
/// A block or a redeclaration of a built-in variable against the rules.
pub const REDECLARATION: Code = Code("E049");
/// An argument that must be a constant expression and is not.
pub const CONSTANT_ARGUMENT: Code = Code("E050");

/// An import of something that is not there.
pub const IMPORT: Code = Code("E070");
/// Files that import or include each other in a circle.
pub const IMPORT_CYCLE: Code = Code("E071");
/// An `@if`, `@elif` or `@else` that is written wrongly, or stands where it means nothing.
pub const TRANSLATE_TIME: Code = Code("E072");
/// A placeholder of a template without a value, or a template that is not read.
pub const TEMPLATE: Code = Code("E073");
/// A text that is one part of several: a name is declared neither in it nor in what it imports.
pub const FRAGMENT: Code = Code("E074");
/// A name that is imported twice, or imported and declared.
pub const IMPORTED_TWICE: Code = Code("E075");
/// A text in an early draft of WGSL, or what only such drafts have.
pub const EARLY_DRAFT: Code = Code("E076");
/// A text in another language than the one that it is read as.
pub const OTHER_LANGUAGE: Code = Code("E077");

// Codes of rules of the lint tool: the rule has the page and adds the fix.

/// A constructor gets an argument behind the last component that it needs.
pub const TOO_MANY: Code = Code("T001");
/// A constructor gets too few components.
pub const TOO_FEW: Code = Code("T002");
/// A vector or scalar is assigned to one of another size.
pub const ASSIGN_SIZE: Code = Code("T003");
/// A matrix is multiplied by a matrix or vector of a size that does not fit.
pub const MATRIX_SIZE: Code = Code("T004");
/// An integer stands where a `float` is needed, in a version without implicit conversions.
pub const IMPLICIT_FLOAT: Code = Code("T006");
/// The suffix `f` in a version that does not have it.
pub const FLOAT_SUFFIX: Code = Code("T007");
/// A scalar is swizzled.
pub const SCALAR_SWIZZLE: Code = Code("T008");
/// A swizzle takes a component that is not there, mixes naming sets, or is too long.
pub const SWIZZLE: Code = Code("T009");
/// `<` and the like on vectors.
pub const VECTOR_RELATION: Code = Code("T010");
/// `%` is used on floating-point operands.
pub const FLOAT_REMAINDER: Code = Code("T012");
/// A constant index that no element has.
pub const INDEX_RANGE: Code = Code("T016");
/// Something is written that can only be read.
pub const READ_ONLY: Code = Code("T018");
/// `#version` is not the first thing in the text.
pub const LATE_VERSION: Code = Code("V001");
/// Something that the version does not have.
pub const NEEDS_VERSION: Code = Code("V002");
/// A name that the language keeps for itself.
pub const RESERVED: Code = Code("V004");
/// A `float` in a fragment shader of GLSL ES without a precision.
pub const PRECISION: Code = Code("V009");
/// Something that an extension would bring, which is not enabled.
pub const EXTENSION: Code = Code("V010");
/// An input of a geometry shader that is no array.
pub const GEOMETRY_INPUT: Code = Code("G007");
/// A geometry shader without the layout of its input or output.
pub const MISSING_LAYOUT: Code = Code("G008");
/// A geometry shader whose output primitive is none.
pub const OUTPUT_PRIMITIVE: Code = Code("G009");
/// An integer input of a fragment shader that is not `flat`.
pub const NOT_FLAT: Code = Code("I005");

/// Every code with one line about it, in order.
pub const ALL: &[(Code, &str)] = &[
    (SYNTAX, "the text does not follow the grammar"),
    (TOKEN, "a character or comment that is no part of the language"),
    (LITERAL, "a number that cannot be read or does not fit"),
    (TOO_DEEP, "the text is larger, or nested deeper, than what is read"),
    (UNKNOWN_DIRECTIVE, "a directive that the language does not have"),
    (CONDITIONAL, "an #if without #endif, or an #else, #elif or #endif without #if"),
    (DIRECTIVE, "a directive that is written wrongly"),
    (ERROR_DIRECTIVE, "an #error that is reached"),
    (MACRO, "a macro used with a wrong number of arguments, or one that expands without end"),
    (INCLUDE, "an #include, which compilers do not know; hosts often resolve it"),
    (VALUELESS, "a name in a condition, or marked for replacement, that has no value"),
    (UNKNOWN_NAME, "a name that nothing declares"),
    (UNKNOWN_FUNCTION, "a function that nothing declares"),
    (NO_OVERLOAD, "a function exists, but not for these arguments"),
    (UNKNOWN_TYPE, "a type that nothing declares"),
    (REDEFINITION, "a name is declared twice in one scope, or a function has two bodies"),
    (MISSING_MAIN, "a stage without main"),
    (ASSIGN_TYPE, "a value is assigned to, or initialises, something of another type"),
    (OPERAND_TYPE, "an operator does not take operands of these types"),
    (UNKNOWN_FIELD, "a structure has no such member"),
    (INDEX, "something that has no elements is indexed, or the index is no integer"),
    (CONDITION_TYPE, "a condition is not a bool"),
    (RETURN_TYPE, "return does not agree with the function's type"),
    (CONSTANT, "an array size or layout value is not a positive constant integer"),
    (CONSTRUCTOR, "a constructor gets an argument that has no components, or cannot be built at all"),
    (NOT_A_PLACE, "something is written that is no variable"),
    (QUALIFIER, "a qualifier that does not belong here, stands there twice, or excludes another"),
    (LAYOUT, "a layout qualifier that does not exist, does not belong here, or has a wrong value"),
    (INITIALISER, "an initialiser that must be constant and is not, or one that is missing or must not be there"),
    (PLACEMENT, "break, continue, discard, case or default where it means nothing, or twice"),
    (FUNCTION, "a function that is declared against the rules, or calls itself"),
    (VARIABLE_TYPE, "a variable, parameter or member of a type that it cannot have"),
    (ARRAY, "an array whose size is not known where it must be, or that is used against the rules"),
    (REDECLARATION, "a block or a redeclaration of a built-in variable against the rules"),
    (CONSTANT_ARGUMENT, "an argument that must be a constant expression and is not"),
    (IMPORT, "an import of something that is not there"),
    (IMPORT_CYCLE, "files that import or include each other in a circle"),
    (TRANSLATE_TIME, "an @if, @elif or @else that is written wrongly, or stands where it means nothing"),
    (TEMPLATE, "a placeholder of a template without a value, or a template that is not read"),
    (FRAGMENT, "a text that is one part of several: a name is declared neither in it nor in what it imports"),
    (IMPORTED_TWICE, "a name that is imported twice, or imported and declared"),
    (EARLY_DRAFT, "a text in an early draft of WGSL, or what only such drafts have"),
    (OTHER_LANGUAGE, "a text in another language than the one that it is read as"),
];
