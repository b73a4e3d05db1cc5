//! How far a conforming device may be off: what specifications promise for single operations, what a
//! device was measured to keep, and the tape that derives from it how far whole programs may be off.
//! Beside it the sweep that measures a device, single operations run again, and a device that errs as
//! far as it may.

pub mod adversary;
pub mod calibrate;
pub mod profile;
pub mod replay;
pub mod tape;
