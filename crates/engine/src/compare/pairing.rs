//! Which function of one text stands beside which of the other: by name and by the types of the parameters.
//!
//! GLSL, HLSL and Slang have several functions of one name; WGSL has one, so that its libraries write `cubic2` and `cubic3`
//! beside `cubic`. How a name is written (`segmentDistance`, `segment_distance`) does not count.

use serde::{Deserialize, Serialize};

use crate::fuzz::Subject;
use base::did_you_mean;
use program::{Parameter, Written};
use syntax::symbols::Direction;

/// The functions of two texts that belong together, and those that have no partner.
#[derive(Default)]
pub struct Pairing<'a> {
    /// Pairs in the order of the first text.
    pub pairs: Vec<[&'a Subject; 2]>,
    /// What has none, by text.
    pub unpaired: [Vec<Unpaired>; 2],
}

/// A function that has no partner.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unpaired {
    /// Its name; with the types of its parameters where its text has several of that name.
    pub function: String,
    /// `name:line:column`.
    pub at: String,
    /// Why; `None` where the other text has no function of that name.
    pub why: Option<String>,
}

/// A function that is asked for: `cubic`, or `cubic(vec2)` for one of several.
#[derive(Clone, Debug, PartialEq, Eq)]
struct WantedPair<'o> {
    text: &'o str,
    name: &'o str,
    types: Option<Vec<String>>,
}

impl<'o> WantedPair<'o> {
    fn read(text: &'o str) -> Self {
        let text = text.trim();
        let Some((name, inside)) = text.split_once('(').and_then(|(n, rest)| Some((n, rest.strip_suffix(')')?))) else {
            return Self { text, name: text, types: None };
        };
        let (mut types, mut depth, mut from) = (Vec::new(), 0, 0);
        for (at, c) in inside.char_indices() {
            depth += i32::from(c == '<') - i32::from(c == '>');
            if c == ',' && depth == 0 {
                types.push(&inside[from..at]);
                from = at + 1;
            }
        }
        types.push(&inside[from..]);
        let known = |ty: &str| Written::shape_named(ty).map_or_else(|| ty.trim().to_owned(), |shape| shape.to_string());
        let types = if inside.trim().is_empty() { Vec::new() } else { types.into_iter().map(known).collect() };
        Self { text, name: name.trim(), types: Some(types) }
    }

    /// The functions of a text that are meant.
    fn of<'a>(&self, side: &'a [Subject]) -> Vec<&'a Subject> {
        let all = |is: &dyn Fn(&Subject) -> bool| side.iter().filter(|s| is(s)).collect::<Vec<_>>();
        let fits = |s: &Subject| self.types.as_ref().is_none_or(|types| s.parameters.iter().map(|p| &p.ty).eq(types));
        let ways: [&dyn Fn(&Subject) -> bool; 3] =
            [&|s| s.label == self.text, &|s| s.name == self.name && fits(s), &|s| {
                plain(&s.name) == plain(self.name) && fits(s)
            }];
        ways.into_iter().map(all).find(|found| !found.is_empty()).unwrap_or_default()
    }

    fn unknown(&self, side: &[Subject], which: usize) -> String {
        let hint = did_you_mean(self.text, side.iter().map(|s| s.label.as_str()), "there are:");
        format!("the {} text has no function `{}` with a body; {hint}", ORDER[which], self.text)
    }
}

const ORDER: [&str; 2] = ["first", "second"];

/// The pairs that are wanted, as `NAME` or `NAME=OTHER`, where a name may have the types of the parameters behind it; or all
/// that belong together.
///
/// # Errors
/// When an option cannot be read, a name that is asked for is in neither text, and when nothing belongs together.
pub fn pairing<'a>(sides: [&'a [Subject]; 2], wanted: &[String]) -> Result<Pairing<'a>, String> {
    if wanted.is_empty() {
        let all = sides.map(|side| side.iter().collect::<Vec<_>>());
        let pairing = of(&all[0], &all[1], &NAMED);
        if pairing.pairs.is_empty() {
            // A text that cannot be read has no functions, and says why.
            let label = |s: &Subject| match &s.ready {
                Err(why) if s.at.starts_with(&s.label) => format!("{} ({why})", s.label),
                _ => s.label.clone(),
            };
            let labels = |side: usize| sides[side].iter().map(label).collect::<Vec<_>>().join(", ");
            let reasons = reasons(&pairing.unpaired);
            return Err(format!(
                "the texts have no function in common; --function NAME=OTHER says which belong together; the first has: {}; \
                 the second has: {}{reasons}",
                labels(0),
                labels(1)
            ));
        }
        return Ok(pairing);
    }
    let mut all = Pairing::default();
    for option in wanted {
        let (first, second) = option.split_once('=').unwrap_or((option, ""));
        if first.is_empty() || (second.is_empty() && option.contains('=')) {
            return Err(format!("--function `{option}`: write NAME or NAME=OTHER"));
        }
        let some = if second.is_empty() { one_name(sides, first)? } else { two_names(sides, [first, second])? };
        if some.pairs.is_empty() {
            return Err(format!("--function `{option}`: nothing belongs together{}", reasons(&some.unpaired)));
        }
        all.pairs.extend(some.pairs);
        all.unpaired.iter_mut().zip(some.unpaired).for_each(|(all, some)| all.extend(some));
    }
    Ok(all)
}

