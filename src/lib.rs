//! Tests for shaders, on a machine without a GPU.
//!
//! A [`Shader`] is run on many generated inputs on lavapipe, Mesa's Vulkan driver for the processor, or on
//! an interpreter in strict binary32, and every output is compared with what it should be in `f64`: a
//! closure, another shader, or the shader's own meaning, with [`Law`]s beside it. What differs is shrunk to
//! the smallest inputs that still show it. [`test_main`] makes a test of cargo of every suite file in a
//! folder.
//!
//! ```
//! use shadercheck::{Domain, Law, Shader};
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
//! What is named on this page is the interface of the library. [`cli`] is the program `shadercheck`; the crates behind both
//! change without notice.

#[cfg(feature = "run")]
mod api;
#[doc(hidden)]
pub mod cli;

#[cfg(feature = "run")]
pub use api::{Components, Domain, Error, Inputs, Law, Outcome, Shader, test_main};

// Its catalogue is found by every program that links it.
#[cfg(feature = "run")]
use chapter as _;
