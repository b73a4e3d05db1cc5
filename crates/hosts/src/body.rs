//! Statements of GLSL whose function a host writes: bodies without a head, and lines that go into a function of another text.
//! Between a head and an end they are a function, of which everything that nothing declares is an input.

use base::text::SourceFile;
use syntax::ast::{Callee, ExprId, ExprKind, ItemKind, Stmt, StmtKind, TypeKind};
use syntax::errors;
use syntax::symbols::SymbolKind;
use syntax::types::{ScalarType, Type};
use syntax::{Lacks, Parsed, Shader, Stage, walk};

use crate::{Literal, marks};

/// Statements as a function.
#[derive(Clone, Debug)]
pub struct Body {
    /// The function, whose statements lead back to their places.
    pub literal: Literal,
    /// Names that are defined for it, since nothing is left of it otherwise.
    pub defined: Vec<String>,
}

/// How deep expressions are followed to the type of what a function gives.
const DEPTH: usize = 16;

impl Body {
    /// The statements of a text as a function that is `called` so; none for a text that is no statements, that declarations
    /// may be as well, or that is not surely of a shader.
    pub fn of(literal: &Literal, called: &str) -> Option<Self> {
        let code = marks::without_comments(&literal.text);
        if !code.contains(';') || !is_surely_of_a_shader(&code) || marks::has_main(&code) {
            return None;
        }
        let name = name(called, &code);
        let read = |define: &str| {
            let alone = parsed(&format!("{define}{}", literal.text));
            let within = parsed(&between(define, "void", &name, &literal.text, ""));
            (!are_declarations(&alone) && are_statements(&within, &name)).then_some(within.shader)
        };
        // Of a chunk that its host turns on as a whole, nothing is left without the name that does.
        let tested = tested(&code);
        let defines: String = tested.iter().map(|name| format!("#define {name}\n")).collect();
        let (shader, define) = match read("") {
            Some(shader) if !top(&shader, &name).is_empty() => (shader, ""),
            _ if tested.is_empty() => return None,
            _ => (read(&defines).filter(|shader| !top(shader, &name).is_empty())?, &defines[..]),
        };
        let (gives, end) = gives(&shader, &name);
        let literal = literal.within(&format!("{define}{gives} {name}() {{\n"), &format!("\n{end}}}\n"));
        Some(Self { literal, defined: if define.is_empty() { Vec::new() } else { tested } })
    }

    /// What to tell of names that are defined.
    pub fn notes(&self) -> Vec<String> {
        let names: Vec<String> = self.defined.iter().map(|name| format!("`{name}`")).collect();
        let are = if names.len() == 1 { "is" } else { "are" };
        let note = || format!("{} {are} defined: nothing is left of the text otherwise", names.join(", "));
        (!names.is_empty()).then(note).into_iter().collect()
    }
}

/// True for a text with a type or a variable that only languages of shaders have, or with several components at once.
pub(crate) fn is_surely_of_a_shader(code: &str) -> bool {
    let types = ["vec2", "vec3", "vec4", "ivec2", "ivec3", "ivec4", "mat2", "mat3", "mat4"];
    let is_variable = |at: usize| {
        let begins = !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '.');
        begins && code[at + 3..].starts_with(|c: char| c.is_ascii_uppercase())
    };
    let is_swizzle = |at: usize| {
        let behind = &code[at + 1..];
        let field = &behind[..behind.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(behind.len())];
        let of = |set: &str| (2..=4).contains(&field.len()) && field.chars().all(|c| set.contains(c));
        of("xyzw") || of("rgba")
    };
    types.iter().any(|word| marks::has_word(code, word))
        || code.match_indices("gl_").any(|(at, _)| is_variable(at))
        || code.match_indices('.').any(|(at, _)| is_swizzle(at))
}

/// What the function is called: by what its text is kept under, where that is a name and not one of the text.
fn name(called: &str, code: &str) -> String {
    let is_name = called.starts_with(|c: char| c.is_ascii_alphabetic())
        && called.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        && !called.contains("__")
        && !called.starts_with("gl_")
        && !syntax::is_keyword(called);
    let mut name = if is_name { called.to_owned() } else { "body".to_owned() };
    let language = parsed("").shader;
    while marks::has_word(code, &name) || syntax::is_builtin_function(&language, &name) {
        name.push_str("Body");
    }
    name
}

