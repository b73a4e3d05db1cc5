//! Planted faults that must be found, each beside the same thing without the fault, which must pass.

mod edges;
mod files;
mod formulas;
mod lanes;
mod shaders;
mod suites;
mod survey;
mod translators;
