//! Bit-exact values: binary32 as bits, distances in ULP, hexadecimal floats, shapes of shader
//! values and the records and batches made of them. A leaf of the dependency graph.

mod batch;
pub mod exact;
mod float;
mod shape;

pub use batch::{Batch, Field, Record};
pub use float::{F32Bits, ulp_at, ulp_distance};
pub use shape::{Scalar, Shape, ShapeError};
