//! Every key of a suite file: its manual page, and the JSON Schema that editors use. Both come from one
//! table, and a test holds it against what is read.

use std::fmt::Write;

use serde_json::{Map, Value, json};

use super::parse::SUITES;
use crate::catalogue;
use judge::verdict::Literals;
use property::generators::Generator;
use property::law::LawKind;

/// What a value may be.
#[derive(Clone, Copy, Debug)]
pub(super) enum KeyForm {
    Text,
    Texts,
    TextOrTexts,
    Whole {
        least: i64,
        most: i64,
    },
    Number,
    /// Numbers or texts, or one of them.
    Words,
    /// Names with numbers or texts.
    Counts(&'static str),
    Range,
    Numbers,
    Flag,
    OneOf(fn() -> Vec<&'static str>),
    /// A text with a file, or a table of this title.
    FileOr(&'static str),
    Table(&'static str),
    Tables(&'static str),
    /// Names of relations, and laws.
    Relations,
    /// Macros with their values.
    Macros,
    /// Samplers with their textures.
    Textures,
}

pub(super) struct Key {
    pub name: &'static str,
    pub form: KeyForm,
    pub required: bool,
    pub about: &'static str,
}

/// A table of keys: its title as people write it, and what it is.
pub(super) struct Section {
    pub title: &'static str,
    pub about: &'static str,
    pub keys: &'static [Key],
}

const fn key(name: &'static str, form: KeyForm, about: &'static str) -> Key {
    Key { name, form, required: false, about }
}

const fn required(name: &'static str, form: KeyForm, about: &'static str) -> Key {
    Key { name, form, required: true, about }
}

fn stages() -> Vec<&'static str> {
    super::Stage::ALL.into_iter().map(super::Stage::name).collect()
}

fn formulas() -> Vec<&'static str> {
    catalogue::formulas().map(|f| f.name).collect()
}

fn generator_names() -> Vec<&'static str> {
    catalogue::generators().map(Generator::name).collect()
}

fn literals() -> Vec<&'static str> {
    Literals::NAMES.to_vec()
}

fn laws() -> Vec<&'static str> {
    LawKind::NAMES.to_vec()
}

fn directions() -> Vec<&'static str> {
    vec!["rising", "falling"]
}

fn ends() -> Vec<&'static str> {
    vec!["repeat", "as-drawn"]
}

const WHOLE: i64 = 1 << 32;

