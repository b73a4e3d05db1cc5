//! `shadercheck --version --verbose`: what a report of a fault has to say about the program.

macro_rules! verbose {
    ($($more:expr),*) => {
        concat!(
            env!("CARGO_PKG_VERSION"),
            "\ncommit: ",
            env!("SHADERCHECK_COMMIT"),
            "\ntarget: ",
            env!("SHADERCHECK_TARGET"),
            "\nprofile: ",
            env!("SHADERCHECK_PROFILE"),
            "\nfeatures: lint",
            $($more),*
        )
    };
}

/// Version, commit, target, profile, features and the versions of what reads and runs shaders: the version, and then a line
/// each, `name: value`. The build script sets what cargo does not.
#[cfg(feature = "drivers")]
pub const VERBOSE: &str =
    verbose!(", run, drivers", "\nnaga: ", env!("SHADERCHECK_NAGA"), "\nwgpu: ", env!("SHADERCHECK_WGPU"));
/// Version, commit, target, profile, features and the version of what reads shaders.
#[cfg(all(feature = "run", not(feature = "drivers")))]
pub const VERBOSE: &str = verbose!(", run", "\nnaga: ", env!("SHADERCHECK_NAGA"));
/// Version, commit, target, profile and features.
#[cfg(not(feature = "run"))]
pub const VERBOSE: &str = verbose!();

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_after_the_first_has_a_name_and_a_value() {
        let mut lines = VERBOSE.lines();
        assert_eq!(lines.next(), Some(env!("CARGO_PKG_VERSION")));
        let named: Vec<_> = lines.map(|line| line.split_once(": ").unwrap()).collect();
        assert!(named.iter().all(|(_, value)| !value.is_empty()), "{named:?}");
        let value = |name: &str| named.iter().find(|(known, _)| *known == name).map(|(_, value)| *value);
        let digits = |value: &str| value.split('.').all(|part| part.parse::<u32>().is_ok());
        for (library, here) in [("naga", cfg!(feature = "run")), ("wgpu", cfg!(feature = "drivers"))] {
            assert_eq!(value(library).is_some_and(digits), here, "{VERBOSE}");
        }
    }
}
