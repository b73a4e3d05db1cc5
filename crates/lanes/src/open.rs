//! Opening lanes: those that are named, or those that this machine has.

use thiserror::Error;

use crate::{Candidate, Lane, LaneName, Unavailable, registry};

/// There is no lane of this name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no lane `{name}`; {hint}")]
pub struct UnknownLane {
    name: String,
    hint: String,
}

/// What becomes of a lane that only stands in for devices, where no lane is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandIn {
    /// It runs beside devices.
    Beside,
    /// It runs where no device is available.
    WithoutDevice,
    /// It does not run.
    Never,
}

/// Which lanes are opened, in the order of the registry.
#[derive(Clone, Copy, Debug)]
pub struct Wanted<'a> {
    /// These; all of this machine when none is named.
    pub names: &'a [String],
    /// These as well.
    pub also: &'a [String],
    /// What becomes of stand-ins where `names` is empty.
    pub stand_in: StandIn,
    /// The first so many that is available.
    pub most: usize,
}

impl<'a> Wanted<'a> {
    /// The lanes of these names; without names every device, and a stand-in where there is none.
    pub fn named(names: &'a [String]) -> Self {
        Self { names, also: &[], stand_in: StandIn::WithoutDevice, most: usize::MAX }
    }

    /// Opens the lanes.
    ///
    /// # Errors
    /// [`UnknownLane`] for the first name that no lane has. A lane that is there and is not available is no error.
    pub fn open(&self) -> Result<Opened, UnknownLane> {
        self.open_of(registry())
    }

    fn open_of(&self, all: &[Candidate]) -> Result<Opened, UnknownLane> {
        let names = || all.iter().map(|candidate| candidate.name);
        if let Some(name) = self.names.iter().chain(self.also).find(|name| names().all(|known| known != **name)) {
            return Err(UnknownLane { name: name.clone(), hint: base::did_you_mean(name, names(), "lanes are") });
        }
        let mut opened = Opened { lanes: Vec::new(), missing: Vec::new() };
        for candidate in all {
            let named = self.names.iter().chain(self.also).any(|name| name == candidate.name);
            let wanted = self.names.is_empty()
                && !candidate.named_only
                && match self.stand_in {
                    _ if !candidate.stand_in => true,
                    StandIn::Beside => true,
                    StandIn::WithoutDevice => opened.lanes.is_empty(),
                    StandIn::Never => false,
                };
            if (named || wanted) && opened.lanes.len() < self.most {
                match (candidate.open)() {
                    Ok(lane) => opened.lanes.push(lane),
                    Err(_) if candidate.extra && !named => {}
                    Err(why) => opened.missing.push((candidate.name, why)),
                }
            }
        }
        Ok(opened)
    }
}

/// The lane of this name, or the first that is available.
///
/// # Errors
/// [`UnknownLane`] when no lane has the name.
pub fn open_first(name: Option<&String>) -> Result<Opened, UnknownLane> {
    let names = name.map_or(&[][..], std::slice::from_ref);
    Wanted { stand_in: StandIn::Beside, most: 1, ..Wanted::named(names) }.open()
}

/// Lanes that were opened.
pub struct Opened {
    /// The lanes.
    pub lanes: Vec<Box<dyn Lane>>,
    /// Lanes that were asked for and are unavailable, and why.
    pub missing: Vec<(LaneName, Unavailable)>,
}

impl Opened {
    /// The only lane that was asked for, or why it is not available.
    pub fn only(self) -> Result<Box<dyn Lane>, Vec<(LaneName, Unavailable)>> {
        self.lanes.into_iter().next().ok_or(self.missing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::embedded;

    fn candidate(name: &'static str, there: bool, stand_in: bool) -> Candidate {
        let open = move || {
            if there {
                embedded::open()
            } else {
                Err(Unavailable { why: "it is away".to_owned(), remedy: "bring it".to_owned() })
            }
        };
        Candidate { name, about: "", open: Box::new(open), stand_in, named_only: false, extra: false }
    }

    fn names(names: &[&str]) -> Vec<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    /// How many lanes are opened, and which are missing.
    fn opened(wanted: &Wanted<'_>, device: bool) -> (usize, Vec<LaneName>) {
        let all = [candidate("gone", false, false), candidate("device", device, false), candidate("spare", true, true)];
        let opened = wanted.open_of(&all).unwrap();
        (opened.lanes.len(), opened.missing.into_iter().map(|(name, _)| name).collect())
    }

    #[test]
    fn a_stand_in_runs_where_there_is_no_device_or_it_is_named() {
        let all = Wanted::named(&[]);
        assert_eq!(opened(&all, true), (1, vec!["gone"]));
        assert_eq!(opened(&all, false), (1, vec!["gone", "device"]));
        assert_eq!(opened(&Wanted { also: &names(&["spare"]), ..all }, true), (2, vec!["gone"]));
        assert_eq!(opened(&Wanted { stand_in: StandIn::Beside, ..all }, true), (2, vec!["gone"]));
        assert_eq!(opened(&Wanted { stand_in: StandIn::Never, ..all }, false), (0, vec!["gone", "device"]));
        assert_eq!(opened(&Wanted { stand_in: StandIn::Beside, most: 1, ..all }, true), (1, vec!["gone"]));
    }

    #[test]
    fn only_lanes_that_are_named_are_opened() {
        assert_eq!(opened(&Wanted::named(&names(&["spare"])), true), (1, vec![]));
        assert_eq!(opened(&Wanted::named(&names(&["gone", "device"])), true), (1, vec!["gone"]));
    }

    #[test]
    fn an_unknown_lane_is_an_error_with_a_suggestion() {
        let error = |name: &str| Wanted::named(&names(&[name])).open().err().unwrap().to_string();
        assert_eq!(error("vulcan"), "there is no lane `vulcan`; did you mean `vulkan`?");
        assert!(error("metal").starts_with("there is no lane `metal`; lanes are vulkan, "), "{}", error("metal"));
    }
}