/// What is called so in the first text, or else in the second, with what belongs to it.
fn one_name<'a>(sides: [&'a [Subject]; 2], name: &str) -> Result<Pairing<'a>, String> {
    let wanted = WantedPair::read(name);
    let firsts = wanted.of(sides[0]);
    let mut pairing = if firsts.is_empty() {
        let seconds = wanted.of(sides[1]);
        if seconds.is_empty() {
            return Err(wanted.unknown(sides[0], 0));
        }
        of(&sides[0].iter().collect::<Vec<_>>(), &seconds, &NAMED)
    } else {
        of(&firsts, &sides[1].iter().collect::<Vec<_>>(), &NAMED)
    };
    // Nobody asked about the others.
    pairing.unpaired[usize::from(!firsts.is_empty())].clear();
    Ok(pairing)
}

/// What two names are about, whatever they are: one of each, or several by their parameters.
fn two_names<'a>(sides: [&'a [Subject]; 2], names: [&str; 2]) -> Result<Pairing<'a>, String> {
    let mut found = [Vec::new(), Vec::new()];
    for side in 0..2 {
        let wanted = WantedPair::read(names[side]);
        found[side] = wanted.of(sides[side]);
        if found[side].is_empty() {
            return Err(wanted.unknown(sides[side], side));
        }
    }
    let [firsts, seconds] = &found;
    if let ([first], [second]) = (&firsts[..], &seconds[..]) {
        return Ok(Pairing { pairs: vec![[*first, *second]], unpaired: <[Vec<Unpaired>; 2]>::default() });
    }
    Ok(of(firsts, seconds, &[PairingWay { names: |_, _| true, fits: in_order, only: true }]))
}

/// Of functions that have no partner although there is one of their name, the reasons.
fn reasons(unpaired: &[Vec<Unpaired>; 2]) -> String {
    let all = unpaired.iter().flatten();
    all.filter_map(|one| Some(format!("\n  `{}` at {}: {}", one.function, one.at, one.why.as_ref()?))).collect()
}

/// How functions may belong together.
struct PairingWay {
    names: fn(&Subject, &Subject) -> bool,
    fits: fn(&Subject, &Subject) -> bool,
    /// Only where neither has another partner.
    only: bool,
}

/// The ways in which functions belong together by name, the surest first.
const NAMED: [PairingWay; 7] = [
    PairingWay { names: |a, b| a.name == b.name, fits: alike, only: false },
    PairingWay { names: |a, b| plain(&a.name) == plain(&b.name), fits: alike, only: true },
    PairingWay { names: by_suffix, fits: alike, only: true },
    PairingWay { names: |a, b| a.name == b.name, fits: in_order, only: false },
    PairingWay { names: |a, b| plain(&a.name) == plain(&b.name), fits: in_order, only: true },
    PairingWay { names: by_suffix, fits: in_order, only: true },
    PairingWay { names: |a, b| plain(&a.name) == plain(&b.name), fits: somehow, only: true },
];

