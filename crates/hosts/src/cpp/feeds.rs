//! Where the location that a look-up gives is used.

use tree_sitter::Node;

use super::index::{Index, within};
use super::tree::{ancestors, arguments, bare, callee, span, wrapped, write};
use crate::HostFile;
use base::text::Span;

/// Uses of a location, as far as they can be followed in the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Feeds {
    /// Given to `glVertexAttrib…`, `glEnableVertexAttribArray` and the like.
    pub attribute: bool,
    /// Given to `glUniform…` or `glProgramUniform…`.
    pub uniform: bool,
}

impl Feeds {
    /// True when all uses that were found are those of an attribute.
    pub fn only_attribute(self) -> bool {
        self.attribute && !self.uniform
    }

    /// True when all uses that were found are those of a uniform.
    pub fn only_uniform(self) -> bool {
        self.uniform && !self.attribute
    }

    fn add(&mut self, other: Self) {
        self.attribute |= other.attribute;
        self.uniform |= other.uniform;
    }
}

/// A call that gets a location.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct User {
    /// The function.
    pub function: String,
    /// Place of its name.
    pub function_span: Span,
    /// Its arguments.
    pub arguments: Vec<Span>,
    /// Index of the argument that is the location.
    pub position: usize,
}

/// Follows the result of `call`: directly into a call, or through the one variable it is kept in.
pub fn feeds<'t>(index: &Index<'t>, call: Node<'t>) -> Feeds {
    let mut feeds = Feeds::default();
    for (user, argument) in followed(index, call) {
        feeds.add(role(index.host, user, argument));
    }
    feeds
}

/// The calls that get the result of `call`, as far as it can be followed.
pub fn users<'t>(index: &Index<'t>, call: Node<'t>) -> Vec<User> {
    let described = followed(index, call).into_iter().filter_map(|(user, argument)| {
        let (function, name) = callee(user, &index.host.file)?;
        let all = arguments(user);
        Some(User {
            function: function.to_owned(),
            function_span: span(name),
            position: all.iter().position(|a| a.id() == argument.id())?,
            arguments: all.into_iter().map(span).collect(),
        })
    });
    described.collect()
}

/// Calls, each with the argument that is the result of `call`.
fn followed<'t>(index: &Index<'t>, call: Node<'t>) -> Vec<(Node<'t>, Node<'t>)> {
    let host = index.host;
    let value = wrapped(call);
    let Some(parent) = value.parent() else { return Vec::new() };
    if parent.kind() == "argument_list" {
        return parent.parent().map(|user| (user, value)).into_iter().collect();
    }
    let Some(kept) = write(parent) else { return Vec::new() };
    let variable = host.text(kept.target);
    let Some(scope) = scope(index, kept.target, variable, kept.declares) else { return Vec::new() };
    // With a second value in the same variable it is not known which one a use means.
    if index.values(scope, variable).count() != 1 {
        return Vec::new();
    }
    let mut found = Vec::new();
    for &user in index.calls.iter().filter(|c| within(scope, **c)) {
        found.extend(arguments(user).into_iter().filter(|a| host.text(bare(*a)) == variable).map(|a| (user, a)));
    }
    found
}

/// What the call `user` does with `argument` as a location.
fn role(host: &HostFile, user: Node<'_>, argument: Node<'_>) -> Feeds {
    let Some((function, _)) = callee(user, &host.file) else { return Feeds::default() };
    let index = arguments(user).iter().position(|a| a.id() == argument.id());
    let attribute = match function {
        "glEnableVertexAttribArray" | "glDisableVertexAttribArray" => index == Some(0),
        "glEnableVertexArrayAttrib" | "glDisableVertexArrayAttrib" => index == Some(1),
        _ => function.starts_with("glVertexAttrib") && index == Some(0),
    };
    let uniform = match function {
        "glUniformBlockBinding" | "glUniformSubroutinesuiv" => false,
        _ => {
            (function.starts_with("glUniform") && index == Some(0))
                || (function.starts_with("glProgramUniform") && index == Some(1))
        }
    };
    Feeds { attribute, uniform }
}

/// The part of the file in which `variable` means what it means at `target`; none when the name is
/// declared more than once there.
fn scope<'t>(index: &Index<'t>, target: Node<'t>, variable: &str, declares: bool) -> Option<Node<'t>> {
    if target.kind() != "identifier" {
        // A member: its object is not followed, but its spelling is the same all over the file.
        return Some(index.root);
    }
    let mut blocks = ancestors(target).filter(|n| matches!(n.kind(), "compound_statement" | "for_statement"));
    let block = if declares { blocks.next() } else { blocks.find(|b| index.declarations(*b, variable) > 0) };
    let scope = block.unwrap_or(index.root);
    (index.declarations(scope, variable) <= 1).then_some(scope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::text::SourceFile;

    fn of(body: &str) -> Feeds {
        let text = format!("void f() {{ {body} }}");
        let host = HostFile::new(&SourceFile::new("a.cpp", text), true);
        host.lookups()[0].feeds
    }

    const ATTRIBUTE: Feeds = Feeds { attribute: true, uniform: false };
    const UNIFORM: Feeds = Feeds { attribute: false, uniform: true };

    #[test]
    fn a_location_is_followed_through_its_variable() {
        let look = "glGetUniformLocation(p, \"a\")";
        assert_eq!(of(&format!("GLint l = {look}; glVertexAttribPointer(l, 3, GL_FLOAT, GL_FALSE, 0, 0);")), ATTRIBUTE);
        assert_eq!(of(&format!("GLuint l = (GLuint){look}; glEnableVertexAttribArray((GLuint)l);")), ATTRIBUTE);
        assert_eq!(of(&format!("GLint l = -1; l = {look}; glUniform1f(l, 1.0f);")), UNIFORM);
        assert_eq!(of(&format!("const auto l{{ {look} }}; glUniform1f(l, 1.0f);")), UNIFORM);
        assert_eq!(of(&format!("this->l = {look}; glProgramUniform1f(p, this->l, 1.0f);")), UNIFORM);
        assert_eq!(of(&format!("glUniform1f({look}, 1.0f);")), UNIFORM);
        assert_eq!(of(&format!("glEnableVertexAttribArray(static_cast<GLuint>({look}));")), ATTRIBUTE);
    }

    #[test]
    fn what_cannot_be_followed_is_not_guessed() {
        let look = "glGetUniformLocation(p, \"a\")";
        assert_eq!(of(&format!("GLint l = {look}; l = other(); glUniform1f(l, 1.0f);")), Feeds::default());
        assert_eq!(of(&format!("GLint l = {look}; {{ GLint l = 0; glUniform1f(l, 1.0f); }}")), Feeds::default());
        assert_eq!(of(&format!("GLint l = {look}; glUniform1f(0, l);")), Feeds::default());
        assert_eq!(of(&format!("{{ GLint l = {look}; }} glUniform1f(l, 1.0f);")), Feeds::default());
        assert_eq!(of(&format!("{look};")), Feeds::default());
    }

    #[test]
    fn both_uses_are_seen() {
        let feeds = of("GLint l = glGetUniformLocation(p, \"a\"); glUniform1f(l, 1.0f); glEnableVertexAttribArray(l);");
        assert_eq!(feeds, Feeds { attribute: true, uniform: true });
        assert!(!feeds.only_attribute() && !feeds.only_uniform());
    }
}
