//! Macros that a build or a host gives, and that nothing in a text defines: types of buffers, sizes of workgroups.
//!
//! A kernel that is built once for each type cannot be run without one. Where a text holds no errors once such names stand for
//! something plain, it is run with that, and the report says so.
//!
//! A macro of several arguments is taken from host code and build files and never assumed: it has a meaning that must
//! not be invented.

use lanes::interrupt;
use program::{WIDE_BYTES, WORKGROUP_SIZE};
use syntax::{Lacks, Parsed, TokenKind, TokenPlace};

use super::{Completed, errors};

/// Macros that are assumed: names and values.
pub type Assumed = Vec<(String, String)>;

/// Reads a text with more macros.
type Parse<'p> = dyn Fn(&Assumed) -> Parsed + 'p;

/// Times that names are looked for which only show when others are known.
const ROUNDS: usize = 6;

/// Names that are assumed at most.
const MOST: usize = 16;

/// Names that are taken from host code at most.
const MOST_TAKEN: usize = 128;

/// Values of a name, and builds of a shader, that are tried at most.
const MOST_OPTIONS: usize = 12;

/// Times that every choice is gone through.
const PASSES: usize = 2;

/// What a type may stand for, the plainest first.
const TYPES: [&str; 5] = ["float", "vec4", "uint", "int", "ivec4"];

/// What a number may stand for: a size that is none of the first sizes of buffers, and the least.
const VALUES: [&str; 3] = ["32", "1", "4"];

/// Numbers that have a name in mathematics, by their names in small letters without `m_`.
const CONSTANTS: [(&str, &str); 12] = [
    ("pi", "3.14159265358979"),
    ("tau", "6.28318530717959"),
    ("two_pi", "6.28318530717959"),
    ("twopi", "6.28318530717959"),
    ("half_pi", "1.5707963267949"),
    ("pi_over_two", "1.5707963267949"),
    ("inv_pi", "0.318309886183791"),
    ("one_over_pi", "0.318309886183791"),
    ("sqrt2", "1.4142135623731"),
    ("epsilon", "1e-5"),
    ("eps", "1e-5"),
    ("deg_to_rad", "0.0174532925199433"),
];

/// The number that a name stands for in mathematics.
fn constant(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let name = name.strip_prefix("m_").unwrap_or(&name);
    CONSTANTS.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// A macro that host code of the same project defines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Offer {
    /// Its name, with its parameters where it has some: `load(buffer,at)`.
    pub name: String,
    /// What it stands for.
    pub value: String,
    /// The file that says so.
    pub file: String,
    /// The line there, from 1.
    pub line: usize,
    /// The number of the statement in this file: those of one statement belong to one build.
    pub statement: usize,
    /// True where the statement names the shader.
    pub named: bool,
}

/// What host code of the project says of names, the nearest file first, and of the builds that name the shader.
pub type Offers<'o> = dyn FnMut(&[String]) -> Vec<Offer> + 'o;

/// A name and what it may stand for.
struct AssumedChoice {
    name: String,
    options: Vec<Meaning>,
    at: usize,
}

/// What a name may stand for.
enum Meaning {
    Assumed(String),
    Taken(Offer),
}

impl AssumedChoice {
    fn value(&self) -> (String, String) {
        match &self.options[self.at] {
            Meaning::Assumed(value) => (self.name.clone(), value.clone()),
            Meaning::Taken(offer) => (offer.name.clone(), offer.value.clone()),
        }
    }

    fn is_taken(&self) -> bool {
        matches!(self.options[self.at], Meaning::Taken(_))
    }
}

/// The name of a macro without its parameters.
pub fn macro_name(heading: &str) -> &str {
    heading.split('(').next().unwrap_or(heading)
}

