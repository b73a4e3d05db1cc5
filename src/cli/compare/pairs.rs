//! Which function of one text stands beside which of the other.

use base::did_you_mean;
use engine::fuzz::Subject;

/// The names that are asked for: those of the first text, with those of the second.
///
/// # Errors
/// For a name that is empty.
pub(super) fn wanted(options: &[String]) -> anyhow::Result<Vec<[String; 2]>> {
    let one = |option: &String| {
        let (first, second) = option.split_once('=').unwrap_or((option, option));
        anyhow::ensure!(!first.is_empty() && !second.is_empty(), "--function `{option}`: write NAME or NAME=OTHER");
        Ok([first.to_owned(), second.to_owned()])
    };
    options.iter().map(one).collect()
}

/// Pairs in the order of the first text.
pub(super) type Pairs<'a> = Vec<[&'a Subject; 2]>;

/// The pairs that are wanted; or all functions of the same name, where the manner of writing it does not count, with the names
/// that have no partner, by text.
///
/// # Errors
/// When a name that is asked for is in neither text or in one alone, and when no function is in both.
pub(super) fn of<'a>(
    sides: [&'a [Subject]; 2],
    wanted: &[[String; 2]],
) -> anyhow::Result<(Pairs<'a>, [Vec<String>; 2])> {
    if !wanted.is_empty() {
        let named = |side: usize, name: &str| {
            let which = ["first", "second"][side];
            let found = sides[side].iter().find(|s| s.label == name).or_else(|| find(sides[side], name));
            found.ok_or_else(|| {
                let hint = did_you_mean(name, sides[side].iter().map(|s| s.label.as_str()), "there are:");
                anyhow::anyhow!("the {which} text has no function `{name}` with a body; {hint}")
            })
        };
        let pairs = wanted.iter().map(|[a, b]| Ok([named(0, a)?, named(1, b)?])).collect::<anyhow::Result<_>>()?;
        return Ok((pairs, [Vec::new(), Vec::new()]));
    }
    let partner = |subject: &Subject| {
        sides[1].iter().find(|s| s.label == subject.label).or_else(|| find(sides[1], &subject.label))
    };
    let pairs: Pairs<'a> = sides[0].iter().filter_map(|subject| Some([subject, partner(subject)?])).collect();
    if pairs.is_empty() {
        let names = |side: usize| sides[side].iter().map(|s| s.label.as_str()).collect::<Vec<_>>().join(", ");
        anyhow::bail!(
            "the texts have no function in common; --function NAME=OTHER says which belong together; the first has: {}; the second has: {}",
            names(0),
            names(1)
        );
    }
    let alone = |side: usize| {
        let rest = sides[side].iter().filter(|s| !pairs.iter().any(|pair| std::ptr::eq(pair[side], *s)));
        rest.map(|s| s.label.clone()).collect()
    };
    let unpaired = [alone(0), alone(1)];
    Ok((pairs, unpaired))
}

/// The only function of a name, in whatever manner it is written: `segmentDistance` and `segment_distance` are one name, and
/// the types of parameters are no part of it.
fn find<'a>(side: &'a [Subject], name: &str) -> Option<&'a Subject> {
    let plain = |name: &str| {
        let name = name.split('(').next().unwrap_or(name);
        name.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect::<String>()
    };
    let mut found = side.iter().filter(|subject| plain(&subject.label) == plain(name));
    found.next().filter(|_| found.next().is_none())
}
