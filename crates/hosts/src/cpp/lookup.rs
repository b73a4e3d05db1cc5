//! Look-ups of uniforms and attributes by a name in a string literal.

use tree_sitter::Node;

use base::diagnostic::{Message, message};
use base::text::Span;

use super::feeds::{Feeds, User, feeds, users};
use super::index::{Index, within};
use super::presets::PRESETS;
use super::program::{ProgramSource, own_source, source, whole};
use super::tree::{arguments, bare, callee, enclosing_function, plain_string, span};
use crate::HostFile;
use crate::Setter;
use crate::Wrapped;

/// What is looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LookupKind {
    /// `glGetUniformLocation(program, "name")`
    Uniform,
    /// `glGetAttribLocation(program, "name")`
    Attribute,
    /// `glBindAttribLocation(program, index, "name")`
    BindAttribute,
    /// `program["name"]`: a uniform or an attribute.
    Name,
}

/// What comes of a name that the program does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// A location of -1.
    Negative,
    /// A location that is null.
    Null,
    /// What it would set is left aside.
    Ignored,
    /// An error when the program runs.
    Refused,
}

impl Missing {
    /// What stands beside the name.
    pub fn label(self) -> Message {
        match self {
            Self::Negative => message!("gives -1", "-1 になります"),
            Self::Null => message!("gives null", "null になります"),
            Self::Ignored => message!("sets nothing", "何も設定しません"),
            Self::Refused => message!("raises an error", "エラーになります"),
        }
    }

    /// Why that is a mistake; none where a location of -1 is given.
    pub fn why(self) -> Option<Message> {
        match self {
            Self::Negative => None,
            Self::Null => Some(message!(
                "getUniformLocation gives null without an error, and uniform functions ignore null",
                "getUniformLocation はエラーなしに null を返し、uniform 系の関数は null を無視します"
            )),
            Self::Ignored => Some(message!(
                "a value under a name that no stage declares reaches no shader, and no error is raised",
                "どのステージも宣言しない名前の値はシェーダに届かず、エラーにもなりません"
            )),
            Self::Refused => Some(message!(
                "a program that is asked for a name that it does not have raises an error",
                "プログラムにない名前を使うとエラーになります"
            )),
        }
    }
}

impl LookupKind {
    /// The function of OpenGL.
    pub fn function(self) -> &'static str {
        match self {
            Self::Uniform => "glGetUniformLocation",
            Self::Attribute => "glGetAttribLocation",
            Self::BindAttribute => "glBindAttribLocation",
            Self::Name => "",
        }
    }

    /// What a function of OpenGL asks for.
    pub fn of(function: &str) -> Option<Self> {
        [Self::Uniform, Self::Attribute, Self::BindAttribute].into_iter().find(|k| k.function() == function)
    }

    /// Number of arguments; the name is the last one.
    pub fn arity(self) -> usize {
        match self {
            Self::Uniform | Self::Attribute => 2,
            Self::BindAttribute => 3,
            Self::Name => 0,
        }
    }
}

/// A look-up with a literal name.
pub struct Lookup {
    /// What is looked up.
    pub kind: LookupKind,
    /// Place of the function's name.
    pub function: Span,
    /// The name as written.
    pub name: String,
    /// Place of the name, without the quotation marks.
    pub name_span: Span,
    /// Where the shaders of its program are named.
    pub source: ProgramSource,
    /// What the location is used for.
    pub feeds: Feeds,
    /// The calls that get the location.
    pub users: Vec<User>,
    /// True for a function that wraps the one of OpenGL.
    pub wrapped: bool,
    /// What the wrapper sets the uniform with, when it does and that is clear.
    pub sets: Option<Setter>,
    /// True when only the beginning of the name is known: `"bones[" + i + "]"`.
    pub partial: bool,
    /// The expression for the program or the object that stands for it; empty for that of the class.
    pub object: String,
    /// True for a name in quotation marks, false for the key of an object.
    pub quoted: bool,
    /// What comes of a name that the program does not have.
    pub missing: Missing,
    /// Components that an array gives to the attribute, where the look-up says so.
    pub given: Option<usize>,
}