/// Macros that stand for names that a text lacks, as far as they leave no more errors. None where there are too many.
pub(super) fn names(parse: &Parse<'_>, offers: &mut Offers<'_>) -> Option<Completed> {
    let mut parsed = parse(&Vec::new());
    let mut choices: Vec<AssumedChoice> = Vec::new();
    let mut unknown: Vec<String> = Vec::new();
    for round in 0..ROUNDS {
        let is_new =
            |name: &str| !unknown.iter().any(|known| known == name) && choices.iter().all(|choice| choice.name != name);
        let fresh: Vec<(String, Lacks)> =
            parsed.shader.lacking().iter().filter(|(name, _)| is_new(name)).cloned().collect();
        if fresh.is_empty() {
            break;
        }
        let mut names: Vec<String> = fresh.iter().map(|(name, _)| name.clone()).collect();
        if round == 0 {
            names.extend(torn_by(&parsed));
        }
        let offered = offers(&names);
        if round == 0 {
            choices = build(parse, &names, &offered);
            if !choices.is_empty() {
                // Its switches may turn off what is lacking.
                parsed = parse(&values(&choices));
                continue;
            }
        }
        for (name, what) in fresh {
            if choices.iter().any(|choice| choice.name == name) {
                continue;
            }
            let mut options = taken(&name, &offered);
            if options.is_empty() && numbers_places(&parsed, &name) {
                options.push(Meaning::Assumed(choices.len().to_string()));
            }
            if options.is_empty() {
                options = compared(&parsed, &name);
            }
            if options.is_empty() && may_be_given(&parsed, &name, what) {
                options = plain_options(&name, what);
            }
            let of_kind = options.first().map(|option| matches!(option, Meaning::Taken(_)));
            match of_kind {
                None => unknown.push(name),
                Some(is_taken) => {
                    let most = if is_taken { MOST_TAKEN } else { MOST };
                    if choices.iter().filter(|choice| choice.is_taken() == is_taken).count() == most {
                        return None;
                    }
                    choices.push(AssumedChoice { name, options, at: 0 });
                }
            }
        }
        parsed = parse(&values(&choices));
        // What host code offers for one name may ask for others: the choice comes before what is lacking then.
        if choices.iter().any(|choice| choice.is_taken() && choice.options.len() > 1) && errors(&parsed) > 0 {
            improve(parse, &mut choices, errors(&parsed), &AssumedChoice::is_taken);
            parsed = parse(&values(&choices));
        }
    }
    let mut left = errors(&parsed);
    for _ in 0..PASSES {
        left = improve(parse, &mut choices, left, &|_| true);
    }
    let mut found = Completed::default();
    for AssumedChoice { name, mut options, at } in choices {
        match options.swap_remove(at) {
            Meaning::Assumed(value) => found.assumed.push((name, value)),
            Meaning::Taken(offer) => found.taken.push(offer),
        }
    }
    Some(found)
}

fn values(choices: &[AssumedChoice]) -> Assumed {
    choices.iter().map(AssumedChoice::value).collect()
}

/// Tries other options one by one, and keeps those that leave fewer errors. Gives the errors that are left.
fn improve(
    parse: &Parse<'_>,
    choices: &mut [AssumedChoice],
    mut left: usize,
    which: &dyn Fn(&AssumedChoice) -> bool,
) -> usize {
    for k in 0..choices.len() {
        if !which(&choices[k]) {
            continue;
        }
        for other in 0..choices[k].options.len() {
            if left == 0 || interrupt::asked() {
                return left;
            }
            let before = std::mem::replace(&mut choices[k].at, other);
            let now = if other == before { left } else { errors(&parse(&values(choices))) };
            if now < left {
                left = now;
            } else {
                choices[k].at = before;
            }
        }
    }
    left
}

/// Words that may be macros and break the grammar where they are none: `ATTRIBUTE LOW vec4 a;`. None in a text that follows it.
fn torn_by(parsed: &Parsed) -> Vec<String> {
    let (shader, file) = (&parsed.shader, parsed.shader.file());
    let mut found: Vec<String> = Vec::new();
    if parsed.diagnostics.iter().any(|error| error.code == syntax::errors::SYNTAX) {
        let words = |place: TokenPlace| {
            let own = move |token: &&syntax::Token| token.kind == TokenKind::Word && token.place == place;
            shader.tokens().iter().filter(own).map(|token| file.slice(token.span))
        };
        for word in words(TokenPlace::Text).filter(|word| syntax::is_macro(word)) {
            let is_known = words(TokenPlace::Directive).any(|known| known == word);
            if !is_known && found.iter().all(|known| known != word) {
                found.push(word.to_owned());
            }
        }
    }
    found
}

