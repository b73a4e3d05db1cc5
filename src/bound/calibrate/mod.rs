//! Measures the operations of a device.
