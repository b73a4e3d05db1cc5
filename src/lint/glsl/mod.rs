//! Rules on shaders.

pub(super) mod d015;
pub(super) mod d009;
pub(super) mod d008;
pub(super) mod d005;
pub(super) mod d004;
pub(super) mod d003;
pub(super) mod d002;
pub(super) mod d001;
pub(super) mod g002;
pub(super) mod n014;
pub(super) mod t001;
mod walk;
mod variable;
#[cfg(test)]
mod testing;
