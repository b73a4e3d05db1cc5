//! From the text of a suite file to a [`Suite`].

mod dispatch;
mod expect;
mod laws;

use toml::de::DeTable;

use crate::catalogue;
use base::text::SourceFile;
use judge::verdict::Literals;
use program::Written;
use property::generators::{Ends, Generator, Options, RangeRule, Role, Strands};
use property::{InputGroup, Own};

use super::dispatch::SizedInput;
use super::expect::hint;
use super::textures::WORDS;
use super::{BoundTexture, Contents, Dispatching, Floors, GuessedInputs, Includes, Stage, Suite, SuiteError};
use disk::table::{At, Reader, Table};

const KEYS: [&str; 22] = [
    "suite",
    "title",
    "shader",
    "linked",
    "with",
    "assign_bindings",
    "stage",
    "entry",
    "formula",
    "reference",
    "recorded",
    "defines",
    "include",
    "samples",
    "per_case",
    "relations",
    "inputs",
    "floors",
    "literals",
    "textures",
    "strands",
    "dispatch",
];
const INPUT_KEYS: [&str; 6] = ["names", "generator", "range", "components", "values", "guessed"];
/// Largest numbers that are taken for intended: 2^32 samples, 2^20 invocations of a case.
const MOST_SAMPLES: u64 = 1 << 32;
const MOST_PER_CASE: u64 = 1 << 20;
/// Invocations of a case when a suite does not say.
const PER_CASE: u64 = 16;
/// Largest share of undetermined samples when a suite does not say.
pub(super) const UNDETERMINED: f64 = 0.05;
/// Samples when a suite does not say.
pub(super) const SAMPLES: u64 = 16384;
/// Dispatches of each size when a suite does not say.
pub(super) const DISPATCHES: u64 = 256;

/// Names that a suite may use.
#[derive(Clone, Debug)]
pub struct Names {
    /// Formulas.
    pub formulas: Vec<String>,
    /// Relations.
    pub relations: Vec<String>,
}

impl Names {
    /// The formulas and relations of this crate.
    pub fn built_in() -> Self {
        Self {
            formulas: catalogue::formulas().map(|f| f.name.to_owned()).collect(),
            relations: catalogue::relations().map(|r| r.name().to_owned()).collect(),
        }
    }
}

/// Reads the text of a suite file with one suite. Touches no other file: whether the shader exists and has these
/// inputs shows later.
///
/// # Errors
/// Everything that is wrong, each with `file:line:column`.
pub fn parse(file: &SourceFile) -> Result<Suite, SuiteError> {
    parse_with(file, &Names::built_in())
}

/// Reads the text of a suite file with any number of suites: the one of the whole file, or those of its tables
/// `[[suites]]`, which take from the top of the file what they do not say themselves.
///
/// # Errors
/// Everything that is wrong, each with `file:line:column`.
pub fn parse_all(file: &SourceFile) -> Result<Vec<Suite>, SuiteError> {
    let reader = Reader::new(file);
    let document = DeTable::parse(file.text()).ok().filter(|document| document.get_ref().contains_key(SUITES));
    let Some(document) = document else { return parse(file).map(|suite| vec![suite]) };
    let root = Table::root(&reader, document.get_ref());
    let tables = root.inheriting(SUITES, "[[suites]]");
    let names = Names::built_in();
    let mut suites: Vec<Suite> = Vec::new();
    for (table, offset) in &tables {
        let Some(suite) = suite(Table::inside_of(&reader, table, *offset), file, &names) else { continue };
        if suites.iter().any(|other| other.name == suite.name) {
            reader.problem(*offset, format!("the suite `{}` stands twice in this file", suite.name));
        }
        suites.push(suite);
    }
    if tables.is_empty() {
        reader.problem(root.offset_of(SUITES), "`suites` is empty; a file states at least one suite");
    }
    reader.finish(Some(suites), "the suites cannot be read").map_err(|problems| SuiteError { problems })
}