impl Lookup {
    /// A look-up whose location is not followed.
    pub fn new(kind: LookupKind, function: Span, name: (String, Span, bool), source: ProgramSource) -> Self {
        let (name, name_span, partial) = name;
        Self {
            kind,
            function,
            name,
            name_span,
            source,
            feeds: Feeds::default(),
            users: Vec::new(),
            wrapped: false,
            sets: None,
            partial,
            object: String::new(),
            quoted: true,
            missing: Missing::Negative,
            given: None,
        }
    }

    /// Place of the name with its quotation marks.
    pub fn literal_span(&self) -> Span {
        if !self.quoted {
            return self.name_span;
        }
        Span::new(self.name_span.start - 1, self.name_span.end + 1)
    }

    /// The variable that the name speaks of: `light` of `light[2].position`.
    pub fn base_name(&self) -> &str {
        self.name.split(['.', '[']).next().unwrap_or(&self.name)
    }

    /// True for names that GL reserves; they never have a location.
    pub fn is_reserved(&self) -> bool {
        self.name.starts_with("gl_")
    }
}

/// All look-ups of a file, in the order of the text.
pub fn find(host: &HostFile) -> Vec<Lookup> {
    let Some(index) = Index::new(host) else { return Vec::new() };
    index.calls.iter().filter_map(|&call| lookup(&index, call).or_else(|| wrapped(&index, call))).collect()
}

/// A look-up, or a setter by name, through a function that wraps that of OpenGL: a preset, or one that
/// the configuration names. The program is that of the object, or of the first argument of a plain
/// function, and is known by what is done with it in this file.
fn wrapped<'t>(index: &Index<'t>, call: Node<'t>) -> Option<Lookup> {
    let host = index.host;
    let function = call.child_by_field_name("function")?;
    let object = function.child_by_field_name("argument").filter(|_| function.kind() == "field_expression");
    let name_node = function.child_by_field_name("field").or_else(|| function.child_by_field_name("name"));
    let name_node = name_node.unwrap_or(function);
    let called = host.text(name_node);
    let all = arguments(call);
    let configured = host.wrappers().iter().find(|w| w.function == called);
    let (kind, at, sets) = match configured {
        Some(w) => (w.kind, w.argument, w.sets.as_deref().and_then(Setter::of_type)),
        None => {
            let preset = PRESETS.iter().find(|p| p.method == called && object.is_some())?;
            (preset.kind, 0, preset.like.and_then(Setter::of_function))
        }
    };
    let kind = match kind {
        Wrapped::UniformLocation | Wrapped::SetUniform => LookupKind::Uniform,
        Wrapped::AttributeLocation => LookupKind::Attribute,
        Wrapped::LoadProgram => return None,
    };
    let name = name(index, *all.get(at)?)?;
    let program = object.or_else(|| all.first().copied().filter(|_| at > 0));
    // Any object may be passed in: only what is done with this one counts. Without one it is that of the class.
    let known = match program {
        Some(program) => own_source(index, call, program),
        None => Some(whole(index)).filter(|s| configured.is_some() && matches!(s, ProgramSource::Named(_))),
    };
    let source = known.filter(|_| !call.has_error()).unwrap_or(ProgramSource::Unknown);
    let object = program.map_or("", |p| host.text(p)).to_owned();
    Some(Lookup { wrapped: true, sets, object, ..Lookup::new(kind, span(name_node), name, source) })
}

/// A name in a literal, or the beginning of one that goes on with an index or a member.
fn name(index: &Index<'_>, argument: Node<'_>) -> Option<(String, Span, bool)> {
    let file = &index.host.file;
    if let Some((name, place)) = plain_string(argument, file) {
        return Some((name.to_owned(), place, false));
    }
    let node = unwrapped(argument);
    let (name, place) = match node.kind() {
        "identifier" => beginning(index, node)?,
        _ => begins(index, node)?,
    };
    name.contains(['[', '.']).then_some((name, place, true))
}

