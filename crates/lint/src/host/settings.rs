//! Calls that set a uniform whose type is known.

use base::text::Span;
use reading::program::Program;
use reading::{Project, ShaderFile};
use syntax::interface::Variable;
use syntax::types::Type;

use hosts::HostFile;
use hosts::cpp::feeds::User;
use hosts::cpp::lookup::{Lookup, LookupKind};
use hosts::setter::{Setter, member};
use reading::program::resolve;

/// One such call.
pub struct Setting<'a> {
    /// The look-up of the uniform; the call itself for a setter by name.
    pub lookup: &'a Lookup,
    /// The call that gets the location; none for a setter by name.
    pub user: Option<&'a User>,
    /// The function.
    pub function: String,
    /// Place of its name.
    pub place: Span,
    /// The types that the function sets.
    pub setter: Setter,
    /// The uniform.
    pub variable: &'a Variable,
    /// The shader that declares it.
    pub shader: &'a ShaderFile,
    /// The type that the name means: a member or element of the uniform.
    pub ty: &'a Type,
}

impl Setting<'_> {
    /// The type without arrays around it.
    pub fn element(&self) -> &Type {
        let mut ty = self.ty;
        while let Type::Array(element, _) = ty {
            ty = element;
        }
        ty
    }

    /// Place of the value that a function for one value gets.
    pub fn value(&self) -> Option<Span> {
        let user = self.user.filter(|_| !self.setter.vector)?;
        user.arguments.get(user.position + 1).copied()
    }
}

/// The calls of a file that set a uniform, where its program and type are known.
pub fn settings<'a>(host: &'a HostFile, project: &'a Project) -> Vec<Setting<'a>> {
    let mut found = Vec::new();
    for lookup in host.lookups().iter().filter(|l| l.kind == LookupKind::Uniform && !l.partial) {
        let program = resolve(host, project, &lookup.source);
        let Some((shader, variable)) = program.as_ref().and_then(|p| uniform(p, lookup.base_name())) else { continue };
        let Some(ty) = member(&variable.ty, &lookup.name) else { continue };
        if let Some(setter) = lookup.sets {
            let (function, place) = (host.file.slice(lookup.function).to_owned(), lookup.function);
            found.push(Setting { lookup, user: None, function, place, setter, variable, shader, ty });
        }
        for user in &lookup.users {
            let at = usize::from(user.function.starts_with("glProgramUniform"));
            let Some(setter) = Setter::of_function(&user.function).filter(|_| user.position == at) else { continue };
            let (function, place) = (host.file.slice(user.function_span).to_owned(), user.function_span);
            found.push(Setting { lookup, user: Some(user), function, place, setter, variable, shader, ty });
        }
    }
    found
}

fn uniform<'p>(program: &Program<'p>, name: &str) -> Option<(&'p ShaderFile, &'p Variable)> {
    program.uniform(name).filter(|(s, _)| s.is_plain())
}
