//! What a command of this program found, out of what it wrote: a text to read, and places in files.

use serde_json::Value;

/// What a command found.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Results {
    /// What is shown beside the file: Markdown, or a translation.
    pub text: String,
    /// Ending of a file with that text.
    pub ending: &'static str,
    /// What concerns a place.
    pub found: Vec<Found>,
}

/// Something about a place.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Found {
    /// `name:line:column`.
    pub at: String,
    /// What stands there, where it is known.
    pub text: Option<String>,
    /// As in the protocol: 1 an error, 2 a warning, 3 information, 4 a hint.
    pub severity: u8,
    pub message: String,
    /// What may be written instead.
    pub replace: Option<String>,
}

/// Reads what a command wrote.
pub(super) fn read(command: &str, to: Option<&str>, output: &str) -> Results {
    if let Some(to) = to {
        let ending = match to {
            "wgsl" => "wgsl",
            "hlsl" => "hlsl",
            "msl" => "metal",
            "spirv" => "spvasm",
            _ => "glsl",
        };
        return Results { text: output.to_owned(), ending, found: Vec::new() };
    }
    let mut results = Results { ending: "md", ..Results::default() };
    let Ok(report) = serde_json::from_str::<Value>(output) else {
        output.clone_into(&mut results.text);
        return results;
    };
    match command {
        "shadercheck.fuzz" => results.fuzzed(&report),
        "shadercheck.improve" => results.improved(&report),
        "shadercheck.compare" => results.compared(&report),
        _ => results.checked(&report),
    }
    results
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn word(value: &Value) -> &str {
    value.as_str().unwrap_or("")
}

/// `vec2 x = 1.0, 2.0`, for each input.
fn inputs(all: &Value) -> String {
    let one = |input: &Value| {
        let values: Vec<&str> = list(&input["values"]).chain(list(&input["decimal"])).map(word).collect();
        format!("`{} = {}`", word(&input["declared"]), values.join(", "))
    };
    list(all).map(one).collect::<Vec<_>>().join(", ")
}

impl Results {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn point(&mut self, message: &str, further: &[(&str, String)]) {
        self.line(&format!("- {message}"));
        for (what, text) in further.iter().filter(|(_, text)| !text.is_empty()) {
            self.line(&format!("  - {what}: {text}"));
        }
    }

    fn errors(&mut self, file: &Value) {
        for error in list(&file["errors"]) {
            self.line(&format!("{}: {} {}\n", word(&error["at"]), word(&error["code"]), word(&error["message"])));
        }
    }

    fn fuzzed(&mut self, report: &Value) {
        for file in list(&report["files"]) {
            self.errors(file);
            for function in list(&file["functions"]) {
                self.line(&format!("# Fuzzed: `{}`\n", word(&function["function"])));
                match function["not_run"].as_str() {
                    Some(why) => self.line(&format!("not run: {why}\n")),
                    None => self.line(&format!("{} samples, seed {}\n", function["samples"], report["seed"])),
                }
                for finding in list(&function["findings"]) {
                    let severity = match word(&finding["severity"]) {
                        "finding" => 1,
                        "warning" => 2,
                        _ => 3,
                    };
                    let (message, with) = (word(&finding["message"]), inputs(&finding["inputs"]));
                    let again = code(word(&finding["reproduce"]));
                    self.point(
                        message,
                        &[("at", word(&finding["at"]).to_owned()), ("with", with.clone()), ("again", again)],
                    );
                    let at = finding["at"].as_str().unwrap_or(word(&function["at"])).to_owned();
                    let message = if with.is_empty() {
                        message.to_owned()
                    } else {
                        format!("{message}\nwith {}", with.replace('`', ""))
                    };
                    self.found.push(Found { at, text: text(&finding["text"]), severity, message, replace: None });
                }
                self.line("");
            }
        }
    }

    fn improved(&mut self, report: &Value) {
        let bits = |lost: &Value| {
            let bits = |v: &Value| v.as_f64().unwrap_or(0.0);
            format!("{:.1} bits in the mean and {:.1} at worst", bits(&lost["mean"]), bits(&lost["worst"]))
        };
        self.line("# Improved\n");
        for file in list(&report["files"]) {
            for skipped in list(&file["not_run"]) {
                self.line(&format!("`{}`: {}\n", word(&skipped["function"]), word(&skipped["why"])));
            }
            for expression in list(&file["expressions"]) {
                let (own, at) = (word(&expression["text"]), word(&expression["at"]));
                self.line(&format!("`{own}` at {at} loses {}\n", bits(&expression["lost"])));
                for proposal in list(&expression["proposals"]) {
                    let points = format!("proved at {} points", proposal["proof"]["points"]);
                    self.point(
                        &format!("`{}` loses {}", word(&proposal["text"]), bits(&proposal["lost"])),
                        &[("proof", points)],
                    );
                }
                self.line("");
                let Some(best) = list(&expression["proposals"]).next() else { continue };
                let new = word(&best["text"]);
                let message = format!(
                    "loses {}; `{new}` is the same in real numbers and loses {}",
                    bits(&expression["lost"]),
                    bits(&best["lost"])
                );
                let replace = Some(if new.contains([' ', '?']) { format!("({new})") } else { new.to_owned() });
                self.found.push(Found {
                    at: at.to_owned(),
                    text: text(&expression["text"]),
                    severity: 3,
                    message,
                    replace,
                });
            }
        }
        if self.found.is_empty() {
            self.line("Nothing better was found.");
        }
    }

    fn compared(&mut self, report: &Value) {
        self.line(&format!("# Compared: {} and {}\n", word(&report["first"]), word(&report["second"])));
        for pair in list(&report["pairs"]) {
            let function = word(&pair["second"]["function"]);
            if let Some(why) = pair["not_compared"].as_str() {
                self.line(&format!("`{function}`: not compared: {why}\n"));
                continue;
            }
            let (samples, equal, unlike) = (&pair["samples"], &pair["equal"], &pair["unlike"]);
            self.line(&format!("`{function}`: {samples} samples, {equal} mean the same, {unlike} do not\n"));
            for bounds in list(&pair["accuracy"]) {
                let ulp = |side: &str| word(&bounds[format!("widest_{side}")][format!("ulp_{side}")]).parse::<f64>();
                if let (Ok(before), Ok(after)) = (ulp("first"), ulp("second")) {
                    let profile = word(&bounds["profile"]);
                    self.line(&format!("A device ({profile}) is off by {before:.1} ULP at worst in the first, {after:.1} in the second.\n"));
                }
            }
            let smallest = &pair["smallest"];
            if smallest.is_object() {
                let (message, with) = (word(&smallest["message"]), inputs(&smallest["inputs"]));
                self.point(message, &[("with", with.clone()), ("again", code(word(&smallest["reproduce"])))]);
                let message = format!(
                    "means something else than {}: {message}\nwith {}",
                    word(&report["first"]),
                    with.replace('`', "")
                );
                let at = word(&pair["second"]["at"]).to_owned();
                self.found.push(Found {
                    at,
                    text: text(&pair["second"]["function"]),
                    severity: 1,
                    message,
                    replace: None,
                });
            }
        }
        for alone in list(&report["unpaired"]) {
            self.line(&format!("`{}`: {}\n", word(&alone["function"]), word(&alone["why"])));
        }
    }

    fn checked(&mut self, report: &Value) {
        self.line(&format!("# Checked: {}\n", word(&report["status"])));
        let totals = &report["totals"];
        let counts = (&totals["judged"], &totals["agreed"], &totals["deviated"], &totals["undetermined"]);
        self.line(&format!(
            "{} samples judged: {} agreed, {} deviated, {} undetermined\n",
            counts.0, counts.1, counts.2, counts.3
        ));
        for entry in list(&report["suites"]) {
            let on = match entry["lane"].as_str() {
                Some(lane) => format!("`{}` on {lane}", word(&entry["suite"])),
                None => format!("`{}`", word(&entry["suite"])),
            };
            if let Some(why) = entry["not_run"].as_str() {
                self.line(&format!("{on}: not run: {why}\n"));
            }
            for finding in list(&entry["findings"]) {
                let (message, case) = (word(&finding["message"]), &finding["case"]);
                let with = inputs(&case["inputs"]);
                self.point(
                    &format!("{on}: {message}"),
                    &[("with", with), ("again", code(word(&finding["reproduce"])))],
                );
                let own = finding["file"].as_str().zip(finding["line"].as_u64());
                let own = own.map(|(file, line)| format!("{file}:{line}:{}", finding["column"].as_u64().unwrap_or(1)));
                let Some(at) = own.or_else(|| text(&case["computed_at"]["at"])) else { continue };
                let severity = if finding["severity"] == "error" { 1 } else { 2 };
                let (text, message) = (text(&case["computed_at"]["text"]), format!("{on}: {message}").replace('`', ""));
                // The same on several lanes is told once a place.
                if !self.found.iter().any(|f| f.at == at && f.message == message) {
                    self.found.push(Found { at, text, severity, message, replace: None });
                }
            }
        }
    }
}

fn code(text: &str) -> String {
    if text.is_empty() { String::new() } else { format!("`{text}`") }
}

fn text(value: &Value) -> Option<String> {
    value.as_str().map(str::to_owned)
}

impl Found {
    /// The file, and the place in it as line and column from 1.
    pub fn place(&self) -> Option<(&str, usize, usize)> {
        let (rest, column) = self.at.rsplit_once(':')?;
        let (file, line) = rest.rsplit_once(':')?;
        Some((file, line.parse().ok()?, column.parse().ok()?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_read_behind_colons_of_a_path() {
        let at = |at: &str| Found { at: at.to_owned(), ..Found::default() };
        assert_eq!(at("C:/a.glsl:3:7").place(), Some(("C:/a.glsl", 3, 7)));
        assert_eq!(at("a.glsl").place(), None);
    }

    #[test]
    fn what_is_no_report_is_shown_as_it_is() {
        let found = read("shadercheck.fuzz", None, "error: no such file");
        assert!(found.text.contains("no such file") && found.found.is_empty());
        assert_eq!(read("shadercheck.translate", Some("msl"), "kernel").ending, "metal");
    }
}
