//! Tests for shaders, on a machine without a GPU.
//!
//! A [`Shader`] is run on many generated inputs on an interpreter in strict binary32, or with the feature `drivers` on
//! lavapipe, Mesa's Vulkan driver for the processor, and every output is compared with what it should be in `f64`: a
//! closure, another shader, or the shader's own meaning, with [`Law`]s beside it. What differs is shrunk to
//! the smallest inputs that still show it. [`test_main`] makes a test of cargo of every suite file in a
//! folder.
//!
//! ```
//! use shadercheck_test::{Domain, Law, Shader};
//!
//! Shader::from_text("reflect.glsl", "vec3 mirror(vec3 v, vec3 n) { return v - 2.0 * dot(v, n) * n; }")
//!     .function("mirror")
//!     .input("v", -2.0..=2.0)
//!     .input("n", Domain::direction())
//!     .expect("return", |inputs| {
//!         let (v, n): ([f64; 3], [f64; 3]) = (inputs.array("v"), inputs.array("n"));
//!         let dot: f64 = v.iter().zip(n).map(|(v, n)| v * n).sum();
//!         (0..3).map(|k| v[k] - 2.0 * dot * n[k]).collect()
//!     })
//!     .law(Law::odd(["v"]))
//!     .law(Law::even(["n"]))
//!     .lane("embedded")
//!     .samples(512)
//!     .assert_agrees();
//! ```
//!
//! What is named on this page is the interface; the crates behind it change without notice. Without the feature `drivers`,
//! shaders run on the interpreter, and nothing has to be installed.

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