fn between(define: &str, gives: &str, name: &str, text: &str, end: &str) -> String {
    format!("{define}{gives} {name}() {{\n{text}\n{end}}}\n")
}

fn parsed(text: &str) -> Parsed {
    Shader::parse(&SourceFile::new("body.glsl", text.to_owned()), Stage::Library)
}

/// Names that lines of conditions ask for.
fn tested(code: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let lines = code.lines().filter_map(|line| line.trim_start().strip_prefix('#'));
    for line in lines.map(str::trim_start).filter(|line| line.starts_with("if") || line.starts_with("elif")) {
        let words: Vec<&str> =
            line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty()).collect();
        let asked = words.windows(2).filter(|pair| ["ifdef", "defined"].contains(&pair[0])).map(|pair| pair[1]);
        for name in asked.filter(|name| !name.starts_with("GL_")) {
            if found.iter().all(|known| known != name) {
                found.push(name.to_owned());
            }
        }
    }
    found
}

/// True where characters, directives or the grammar are wrong.
fn is_torn(parsed: &Parsed) -> bool {
    let wrong = |code| errors::is_of_the_text(code) && code != errors::INCLUDE;
    parsed.diagnostics.iter().any(|found| wrong(found.code))
}

/// True for a text at file level. Variables without a qualifier whose values are no constants are statements as well.
fn are_declarations(parsed: &Parsed) -> bool {
    let shader = &parsed.shader;
    let items = || shader.unit().items.iter().map(|item| &item.kind).filter(|kind| **kind != ItemKind::Empty);
    let plain = |kind: &ItemKind| match kind {
        ItemKind::Declaration(own) => own.qualifiers.list.is_empty() && !matches!(own.ty.kind, TypeKind::Struct(_)),
        _ => false,
    };
    let lacks = |id: ExprId| shader.symbol_of(id).is_none() && matches!(shader.expr(id).kind, ExprKind::Name(_));
    let computes = |kind: &ItemKind| match kind {
        ItemKind::Declaration(own) => own.declarators.iter().any(|one| {
            let value = one.initializer.as_ref().map(|own| own.value);
            value.is_some_and(|value| walk::expressions(shader, value).into_iter().any(lacks))
        }),
        _ => false,
    };
    let whole = !is_torn(parsed) && items().all(|kind| *kind != ItemKind::Error);
    whole && !(items().all(plain) && items().any(computes))
}

/// True for a text that is the function and nothing else, in which no statement can stand at file level alone. What ends the
/// function may begin others, the last of which its host ends.
fn are_statements(parsed: &Parsed, name: &str) -> bool {
    let shader = &parsed.shader;
    let is_function = |kind: &ItemKind| matches!(kind, ItemKind::Function(own) if own.body.is_some());
    let one = shader.unit().items.iter().all(|item| is_function(&item.kind));
    let global = [errors::QUALIFIER, errors::LAYOUT, errors::REDECLARATION];
    let is_global = parsed.diagnostics.iter().any(|found| global.contains(&found.code));
    // What other languages declare variables with is no type that a host has.
    let is_foreign = |(name, what): &(String, Lacks)| *what == Lacks::Type && FOREIGN.contains(&&name[..]);
    let foreign = shader.lacking().iter().any(is_foreign);
    one && shader.function(name).is_some() && !is_torn(parsed) && !is_global && !foreign && !walk::has_errors(shader)
}

/// Words of other languages that stand in front of a variable.
const FOREIGN: [&str; 5] = ["auto", "let", "var", "val", "final"];

/// The statements of the function, those inside of others left out.
fn top<'s>(shader: &'s Shader, name: &str) -> &'s [Stmt] {
    let function = shader.function(name).and_then(|own| shader.function_syntax(own));
    function.and_then(|own| own.body.as_ref()).map_or(&[], |body| &body.statements)
}