/// What host code says of a name, each value once.
fn taken(name: &str, offered: &[Offer]) -> Vec<Meaning> {
    let mut found: Vec<&Offer> = Vec::new();
    for offer in offered.iter().filter(|offer| macro_name(&offer.name) == name) {
        let known = found.iter().any(|known| known.name == offer.name && known.value == offer.value);
        // A name that stands for itself says nothing.
        if !known && offer.value != name && found.len() < MOST_OPTIONS {
            found.push(offer);
        }
    }
    found.into_iter().cloned().map(Meaning::Taken).collect()
}

/// The macros of the build that names the shader and defines most of what it lacks; of several, that with the fewest errors.
/// A build of all shaders, which names none, is one where it defines several names.
fn build(parse: &Parse<'_>, lacking: &[String], offered: &[Offer]) -> Vec<AssumedChoice> {
    let named = offered.iter().any(|offer| offer.named);
    let mut builds: Vec<Vec<&Offer>> = Vec::new();
    for offer in offered.iter().filter(|offer| offer.named == named) {
        let same = |build: &&mut Vec<&Offer>| build[0].file == offer.file && build[0].statement == offer.statement;
        match builds.iter_mut().find(same) {
            Some(build) => build.push(offer),
            None => builds.push(vec![offer]),
        }
    }
    let defines = |build: &[&Offer]| {
        lacking.iter().filter(|name| build.iter().any(|offer| macro_name(&offer.name) == name.as_str())).count()
    };
    let most = builds.iter().map(|build| defines(build)).max().unwrap_or(0);
    let least = if named { 1 } else { 2 };
    builds.retain(|build| most >= least && defines(build) == most);
    builds.truncate(MOST_OPTIONS);
    let choices = |build: &[&Offer]| -> Vec<AssumedChoice> {
        let mut all: Vec<AssumedChoice> = Vec::new();
        for &offer in build {
            let (name, option) = (macro_name(&offer.name), Meaning::Taken(offer.clone()));
            match all.iter_mut().find(|choice| choice.name == name) {
                // One string may define a name in each branch of a condition.
                Some(choice) if choice.options.len() < MOST_OPTIONS => choice.options.push(option),
                Some(_) => {}
                None => all.push(AssumedChoice { name: name.to_owned(), options: vec![option], at: 0 }),
            }
        }
        all
    };
    let errors_with = |build: &&Vec<&Offer>| errors(&parse(&values(&choices(build))));
    builds.iter().min_by_key(errors_with).map(|build| choices(build)).unwrap_or_default()
}

/// True for a name that numbers places of the interface, each of which has another number: `layout(location = POSITION)`.
fn numbers_places(parsed: &Parsed, name: &str) -> bool {
    let (shader, file) = (&parsed.shader, parsed.shader.file());
    shader.tokens().windows(3).any(|tokens| {
        let [key, is, value] = [0, 1, 2].map(|k| file.slice(tokens[k].span));
        value == name && is == "=" && ["location", "binding", "set", "input_attachment_index"].contains(&key)
    })
}

/// The numbers that a macro of a condition is compared with: `#if PHASE == 2`.
fn compared(parsed: &Parsed, name: &str) -> Vec<Meaning> {
    let (shader, file) = (&parsed.shader, parsed.shader.file());
    let mut numbers: Vec<&str> = Vec::new();
    for tokens in shader.tokens().windows(3).filter(|tokens| tokens[0].place == TokenPlace::Directive) {
        let [of, is, number] = [0, 1, 2].map(|k| file.slice(tokens[k].span));
        let fits = of == name && matches!(is, "==" | "!=") && tokens[2].kind == TokenKind::Number;
        if fits && !numbers.contains(&number) && numbers.len() < MOST_OPTIONS {
            numbers.push(number);
        }
    }
    numbers.into_iter().map(|number| Meaning::Assumed(number.to_owned())).collect()
}

