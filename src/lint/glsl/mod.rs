//! Rules on shaders.

pub(super) mod g002;
pub(super) mod n001;
pub(super) mod n002;
pub(super) mod n003;
pub(super) mod n004;
pub(super) mod n005;
pub(super) mod n006;
pub(super) mod n007;
pub(super) mod n008;
pub(super) mod n009;
pub(super) mod n010;
pub(super) mod n011;
pub(super) mod n012;
pub(super) mod n013;
pub(super) mod n014;
pub(super) mod n015;
pub(super) mod n018;
pub(super) mod n019;
pub(super) mod n022;
mod numeric;
pub(super) mod t001;
mod walk;