/// The type of what the function gives, and a line at its end. Statements that give nothing back and write nothing but
/// variables of their own give the last of these to what stands behind them.
fn gives(shader: &Shader, name: &str) -> (String, String) {
    let mut returned = Vec::new();
    let mut returns = false;
    let own = shader.unit().items.first().map(|item| item.span).unwrap_or_default();
    walk::statements(shader, |stmt| {
        if let StmtKind::Return(value) = stmt.kind
            && own.contains(stmt.span.start)
        {
            returns = true;
            returned.extend(value);
        }
    });
    if !returned.is_empty() {
        let known = returned.iter().map(|id| shader.type_of(*id)).find(|ty| !ty.is_error()).cloned();
        let guessed = || returned.iter().filter_map(|id| guess(shader, *id, DEPTH)).reduce(larger);
        return (known.or_else(guessed).unwrap_or(FLOAT).to_string(), String::new());
    }
    let alone = shader.unit().items.len() == 1;
    let last = top(shader, name).iter().rev().filter(|_| alone).find_map(|stmt| {
        let StmtKind::Declaration(own) = &stmt.kind else { return None };
        let TypeKind::Named(ty) = &own.ty.kind else { return None };
        let plain = own.ty.dims.is_empty() && Type::from_name(ty).is_some();
        let one = own.declarators.last().filter(|one| plain && one.dims.is_empty())?;
        Some((ty.clone(), format!("return {};\n", one.name.name)))
    });
    last.filter(|_| !returns && !writes_outside(shader)).unwrap_or_else(|| ("void".to_owned(), String::new()))
}

/// True where something is written that the statements do not declare.
fn writes_outside(shader: &Shader) -> bool {
    let is_outside = |mut id: ExprId| loop {
        match &shader.expr(id).kind {
            ExprKind::Paren(base) | ExprKind::Index { base, .. } | ExprKind::Field { base, .. } => id = *base,
            ExprKind::Name(_) => {
                let kind = shader.symbol_of(id).map(|symbol| &shader.symbol(symbol).kind);
                break matches!(kind, None | Some(SymbolKind::Builtin));
            }
            _ => break false,
        }
    };
    shader.arena().iter().any(|(_, expr)| match &expr.kind {
        ExprKind::Assign { target, .. } => is_outside(*target),
        ExprKind::Postfix { operand, .. } => is_outside(*operand),
        _ => false,
    })
}

const FLOAT: Type = Type::Scalar(ScalarType::Float);

/// The one of two types with more components.
fn larger(one: Type, other: Type) -> Type {
    if other.components() > one.components() { other } else { one }
}

/// The type that an expression may have in which names are not declared: that of its parts.
fn guess(shader: &Shader, id: ExprId, depth: usize) -> Option<Type> {
    let ty = shader.type_of(id);
    if !ty.is_error() {
        return Some(ty.clone());
    }
    let depth = depth.checked_sub(1)?;
    let of = |id: &ExprId| guess(shader, *id, depth);
    match &shader.expr(id).kind {
        ExprKind::Paren(inner) => of(inner),
        ExprKind::Unary { operand, .. } | ExprKind::Postfix { operand, .. } => of(operand),
        ExprKind::Assign { value, .. } => of(value),
        ExprKind::Comma { right, .. } => of(right),
        ExprKind::Ternary { yes, no, .. } => of(yes).into_iter().chain(of(no)).reduce(larger),
        ExprKind::Field { field, .. } => components(&field.name),
        ExprKind::Binary { left, right, .. } => {
            let column = |ty: Type| match ty {
                Type::Matrix(scalar, _, rows) => Type::Vector(scalar, rows),
                other => other,
            };
            match (of(left), of(right)) {
                (Some(left), Some(right)) => Some(larger(left, right)),
                // What a matrix is multiplied by is mostly a vector.
                (one, other) => one.or(other).map(column),
            }
        }
        ExprKind::Call { callee: Callee::Name(own), args } => match &own.name[..] {
            "dot" | "length" | "distance" | "determinant" => Some(FLOAT),
            "cross" => Some(Type::VEC3),
            name if name.starts_with("texture") || name.starts_with("texel") => Some(Type::VEC4),
            name if syntax::is_builtin_function(shader, name) => args.iter().filter_map(of).reduce(larger),
            _ => None,
        },
        // By the components that are asked for elsewhere, and the values that it gets.
        ExprKind::Name(name) => {
            let is = |id: &ExprId| matches!(&shader.expr(*id).kind, ExprKind::Name(own) if own == name);
            let said = shader.arena().iter().filter_map(|(_, expr)| match &expr.kind {
                ExprKind::Field { base, field } if is(base) => widest(&field.name),
                ExprKind::Assign { target, value, .. } if is(target) => of(value),
                _ => None,
            });
            said.reduce(larger)
        }
        _ => None,
    }
}

