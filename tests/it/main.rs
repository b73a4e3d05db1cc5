//! Tests across modules and processes, in one binary.

mod calibrate;
mod tidy;