/// All tables, in the order of the manual.
pub(super) const SECTIONS: &[Section] = &[
    Section {
        title: "",
        about: "A suite file is called NAME.suite.toml and lies beside its shader.",
        keys: &[
            required("suite", KeyForm::Text, "Name: lower case letters, digits and `_`."),
            key("title", KeyForm::Text, "What is tested, in a few words."),
            required(
                "shader",
                KeyForm::Text,
                "The shader, relative to this file. Elsewhere than beside it, only a file with the ending of a shader is \
                 read.",
            ),
            key(
                "linked",
                KeyForm::Texts,
                "Other texts of the same stage, relative to this file: what the shader declares and they define is \
                 linked as OpenGL does.",
            ),
            key(
                "with",
                KeyForm::Texts,
                "For a shader in WGSL: files that the host puts before it, relative to this one. What the shader does not \
                 declare is taken from them.",
            ),
            key(
                "assign_bindings",
                KeyForm::Flag,
                "For a shader in WGSL: give its resources a group and a binding where none of them has one, as its host \
                 does; false without it.",
            ),
            required("stage", KeyForm::OneOf(stages), "What is run: `main` of a stage, or one function."),
            key(
                "entry",
                KeyForm::TextOrTexts,
                "The function that is called; for `stage = \"function\"`. A list runs several: each takes the inputs that \
                 are its parameters. For another stage, the entry point of a .wgsl that has several of the stage.",
            ),
            key("formula", KeyForm::OneOf(formulas), "Expected outputs: a formula that comes with shadercheck."),
            key(
                "reference",
                KeyForm::FileOr("[reference]"),
                "Expected outputs: what another shader means in binary64. A file alone stands for the same stage, or \
                 the function of the same name: the shader as it was, a slow one that is right; of a .wgsl, a function. \
                 Without `#version`, it is read under the version that fits what it uses.",
            ),
            key(
                "recorded",
                KeyForm::FileOr("[recorded]"),
                "Expected outputs: a file of recorded values, .csv, .json or .npz. The first line of a .csv names components \
                 of inputs and outputs (`x`, `p.y`, `m[3][0]`, `return`; `out p` for what is both), a .json is a list \
                 of objects. Values are decimal, or the bits of a binary32 as 0x3f800000. A .npz has an array for each \
                 variable, `expected.p` for an output; `sum_{N}.npz` is a file for each value of the size `N`.",
            ),
            key(
                "relations",
                KeyForm::Relations,
                "What holds between outputs: names of relations that come with shadercheck, and laws in tables.",
            ),
            key(
                "defines",
                KeyForm::Macros,
                "Macros, each with a value or a list of values: every combination is run. `true` defines a macro as 1, \
                 `false` leaves it undefined.",
            ),
            key(
                "include",
                KeyForm::Texts,
                "Folders, from the suite file on, in which files are looked for that the shader includes. Those beside \
                 the file that includes them are found without it. From elsewhere than the folder of the shader, only \
                 files with the ending of a shader or of a part of one (.glsl, .inc, .h) are read.",
            ),
            key("samples", KeyForm::Whole { least: 1, most: WHOLE }, "Inputs that are made; 16384 without it."),
            key(
                "per_case",
                KeyForm::Whole { least: 1, most: 1 << 20 },
                "Invocations that share one set of uniforms; 16 without it.",
            ),
            key(
                "inputs",
                KeyForm::Tables("[[inputs]]"),
                "What fills the inputs: every attribute, uniform and parameter.",
            ),
            key("floors", KeyForm::Table("[floors]"), "What a run must reach, so that its success means something."),
            key(
                "literals",
                KeyForm::OneOf(literals),
                "What is made of literals that are known constants in few digits, such as 3.141593 for π. \"meant\", as \
                 without it: where the shader deviates with the digits that are written, it is judged with the constant, \
                 and the literal is a warning; with fewer than 6 digits only where that moves no output farther than a \
                 conforming device may. \"exact\": every literal counts as it is written.",
            ),
            key(
                "textures",
                KeyForm::Textures,
                "What samplers are bound to, by their names in the shader (`\"material.map\"`, `\"maps[1]\"`): \"procedural\" \
                 (texels that all differ, as without this), \"checker\", a .png file beside this one (its first row is at \
                 0), or four numbers that every texel holds. Textures have one level, the nearest texel is taken, and \
                 coordinates are clamped to the edge.",
            ),
            key("strands", KeyForm::Table("[strands]"), "Strands of nodes that a geometry stage sees four at a time."),
            key("dispatch", KeyForm::Table("[dispatch]"), "How a compute stage is dispatched; needed for it."),
        ],
    },
    Section {
        title: "[dispatch]",
        about: "How a compute stage is dispatched. One sample is a whole dispatch: its inputs are what all buffers hold \
                before, and its outputs what those hold behind it that are written. Numbers may be expressions of sizes: \
                `\"(N + 63) / 64\"`.",
        keys: &[
            required("groups", KeyForm::Words, "Workgroups along x, y and z; 1 along axes that are left out."),
            key(
                "lengths",
                KeyForm::Counts("[dispatch.lengths]"),
                "Elements of the arrays that are as long as their buffers, by the name of the buffer.",
            ),
            key(
                "sizes",
                KeyForm::Counts("[dispatch.sizes]"),
                "Names of sizes with the values that they take, as a list, or as a range of which the awkward ones are \
                 taken: { from = 1, to = 300 }. Every combination is run, and the reference gets sizes as macros.",
            ),
        ],
    },
    Section {
        title: "[[suites]]",
        about: "Several suites in one file, each with the keys above and below: `[[suites.inputs]]`, `[suites.floors]`. What one \
                does not say itself, such as `shader`, it takes from the top of the file. `check FILE[NAME]` runs one of them.",
        keys: &[],
    },
    Section {
        title: "[[inputs]]",
        about: "A group of inputs that one generator fills. Uniforms are inputs like all others: a fixed one has the \
                generator `constant`. Numbers of the draw (`gl_VertexID`, `gl_InstanceID`, `gl_PrimitiveIDIn`, …) are \
                inputs too; without a group they are whole numbers from 0 that no array of the shader is too short for.",
        keys: &[
            required("names", KeyForm::Texts, "Names in the shader, in the order in which the generator takes them."),
            required("generator", KeyForm::OneOf(generator_names), "How values are made."),
            key(
                "range",
                KeyForm::Range,
                "Smallest and largest value; of a compute stage, also whole numbers by sizes: `[0, \"N - 1\"]`.",
            ),
            key(
                "values",
                KeyForm::Numbers,
                "For `constant`: one number for all components, or one for each; of a compute stage, also whole numbers by \
                 sizes: `[\"N\"]`.",
            ),
            key(
                "components",
                KeyForm::Whole { least: 1, most: 4 },
                "Floats that the host feeds to an attribute; the rest is filled from (0, 0, 0, 1).",
            ),
            key(
                "guessed",
                KeyForm::Flag,
                "`true` where these values are a guess, as in suites that `init` writes: an undefined value that comes of them \
                 is a warning. Delete the line once they are what programs give.",
            ),
        ],
    },
    Section {
        title: "[reference]",
        about: "A shader that says what is right.",
        keys: &[
            required("file", KeyForm::Text, "The file, relative to this one."),
            key("function", KeyForm::Text, "The function that is called. Its parameters are found by their names."),
            key("output", KeyForm::Text, "The output that the value of the function stands for; needed for several."),
            key(
                "groups",
                KeyForm::Words,
                "Of a compute stage, its workgroups along x, y and z; those of the suite without it. A plain loop over the \
                 buffers has one workgroup of one invocation: `groups = 1`.",
            ),
        ],
    },
    Section {
        title: "[recorded]",
        about: "Recorded values, and how exact they are.",
        keys: &[
            required("file", KeyForm::Text, "The file, relative to this one."),
            key(
                "relative_error",
                KeyForm::Number,
                "How far recorded values may be from true ones, as a part of the largest component; 2^-24 without \
                 it, which is rounding to binary32 and nothing else.",
            ),
            key("absolute_error", KeyForm::Number, "A number that is added to that; 0 without it."),
        ],
    },
    Section {
        title: "[[relations]]",
        about: "A law: a relation that holds for any shader of its kind, by the names of inputs and outputs. The same \
                as a table in the list `relations`.",
        keys: &[
            required("kind", KeyForm::OneOf(laws), "What is claimed; see below."),
            key(
                "outputs",
                KeyForm::Texts,
                "Outputs that it is about (`return` for the value of a function); all without it.",
            ),
            key(
                "inputs",
                KeyForm::Texts,
                "Inputs that it is about; for all kinds but `range`, `unit`, `rigid` and `sums`.",
            ),
            key("period", KeyForm::Number, "For `periodic`: a real number, with as many digits as it has."),
            key("direction", KeyForm::OneOf(directions), "For `monotone`, and for `sorts`: rising without it."),
            key("range", KeyForm::Range, "For `range`: both ends belong to it."),
            key("points", KeyForm::Texts, "For `rigid`: inputs and outputs that are points, and move with the motion."),
            key("directions", KeyForm::Texts, "For `rigid`: inputs and outputs that are directions, and turn with it."),
            key("mirrored", KeyForm::Flag, "For `rigid`: whether mirror images count; false without it."),
            key("degree", KeyForm::Whole { least: -8, most: 8 }, "For `scales`: the power."),
            key("total", KeyForm::Number, "For `sums`: what elements add up to."),
            key(
                "rows",
                KeyForm::Whole { least: 1, most: 1 << 20 },
                "For `sums`: equal rows of the array; 1 without it.",
            ),
        ],
    },
    Section {
        title: "[floors]",
        about: "A run that judges too little fails.",
        keys: &[
            key(
                "judged",
                KeyForm::Whole { least: 1, most: WHOLE },
                "Samples that must be judged of a full run; what `undetermined` leaves without it.",
            ),
            key("undetermined", KeyForm::Number, "Share of samples that may be inconclusive; 0.05 without it."),
            key("reason", KeyForm::Text, "Why more than 0.05 may."),
        ],
    },
    Section {
        title: "[strands]",
        about: "For a geometry stage on lines with adjacency, with a generator of the nodes of strands.",
        keys: &[
            required("nodes", KeyForm::Whole { least: 4, most: 1 << 20 }, "Nodes of a strand."),
            required("ends", KeyForm::OneOf(ends), "Whether the host repeats the nodes at the ends."),
        ],
    },
];

