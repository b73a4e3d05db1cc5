//! `shadercheck lanes`: what can run shaders here, and why what cannot, cannot.

use std::io::Write;

use clap::Args;
use serde_json::{Value, json};

use super::check::Format;
use crate::cli::status::ExitStatus;
use judge::profile::Promises;
use lanes::{self, Description, Lane, StandIn, Unavailable, Wanted};

/// Arguments of `shadercheck lanes`.
#[derive(Args, Clone, Debug, Default)]
pub struct LanesArgs {
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// The lanes of these names, or all that are available where there are none. What is missing is an error, but for who is
/// content with what there is.
///
/// # Errors
/// An unknown name, and each lane that is missing with the reason.
pub(super) fn opened(names: &[String], content: bool) -> anyhow::Result<Vec<Box<dyn Lane>>> {
    let opened = Wanted { stand_in: StandIn::Beside, ..Wanted::named(names) }.open()?;
    let missing: Vec<String> = opened.missing.iter().map(|(name, error)| format!("lane `{name}`: {error}")).collect();
    anyhow::ensure!(content || missing.is_empty(), "{}", missing.join("; "));
    Ok(opened.lanes)
}

/// The widest line.
const WIDTH: usize = 100;

/// A lane of the registry.
struct LaneState {
    name: &'static str,
    about: &'static str,
    what: Result<(Description, Promises), Unavailable>,
}

/// Runs the command. The status is [`ExitStatus::Clean`] even when no lane is available: that is an
/// answer.
///
/// # Errors
/// When `out` cannot be written to.
pub fn run(args: &LanesArgs, out: &mut dyn Write) -> anyhow::Result<ExitStatus> {
    let one = |candidate: &lanes::Candidate| {
        let opened = (candidate.open)();
        let what = opened.map(|lane| (lane.description().clone(), Promises::of_lane(lane.description())));
        LaneState { name: candidate.name, about: candidate.about, what }
    };
    let all: Vec<LaneState> = lanes::registry().iter().map(one).collect();
    match args.format {
        Format::Text => {
            out.write_all(table(&all).as_bytes())?;
            let found: Vec<&Description> =
                all.iter().filter_map(|f| f.what.as_ref().ok()).map(|(lane, _)| lane).collect();
            if let Some(more) = lanes::more(&found) {
                out.write_all(wrapped(more, "help:", 6).as_bytes())?;
            }
        }
        Format::Json => writeln!(out, "{:#}", json!({ "lanes": all.iter().map(value).collect::<Vec<_>>() }))?,
    }
    Ok(ExitStatus::Clean)
}

const HEAD: [&str; 5] = ["lane", "stages", "driver", "version", "executor x front end"];

/// Lanes as a table: a line for what each is, one for what it is held against, or why it is not available.
fn table(all: &[LaneState]) -> String {
    let stages = |lane: &Description| lane.stages.iter().map(|s| s.name()).collect::<Vec<_>>().join(" ");
    let row = |found: &LaneState| -> Option<[String; 5]> {
        let (lane, _) = found.what.as_ref().ok()?;
        let (driver, version) = driver(&lane.driver);
        let group = format!("{} x {}", lane.executor, lane.front_end);
        Some([found.name.to_owned(), stages(lane), driver, version, group])
    };
    let rows: Vec<Option<[String; 5]>> = all.iter().map(row).collect();
    let mut widths = HEAD.map(str::len);
    for cells in rows.iter().flatten() {
        widths.iter_mut().zip(cells).for_each(|(width, cell)| *width = (*width).max(cell.chars().count()));
    }
    widths[0] = all.iter().map(|found| found.name.len()).max().unwrap_or_default().max(widths[0]);
    // The name of the driver is what can be cut.
    let rest: usize = widths.iter().sum::<usize>() - widths[2] + 2 * (widths.len() - 1);
    widths[2] = widths[2].min(WIDTH.saturating_sub(rest).max(HEAD[2].len()));
    let line = |cells: [&str; 5]| {
        let cell = |(cell, &width): (&str, &usize)| {
            let cut: String = cell.chars().take(width).collect();
            format!("{cut:<width$}")
        };
        let cells: Vec<String> = cells.into_iter().zip(&widths).map(cell).collect();
        format!("{}\n", cells.join("  ").trim_end())
    };
    let indent = widths[0] + 2;
    let mut text = line(HEAD);
    for (found, row) in all.iter().zip(&rows) {
        match (&found.what, row) {
            (Ok((lane, promises)), Some(cells)) => {
                text.push_str(&line(cells.each_ref().map(String::as_str)));
                let names: Vec<&str> = promises.promises().map(|p| p.name.as_str()).collect();
                let measured = promises.measured.as_ref().map_or("none", |p| p.name.as_str());
                let (api, promises) = (lane.api.name(), names.join(", "));
                text.push_str(&wrapped(
                    &format!("API {api}: promises {promises}; measured profile: {measured}"),
                    "",
                    indent,
                ));
            }
            (Ok(_), None) => {}
            (Err(missing), _) => {
                let Unavailable { why, remedy } = missing;
                let about = format!("unavailable ({}): {why}", found.about);
                text.push_str(&wrapped(&about, found.name, indent));
                text.push_str(&wrapped(&format!("to get it: {remedy}"), "", indent));
            }
        }
    }
    text
}

/// A text behind a label, in lines that are no wider than the table where blanks permit it.
fn wrapped(said: &str, label: &str, indent: usize) -> String {
    let mut text = String::new();
    let mut line = format!("{label:<indent$}");
    let mut begun = false;
    for word in said.split(' ') {
        if begun && line.chars().count() + 1 + word.chars().count() > WIDTH {
            text.push_str(&line);
            text.push('\n');
            (line, begun) = (" ".repeat(indent), false);
        }
        if begun {
            line.push(' ');
        }
        line.push_str(word);
        begun = true;
    }
    format!("{text}{line}\n")
}

/// The name of a driver, and its version with the word before it: what stands in brackets is neither.
fn driver(text: &str) -> (String, String) {
    let mut depth = 0_usize;
    let plain: String = text
        .chars()
        .filter(|&c| {
            depth += usize::from(c == '(');
            let kept = depth == 0;
            depth -= usize::from(c == ')' && depth > 0);
            kept
        })
        .collect();
    let first = plain.split(',').next().unwrap_or_default().trim();
    let words: Vec<&str> = plain.split([' ', ',']).filter(|word| !word.is_empty()).collect();
    let number = |word: &str| {
        word.contains('.') && word.split('.').all(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
    };
    let version = words.iter().position(|word| number(word)).map_or_else(String::new, |at| match at.checked_sub(1) {
        Some(before) => format!("{} {}", words[before], words[at]),
        None => words[at].to_owned(),
    });
    let name = first.strip_suffix(version.rsplit(' ').next().unwrap_or_default()).map_or(first, str::trim);
    // Whose it is, the version says.
    let name = match name.split_once(" of ") {
        Some((name, whose)) if version.split(' ').next() == Some(whose) => name,
        Some(_) | None => name,
    };
    (name.to_owned(), version)
}

fn value(found: &LaneState) -> Value {
    match &found.what {
        Ok((lane, promises)) => {
            let stages: Vec<&str> = lane.stages.iter().map(|stage| stage.name()).collect();
            let names: Vec<&str> = promises.promises().map(|p| p.name.as_str()).collect();
            json!({
                "name": found.name,
                "about": found.about,
                "available": true,
                "stages": stages,
                "driver": lane.driver,
                "version": driver(&lane.driver).1,
                "executor": lane.executor,
                "front_end": lane.front_end,
                "api": lane.api.name(),
                "promises": names,
                "measured": promises.measured.as_ref().map(|p| p.name.clone()),
            })
        }
        Err(Unavailable { why, remedy }) => json!({
            "name": found.name,
            "about": found.about,
            "available": false,
            "why": why,
            "remedy": remedy,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lanes::{Api, Stage};

    fn found(name: &'static str, driver: &str, stages: Vec<Stage>) -> LaneState {
        let (executor, front_end) = ("gallivm".to_owned(), "glslang".to_owned());
        let description =
            Description { name, driver: driver.to_owned(), executor, front_end, api: Api::Vulkan, stages };
        let promises = Promises::of_lane(&description);
        LaneState { name, about: "a lane", what: Ok((description, promises)) }
    }

    const LLVMPIPE: &str = "llvmpipe (LLVM 15.0.6, 256 bits), llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)";

    #[test]
    fn the_table_fits_a_hundred_columns() {
        let why = "no Vulkan driver was found in any of the folders in which the loader looks for them here";
        let remedy = "install one, for example `apt-get install mesa-vulkan-drivers libvulkan1` on Debian or Ubuntu";
        let missing = Unavailable { why: why.to_owned(), remedy: remedy.to_owned() };
        let all = [
            found("vulkan", LLVMPIPE, vec![Stage::Compute, Stage::Vertex]),
            found(
                "vulkan-glslang-x",
                &"a very long name of a device ".repeat(5),
                vec![Stage::Compute, Stage::Vertex, Stage::Geometry],
            ),
            LaneState { name: "opengl", about: "any OpenGL driver", what: Err(missing) },
        ];
        let text = table(&all);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH), "{text}");
        let row: Vec<&str> =
            text.lines().nth(1).unwrap().split("  ").filter(|cell| !cell.is_empty()).map(str::trim).collect();
        assert_eq!(row, ["vulkan", "compute vertex", "llvmpipe", "Mesa 22.3.6", "gallivm x glslang"]);
        assert!(text.contains("promises vulkan-1.4, vulkan-cts; measured profile: llvmpipe-22.3.6\n"), "{text}");
        assert!(text.contains("\nopengl            unavailable (any OpenGL driver): no Vulkan driver"), "{text}");
        assert!(text.contains("to get it: install one, for example"), "{text}");
    }

    #[test]
    fn drivers_are_reported_by_name_and_version() {
        for (text, name, version) in [
            (LLVMPIPE, "llvmpipe", "Mesa 22.3.6"),
            ("SwiftShader Device (Subzero), SwiftShader driver, 5.0.0", "SwiftShader Device", "driver 5.0.0"),
            ("interpreter of shadercheck 0.1.0, strict binary32", "interpreter", "shadercheck 0.1.0"),
            ("NVIDIA X, NVIDIA, 535.104", "NVIDIA X", "NVIDIA 535.104"),
            ("soft", "soft", ""),
        ] {
            assert_eq!(driver(text), (name.to_owned(), version.to_owned()), "{text}");
        }
    }
}
