//! Rules on shaders.

mod compile;
pub(super) mod g002;
pub(super) mod g007;
pub(super) mod g008;
pub(super) mod g009;
pub(super) mod n014;
pub(super) mod t001;
pub(super) mod t002;
pub(super) mod t003;
pub(super) mod t004;
pub(super) mod t008;
pub(super) mod t009;
pub(super) mod t010;
pub(super) mod t012;
pub(super) mod t016;
pub(super) mod t018;
pub(super) mod v001;
pub(super) mod v002;
pub(super) mod v003;
pub(super) mod v004;
pub(super) mod v005;
pub(super) mod v006;
pub(super) mod v007;
pub(super) mod v008;
pub(super) mod v009;
pub(super) mod v010;
mod walk;
