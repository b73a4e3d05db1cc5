//! Files that people name: source texts are read with a limit, TOML with the place of every value, and whatever is written
//! replaces its target as a whole.

pub mod elsewhere;
pub mod fresh;
mod hosts;
mod includes;
mod modules;
mod problem;
mod source;
pub mod table;

pub use elsewhere::{plain, plain_path};
pub use hosts::{Budget, hosts_around};
pub use includes::included;
pub use modules::{ComposeError, Modules, ancestors, outwards};
pub use problem::Problem;
pub use source::{MOST_BYTES, read_source};