/// The type of a swizzle.
fn components(field: &str) -> Option<Type> {
    widest(field)?;
    Some(Type::vector(ScalarType::Float, u8::try_from(field.len()).ok()?))
}

/// The smallest vector that has such components.
fn widest(field: &str) -> Option<Type> {
    let of = |set: &str| field.chars().map(|c| set.find(c)).collect::<Option<Vec<usize>>>();
    let most = syntax::swizzle::SETS.iter().find_map(|set| of(set))?.into_iter().max()?;
    Some(Type::vector(ScalarType::Float, u8::try_from(most.max(1)).ok()? + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<String> {
        let file = SourceFile::new("a.js", text.to_owned());
        let literal = Literal::part(&file, base::text::Span::new(0, text.len()));
        Body::of(&literal, "glsl").map(|body| body.literal.text)
    }

    #[test]
    fn statements_become_a_function() {
        for (text, expected) in [
            ("position.x += sin(p.y); vec2 q = p;", "void glsl() {\nposition.x += sin(p.y); vec2 q = p;\n}\n"),
            (
                "vec2 s = p.xy; return vec4(s, 0.0, 1.0);",
                "vec4 glsl() {\nvec2 s = p.xy; return vec4(s, 0.0, 1.0);\n}\n",
            ),
            ("return a * vec2(0.5) + b;", "vec2 glsl() {\nreturn a * vec2(0.5) + b;\n}\n"),
            ("vec2 w = vec2(t); a.xy *= w; return a;", "vec2 glsl() {\nvec2 w = vec2(t); a.xy *= w; return a;\n}\n"),
            (
                "if (k > 0.5) return mix(a, vec3(1.0), k); return a;",
                "vec3 glsl() {\nif (k > 0.5) return mix(a, vec3(1.0), k); return a;\n}\n",
            ),
            ("gl_FragColor.w = pow(a, 2.0);", "void glsl() {\ngl_FragColor.w = pow(a, 2.0);\n}\n"),
            ("float t = p.y; p.xz *= t;", "void glsl() {\nfloat t = p.y; p.xz *= t;\n}\n"),
            (
                "vec4 v = c; return v; } float sum(vec4 w) { return w.x + w.y;",
                "vec4 glsl() {\nvec4 v = c; return v; } float sum(vec4 w) { return w.x + w.y;\n}\n",
            ),
            ("vec3 n = normalize(normal);", "vec3 glsl() {\nvec3 n = normalize(normal);\nreturn n;\n}\n"),
            (
                "#ifdef FOG\nc.rgb = mix(c.rgb, vec3(0.5), f);\n#endif",
                "#define FOG\nvoid glsl() {\n#ifdef FOG\nc.rgb = mix(c.rgb, vec3(0.5), f);\n#endif\n}\n",
            ),
        ] {
            assert_eq!(of(text).as_deref(), Some(expected), "{text}");
        }
    }

    #[test]
    fn other_texts_are_no_bodies() {
        for text in [
            "uniform vec3 a; varying vec2 b;",
            "vec3 a;",
            "const vec3 A = vec3(1.0);",
            "vec3 f(vec3 a) { return a; }",
            "void main() { gl_FragColor = vec4(1.0); }",
            "let v = vec3.create(); vec3.add(v, a, b);",
            "float x = 1.0; return x;",
            "for (int i = 0; i < 4; i++) { sum += a[i]; }",
            "a vec3 is a vector; it has three parts",
            "vec3 a = b; }",
            "vec3.set(a, 1, 2, 3);",
            "const v = vec3(1, 2, 3); return v;",
            "auto v = vec3(1, 2, 3); return v;",
            "a.xyz = 1; let p = a.x;",
            "#define UP vec3(0.0, 1.0, 0.0);",
        ] {
            assert_eq!(of(text), None, "{text}");
        }
    }

    #[test]
    fn every_place_leads_back() {
        let text = "vec2 s = p.xy; return vec4(s, 0.0, 1.0);";
        let file = SourceFile::new("a.js", text.to_owned());
        let literal = Literal::part(&file, base::text::Span::new(0, text.len()));
        let body = Body::of(&literal, "glsl").unwrap();
        let at = body.literal.text.find("p.xy").unwrap();
        assert_eq!(file.slice(body.literal.to_host(base::text::Span::new(at, at + 4))), "p.xy");
    }
}
