//! Tests across modules and processes, in one binary.

mod geometry;
mod lowering;
mod lowering_vertex;
mod positions;
mod tidy;
mod translate;
mod translate_flips;
mod translate_validators;