fn of<'a>(firsts: &[&'a Subject], seconds: &[&'a Subject], ways: &[PairingWay]) -> Pairing<'a> {
    let mut partners: Vec<Option<usize>> = vec![None; firsts.len()];
    for way in ways {
        let taken: Vec<bool> = (0..seconds.len()).map(|k| partners.contains(&Some(k))).collect();
        let belongs = |a: usize, b: usize| (way.names)(firsts[a], seconds[b]) && (way.fits)(firsts[a], seconds[b]);
        let open: Vec<usize> = (0..firsts.len()).filter(|&a| partners[a].is_none()).collect();
        for &a in &open {
            let mut found = (0..seconds.len()).filter(|&b| !taken[b] && belongs(a, b));
            let Some(b) = found.next() else { continue };
            let alone = || found.next().is_none() && open.iter().filter(|&&other| belongs(other, b)).count() == 1;
            if !way.only || { alone }() {
                partners[a] = Some(b);
            }
        }
    }
    let pairs = partners.iter().enumerate().filter_map(|(a, b)| Some([firsts[a], seconds[(*b)?]])).collect();
    let without = |own: &[&Subject], others: &[&Subject], which: usize, has: &dyn Fn(usize) -> bool| {
        let rest = (0..own.len()).filter(|&k| !has(k)).map(|k| own[k]);
        rest.map(|one| unpaired(one, others, which)).collect::<Vec<_>>()
    };
    let unpaired = [
        without(firsts, seconds, 1, &|a| partners[a].is_some()),
        without(seconds, firsts, 0, &|b| partners.contains(&Some(b))),
    ];
    Pairing { pairs, unpaired }
}

fn unpaired(one: &Subject, others: &[&Subject], which: usize) -> Unpaired {
    let alike = |other: &&&Subject| plain(&one.name) == plain(&other.name) || by_suffix(one, other);
    let named: Vec<String> = others.iter().filter(alike).map(|other| format!("`{}`", signature(other))).collect();
    let why = (!named.is_empty()).then(|| {
        let text = ORDER[which];
        format!("`{}` has other parameters than what the {text} text has: {}", signature(one), named.join(", "))
    });
    Unpaired { function: one.label.clone(), at: one.at.clone(), why }
}

/// `cubic(vec2, float)`, in the words of GLSL.
fn signature(one: &Subject) -> String {
    let types: Vec<&str> = one.parameters.iter().map(|parameter| parameter.ty.as_str()).collect();
    format!("{}({})", one.name, types.join(", "))
}

/// A name however it is written.
fn plain(name: &str) -> String {
    name.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect()
}

/// True where one name is the other with a type or a number of components behind it: `cubic2`, `cubic_vec2`, `cubic3f`.
fn by_suffix(a: &Subject, b: &Subject) -> bool {
    let (a, b) = (plain(&a.name), plain(&b.name));
    let suffix = |long: &str, short: &str| long.strip_prefix(short).is_some_and(is_suffix);
    a != b && (suffix(&a, &b) || suffix(&b, &a))
}

fn is_suffix(text: &str) -> bool {
    let number = text.trim_end_matches(['f', 'i', 'u']);
    let short = number.len() == 1 && number.len() + 1 >= text.len() && ("1"..="4").contains(&number);
    let of_vector = text.strip_prefix('v').is_some_and(|rest| Written::shape_named(&format!("vec{rest}")).is_some());
    short || of_vector || Written::shape_named(text).is_some() || ["f32", "i32", "u32", "f", "i", "u"].contains(&text)
}

/// True for the same types of parameters in the same order, and the same type of what is returned: `noise2` may be the
/// second noise, or noise of two numbers.
fn alike(a: &Subject, b: &Subject) -> bool {
    let returned = |s: &Subject| {
        let fields = s.ready.as_ref().ok()?.kernel.output.vertex.fields();
        Some(fields.iter().find(|field| field.name == "return").map(|field| field.shape))
    };
    let same = match (returned(a), returned(b)) {
        (Some(a), Some(b)) => a == b,
        _ => true,
    };
    same && in_order(a, b)
}

/// True for the same types of parameters in the same order.
fn in_order(a: &Subject, b: &Subject) -> bool {
    let types = |s: &Subject| s.parameters.iter().map(|p| p.ty.clone()).collect::<Vec<_>>();
    types(a) == types(b)
}

/// True for parameters in another order, which their names tell apart; for those that one gives back as a value and the other
/// in an `out` parameter; and where one cannot be run, which says more than its parameters.
fn somehow(a: &Subject, b: &Subject) -> bool {
    let types = |s: &Subject, is: fn(&Parameter) -> bool| {
        let mut all: Vec<String> = s.parameters.iter().filter(|p| is(p)).map(|p| p.ty.clone()).collect();
        all.sort_unstable();
        all
    };
    let given = |p: &Parameter| p.direction != Direction::Out;
    a.ready.is_err()
        || b.ready.is_err()
        || types(a, |_| true) == types(b, |_| true)
        || types(a, given) == types(b, given)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzz::{subjects, subjects_of_module};
    use base::text::SourceFile;
    use program::ModuleText;
    use syntax::{Shader, Stage};

    fn glsl(text: &str) -> Vec<Subject> {
        let parsed = Shader::parse(&SourceFile::new("a.glsl", text), Stage::Library);
        subjects(&parsed.shader, &|_| true).unwrap()
    }

    fn wgsl(text: &str) -> Vec<Subject> {
        let text = ModuleText::read(&SourceFile::new("a.wgsl", text), Written::Wgsl).unwrap();
        subjects_of_module(&text, &[], &|_| true).unwrap()
    }

    const CUBIC: &str = "float cubic(float v) { return v; }\nvec2 cubic(vec2 v) { return v; }\n\
        vec3 cubic(vec3 v) { return v; }\nfloat cubic(float v, float w) { return v + w; }\n";
    const CUBICS: &str = "fn cubic(v: f32) -> f32 { return v; }\nfn cubic2(v: vec2f) -> vec2f { return v; }\n\
        fn cubic_vec3(v: vec3f) -> vec3f { return v; }\n";

    fn names(pairing: &Pairing<'_>) -> Vec<String> {
        pairing.pairs.iter().map(|[a, b]| format!("{} = {}", a.label, b.label)).collect()
    }

    #[test]
    fn overloads_find_the_function_of_their_parameters() {
        let (a, b) = (glsl(CUBIC), wgsl(CUBICS));
        let all = pairing([&a, &b], &[]).unwrap();
        assert_eq!(names(&all), ["cubic(float) = cubic", "cubic(vec2) = cubic2", "cubic(vec3) = cubic_vec3"]);
        let [rest, none] = &all.unpaired;
        assert!(none.is_empty() && rest.len() == 1 && rest[0].function == "cubic(float, float)", "{rest:?}");
        let why = rest[0].why.as_ref().unwrap();
        assert!(why.contains("other parameters") && why.contains("`cubic2(vec2)`"), "{why}");
        let turned = pairing([&b, &a], &[]).unwrap();
        assert_eq!(names(&turned), ["cubic = cubic(float)", "cubic2 = cubic(vec2)", "cubic_vec3 = cubic(vec3)"]);
        let same = pairing([&a, &a], &[]).unwrap();
        assert!(same.pairs.len() == 4 && same.pairs.iter().all(|[x, y]| std::ptr::eq(*x, *y)));
    }

    #[test]
    fn the_exact_name_goes_before_one_with_a_suffix() {
        let a = glsl("vec2 f(vec2 v) { return v; }\nvec2 f2(vec2 v) { return v + 1.0; }\n");
        let b = wgsl("fn f2(v: vec2f) -> vec2f { return v; }\n");
        let all = pairing([&a, &b], &[]).unwrap();
        assert_eq!(names(&all), ["f2 = f2"]);
        assert_eq!(all.unpaired[0][0].function, "f");
    }

    #[test]
    fn what_is_returned_tells_a_number_from_a_suffix() {
        let a = glsl("float noise(vec2 v) { return v.x; }\nvec2 noise2(vec2 v) { return v; }\n");
        let b = wgsl("fn noise2(v: vec2f) -> f32 { return v.x; }\nfn noise22(v: vec2f) -> vec2f { return v; }\n");
        assert_eq!(names(&pairing([&a, &b], &[]).unwrap()), ["noise = noise2", "noise2 = noise22"]);
    }

    #[test]
    fn what_could_be_either_is_neither() {
        let a = glsl("vec2 f(vec2 v) { return v; }\n");
        let b = wgsl("fn f2(v: vec2f) -> vec2f { return v; }\nfn f_vec2(v: vec2f) -> vec2f { return v; }\n");
        assert!(pairing([&a, &b], &[]).is_err());
    }

    #[test]
    fn one_of_several_is_named_by_its_types_in_any_language() {
        let (a, b) = (glsl(CUBIC), wgsl(CUBICS));
        for option in
            ["cubic(vec2)", "cubic(vec2f)", "cubic( vec2<f32> )", "cubic(float2)", "cubic2", "cubic(vec2)=cubic2"]
        {
            let found = pairing([&a, &b], &[option.to_owned()]).unwrap();
            assert_eq!(names(&found), ["cubic(vec2) = cubic2"], "{option}");
        }
        let all = pairing([&a, &b], &["cubic".to_owned()]).unwrap();
        assert_eq!((all.pairs.len(), all.unpaired[0].len(), all.unpaired[1].len()), (3, 1, 0));
        let why = pairing([&a, &b], &["cubic(mat3)".to_owned()]).err().unwrap();
        assert!(why.contains("no function `cubic(mat3)`") && why.contains("did you mean `cubic(vec"), "{why}");
    }

    #[test]
    fn a_parameter_that_is_set_is_a_pointer_or_a_value() {
        let a = glsl("void f(vec2 p, out float d) { d = p.x; }\nvec3 g(float a, vec2 b) { return vec3(a, b); }\n");
        let b =
            wgsl("fn f(p: vec2f) -> f32 { return p.x; }\nfn g(b: vec2f, a: f32) -> vec3f { return vec3f(a, b); }\n");
        assert_eq!(names(&pairing([&a, &b], &[]).unwrap()), ["f = f", "g = g"]);
        // A matrix is not three vectors.
        let a = glsl("vec3 h(mat3 m) { return m[0]; }\n");
        let b = wgsl("fn h(x: vec3f, y: vec3f, z: vec3f) -> vec3f { return x; }\n");
        let why = pairing([&a, &b], &[]).err().unwrap();
        assert!(why.contains("`h(mat3)` has other parameters") && why.contains("`h(vec3, vec3, vec3)`"), "{why}");
    }
}
