//! Keeps panics of naga inside: on odd input they become an error, and nothing is printed.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
    /// The source file of the last panic that was kept inside.
    static FILE: Cell<Option<String>> = const { Cell::new(None) };
}

/// A panic that was kept inside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Panic {
    /// What it says.
    pub message: String,
    /// The source file in which it began, as the compiler was given it.
    pub file: Option<String>,
}

impl Panic {
    /// True for one that began in a library of this name, whatever its version.
    pub fn is_of(&self, library: &str) -> bool {
        let versioned = |folder: &str| {
            folder.strip_prefix(library).is_some_and(|rest| {
                rest.is_empty()
                    || rest.strip_prefix('-').is_some_and(|version| version.starts_with(|c: char| c.is_ascii_digit()))
            })
        };
        self.file.as_deref().is_some_and(|file| file.split(['/', '\\']).any(versioned))
    }
}

/// Runs `work`; a panic in it becomes `Err` with the panic's message.
pub fn contain<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    contain_whole(work).map_err(|panic| panic.message)
}

/// The same with where the panic began.
pub fn contain_whole<T>(work: impl FnOnce() -> T) -> Result<T, Panic> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            // Other threads, and code outside `contain`, keep the hook they had.
            if QUIET.get() {
                FILE.set(info.location().map(|location| location.file().to_owned()));
            } else {
                previous(info);
            }
        }));
    });
    let before = QUIET.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(work));
    QUIET.set(before);
    result.map_err(|payload| {
        let message = payload
            .downcast_ref::<&str>()
            .map(|s| (*s).to_owned())
            .or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_else(|| "unknown panic".to_owned());
        Panic { message, file: FILE.take() }
    })
}

#[cfg(test)]
mod tests {
    use super::{Panic, contain, contain_whole};

    #[test]
    fn a_panic_becomes_an_error_with_its_message() {
        assert_eq!(contain(|| panic!("index {}", 7)), Err::<(), _>("index 7".to_owned()));
        assert_eq!(contain(|| 7), Ok(7));
    }

    #[test]
    fn a_panic_knows_the_library_in_which_it_began() {
        let of = |file: &str| Panic { message: String::new(), file: Some(file.to_owned()) };
        assert!(of("/registry/src/index/naga-30.0.1/src/back/spv/block.rs").is_of("naga"));
        assert!(of("C:\\registry\\naga-30.0.1\\src\\lib.rs").is_of("naga"));
        assert!(
            !of("/registry/naga-types-30.0.1/src/lib.rs").is_of("naga") && !of("crates/x/contain.rs").is_of("naga")
        );
        let panic = contain_whole(|| panic!("here")).unwrap_err();
        assert!(panic.file.is_some_and(|file| file.ends_with("contain.rs")));
    }
}