/// The object of methods that only convert: `(…).c_str()`, `QString("…").arg(i)`.
pub fn unwrapped(argument: Node<'_>) -> Node<'_> {
    let mut node = bare(argument);
    while let Some(inner) = node.child_by_field_name("function").and_then(|f| f.child_by_field_name("argument")) {
        node = bare(inner);
    }
    node
}

/// How the text begins that a variable holds: by its one value in the function, or by the one call that
/// prints into it.
fn beginning(index: &Index<'_>, variable: Node<'_>) -> Option<(String, Span)> {
    let host = index.host;
    let function = enclosing_function(variable)?;
    let name = host.text(variable);
    let mut values = index.values(function, name);
    if let Some(only) = values.next() {
        let is_last = values.next().is_none() && only.target.end_byte() < variable.start_byte();
        return if is_last { begins(index, unwrapped(only.value)) } else { None };
    }
    let mut prints = index.calls.iter().filter(|c| {
        let prints = callee(**c, &host.file).is_some_and(|(f, _)| ["sprintf", "snprintf", "sprintf_s"].contains(&f));
        prints && within(function, **c) && arguments(**c).first().is_some_and(|a| host.text(bare(*a)) == name)
    });
    let call = *prints.next().filter(|_| prints.next().is_none())?;
    formatted(index, call)
}

/// How the text of an expression begins: a sum that starts with a literal, or a call that fills one in.
fn begins(index: &Index<'_>, expression: Node<'_>) -> Option<(String, Span)> {
    let mut node = expression;
    if node.kind() == "call_expression" {
        return formatted(index, node);
    }
    if node.kind() != "binary_expression" {
        return None;
    }
    while node.kind() == "binary_expression" {
        node = bare(node.child_by_field_name("left")?);
    }
    // `std::string("bones[")`
    if let (Some(_), &[only]) = (node.child_by_field_name("function"), arguments(node).as_slice()) {
        node = bare(only);
    }
    plain_string(node, &index.host.file).map(|(name, place)| (name.to_owned(), place))
}

/// The text before the first place to fill in, of `format("bones[{}]", i)` and the like.
fn formatted(index: &Index<'_>, call: Node<'_>) -> Option<(String, Span)> {
    let all = arguments(call);
    let (text, place) = all.iter().find_map(|a| plain_string(*a, &index.host.file))?;
    let end = text.find(['%', '{'])?;
    Some((text[..end].to_owned(), Span::new(place.start, place.start + end)))
}

fn lookup<'t>(index: &Index<'t>, call: Node<'t>) -> Option<Lookup> {
    let file = &index.host.file;
    let (function, function_node) = callee(call, file)?;
    let kind = LookupKind::of(function)?;
    let arguments = arguments(call);
    if call.has_error() || arguments.len() != kind.arity() {
        return None;
    }
    let name = name(index, *arguments.last()?)?;
    let source = source(index, call, arguments[0]);
    let (feeds, users) = (feeds(index, call), users(index, call));
    let object = index.host.text(bare(arguments[0])).to_owned();
    Some(Lookup { feeds, users, object, ..Lookup::new(kind, span(function_node), name, source) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;

    #[test]
    fn literal_names_are_found_and_others_are_not() {
        let host = HostFile::new(
            &SourceFile::new(
                "a.cpp",
                r#"void f(const char *n) {
                    GLint a = glGetUniformLocation(p, "light[0].position");
                    GLint b = glGetAttribLocation(this->p, /* 頂点 */ "v");
                    glBindAttribLocation(p, 0, "w");
                    GLint c = glGetUniformLocation(p, n);
                    // glGetUniformLocation(p, "comment");
                    const char *s = "glGetUniformLocation(p, 'x')";
                }"#,
            ),
            true,
        );
        let found: Vec<_> =
            host.lookups().iter().map(|l| (l.kind, l.name.as_str(), l.base_name().to_owned())).collect();
        assert_eq!(
            found,
            [
                (LookupKind::Uniform, "light[0].position", "light".to_owned()),
                (LookupKind::Attribute, "v", "v".to_owned()),
                (LookupKind::BindAttribute, "w", "w".to_owned()),
            ]
        );
    }
}
