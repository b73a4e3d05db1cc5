//! Another program whose meaning is what is expected: a reference implementation, or the shader as it was.

use std::ops::Range;
use std::sync::Arc;

use super::ReferenceError;
use super::formula::list;
use crate::verdict::oracle::Oracle;
use base::value::{Batch, Field, Record, Scalar, Shape};
use program::{Entry, Program};

/// A program, with the way of inputs to it and of outputs from it.
#[derive(Clone)]
pub(super) struct Model {
    pub oracle: Oracle,
    records: [Arc<Record>; 2],
    /// For the words of an invocation and of a case: where they come from.
    routes: [Vec<Route>; 2],
    /// For each judged output, its words among the model's own.
    pub outputs: Vec<Range<usize>>,
    vertex: Arc<Record>,
    emits: bool,
}

#[derive(Clone)]
struct Route {
    to: Range<usize>,
    from_case: bool,
    from: Range<usize>,
}

impl Model {
    pub fn emits(&self) -> bool {
        self.emits
    }

    /// Type of one of its own output words.
    pub fn scalar_of(&self, word: usize) -> Scalar {
        self.vertex.scalar_of(word)
    }

    /// Invocations of a batch as a batch of the model, each with a case of its own.
    pub fn batch(&self, batch: &Batch, invocations: &[usize]) -> Batch {
        let [invocation, case] = &self.records;
        // What takes nothing has as many invocations as there are, in one case.
        let nothing = invocation.words() + case.words() == 0;
        let (per_case, cases) = if nothing { (invocations.len(), 1) } else { (1, invocations.len()) };
        let mut own = Batch::with_capacity(invocation.clone(), case.clone(), per_case, cases);
        own.invocations.resize(invocation.words() * invocations.len(), 0);
        own.cases.resize(case.words() * invocations.len(), 0);
        for (k, &from) in invocations.iter().enumerate() {
            let sides = [batch.invocation(from), batch.case_of(from)];
            for (record, routes, words) in
                [(invocation, &self.routes[0], &mut own.invocations), (case, &self.routes[1], &mut own.cases)]
            {
                let at = k * record.words();
                for route in routes {
                    let to = at + route.to.start..at + route.to.end;
                    words[to].copy_from_slice(&sides[usize::from(route.from_case)][route.from.clone()]);
                }
            }
        }
        own
    }
}

