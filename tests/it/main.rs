//! Tests across modules and processes, in one binary.

mod mutate;
mod tidy;
