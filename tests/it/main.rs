//! Tests across modules and processes, in one binary.

mod adversary;
mod alarms;
mod api;
mod binary;
mod blame;
mod calibrate;
mod check_cli;
mod geometry;
mod glsl_differential;
mod interp;
mod json;
mod lint_cli;
mod lowering;
mod lowering_vertex;
mod mutate;
mod own;
mod positions;
mod probe;
mod regress;
mod soundness;
mod tidy;
mod translate;
mod translate_flips;
mod translate_validators;
mod translated;