/// Binds a model to a program; with the indices of the outputs that it gives.
pub(super) fn bind(
    model: &Program,
    by: &str,
    output: Option<&str>,
    program: &Program,
) -> Result<(Model, Vec<usize>), ReferenceError> {
    let by = || by.to_owned();
    let (given, own) = (program.output_layout(), model.output_layout());
    if given.max_vertices.is_some() != own.max_vertices.is_some() {
        let gives = if own.max_vertices.is_some() { "emits vertices" } else { "gives one set of outputs" };
        let stage = if own.max_vertices.is_some() { "vertex stage or function" } else { "geometry stage" };
        return Err(ReferenceError::Stage { by: by(), gives, stage });
    }
    let sources = [program.invocation_record(), program.case_record()];
    let records = [Arc::new(model.invocation_record()), Arc::new(model.case_record())];
    let functions = both_functions(model, program);
    // What a pointer points to is given, and what an `out` parameter has before the call is not.
    let gives = |layout: &Record, field: &Field| layout.fields().contains(field);
    let unset = |field: &Field| {
        functions && !gives(&sources[0], field) && gives(&own.vertex, field) && gives(&given.vertex, field)
    };
    let named = |field: &Field| {
        sources.iter().enumerate().find_map(|(case, source)| {
            let index = source.index_of(&field.name).filter(|&i| source.fields()[i].shape == field.shape)?;
            Some((case == 1, source.range(index)))
        })
    };
    // Parameters of two functions may have other names, as the pairs of a call have; then all are matched by place.
    let called: Vec<&Field> = records[0].fields().iter().filter(|field| !unset(field)).collect();
    let shapes = |fields: &[&Field]| fields.iter().map(|f| f.shape).collect::<Vec<Shape>>();
    let by_place = functions
        && shapes(&called) == shapes(&sources[0].fields().iter().collect::<Vec<_>>())
        && !called.iter().all(|field| named(field).is_some());
    let mut routes = [Vec::new(), Vec::new()];
    for (side, (record, routes)) in records.iter().zip(&mut routes).enumerate() {
        let mut places = 0..sources[0].fields().len();
        for (k, field) in record.fields().iter().enumerate() {
            if side == 0 && unset(field) {
                continue;
            }
            let from = match by_place && side == 0 {
                true => places.next().map(|place| (false, sources[0].range(place))),
                false => named(field),
            };
            let Some((from_case, from)) = from else {
                return Err(ReferenceError::MissingInput {
                    by: by(),
                    name: field.name.clone(),
                    ty: model.written.type_name(field.shape),
                    has: list(program, sources.iter().flat_map(Record::fields)),
                });
            };
            routes.push(Route { to: record.range(k), from_case, from });
        }
    }
    let (mut judged, mut outputs) = (Vec::new(), Vec::new());
    let all = given.vertex.fields();
    // What functions give may have other names: a parameter in one text, a value in the other.
    let placed = functions && output.is_none() && same_shapes(&own.vertex, &given.vertex);
    let taken = |name: &str| own.vertex.index_of(name).is_some();
    let placed = placed && all.iter().zip(own.vertex.fields()).all(|(a, b)| a.name == b.name || !taken(&a.name));
    for (k, field) in own.vertex.fields().iter().enumerate() {
        let name = match output {
            Some(name) if field.name == RETURN => name,
            Some(_) | None => &field.name,
        };
        // The position of a vertex is the same output by whatever name.
        let position = || {
            let own = model.position().is_some_and(|own| own.name == *name);
            if own { Some(program.position()?.name.clone()) } else { None }
        };
        let named = program.output_called(name).or_else(|| program.output_called(&position()?));
        // The value of a function stands for the only output that there is.
        let only = (field.name == RETURN && output.is_none() && all.len() == 1).then_some(0);
        // A member of the value that one returns is a parameter that the other sets.
        let member = || match name.strip_prefix("return.") {
            Some(member) => program.output_called(member),
            None => program.output_called(&format!("return.{name}")),
        };
        let member = || if functions { member() } else { None };
        let Some(index) = named.or_else(|| placed.then_some(k)).or(only).or_else(member) else { continue };
        if all[index].shape != field.shape {
            return Err(ReferenceError::MissingOutput {
                by: by(),
                name: name.to_owned(),
                ty: model.written.type_name(field.shape),
                has: list(program, all),
            });
        }
        judged.push(index);
        outputs.push(own.vertex.range(k));
    }
    if judged.is_empty() {
        let (gives, has) = (list(model, own.vertex.fields()), list(program, all));
        let help = "; `output` in [reference] says which output the value of a function stands for";
        let help = if own.vertex.index_of(RETURN).is_some() { help } else { "" };
        return Err(ReferenceError::NothingInCommon { by: by(), gives, has, help });
    }
    let interpreter = |why: String| ReferenceError::Interpreter { by: by(), why };
    let oracle = Oracle::new(model).map_err(|error| interpreter(error.locate(model)))?;
    let (vertex, emits) = (own.vertex, own.max_vertices.is_some());
    Ok((Model { oracle, records, routes, outputs, vertex, emits }, judged))
}

impl Model {
    /// The same with another number of rounds that loops may take.
    pub fn with_fuel(&self, fuel: u32) -> Self {
        Self { oracle: self.oracle.clone().with_fuel(fuel), ..self.clone() }
    }
}

/// Name of the value of a function among outputs.
const RETURN: &str = "return";

fn both_functions(model: &Program, program: &Program) -> bool {
    let function = |program: &Program| matches!(program.entry, Entry::Function(_));
    function(model) && function(program)
}

fn same_shapes(a: &Record, b: &Record) -> bool {
    let shapes = |record: &Record| -> Vec<Shape> { record.fields().iter().map(|f: &Field| f.shape).collect() };
    shapes(a) == shapes(b)
}