/// The key of a file with several suites.
pub(super) const SUITES: &str = "suites";

/// The same with other formulas and relations than those of this crate.
///
/// # Errors
/// Everything that is wrong, each with `file:line:column`.
pub fn parse_with(file: &SourceFile, names: &Names) -> Result<Suite, SuiteError> {
    let reader = Reader::new(file);
    let suite = match DeTable::parse(file.text()) {
        Ok(document) => suite(Table::root(&reader, document.get_ref()), file, names),
        Err(error) => {
            let message = error.message().trim_end().replace('\n', "; ");
            reader.problem(error.span().map_or(0, |s| s.start), format!("not TOML: {message}"));
            None
        }
    };
    reader.finish(suite, "the suite cannot be read").map_err(|problems| SuiteError { problems })
}

fn suite(root: Table<'_>, file: &SourceFile, names: &Names) -> Option<Suite> {
    if root.has("tolerance") {
        let message = "a suite states no tolerance: what a lane may be off follows from the shader; remove the table";
        root.reader.problem(root.offset_of("tolerance"), message);
        return None;
    }
    let root = root.only(&KEYS);
    let name = suite_name(root);
    let title = root.text("title");
    let shader = root.required_text("shader", "shader = \"sphere.vert\"");
    let linked = root.texts("linked");
    let (with, assign_bindings) = composed(root, shader.as_ref().map(|shader| shader.value.as_str()));
    let stage = stage(root);
    let modules = shader.as_ref().is_some_and(|shader| Written::of_path(&shader.value) != Written::Glsl);
    let mut entries = entries(root, stage, modules);
    let entry = if entries.len() == 1 { entries.pop() } else { None };
    let expect = expect::expect(root, names, stage);
    let defines = expect::defines(root);
    let include = root.texts("include").into_iter().map(|folder| folder.value.into()).collect();
    let usual = if stage == Some(Stage::Compute) { DISPATCHES } else { SAMPLES };
    let samples = if root.has("samples") { root.whole("samples", 1, MOST_SAMPLES) } else { Some(usual) };
    let per_case = root.whole("per_case", 1, MOST_PER_CASE);
    let (relations, laws) = laws::relations(root, names);
    let floors = floors(root, samples);
    let literals = literals(root);
    let textures = textures(root);
    let strands = strands(root, stage);
    let mut dispatch = dispatch::dispatch(root, stage);
    let (inputs, guessed) = inputs(root, strands, dispatch.as_mut());
    if root.has("strands") && inputs.iter().all(|group| group.generator.role() != Role::Strand) {
        let takers = catalogue::generators().filter(|generator| generator.role() == Role::Strand);
        let takers: Vec<String> = takers.map(|generator| format!("{:?}", generator.name())).collect();
        let message =
            format!("[strands] has no effect without an [[inputs]] group with generator = {}", takers.join(" or "));
        root.reader.problem(root.offset_of("strands"), message);
    }
    Some(Suite {
        title: title.map_or_else(|| name.clone().unwrap_or_default(), |title| title.value),
        name: name?,
        shader: shader?.value,
        linked: linked.into_iter().map(|name| name.value).collect(),
        linked_texts: Vec::new(),
        with: with.into_iter().map(|name| name.value).collect(),
        with_texts: Vec::new(),
        assign_bindings,
        stage: stage?,
        entry,
        entries,
        expect,
        defines,
        chosen: Vec::new(),
        samples: samples?,
        per_case: per_case.unwrap_or(PER_CASE) as usize,
        relations,
        laws,
        inputs,
        guessed,
        floors: floors?,
        literals: literals?,
        textures,
        strands,
        dispatch: dispatch.unwrap_or_default(),
        includes: Includes::of_suite(include),
        file: file.clone(),
    })
}

