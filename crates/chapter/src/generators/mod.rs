//! Generators of what the chapter's shaders take: skeletons, parts of a jointed figure, strands of hair.

mod arm;
mod bones;
mod node_run;
mod posed;
mod rigid_parts;
#[cfg(test)]
mod tests;

use property::generators::Generator;

/// All of them, in the order of the manual.
pub static ALL: &[&dyn Generator] = &[&bones::Bones, &rigid_parts::RigidParts, &node_run::NodeRun];