/// What a name may stand for that no host code says anything of, the plainest first.
fn plain_options(name: &str, what: Lacks) -> Vec<Meaning> {
    if let Some(number) = constant(name).filter(|_| what == Lacks::Value) {
        return vec![Meaning::Assumed(number.to_owned())];
    }
    // What a type is that says its size, nothing else may be.
    if let Some(sized) = of_32_bits(name) {
        return vec![Meaning::Assumed(sized)];
    }
    let others: &[&str] = match what {
        Lacks::Type | Lacks::Function => &TYPES,
        Lacks::Value => &VALUES,
    };
    let first = plainest(name, what);
    let others = others.iter().filter(|other| **other != first).map(|other| (*other).to_owned());
    std::iter::once(first.clone()).chain(others).map(Meaning::Assumed).collect()
}

/// Whether a name may be one that a build gives: in capitals, as macros are; or a type, unless it is a slip of the pen.
fn may_be_given(parsed: &Parsed, name: &str, what: Lacks) -> bool {
    let macro_like = syntax::is_macro(name);
    // A type that an extension brings is told with the line that is missing, and is no slip.
    let sized = of_32_bits(name).is_some();
    let slip = !sized && parsed.diagnostics.iter().any(|d| d.help.is_some() && d.file.slice(d.span) == name);
    // Numbers of 64 bits have more digits than any that could stand for them.
    let wide = !macro_like && name.contains("64");
    !slip && !wide && !name.starts_with("gl_") && (macro_like || constant(name).is_some() || what == Lacks::Type)
}

/// The type of 32 bits for one that is smaller or says its size, where the extension that brings it is not on:
/// `uint8_t`, `f16vec2`.
fn of_32_bits(name: &str) -> Option<String> {
    const BITS: [&str; 3] = ["8", "16", "32"];
    let scalars = [("uint", "uint", "u", "uvec"), ("int", "int", "i", "ivec"), ("float", "float", "f", "vec")];
    scalars.into_iter().find_map(|(long, scalar, short, vector)| {
        let sized = |text: &str| BITS.contains(&text);
        let single = name.strip_prefix(long).and_then(|rest| rest.strip_suffix("_t")).filter(|bits| sized(bits));
        let several = || {
            let (bits, count) = name.strip_prefix(short)?.split_once("vec")?;
            (sized(bits) && ["2", "3", "4"].contains(&count)).then(|| format!("{vector}{count}"))
        };
        single.map(|_| scalar.to_owned()).or_else(several)
    })
}

/// What a name stands for at first. A function of one argument becomes a conversion.
fn plainest(name: &str, what: Lacks) -> String {
    let vector =
        ["vec2", "vec3", "vec4", "mat2", "mat3", "mat4"].into_iter().find(|of| name.to_lowercase().contains(of));
    match what {
        Lacks::Type | Lacks::Function => vector.unwrap_or(TYPES[0]).to_owned(),
        Lacks::Value => VALUES[0].to_owned(),
    }
}

/// What to tell of what is assumed.
pub fn assumption_note(assumed: &[(String, String)]) -> String {
    let (bytes, others): (Vec<_>, Vec<_>) = assumed.iter().partition(|(name, _)| name == WIDE_BYTES);
    let (sizes, others): (Vec<_>, Vec<_>) = others.into_iter().partition(|(name, _)| name == WORKGROUP_SIZE);
    let (types, names): (Vec<_>, Vec<_>) = others.into_iter().partition(|(name, _)| of_32_bits(name).is_some());
    let word = |(name, value): &(String, String)| match name.contains('(') {
        true => format!("--define '{name}={value}'"),
        false => format!("--define {name}={value}"),
    };
    let words = |of: Vec<&(String, String)>| of.into_iter().map(word).collect::<Vec<_>>().join(" ");
    let mut told = Vec::new();
    if !names.is_empty() {
        let what = if names.len() == 1 { "a name that nothing defines" } else { "names that nothing defines" };
        told.push(format!("assumed {}: {what} here, as a build or a host may; state others by --define", words(names)));
    }
    if !types.is_empty() {
        let what =
            "types of other sizes, for which those of 32 bits stand: their ranges and places in buffers are others";
        told.push(format!("assumed {}: {what}", words(types)));
    }
    if !bytes.is_empty() {
        let what = "numbers of 8 bits take in buffers the place of those of 32: distances in memory are others";
        told.push(format!("assumed {}: {what}", words(bytes)));
    }
    if !sizes.is_empty() {
        let what = "the text leaves the size of a workgroup to its host; state another by --define";
        told.push(format!("assumed {}: {what}", words(sizes)));
    }
    told.join("; ")
}