/// The name when it is one of `all`; else a problem with a suggestion.
fn known<'n>(
    table: Table<'_>,
    what: &str,
    given: &At<String>,
    all: impl Iterator<Item = &'n str> + Clone,
) -> Option<String> {
    if all.clone().any(|name| name == given.value) {
        return Some(given.value.clone());
    }
    table.reader.problem(given.offset, format!("unknown {what} `{}`; {}", given.value, hint(&given.value, all)));
    None
}

/// Names of functions and inputs as they may be; a line break in one would be one in every message.
fn named(table: Table<'_>, names: Vec<At<String>>) -> Vec<At<String>> {
    let (odd, good): (Vec<_>, Vec<_>) = names.into_iter().partition(|name| name.value.contains(char::is_control));
    for name in odd {
        table.reader.problem(name.offset, format!("`{}` is no name: it has a control character", name.value));
    }
    good
}

fn suite_name(root: Table<'_>) -> Option<String> {
    let name = root.required_text("suite", "suite = \"sphere\"")?;
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if name.value.chars().all(fits) {
        return Some(name.value);
    }
    let message = format!("suite name `{}` may hold lower case letters, digits and `_` only", name.value);
    root.reader.problem(name.offset, message);
    None
}

fn stage(root: Table<'_>) -> Option<Stage> {
    let given = root.required_text("stage", "stage = \"vertex\"")?;
    let name = known(root, "stage", &given, Stage::ALL.into_iter().map(Stage::name))?;
    Stage::ALL.into_iter().find(|stage| stage.name() == name)
}

/// The function that is called, or several of them. Of a text with several entry points, the one that is run.
fn entries(root: Table<'_>, stage: Option<Stage>, modules: bool) -> Vec<String> {
    match stage {
        None => Vec::new(),
        Some(Stage::Function) if root.has("entry") && !root.is_text("entry") => {
            let names = named(root, root.texts("entry"));
            if names.is_empty() {
                root.reader.problem(root.offset_of("entry"), "`entry` names no function");
            }
            names.into_iter().map(|name| name.value).collect()
        }
        Some(Stage::Function) => {
            let name = root.required_text("entry", "entry = \"segment_distance\"");
            named(root, name.into_iter().collect()).into_iter().map(|name| name.value).collect()
        }
        Some(Stage::Vertex | Stage::Fragment | Stage::Compute) if modules => {
            let name = if root.has("entry") { root.text("entry") } else { None };
            named(root, name.into_iter().collect()).into_iter().map(|name| name.value).collect()
        }
        Some(other @ (Stage::Vertex | Stage::Geometry | Stage::Fragment | Stage::Compute)) => {
            if root.has("entry") {
                let message = format!("`entry` names a function; the stage `{}` starts at main", other.name());
                root.reader.problem(root.offset_of("entry"), message);
            }
            Vec::new()
        }
    }
}

/// What is stated about a text in WGSL that is a part of others.
fn composed(root: Table<'_>, shader: Option<&str>) -> (Vec<At<String>>, bool) {
    for key in ["with", "assign_bindings"] {
        if root.has(key) && shader.is_some_and(|shader| Written::of_path(shader) != Written::Wgsl) {
            root.reader.problem(root.offset_of(key), format!("`{key}` is for a shader in WGSL"));
        }
    }
    (root.texts("with"), root.has("assign_bindings") && root.flag("assign_bindings").unwrap_or_default())
}

fn literals(root: Table<'_>) -> Option<Literals> {
    if !root.has("literals") {
        return Some(Literals::default());
    }
    let given = root.text("literals")?;
    let name = known(root, "reading of literals", &given, Literals::NAMES.into_iter())?;
    Literals::by_name(&name)
}

