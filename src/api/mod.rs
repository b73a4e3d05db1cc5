//! Tests of shaders in Rust: the builder [`Shader`], and the harness [`test_main`].

mod domain;
mod harness;
mod inputs;
mod law;
mod outcome;
mod run;
mod shader;

pub use domain::{Components, Domain};
pub use harness::test_main;
pub use inputs::Inputs;
pub use law::Law;
pub use outcome::{Error, Outcome};
pub use shader::Shader;