/// What each law claims, for the manual.
const LAWS: &[(&str, &str)] = &[
    ("odd", "changing the sign of `inputs` changes the sign of the outputs: f(-x) = -f(x)"),
    ("even", "changing the sign of `inputs` changes nothing: f(-x) = f(x)"),
    ("periodic", "`period` added to `inputs` changes nothing: f(x + p) = f(x)"),
    ("monotone", "the outputs do not fall (or do not grow) where the input grows"),
    ("range", "every component of the outputs lies in `range`"),
    ("unit", "the outputs, vectors of floats, have length one"),
    ("symmetric", "exchanging `inputs` changes nothing: f(a, b) = f(b, a)"),
    ("rigid", "turning and shifting `points` and turning `directions` moves outputs named there, and no other"),
    ("scales", "inputs times k give outputs times k to the power of `degree`: f(kx) = k^n f(x)"),
    ("unordered", "the order of the elements of `inputs`, arrays, changes nothing: a sum, a histogram"),
    ("prefix", "the first k elements of output arrays depend on the first k elements of `inputs` alone: a scan"),
    ("sorts", "the outputs are the elements of the array `inputs`, in ascending order or the one of `direction`"),
    ("sums", "the elements of each output, or of each of its `rows`, add up to `total`: a softmax"),
    ("additive", "the outputs of a sum of `inputs` are the sum of the outputs: f(x + y) = f(x) + f(y)"),
];

