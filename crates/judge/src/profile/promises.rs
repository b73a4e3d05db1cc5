//! Which profiles a lane is judged by.

use std::sync::Arc;

use super::{Profile, by_name, for_device};
use program::lane::{Api, Description};

/// The profiles that are promises of an API, the strictest first: its text, and what its conformance
/// suite accepts where there is one. What each later one accepts includes what the one before does.
pub fn promises(api: Api) -> Vec<&'static Profile> {
    let names: &[&str] = match api {
        Api::Vulkan => &["vulkan-1.4", "vulkan-cts"],
        Api::OpenGl => &["glsl-4.60"],
        Api::WebGpu => &["wgsl"],
        Api::Binary32 => &["binary32"],
    };
    let shipped = |name: &&str| by_name(name).unwrap_or_else(|| unreachable!("`{name}` is part of the program"));
    names.iter().map(shipped).collect()
}

/// What the results of a lane are held against.
#[derive(Clone, Debug)]
pub struct Promises {
    /// The text of the specification.
    pub text: &'static Profile,
    /// What the conformance suite of the specification accepts.
    pub conformance: Option<&'static Profile>,
    /// What this device was measured to keep.
    pub measured: Option<Arc<Profile>>,
}

impl Promises {
    /// The promises of an API, without a measurement.
    pub fn of_api(api: Api) -> Self {
        let promises = promises(api);
        Self { text: promises[0], conformance: promises.get(1).copied(), measured: None }
    }

    /// The promises of a lane's API with the shipped measurement of its device, if there is one.
    pub fn of_lane(lane: &Description) -> Self {
        Self { measured: for_device(&lane.driver).cloned(), ..Self::of_api(lane.api) }
    }

    /// The promise that allows the most.
    pub fn lenient(&self) -> &'static Profile {
        self.conformance.unwrap_or(self.text)
    }

    /// The promises, the strictest first.
    pub fn promises(&self) -> impl Iterator<Item = &'static Profile> {
        [Some(self.text), self.conformance].into_iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::profile::{Op, accept};
    use program::lane::Stage;

    fn lane(api: Api, driver: &str) -> Description {
        Description {
            name: "soft",
            driver: driver.to_owned(),
            executor: "soft".to_owned(),
            front_end: "naga".to_owned(),
            api,
            stages: vec![Stage::Compute],
        }
    }

    #[test]
    fn an_api_has_its_promises_in_order() {
        let names = |api| promises(api).iter().map(|p| p.name.as_str()).collect::<Vec<_>>();
        assert_eq!(names(Api::Vulkan), ["vulkan-1.4", "vulkan-cts"]);
        assert_eq!(names(Api::WebGpu), ["wgsl"]);
        assert_eq!(names(Api::Binary32), ["binary32"]);
    }

    #[test]
    fn each_promise_accepts_what_the_one_before_accepts() {
        let [text, suite] = promises(Api::Vulkan)[..] else { panic!("two promises") };
        for op in Op::ALL.into_iter().filter(|op| op.arity().is_some()) {
            for args in [[0.3, 0.7, 2.0], [1.7, 0.2, -1.0], [2.5, -3.0, 0.1]] {
                let of = |profile| accept(profile, op, &args[..op.arity().unwrap()], Stage::Compute);
                match (of(text), of(suite)) {
                    (Ok(text), Ok(suite)) => assert!(suite.lo <= text.lo && text.hi <= suite.hi, "{op:?}"),
                    (text, suite) => assert_eq!(text, suite, "{op:?}"),
                }
            }
        }
    }

    #[test]
    fn a_lane_gets_the_measurement_of_its_device_and_no_other() {
        let measured = |lane: &Description| Promises::of_lane(lane).measured.map(|p| p.name.clone());
        let driver = |version| format!("llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa {version} (LLVM 15.0.6)");
        assert_eq!(measured(&lane(Api::Vulkan, &driver("22.3.6"))).as_deref(), Some("llvmpipe-22.3.6"));
        assert_eq!(measured(&lane(Api::Vulkan, &driver("22.3.1"))).as_deref(), Some("llvmpipe-22.3.6"));
        for other in [&driver("22.2.0"), &driver("25.0.1"), "softpipe, softpipe, Mesa 25.0.7", "soft 1"] {
            assert_eq!(measured(&lane(Api::Vulkan, other)), None, "{other}");
        }
        let promises = Promises::of_lane(&lane(Api::Binary32, "interpreter"));
        assert_eq!((promises.text.name.as_str(), promises.conformance), ("binary32", None));
    }
}