/// Names of a file that are told at most.
const MOST_TOLD: usize = 4;

/// What to tell of what is taken from host code: for each file, the names and their lines.
pub fn taken_notes(taken: &[Offer]) -> Vec<String> {
    let mut files: Vec<&str> = Vec::new();
    for offer in taken {
        if !files.contains(&&*offer.file) {
            files.push(&offer.file);
        }
    }
    let about = |file: &str| {
        let own: Vec<&Offer> = taken.iter().filter(|offer| offer.file == file).collect();
        let (first, more) = own.split_at(own.len().min(MOST_TOLD));
        let told: Vec<String> = first.iter().map(|offer| format!("`{}` at line {}", offer.name, offer.line)).collect();
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        let what =
            if own.len() == 1 { "a name that nothing defines here is" } else { "names that nothing defines here are" };
        format!("{what} taken from {file}: {}{more}; state others by --define", told.join(", "))
    };
    files.into_iter().map(about).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Completed, completed};
    use super::*;
    use base::text::SourceFile;
    use syntax::{Shader, Stage};

    fn parsed(file: &SourceFile, with: &Completed) -> Parsed {
        Shader::parse_with(&with.put(file), Stage::Compute, &with.macros())
    }

    fn of(text: &str) -> Option<Assumed> {
        let file = SourceFile::new("k.comp", format!("#version 450\n{text}"));
        let found = completed(&|with| parsed(&file, with), &mut |_| Vec::new(), &mut |_| Vec::new());
        found.map(|found| found.assumed)
    }

    fn pairs(of: &[(&str, &str)]) -> Option<Assumed> {
        Some(of.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect())
    }

    #[test]
    fn types_and_sizes_of_a_build_become_plain_ones() {
        let text = "layout(local_size_x = WIDTH) in;\nlayout(binding = 0) buffer B { ELEMENT x[]; };\n\
                    void main() { x[gl_GlobalInvocationID.x] = ELEMENT(2.0 * float(x[0])); }\n";
        assert_eq!(of(text), pairs(&[("WIDTH", "32"), ("ELEMENT", "float")]));
        let text = "layout(local_size_x = 8) in;\nlayout(binding = 0) buffer B { ELEMENT x[]; };\n\
                    void main() { x[0].xyz = x[1].yzw; }\n";
        assert_eq!(of(text), pairs(&[("ELEMENT", "vec4")]));
    }

    #[test]
    fn types_that_say_their_size_keep_their_kind() {
        let text = "layout(local_size_x = 8) in;\nlayout(binding = 0) buffer B { uint8_t x[]; };\n\
                    layout(binding = 1) buffer C { f16vec2 y[]; };\nvoid main() { y[0].x = float(x[0] & 3u); }\n";
        let found = of(text).unwrap();
        assert_eq!(Some(&found), pairs(&[("uint8_t", "uint"), ("f16vec2", "vec2")]).as_ref());
        assert!(assumption_note(&found).contains("places in buffers are others"));
        for (name, kind) in [("int16_t", "int"), ("float32_t", "float"), ("u8vec4", "uvec4"), ("i32vec3", "ivec3")] {
            assert_eq!(of_32_bits(name).as_deref(), Some(kind), "{name}");
        }
        for name in ["uint_t", "float16", "f16mat2", "vec2", "u8vec5", "i24vec2"] {
            assert_eq!(of_32_bits(name), None, "{name}");
        }
        assert_eq!(of(&text.replace("uint8_t", "uint64_t")), None, "no type of 32 bits holds that");
    }

    fn offer(name: &str, value: &str, statement: usize, named: bool) -> Offer {
        let (name, value, file) = (name.to_owned(), value.to_owned(), "host.cpp".to_owned());
        Offer { name, value, file, line: statement + 1, statement, named }
    }

    fn with(text: &str, all: &[Offer]) -> Option<Completed> {
        let file = SourceFile::new("k.comp", format!("#version 450\n{text}"));
        let mut offers = |names: &[String]| {
            let about = |offer: &&Offer| offer.named || names.iter().any(|name| macro_name(&offer.name) == name);
            all.iter().filter(about).cloned().collect()
        };
        completed(&|with| parsed(&file, with), &mut offers, &mut |_| Vec::new())
    }

    #[test]
    fn functions_of_several_arguments_are_taken_from_host_code() {
        let text = "layout(local_size_x = 8) in;\nlayout(binding = 0) buffer B { real4 x[]; };\n\
                    void main() { uint i = gl_GlobalInvocationID.x; store(x, i, load(x, i) * SCALE); }\n";
        // What gets a buffer alone is known by that.
        let access = [("load(from,at)", "(from[at])"), ("store(to,at,value)", "(to[at] = (value))")];
        let plain = [&[("real4", "float"), ("SCALE", "32")][..], &access].concat();
        assert_eq!(with(text, &[]).unwrap().assumed, pairs(&plain).unwrap());
        // What a definition needs itself is taken as well.
        let offers = [
            offer("real4", "vec4", 3, false),
            offer("real4", "uvec2", 1, false),
            offer("load(b,i)", "widened(b[i])", 4, false),
            offer("store(b,i,v)", "{b[i]=v;}", 5, false),
            offer("widened(v)", "vec4(v)", 6, false),
        ];
        let found = with(text, &offers).unwrap();
        let mut names: Vec<&str> = found.taken.iter().map(|offer| &*offer.name).collect();
        names.sort_unstable();
        assert_eq!(names, ["load(b,i)", "real4", "store(b,i,v)", "widened(v)"]);
        assert_eq!(found.assumed, pairs(&[("SCALE", "32")]).unwrap());
        let told = taken_notes(&found.taken);
        assert!(told[0].contains("`real4` at line 4") && told[0].contains("host.cpp"), "{told:?}");
        // Where the first value does not fit, others are tried.
        let swapped: Vec<Offer> = [1, 0, 2, 3, 4].map(|k| offers[k].clone()).to_vec();
        let found = with(text, &swapped).unwrap();
        assert!(found.taken.iter().any(|offer| offer.name == "real4" && offer.value == "vec4"), "{found:?}");
    }

    #[test]
    fn the_values_of_one_command_go_together() {
        let text = "layout(local_size_x = 8) in;\nlayout(binding = 0) buffer B { TYPE x[]; };\n\
                    void main() { uint i = gl_GlobalInvocationID.x; WIDE v = x[i]; x[i] = v.yx; }\n";
        let of = |k: usize, ty: &str, wide: &str| [offer("TYPE", ty, k, false), offer("WIDE", wide, k, false)];
        let offers = [of(0, "vec2", "vec2"), of(1, "float", "vec4"), of(2, "uint", "uvec2")].concat();
        let found = with(text, &offers).unwrap();
        assert_eq!(found.macros(), pairs(&[("TYPE", "vec2"), ("WIDE", "vec2")]).unwrap());
    }

    #[test]
    fn a_build_that_names_the_shader_is_taken_as_a_whole() {
        let text = "layout(local_size_x = 8) in;\nlayout(binding = 0) buffer B { TYPE x[]; };\n\
                    void main() { uint i = gl_GlobalInvocationID.x;\n#ifdef WIDE\nx[i].xy = x[i].yx;\n#else\n\
                    x[i].w = LIMIT;\n#endif\n}\n";
        let offers = [
            offer("TYPE", "float", 0, false),
            offer("TYPE", "vec2", 1, true),
            offer("WIDE", "1", 1, true),
            offer("OTHER", "1", 2, true),
        ];
        let found = with(text, &offers).unwrap();
        assert_eq!(found.macros(), pairs(&[("TYPE", "vec2"), ("WIDE", "1")]).unwrap());
    }

    #[test]
    fn slips_and_names_of_the_author_are_no_macros() {
        let around = |line: &str| {
            format!("layout(local_size_x = 8) in;\nbuffer B {{ float x[]; }};\nvoid main() {{ {line} }}\n")
        };
        assert_eq!(of(&around("float total = 1.0; x[0] = totl;")), pairs(&[]));
        assert_eq!(of(&around("x[0] = scale * 2.0;")), pairs(&[]));
        assert_eq!(of(&around("x[0] = 1.0;")), None);
        // What else is wrong stays wrong.
        assert_eq!(of(&around("x[0] = SCALE * vec2(1.0);")), None);
    }
}