/// The manual page of suite files.
pub fn page() -> String {
    let mut text = String::from("Suite files\n");
    for section in SECTIONS {
        let title = if section.title.is_empty() { "Top level" } else { section.title };
        let _ = write!(text, "\n{title}\n{}\n\n", wrapped(section.about, 2));
        for Key { name, form, required, about } in section.keys {
            let needed = if *required { ", required" } else { "" };
            let _ = writeln!(text, "  {name}: {}{needed}\n{}", named(*form), wrapped(about, 6));
        }
    }
    text.push_str("\nKinds of laws\n");
    for (name, about) in LAWS {
        let _ = writeln!(text, "  {name}\n{}", wrapped(about, 6));
    }
    text.push_str("\nGenerators\n");
    for generator in catalogue::generators() {
        let _ = writeln!(text, "  {}\n{}", generator.name(), wrapped(generator.about(), 6));
    }
    text
}

fn named(form: KeyForm) -> String {
    match form {
        KeyForm::Text => "text".to_owned(),
        KeyForm::Texts => "list of texts".to_owned(),
        KeyForm::TextOrTexts => "text, or a list of texts".to_owned(),
        KeyForm::Whole { least, most } => format!("whole number from {least} to {most}"),
        KeyForm::Number => "number".to_owned(),
        KeyForm::Words => "number or text, or a list of them".to_owned(),
        KeyForm::Counts(title) => format!("table {title} of numbers, texts and lists of them"),
        KeyForm::Range => "[lo, hi]".to_owned(),
        KeyForm::Numbers => "list of numbers".to_owned(),
        KeyForm::Flag => "true or false".to_owned(),
        KeyForm::OneOf(names) if names().len() > 6 => "text, one of a list".to_owned(),
        KeyForm::OneOf(names) => names().iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", "),
        KeyForm::FileOr(title) => format!("text, or a table {title}"),
        KeyForm::Table(title) => format!("table {title}"),
        KeyForm::Tables(title) => format!("tables {title}"),
        KeyForm::Relations => "list of texts and tables [[relations]]".to_owned(),
        KeyForm::Textures => "table [textures] of texts and lists of four numbers".to_owned(),
        KeyForm::Macros => "table [defines] of texts, numbers, true, false, and lists of them".to_owned(),
    }
}

