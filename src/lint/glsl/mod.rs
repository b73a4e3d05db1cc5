//! Rules on shaders.

pub(super) mod d016;
pub(super) mod d011;
pub(super) mod d010;
pub(super) mod d007;
pub(super) mod d006;
pub(super) mod t017;
pub(super) mod t015;
pub(super) mod t014;
pub(super) mod t013;
pub(super) mod t007;
pub(super) mod t006;
pub(super) mod t005;
pub(super) mod g010;
pub(super) mod g006;
pub(super) mod g005;
pub(super) mod g004;
pub(super) mod g003;
pub(super) mod g001;
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
mod context;
mod emission;
mod walk;
mod variable;
#[cfg(test)]
mod testing;
