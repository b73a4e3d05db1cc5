//! Texts that templates make.