/// Text in lines of 96 characters at most, each moved in by so many.
fn wrapped(text: &str, indent: usize) -> String {
    let pad = " ".repeat(indent);
    let mut lines = vec![pad.clone()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        if lines[last].chars().count() + 1 + word.chars().count() > 96 && lines[last] != pad {
            lines.push(pad.clone());
        }
        let line = lines.last_mut().expect("there is a first line");
        if *line != pad {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.join("\n")
}

/// The JSON Schema (2020-12) of suite files.
pub fn schema() -> Value {
    let mut root = object(&SECTIONS[0]);
    // One of several takes from the top of the file what it does not say itself, so that what belongs together may stand apart.
    let mut part = root.clone();
    part.insert("required".into(), json!(["suite"]));
    part.remove("allOf");
    let required = root.remove("required");
    let alone = json!({ "if": { "not": { "required": [SUITES] } }, "then": { "required": required } });
    if let Some(Value::Object(properties)) = root.get_mut("properties") {
        let about = section("[[suites]]").about.split_whitespace().collect::<Vec<_>>().join(" ");
        let list = json!({ "type": "array", "minItems": 1, "items": part, "description": about });
        properties.insert(SUITES.into(), list);
    }
    let rules = root.remove("allOf");
    let together = json!({ "if": { "not": { "required": [SUITES] } }, "then": { "allOf": rules } });
    root.insert("allOf".into(), json!([alone, together]));
    root.insert("$schema".into(), "https://json-schema.org/draft/2020-12/schema".into());
    root.insert("title".into(), "Suite of shadercheck".into());
    Value::Object(root)
}

fn section(title: &str) -> &'static Section {
    // The titles are those of the table above; a test looks each of them up.
    SECTIONS.iter().find(|section| section.title == title).unwrap_or(&SECTIONS[0])
}

fn object(section: &Section) -> Map<String, Value> {
    let property = |key: &Key| {
        let mut value = of(key.form);
        value["description"] = key.about.split_whitespace().collect::<Vec<_>>().join(" ").into();
        (key.name.to_owned(), value)
    };
    let properties: Map<String, Value> = section.keys.iter().map(property).collect();
    let required: Vec<&str> = section.keys.iter().filter(|key| key.required).map(|key| key.name).collect();
    let mut object = Map::new();
    object.insert("type".into(), "object".into());
    object.insert("properties".into(), Value::Object(properties));
    object.insert("required".into(), required.into());
    object.insert("additionalProperties".into(), false.into());
    if section.title.is_empty() {
        // One expectation at most, and an entry for functions alone.
        let both = |a: &str, b: &str| json!({ "not": { "required": [a, b] } });
        let function = json!({ "properties": { "stage": { "const": "function" } } });
        // A text in GLSL has one entry point, `main`.
        let endings = "\\.(wgsl|wesl|spv|spvasm)$";
        let main = json!({ "properties": {
            "stage": { "not": { "const": "function" } }, "shader": { "not": { "pattern": endings } },
        } });
        object.insert(
            "allOf".into(),
            json!([
                both("formula", "reference"),
                both("formula", "recorded"),
                both("reference", "recorded"),
                { "if": function, "then": { "required": ["entry"] } },
                { "if": main, "then": { "not": { "required": ["entry"] } } }
            ]),
        );
    }
    object
}

fn of(form: KeyForm) -> Value {
    let text = || json!({ "type": "string", "minLength": 1 });
    let table = |title: &str| Value::Object(object(section(title)));
    // Or an expression of sizes.
    let number = json!({ "type": ["number", "string"] });
    match form {
        KeyForm::Text => text(),
        KeyForm::Texts => json!({ "type": "array", "items": text(), "uniqueItems": true }),
        KeyForm::TextOrTexts => {
            json!({ "anyOf": [text(), { "type": "array", "items": text(), "minItems": 1, "uniqueItems": true }] })
        }
        KeyForm::Whole { least, most } => json!({ "type": "integer", "minimum": least, "maximum": most }),
        KeyForm::Number => json!({ "type": "number" }),
        KeyForm::Words => {
            let word = json!({ "type": ["string", "integer"] });
            json!({ "anyOf": [word, { "type": "array", "items": word, "minItems": 1 }] })
        }
        KeyForm::Counts(_) => {
            let word = json!({ "type": ["string", "integer"] });
            let whole = json!({ "type": "integer", "minimum": 0 });
            let range = json!({
                "type": "object", "properties": { "from": whole, "to": whole }, "required": ["from", "to"],
                "additionalProperties": false,
            });
            json!({
                "type": "object",
                "additionalProperties": { "anyOf": [word, { "type": "array", "items": word, "minItems": 1 }, range] },
            })
        }
        KeyForm::Range => json!({ "type": "array", "items": number, "minItems": 2, "maxItems": 2 }),
        KeyForm::Numbers => json!({ "type": "array", "items": number }),
        KeyForm::Flag => json!({ "type": "boolean" }),
        KeyForm::OneOf(names) => json!({ "enum": names() }),
        KeyForm::FileOr(title) => json!({ "anyOf": [text(), table(title)] }),
        KeyForm::Table(title) => table(title),
        KeyForm::Tables(title) => json!({ "type": "array", "items": table(title) }),
        KeyForm::Relations => {
            let names: Vec<&str> = catalogue::relations().map(|relation| relation.name()).collect();
            json!({ "type": "array", "items": { "anyOf": [{ "enum": names }, table("[[relations]]")] } })
        }
        KeyForm::Textures => {
            let numbers = json!({ "type": "array", "items": { "type": "number" }, "minItems": 4, "maxItems": 4 });
            let file = json!({ "type": "string", "pattern": "\\.[pP][nN][gG]$" });
            let words = json!({ "enum": super::textures::WORDS });
            json!({ "type": "object", "additionalProperties": { "anyOf": [words, file, numbers] } })
        }
        KeyForm::Macros => {
            let word = json!({ "type": ["string", "number", "boolean"] });
            let list = json!({ "type": "array", "items": word, "minItems": 1, "uniqueItems": true });
            json!({ "type": "object", "additionalProperties": { "anyOf": [word, list] } })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::suite::parse;
    use base::text::SourceFile;

    /// The keys that the reader lists when it meets one that it does not know.
    fn known(text: &str) -> Vec<String> {
        let error = parse(&SourceFile::new("a.suite.toml", text)).unwrap_err().to_string();
        let list = error.split("known keys are ").nth(1).unwrap_or_else(|| panic!("{error}"));
        let mut keys: Vec<String> = list.lines().next().unwrap().split(", ").map(str::to_owned).collect();
        keys.sort_unstable();
        keys
    }

    #[test]
    fn the_table_has_the_keys_that_are_read() {
        // A suite of several has the keys of the top level.
        let own = |section: &&Section| !["[[relations]]", "[[suites]]"].contains(&section.title);
        for section in SECTIONS.iter().filter(own) {
            let mut keys: Vec<&str> = section.keys.iter().map(|key| key.name).collect();
            keys.sort_unstable();
            assert_eq!(known(&format!("{}\nqqqqqqqqqqqqq = 1\n", section.title)), keys, "{}", section.title);
        }
        // The keys of a law depend on its kind.
        let mut all: Vec<String> = LawKind::NAMES
            .iter()
            .flat_map(|kind| known(&format!("[[relations]]\nkind = {kind:?}\nqqqqqqqqqqqqq = 1\n")))
            .collect();
        all.sort_unstable();
        all.dedup();
        let mut keys: Vec<&str> = section("[[relations]]").keys.iter().map(|key| key.name).collect();
        keys.sort_unstable();
        assert_eq!(all, keys);
        assert_eq!(LAWS.iter().map(|(name, _)| *name).collect::<Vec<_>>(), LawKind::NAMES);
    }

    #[test]
    fn every_title_is_a_section() {
        for key in SECTIONS.iter().flat_map(|section| section.keys) {
            if let KeyForm::FileOr(title) | KeyForm::Table(title) | KeyForm::Tables(title) = key.form {
                assert_eq!(section(title).title, title);
            }
        }
    }

    #[test]
    fn the_page_tells_every_key_and_generator() {
        let page = page();
        for key in SECTIONS.iter().flat_map(|section| section.keys) {
            assert!(page.contains(&format!("\n  {}: ", key.name)), "{}", key.name);
        }
        for generator in catalogue::generators() {
            assert!(page.contains(&format!("\n  {}\n", generator.name())), "{}", generator.name());
        }
        assert!(page.lines().all(|line| line.chars().count() <= 100), "{page}");
    }
}
