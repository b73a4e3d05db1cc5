//! What happens to variables along the paths through a shader: what is read before it is written, what
//! an output holds at the end, what nothing uses.
//!
//! Calls are followed: the body of a called function is part of the paths, once for each call. Paths are
//! those of the text: of conditions only constants are known.

mod assign;
mod build;
mod emit;
mod evaluate;
mod graph;
mod live;
mod open;
mod place;

use std::collections::{BTreeMap, BTreeSet};

use base::text::{SourceFile, Span};
use syntax::interface::{OutputPrimitive, Storage};
use syntax::symbols::{Direction, FunctionId, SymbolId, SymbolKind};
use syntax::{Shader, Stage, TokenKind, TokenPlace};

pub use assign::{Certainty, Unassigned};
pub use emit::Stale;
pub use live::Dead;
pub use place::letters;

/// An output of a stage.
#[derive(Clone, Copy, Debug)]
pub struct Output {
    /// The variable.
    pub symbol: SymbolId,
    /// All of its components.
    pub full: u64,
    /// The components that are written somewhere in functions that `main` reaches.
    pub written: u64,
    /// The components that are written on each path to the end of `main`; all when no path gets there.
    pub surely: u64,
    /// A place where it is written.
    pub write: Option<Span>,
}

/// What is known about a shader. Nothing where the text has errors, or depends on what `#if` leaves out.
#[derive(Debug, Default)]
pub struct Flow {
    /// Functions that `main` reaches, itself included; none when that is not known.
    pub reached: Option<BTreeSet<FunctionId>>,
    /// Reads of variables without a value.
    pub unassigned: Vec<Unassigned>,
    /// Outputs of a stage that ends each invocation by itself: not of a geometry stage.
    pub outputs: Vec<Output>,
    /// Functions with a path to the end of the body that should have returned a value.
    pub falls_off: Vec<FunctionId>,
    /// Parameters that are `out` and are never written.
    pub unwritten: Vec<(FunctionId, usize)>,
    /// Assignments whose value nothing uses.
    pub dead: Vec<Dead>,
    /// Outputs of a geometry stage that are emitted again without being set.
    pub stale: Vec<Stale>,
    /// The first `EmitVertex` before `gl_Position` is set, and whether it is set at all.
    pub unplaced: Option<(Span, bool)>,
    /// True when a geometry stage can reach `EmitVertex`; none when that is not known.
    pub emits: Option<bool>,
    /// Ends of strips with too few vertices for a primitive: the call of `EndPrimitive`, or none at the end
    /// of `main`, with the largest number of vertices there.
    pub short: Vec<(Option<Span>, u32)>,
    /// True when `EndPrimitive` can be reached.
    pub ends: bool,
}

/// True when the text is the same whatever the host defines: nothing that an `#if` leaves out counts but
/// precision statements.
fn is_whole(shader: &Shader, file: &SourceFile) -> bool {
    let included = file.text().lines().filter_map(|l| l.trim_start().strip_prefix('#'));
    let mut included = included.filter(|d| d.trim_start().starts_with("include"));
    let mut left_out = shader.tokens().iter().filter(|t| t.place == TokenPlace::Inactive);
    let plain = |kind: TokenKind, text: &str| {
        kind != TokenKind::Word
            || matches!(text, "precision" | "lowp" | "mediump" | "highp" | "float" | "int")
            || matches!(text, "define" | "extension" | "enable" | "require" | "version" | "error" | "core" | "es")
            || text.starts_with("GL_")
    };
    included.next().is_none() && left_out.all(|t| plain(t.kind, file.slice(t.span)))
}

impl Flow {
    /// Follows a shader that has been read without errors.
    pub fn new(shader: &Shader, file: &SourceFile) -> Self {
        if !is_whole(shader, file) {
            return Self::default();
        }
        let mut flow = Self::default();
        let mut unassigned: BTreeMap<SymbolId, Unassigned> = BTreeMap::new();
        let mut dead: BTreeMap<SymbolId, Vec<Dead>> = BTreeMap::new();
        let bodies: Vec<FunctionId> =
            shader.functions().filter(|(_, f)| f.definition.is_some()).map(|(id, _)| id).collect();
        let main = bodies.iter().copied().find(|id| shader.function_info(*id).name.name == "main");
        let graph = main.and_then(|m| build::graph(shader, m));
        if let Some(graph) = &graph {
            flow.reached = Some(graph.functions.iter().copied().collect());
            let open = graph.open(shader);
            flow.follow_main(shader, &open);
            assign::unassigned(shader, &open).into_iter().for_each(|u| {
                unassigned.insert(u.symbol, u);
            });
            live::dead(shader, graph).into_iter().for_each(|d| dead.entry(d.symbol).or_default().push(d));
        }
        // Without `main` the file is a library; with one that cannot be followed, little is known.
        let known = graph.is_some() || main.is_none();
        for id in bodies.into_iter().filter(|_| known) {
            let Some(graph) = build::graph(shader, id) else { continue };
            let open = graph.open(shader);
            flow.follow_function(shader, id, &open);
            if flow.reached.as_ref().is_some_and(|r| r.contains(&id)) {
                continue;
            }
            let own = |symbol: SymbolId| is_inside(shader, symbol, id);
            let new = assign::unassigned(shader, &open).into_iter().filter(|u| own(u.symbol));
            new.for_each(|u| {
                unassigned.entry(u.symbol).or_insert(u);
            });
            let new = live::dead(shader, &graph).into_iter().filter(|d| own(d.symbol));
            new.for_each(|d| dead.entry(d.symbol).or_default().push(d));
        }
        flow.unassigned = unassigned.into_values().collect();
        flow.dead = dead.into_values().flatten().collect();
        flow
    }

