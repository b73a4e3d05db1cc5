//! The tools: what each takes, and the arguments of the command that it is.

use serde_json::{Map, Value, json};

/// A command as a tool.
struct Tool {
    name: &'static str,
    about: &'static str,
    /// What it takes, beside a limit of time.
    takes: &'static [Take],
    /// Arguments that always stand behind the name of the command.
    always: &'static [&'static str],
}

/// What a tool takes.
#[derive(Clone, Copy)]
struct Take {
    name: &'static str,
    about: &'static str,
    kind: Kind,
    needed: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Files and folders, one after the other; the folder of the server where none is named.
    Paths,
    /// One file or word.
    Word,
    /// An option with a value, given once for each of a list.
    Each(&'static str),
    /// An option with one value.
    Value(&'static str),
    /// An option without a value, where this is true.
    #[cfg(feature = "run")]
    Flag(&'static str),
    /// The text of a file, whose name `name` gives.
    Text,
    /// The name of that file.
    Name,
}

const PATHS: Take =
    take("paths", "Files and folders; the folder in which the server runs where none is named", Kind::Paths);
const TEXT: Take = take("text", "The text of a shader, instead of paths", Kind::Text);
const NAME: Take =
    take("name", "The file name of `text`, whose ending tells its language: a.wgsl, a.frag, a.comp", Kind::Name);
#[cfg(feature = "run")]
const FUNCTIONS: Take = take("functions", "Only these functions and entry points", Kind::Each("--function"));
const DEFINES: Take = take("defines", "Macros and constants, as NAME=VALUE", Kind::Each("--define"));

const JSON: &[&str] = &["--format", "json"];

const fn take(name: &'static str, about: &'static str, kind: Kind) -> Take {
    Take { name, about, kind, needed: false }
}

const fn needed(name: &'static str, about: &'static str, kind: Kind) -> Take {
    Take { name, about, kind, needed: true }
}

const TOOLS: &[Tool] = &[
    Tool {
        name: "lint",
        about: "Find mistakes in shaders and in the host code that feeds them, without running anything. Gives findings with \
                their places, causes and repairs.",
        takes: &[
            PATHS,
            TEXT,
            NAME,
            take("level", "How much is told: default, strict or heuristic", Kind::Value("--level")),
            DEFINES,
        ],
        always: JSON,
    },
    #[cfg(feature = "run")]
    Tool {
        name: "fuzz",
        about: "Run every function and compute kernel of shaders on generated inputs: races, stray indices, missing barriers, \
                NaN, overflow, lost digits, and drivers that are wrong. Gives the smallest inputs that show each.",
        takes: &[
            PATHS,
            TEXT,
            NAME,
            FUNCTIONS,
            DEFINES,
            take(
                "prove",
                "Races and indices of compute kernels for all sizes, instead of samples",
                Kind::Flag("--prove"),
            ),
            take("reproducible", "Which outputs have the same bits on every device", Kind::Flag("--reproducible")),
        ],
        always: JSON,
    },
    #[cfg(feature = "run")]
    Tool {
        name: "trace",
        about: "Show how a case of a function came about: each expression in binary32 and in real numbers, the bits that it \
                loses, and the first one that is wrong. Without a case, the smallest one of what `fuzz` finds.",
        takes: &[
            take("path", "A shader file", Kind::Word),
            TEXT,
            NAME,
            FUNCTIONS,
            take("case", "The inputs of the `reproduce` line of a finding; needs functions", Kind::Value("--case")),
            take("set", "Inputs as NAME=NUMBERS, one for each; needs functions", Kind::Each("--set")),
            take("output", "Only what this output depends on", Kind::Value("--output")),
            DEFINES,
        ],
        always: JSON,
    },
    #[cfg(feature = "run")]
    Tool {
        name: "test",
        about: "Run the tests that stand in shaders: functions of WGSL marked `@test`, comments of GLSL that begin with it. \
                Tells expectations that fail, and those that a conforming device may break.",
        takes: &[PATHS, TEXT, NAME, DEFINES],
        always: JSON,
    },
    #[cfg(feature = "run")]
    Tool {
        name: "check",
        about: "Run the suites of a folder: every output of a shader compared with its formula, within bounds that are derived.",
        takes: &[PATHS],
        always: JSON,
    },
    #[cfg(feature = "run")]
    Tool {
        name: "compare",
        about: "Compare two shader texts, in any two languages, on generated inputs: whether they compute the same.",
        takes: &[
            needed("first", "A shader file", Kind::Word),
            needed("second", "The file that it is compared with", Kind::Word),
            FUNCTIONS,
        ],
        always: JSON,
    },
    #[cfg(feature = "run")]
    Tool {
        name: "improve",
        about: "Find formulas that lose fewer bits than the expressions of a shader, and are worse on no known device.",
        takes: &[needed("path", "A shader file", Kind::Word), FUNCTIONS],
        always: JSON,
    },
    #[cfg(feature = "run")]
    Tool {
        name: "tune",
        about: "Find which declarations of a shader may be mediump on phones, and which must be highp.",
        takes: &[needed("path", "A shader file", Kind::Word)],
        always: JSON,
    },
    Tool {
        name: "explain",
        about: "The page of a lint rule, error code or kind of finding: what is wrong, an example, and its repair.",
        takes: &[needed("code", "T001, E020, constructor-too-many-args, race", Kind::Word)],
        always: &["--lang", "en"],
    },
];

/// The tools as the protocol lists them.
pub fn listed() -> Vec<Value> {
    let schema = |take: &Take| match take.kind {
        Kind::Paths | Kind::Each(_) => {
            json!({ "type": "array", "items": { "type": "string" }, "description": take.about })
        }
        Kind::Word | Kind::Value(_) | Kind::Text | Kind::Name => json!({ "type": "string", "description": take.about }),
        #[cfg(feature = "run")]
        Kind::Flag(_) => json!({ "type": "boolean", "description": take.about }),
    };
    let one = |tool: &Tool| {
        let mut properties: Map<String, Value> =
            tool.takes.iter().map(|take| (take.name.to_owned(), schema(take))).collect();
        let limit = json!({ "type": "integer", "minimum": 1, "description": "Most seconds that the call may take" });
        properties.insert("limit".to_owned(), limit);
        let needed: Vec<&str> = tool.takes.iter().filter(|take| take.needed).map(|take| take.name).collect();
        json!({
            "name": tool.name,
            "description": tool.about,
            "inputSchema": {
                "type": "object", "properties": properties, "required": needed, "additionalProperties": false,
            },
            "annotations": { "readOnlyHint": true, "openWorldHint": false },
        })
    };
    TOOLS.iter().map(one).collect()
}

/// A call: the arguments of a command, and the text that stands for a file.
pub struct Asked {
    pub arguments: Vec<String>,
    /// The name and the text of a file.
    pub file: Option<(String, String)>,
    /// Seconds that it may take.
    pub limit: u64,
}

/// Reads the parameters of `tools/call`.
///
/// # Errors
/// What is wrong with them, as a sentence without a full stop.
pub fn asked(params: &Value, limit: u64) -> Result<Asked, String> {
    let name = params.get("name").and_then(Value::as_str).ok_or("a call needs the `name` of a tool")?;
    let tool = TOOLS.iter().find(|tool| tool.name == name).ok_or_else(|| {
        let all: Vec<&str> = TOOLS.iter().map(|tool| tool.name).collect();
        format!("there is no tool `{name}`; there are: {}", all.join(", "))
    })?;
    let nothing = Map::new();
    let given = match params.get("arguments") {
        None | Some(Value::Null) => &nothing,
        Some(Value::Object(given)) => given,
        Some(_) => return Err("`arguments` is no object".to_owned()),
    };
    if let Some(unknown) = given.keys().find(|key| *key != "limit" && tool.takes.iter().all(|take| take.name != **key))
    {
        let all: Vec<&str> = tool.takes.iter().map(|take| take.name).collect();
        return Err(format!("`{name}` takes no `{unknown}`; it takes {}, limit", all.join(", ")));
    }
    if let Some(lacking) = tool.takes.iter().find(|take| take.needed && !given.contains_key(take.name)) {
        return Err(format!("`{name}` needs `{}`: {}", lacking.name, lacking.about));
    }
    let limit = match given.get("limit") {
        None => limit,
        Some(limit) => limit.as_u64().filter(|limit| *limit > 0).ok_or("`limit` is no number of seconds")?,
    };
    let (mut options, mut words, mut text, mut file_name) = (Vec::new(), Vec::new(), None, None);
    for take in tool.takes {
        let Some(value) = given.get(take.name) else { continue };
        let word = || value.as_str().map(str::to_owned).ok_or_else(|| format!("`{}` is no string", take.name));
        let list = || {
            let all = value.as_array().and_then(|all| all.iter().map(|one| Some(one.as_str()?.to_owned())).collect());
            all.ok_or_else(|| format!("`{}` is no list of strings", take.name))
        };
        match take.kind {
            Kind::Paths => words.extend::<Vec<String>>(list()?),
            Kind::Word => words.push(word()?),
            Kind::Each(option) => {
                let all: Vec<String> = list()?;
                options.extend(all.into_iter().map(|one| format!("{option}={one}")));
            }
            Kind::Value(option) => options.push(format!("{option}={}", word()?)),
            #[cfg(feature = "run")]
            Kind::Flag(option) => {
                if value.as_bool().ok_or_else(|| format!("`{}` is neither true nor false", take.name))? {
                    options.push(option.to_owned());
                }
            }
            Kind::Text => text = Some(word()?),
            Kind::Name => file_name = Some(word()?),
        }
    }
    let file = match (text, file_name) {
        (None, None) => None,
        (Some(_), None) => return Err("`text` needs a `name`, whose ending tells its language".to_owned()),
        (None, Some(_)) => return Err("`name` is that of `text`, which is not given".to_owned()),
        (Some(_), Some(_)) if !words.is_empty() => return Err("`text` stands for `paths`: one of both".to_owned()),
        (Some(_), Some(name)) if name.contains(['/', '\\']) || name.starts_with(['.', '-']) || name.is_empty() => {
            return Err(format!("`{name}` is no plain file name"));
        }
        (Some(text), Some(name)) => {
            words.push(name.clone());
            Some((name, text))
        }
    };
    let mut arguments = vec![tool.name.to_owned()];
    arguments.extend(tool.always.iter().map(|word| (*word).to_owned()));
    arguments.extend(options);
    // What follows is no option, whatever it begins with.
    arguments.push("--".to_owned());
    arguments.extend(words);
    Ok(Asked { arguments, file, limit })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser as _;

    fn arguments(params: &Value) -> Result<Vec<String>, String> {
        asked(params, 300).map(|asked| asked.arguments)
    }

    #[test]
    fn every_tool_is_a_command_with_these_options() {
        for tool in TOOLS {
            let value = |take: &Take| match take.kind {
                Kind::Paths => json!(["a.frag"]),
                Kind::Each("--define" | "--set") => json!(["A=1"]),
                Kind::Each(_) => json!(["f"]),
                Kind::Value("--level") => json!("strict"),
                // The two exclude each other.
                #[cfg(feature = "run")]
                Kind::Flag(option) => json!(option == "--prove"),
                Kind::Word | Kind::Value(_) | Kind::Text | Kind::Name => json!("a.frag"),
            };
            let of_text = |take: &&Take| !matches!(take.kind, Kind::Text | Kind::Name);
            let given: Map<String, Value> =
                tool.takes.iter().filter(of_text).map(|take| (take.name.to_owned(), value(take))).collect();
            let words = arguments(&json!({ "name": tool.name, "arguments": given })).unwrap();
            let line = std::iter::once("shadercheck".to_owned()).chain(words);
            crate::cli::Cli::try_parse_from(line).unwrap_or_else(|error| panic!("{}: {error}", tool.name));
        }
    }

    #[test]
    fn what_is_wrong_with_a_call_is_told() {
        let told = |params: Value| arguments(&params).unwrap_err();
        assert!(told(json!({ "name": "lnt" })).starts_with("there is no tool `lnt`; there are: lint"));
        assert_eq!(told(json!({ "name": "lint", "arguments": [1] })), "`arguments` is no object");
        assert_eq!(told(json!({ "name": "lint", "arguments": { "paths": "a" } })), "`paths` is no list of strings");
        assert!(told(json!({ "name": "lint", "arguments": { "path": "a" } })).starts_with("`lint` takes no `path`"));
        assert!(told(json!({ "name": "explain" })).starts_with("`explain` needs `code`"));
        assert_eq!(told(json!({ "name": "lint", "arguments": { "limit": 0 } })), "`limit` is no number of seconds");
        #[cfg(feature = "run")]
        {
            let yes = json!({ "name": "fuzz", "arguments": { "prove": "yes" } });
            assert_eq!(told(yes), "`prove` is neither true nor false");
        }
        let text = |name: &str| told(json!({ "name": "lint", "arguments": { "text": "", "name": name } }));
        assert_eq!(text("../a.frag"), "`../a.frag` is no plain file name");
        assert_eq!(text("-a.frag"), "`-a.frag` is no plain file name");
    }
}
