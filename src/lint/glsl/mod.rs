//! Rules on shaders.

pub(super) mod g002;
pub(super) mod i005;
pub(super) mod n014;
pub(super) mod t001;
mod walk;