    fn follow_main(&mut self, shader: &Shader, graph: &graph::Graph) {
        let is_output = |symbol: SymbolId| is_output(shader, symbol);
        if shader.stage() == Stage::Geometry {
            self.emits = Some(graph.events().any(|e| e.kind == graph::Kind::Emit));
            self.ends = graph.events().any(|e| e.kind == graph::Kind::EndPrimitive);
            self.stale = emit::stale(graph, is_output);
            self.short = emit::short(graph, vertices_needed(shader).unwrap_or(0));
            self.unplaced = emit::unset(graph, shader.builtin("gl_Position"));
        }
        let likely = assign::solve(graph, false);
        for (index, variable) in graph.variables.iter().enumerate().filter(|(_, s)| is_output(s.symbol)) {
            let writes = |e: &&graph::Event| e.variable == index && matches!(e.kind, graph::Kind::Write { .. });
            let written = graph.events().filter(writes).fold(0, |mask, e| mask | e.mask);
            // A copy is an argument of a function: it may be written there.
            let copied = graph.events().any(|e| e.variable == index && matches!(e.kind, graph::Kind::Copy { .. }));
            let surely = likely[graph.exit].as_ref().map_or(variable.full, |s| s[index].must);
            self.outputs.push(Output {
                symbol: variable.symbol,
                full: variable.full,
                written: if copied { variable.full } else { written },
                surely: if copied { variable.full } else { surely },
                write: graph.events().find(writes).map(|e| e.span),
            });
        }
    }

    fn follow_function(&mut self, shader: &Shader, id: FunctionId, graph: &graph::Graph) {
        let likely = graph.reached(false);
        let off = graph::Kind::NoReturn { root: true };
        if graph.blocks.iter().zip(&likely).any(|(b, reached)| *reached && b.events.iter().any(|e| e.kind == off)) {
            self.falls_off.push(id);
        }
        let end = assign::solve(graph, true).swap_remove(graph.exit);
        for (index, param) in shader.function_info(id).params.iter().enumerate() {
            let variable = param.symbol.and_then(|s| graph.variable(s));
            let (Direction::Out, Some(variable), Some(end)) = (param.direction, variable, &end) else { continue };
            if end[variable].may == 0 {
                self.unwritten.push((id, index));
            }
        }
    }
}

/// The fewest vertices of a primitive that a geometry stage makes.
pub fn vertices_needed(shader: &Shader) -> Option<u32> {
    Some(match shader.interface().geometry.output?.value {
        OutputPrimitive::Points => 1,
        OutputPrimitive::LineStrip => 2,
        OutputPrimitive::TriangleStrip => 3,
    })
}

/// True for a variable that leaves the stage.
fn is_output(shader: &Shader, symbol: SymbolId) -> bool {
    match shader.symbol(symbol).kind {
        SymbolKind::Builtin => !shader.symbol(symbol).read_only,
        SymbolKind::Global(storage) => storage == Storage::Out,
        SymbolKind::BlockMember(index) | SymbolKind::BlockInstance(index) => {
            shader.interface().blocks.get(index).is_some_and(|b| b.storage == Storage::Out)
        }
        SymbolKind::Param(_) | SymbolKind::Local => false,
    }
}

/// True when the variable is declared in this function.
fn is_inside(shader: &Shader, symbol: SymbolId, function: FunctionId) -> bool {
    let info = shader.function_info(function);
    let body = shader.function_syntax(info).and_then(|f| f.body.as_ref()).map(|b| b.span);
    let place = shader.symbol(symbol).span;
    match shader.symbol(symbol).kind {
        SymbolKind::Local => body.zip(place).is_some_and(|(b, p)| b.contains(p.start)),
        SymbolKind::Param(_) => info.params.iter().any(|p| p.symbol == Some(symbol)),
        SymbolKind::Builtin | SymbolKind::Global(_) | SymbolKind::BlockMember(_) | SymbolKind::BlockInstance(_) => {
            false
        }
    }
}
