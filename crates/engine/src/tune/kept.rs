//! Declarations that stay `highp`, or become it, since nobody states how large their values are: where the author wrote
//! `highp`, and inputs that are positions.

use super::declarations::Declarations;
use crate::fuzz::{Domain, Ready};
use crate::guess::{self, Role};
use base::value::Field;
use syntax::Shader;

/// What is of one size in every program, whatever its range.
const BOUNDED: [&str; 5] = ["a colour", "a share", "a direction", "a cosine", "weights that add up to one"];

/// What a position is taken for: of one unit or of a thousand pixels, which only its author knows.
const POSITION: &str = "a point";

/// Words in names of values that are taken apart into bits or compared exactly, however small they are.
const PACKED: [&str; 8] = ["depth", "packed", "pack", "encoded", "id", "index", "key", "hash"];

/// For each declaration, whether it is to be `highp`: an input that is a position; or one at which it is written, where what
/// it holds may be a coordinate, a position, a time or a packed value of a size that nobody states.
pub fn kept(shader: &Shader, ready: &Ready, domain: &Domain, declarations: &Declarations) -> Vec<bool> {
    let taken = ready.realistic.taken_for(domain);
    let fields = ready.kernel.invocation.fields().iter().chain(ready.kernel.case.fields());
    let is_open = |(field, taken): &(&Field, Option<&str>)| taken.is_some_and(|what| !is_bounded(&field.name, what));
    let unstated: Vec<(&Field, Option<&str>)> = fields.zip(taken).filter(is_open).collect();
    let names = |of: &dyn Fn(&str) -> bool| -> Vec<&str> {
        let chosen = unstated.iter().filter(|(_, taken)| taken.is_some_and(of));
        chosen.map(|(field, _)| root(&field.name)).collect()
    };
    let (open, positions) = (names(&|_| true), names(&|what| what == POSITION));
    let of = |name: &str, shape| {
        let field = Field { name: name.to_owned(), shape };
        !is_bounded(name, guess::of(&field, Role::Parameter).taken_for)
    };
    let stays = |k: usize| {
        let one = &declarations.all[k];
        if one.symbols().iter().any(|symbol| positions.contains(&shader.symbol(*symbol).name.as_str())) {
            return true;
        }
        if !one.is_stated_high() || open.is_empty() {
            return false;
        }
        let mut symbols = one.symbols().iter().map(|symbol| shader.symbol(*symbol)).peekable();
        if symbols.peek().is_none() {
            return true;
        }
        symbols.any(|symbol| match inputs(ready).any(|input| input == symbol.name) {
            true => open.contains(&symbol.name.as_str()),
            false => symbol.ty.shape().is_none_or(|shape| of(&symbol.name, shape)),
        })
    };
    (0..declarations.all.len()).map(stays).collect()
}

fn inputs(ready: &Ready) -> impl Iterator<Item = &str> {
    let fields = ready.kernel.invocation.fields().iter().chain(ready.kernel.case.fields());
    fields.map(|field| root(&field.name))
}

/// The name of the variable that a field is, or is a part of.
fn root(name: &str) -> &str {
    name.split(['.', '[']).next().unwrap_or(name)
}

fn is_bounded(name: &str, taken_for: &str) -> bool {
    let packed = syntax::words::words(name).iter().any(|word| PACKED.contains(&word.as_str()));
    !packed && BOUNDED.contains(&taken_for)
}
