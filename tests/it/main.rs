//! Tests across modules and processes, in one binary.

mod interp;
mod tidy;
