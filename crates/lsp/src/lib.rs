//! What a language server says about shaders and the host code around them. Pure: texts in, answers in the types of the
//! protocol out, one file a request. Reading files, messages and threads are the work of `src/cli/lsp/`.

mod actions;
mod completion;
mod diagnostics;
mod encoding;
mod folding;
mod hints;
mod hover;
mod navigate;
mod occurrences;
mod probe;
mod rename;
mod selection;
mod signature;
mod symbols;
mod tokens;
mod unit;
mod walk;
mod workspace;

pub use actions::{actions, ignore_comment};
pub use diagnostics::{diagnostic, rule_link};
pub use encoding::Encoding;
pub use hints::Hints;
pub use probe::Probe;
pub use rename::RenameError;
pub use tokens::legend;
pub use unit::UnitCache;
pub use workspace::{Edits, Place, Workspace};
