//! How far a conforming device may be off: what specifications promise for single operations, what a
//! device was measured to keep, and the sweep that measures it.

pub mod calibrate;
pub mod profile;
pub mod tape;
