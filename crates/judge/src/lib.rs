//! How far a conforming device may be off, and whose fault a difference is: error profiles of specifications and devices,
//! the tape that derives a bound from them for whole programs, and the comparison of what a lane wrote, what the shader
//! means and what a formula says.

pub mod formula;
pub mod profile;
pub mod replay;
pub mod single;
pub mod tape;
pub mod trace;
pub mod verdict;