fn floors(root: Table<'_>, samples: Option<u64>) -> Option<Floors> {
    if !root.has("floors") {
        return Some(Floors::default_for(samples?));
    }
    let table = root.table("floors", "[floors]")?.only(&["judged", "undetermined", "reason"]);
    let judged = table.whole("judged", 1, MOST_SAMPLES);
    if let (Some(judged), Some(samples)) = (judged, samples)
        && judged > samples
    {
        let message = format!("`judged` is {judged}, but the suite has {samples} samples only");
        table.reader.problem(table.offset_of("judged"), message);
    }
    let undetermined = table.number("undetermined");
    if let Some(At { value, offset }) = undetermined.as_ref()
        && !(0.0..=1.0).contains(value)
    {
        table.reader.problem(*offset, format!("`undetermined` is {value}; a share is from 0 to 1"));
    }
    let share = undetermined.as_ref().map_or(UNDETERMINED, |u| u.value);
    let reason = table.text("reason").map_or_else(String::new, |reason| reason.value);
    if let (Some(At { offset, .. }), true) = (undetermined, share > UNDETERMINED && reason.trim().is_empty()) {
        let message =
            format!("`undetermined` is above {UNDETERMINED}; say why: reason = \"sin has no promise beyond pi\"");
        table.reader.problem(offset, message);
    }
    if table.has("judged") && judged.is_none() {
        return None;
    }
    let required = Floors { undetermined: share.clamp(0.0, 1.0), ..Floors::default_for(samples?) }.required(samples?);
    Some(Floors { judged: judged.unwrap_or(required), undetermined: share, reason })
}

fn strands(root: Table<'_>, stage: Option<Stage>) -> Option<Strands> {
    let table = root.table("strands", "[strands]")?.only(&["nodes", "ends"]);
    if let Some(stage @ (Stage::Vertex | Stage::Fragment | Stage::Compute | Stage::Function)) = stage {
        let message = format!("[strands] feed a geometry stage; this suite has the stage `{}`", stage.name());
        table.reader.problem(table.offset, message);
    }
    let nodes = table.required_whole("nodes", 4, MOST_PER_CASE, "nodes = 8");
    let given = table.required_text("ends", "ends = \"repeat\"")?;
    let ends = match known(table, "ends", &given, ["repeat", "as-drawn"].into_iter())?.as_str() {
        "repeat" => Ends::Repeat,
        _ => Ends::AsDrawn,
    };
    Some(Strands { nodes: nodes? as usize, ends })
}

/// `[textures]`: a word, a file, or four numbers for each sampler.
fn textures(root: Table<'_>) -> Vec<BoundTexture> {
    let Some(table) = root.table("textures", "[textures]") else { return Vec::new() };
    let mut all = Vec::new();
    for At { value: sampler, offset } in table.keys() {
        let at = table.reader.locate(offset);
        let contents = if table.is_text(sampler) {
            let Some(At { value, offset }) = table.text(sampler) else { continue };
            match value.as_str() {
                "procedural" => Contents::Procedural,
                "checker" => Contents::Checker,
                file if file.to_ascii_lowercase().ends_with(".png") => Contents::File { name: value, picture: None },
                other => {
                    let hint = hint(other, WORDS.into_iter());
                    table
                        .reader
                        .problem(offset, format!("`{other}` is no .png file and no word for a texture; {hint}"));
                    continue;
                }
            }
        } else {
            let numbers = table.numbers(sampler);
            let offset = table.offset_of(sampler);
            let &[r, g, b, a] = numbers.as_slice() else {
                let message =
                    format!("`{sampler}` is a text or four numbers, such as \"checker\" or [1.0, 0.5, 0.0, 1.0]");
                table.reader.problem(offset, message);
                continue;
            };
            let channels = [r, g, b, a].map(|n| n as f32);
            if channels.iter().any(|n| !n.is_finite()) {
                table.reader.problem(offset, format!("{numbers:?} are not finite in binary32"));
            }
            Contents::Constant(channels)
        };
        all.push(BoundTexture { sampler: sampler.to_owned(), contents, at });
    }
    all
}

