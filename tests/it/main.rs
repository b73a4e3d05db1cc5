//! Tests across modules and processes, in one binary.

mod alarms;
mod binary;
mod check_cli;
mod json;
mod regress;
mod tidy;
