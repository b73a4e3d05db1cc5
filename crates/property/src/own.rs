//! Values behind a trait: those that come with the crate, and those that are made at run time.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

/// A value that lives as long as the program, or one that is shared.
pub enum Own<T: ?Sized + 'static> {
    /// One that comes with the crate.
    Static(&'static T),
    /// One that was made at run time.
    Shared(Arc<T>),
}

impl<T: ?Sized> Clone for Own<T> {
    fn clone(&self) -> Self {
        match self {
            Self::Static(value) => Self::Static(value),
            Self::Shared(value) => Self::Shared(value.clone()),
        }
    }
}

impl<T: ?Sized> Deref for Own<T> {
    type Target = T;

    fn deref(&self) -> &T {
        match self {
            Self::Static(value) => value,
            Self::Shared(value) => value,
        }
    }
}

impl<T: ?Sized + fmt::Debug> fmt::Debug for Own<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}