/// The groups of inputs, and which of them are guessed.
fn inputs(
    root: Table<'_>,
    strands: Option<Strands>,
    mut dispatch: Option<&mut Dispatching>,
) -> (Vec<InputGroup>, Vec<GuessedInputs>) {
    let mut groups: Vec<InputGroup> = Vec::new();
    let mut guessed: Vec<GuessedInputs> = Vec::new();
    for table in root.tables("inputs", "[[inputs]]") {
        let Some((group, mut sized)) = input(table.only(&INPUT_KEYS), strands, dispatch.as_deref()) else { continue };
        if table.has("guessed") && table.flag("guessed").unwrap_or_default() {
            let at = table.reader.locate(table.offset_of("guessed"));
            guessed.push(GuessedInputs { names: group.names.clone(), at });
        }
        if let Some(dispatch) = dispatch.as_mut().filter(|_| !(sized.values.is_empty() && sized.range.is_empty())) {
            sized.group = groups.len();
            dispatch.inputs.push(sized);
        }
        for name in &group.names {
            if groups.iter().any(|g| g.names.contains(name)) {
                table.reader.problem(table.offset_of("names"), format!("the input `{name}` is filled already"));
            }
        }
        groups.push(group);
    }
    (groups, guessed)
}

fn input(
    table: Table<'_>,
    strands: Option<Strands>,
    dispatch: Option<&Dispatching>,
) -> Option<(InputGroup, SizedInput)> {
    if !table.has("names") {
        table.missing("names", "names = [\"position\"]");
    }
    let names: Vec<String> = named(table, table.texts("names")).into_iter().map(|name| name.value).collect();
    if table.has("names") && names.is_empty() {
        table.reader.problem(table.offset_of("names"), "`names` is empty; a group fills at least one input");
    }
    let generator = table.required_text("generator", "generator = \"point\"");
    let generator = generator.and_then(|given| {
        let name = known(table, "generator", &given, catalogue::generators().map(Generator::name))?;
        catalogue::generator(&name)
    });
    let (ends, sized_range) = dispatch::numbers(table, "range", dispatch);
    let range = range(table, ends);
    if let Some(generator) = generator {
        fits(table, generator);
    }
    let components = table.whole("components", 1, 4).map(|n| n as u8);
    let (values, sized_values) = dispatch::numbers(table, "values", dispatch);
    let options = Options { range, values, components, strands };
    let at = table.reader.locate(table.offset_of("names"));
    let names = Some(names).filter(|n| !n.is_empty())?;
    let group = InputGroup { names, generator: Own::Static(generator?), options, at };
    Some((group, SizedInput { group: 0, values: sized_values, range: sized_range }))
}

/// Notes keys that the generator wants and lacks, or has no use for. Whether the values fit the
/// inputs shows when the shader is known.
fn fits(table: Table<'_>, generator: &dyn Generator) {
    let name = generator.name();
    let range = generator.range();
    let no = |key: &str| {
        table.reader.problem(table.offset_of(key), format!("generator `{name}` takes no `{key}`"));
    };
    if table.has("range") && range == RangeRule::None {
        no("range");
    }
    if !table.has("range") && range == RangeRule::Required {
        table.missing("range", "range = [0.0, 1.0]");
    }
    if table.has("components") && !generator.takes_components() {
        no("components");
    }
    match (table.has("values"), generator.takes_values()) {
        (true, false) => no("values"),
        (false, true) => table.missing("values", "values = [1.0]"),
        (true, true) | (false, false) => {}
    }
}

/// The range of a group of inputs or a law, by the numbers that stand there.
fn range(table: Table<'_>, numbers: Vec<f64>) -> Option<[f64; 2]> {
    if !table.has("range") {
        return None;
    }
    let offset = table.offset_of("range");
    let &[lo, hi] = numbers.as_slice() else {
        table.reader.problem(offset, "`range` is [lo, hi], two numbers");
        return None;
    };
    if !((lo as f32).is_finite() && (hi as f32).is_finite()) {
        table.reader.problem(offset, format!("range [{lo}, {hi}] is not finite in binary32"));
        return None;
    }
    if hi < lo {
        table.reader.problem(offset, format!("range [{lo}, {hi}] has its upper end below its lower end"));
        return None;
    }
    Some([lo, hi])
}
