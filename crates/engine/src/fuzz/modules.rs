//! The entry points and functions of a text that is read as a module, each made ready to run or told why it cannot be.

use super::realistic::Realistic;
use super::subject::{Made, Ready, Subject, made, numbers, reason};
use crate::guess::{self, Role, Uses};
use base::value::Field;
use program::{Chosen, ModuleText, Port, PortAt, Program, Runnable};
use syntax::Stage;

/// What can be run of a module, in the order of the text; what `wanted` wants is made ready, with these values of
/// `override` constants.
pub fn subjects_of_module(
    text: &ModuleText,
    values: &[(String, String)],
    wanted: &dyn Fn(&str) -> bool,
) -> Vec<Subject> {
    let mut all: Vec<Runnable> = text.points().into_iter().chain(text.functions()).collect();
    all.sort_by_key(|one| one.span.start);
    all.retain(|one| wanted(&one.name));
    all.into_iter().map(|one| subject(text, values, one)).collect()
}

fn subject(text: &ModuleText, values: &[(String, String)], one: Runnable) -> Subject {
    let at = text.file().locate(one.span.start);
    let ready = ready(text, values, &one).map(|(program, kernel, executable)| {
        let realistic = {
            let guess = |field: &Field| {
                let role = role(&program, field);
                (guess::with_uses(field, role, &Uses::default()), role == Role::Varying)
            };
            Realistic::new([&kernel.invocation, &kernel.case], &guess)
        };
        Box::new(Ready { program, kernel, executable, realistic })
    });
    let stated = ready.iter().flat_map(|ready| numbers(ready, &ready.program.ranges, &[])).collect();
    Subject { label: one.name, at, ready, stated }
}

fn ready(text: &ModuleText, values: &[(String, String)], one: &Runnable) -> Result<Made, String> {
    let chosen = match one.stage {
        Stage::Library => Chosen::Function(&one.name),
        stage => Chosen::Point { stage: Some(stage), name: Some(&one.name) },
    };
    let program = text.program(chosen, values).map_err(|error| reason(&error))?;
    let program = program.with_memory_inside().map_err(|error| reason(&error))?;
    made(program)
}

/// Where the values of an input come from.
fn role(program: &Program, field: &Field) -> Role {
    let named = |port: &&Port| port.field.name == field.name;
    if program.uniforms.iter().any(|port| named(&port)) {
        return Role::Uniform;
    }
    if program.role != program::lower::Role::Fragment {
        return Role::Parameter;
    }
    let place = program.inputs.iter().find(named).and_then(|port| match port.at {
        PortAt::Argument(k) => program.binding_of(k),
        _ => None,
    });
    match place {
        Some(true) => Role::Screen,
        Some(false) => Role::Varying,
        None => Role::Parameter,
    }
}
