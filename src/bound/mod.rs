//! How far a conforming device may be off: what specifications promise for single operations, what a
//! device was measured to keep, the sweep that measures it, and single operations run again.

pub mod calibrate;
pub mod profile;
pub mod replay;
