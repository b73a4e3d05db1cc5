//! What a `.shader_test` file says: texts of stages, values of uniforms, draws, and the colors that they give.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail};
use syntax::Stage;

/// A test: its stages, and what they are run with.
#[derive(Debug)]
pub struct ShaderTest {
    /// The version that `[require]` asks for, such as `130` or `300 es`.
    pub version: String,
    /// Text of each stage, without the version line that the runner puts before it.
    pub stages: BTreeMap<Section, String>,
    /// Attributes of the first vertex by name.
    pub vertex: BTreeMap<String, Values>,
    /// Each draw or dispatch whose color is looked at.
    pub cases: Vec<Case>,
}

/// A stage that has a text of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// `[vertex shader]`
    Vertex,
    /// `[geometry shader]`
    Geometry,
    /// `[fragment shader]`
    Fragment,
    /// `[compute shader]`
    Compute,
}

impl Section {
    /// The stage.
    pub fn stage(self) -> Stage {
        match self {
            Self::Vertex => Stage::Vertex,
            Self::Geometry => Stage::Geometry,
            Self::Fragment => Stage::Fragment,
            Self::Compute => Stage::Compute,
        }
    }
}

/// One draw with the color that a probe expects of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Values of uniforms by name.
    pub uniforms: BTreeMap<String, Values>,
    /// Red, green, blue, and alpha where the probe names it.
    pub color: Vec<f32>,
}

/// Components as they are written, with their type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Values {
    /// Type such as `vec2`.
    pub ty: String,
    /// The components, column by column.
    pub components: Vec<String>,
}

/// Where a draw leaves its color.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Area {
    x: f64,
    y: f64,
    width: f64,
    height: f64,
}

const EVERYWHERE: Area =
    Area { x: f64::NEG_INFINITY, y: f64::NEG_INFINITY, width: f64::INFINITY, height: f64::INFINITY };

impl Area {
    fn has(self, x: f64, y: f64) -> bool {
        // Of an infinite area, the upper ends are no numbers.
        let inside = |low: f64, size: f64, at: f64| at >= low && (size.is_infinite() || at < low + size);
        inside(self.x, self.width, x) && inside(self.y, self.height, y)
    }
}

impl ShaderTest {
    /// Reads a test.
    ///
    /// # Errors
    /// The line that is not understood, with its number.
    pub fn parse(text: &str) -> Result<Self> {
        let mut test =
            Self { version: String::new(), stages: BTreeMap::new(), vertex: BTreeMap::new(), cases: Vec::new() };
        let mut data = Vec::new();
        let mut run = Run::default();
        let mut section = "";
        for (number, line) in (1..).zip(text.lines()) {
            if let Some(name) = line.strip_prefix('[').and_then(|l| l.trim_end().strip_suffix(']')) {
                section = name;
                if let Some(stage) = stage(name)? {
                    test.stages.insert(stage, String::new());
                }
                continue;
            }
            let done = match stage(section)? {
                Some(stage) => {
                    if let Some(text) = test.stages.get_mut(&stage) {
                        text.push_str(line);
                        text.push('\n');
                    }
                    Ok(())
                }
                None => {
                    let line = line.split('#').next().unwrap_or_default().trim();
                    match section {
                        "require" => test.require(line),
                        "test" if !line.is_empty() => run.line(line),
                        "vertex data" if !line.is_empty() && data.len() < 2 => {
                            data.push(line);
                            Ok(())
                        }
                        "test" | "vertex data" | "vertex shader passthrough" | "" => Ok(()),
                        other => bail!("line {number}: section [{other}]"),
                    }
                }
            };
            done.with_context(|| format!("line {number}: `{}`", line.trim()))?;
        }
        if test.version.is_empty() {
            bail!("no version is required");
        }
        test.cases = run.cases;
        if let [header, row] = data[..] {
            test.vertex = attributes(header, row);
        }
        Ok(test)
    }

    fn require(&mut self, line: &str) -> Result<()> {
        let es = line.starts_with("GLSL ES");
        if !es && !line.starts_with("GLSL ") {
            return Ok(());
        }
        let number = line.split(">=").nth(1).context("no `>=`")?.trim();
        let digits: String = number.chars().filter(char::is_ascii_digit).collect();
        self.version = if es && digits != "100" { format!("{digits} es") } else { digits };
        Ok(())
    }

    /// Text of a stage with its version line.
    pub fn text(&self, section: Section) -> Option<String> {
        let text = self.stages.get(&section)?;
        if text.contains("#version") {
            return Some(text.clone());
        }
        Some(format!("#version {}\n#line 1\n{text}", self.version))
    }
}

fn stage(section: &str) -> Result<Option<Section>> {
    Ok(Some(match section {
        "vertex shader" => Section::Vertex,
        "geometry shader" => Section::Geometry,
        "fragment shader" => Section::Fragment,
        "compute shader" => Section::Compute,
        // It hands on a position, and says nothing about the stage behind it.
        "vertex shader passthrough" => return Ok(None),
        _ if section.contains("shader") => bail!("section [{section}]"),
        _ => return Ok(None),
    }))
}

/// Attributes such as `name/float/2` with their components. What is drawn covers the target: where vertices lie
/// is not looked at.
fn attributes(header: &str, row: &str) -> BTreeMap<String, Values> {
    let mut components = row.split_whitespace().map(str::to_owned);
    let mut all = BTreeMap::new();
    for attribute in header.split_whitespace() {
        let mut parts = attribute.split('/');
        let (Some(name), Some(ty), Some(count)) = (parts.next(), parts.next(), parts.next_back()) else { continue };
        let components = components.by_ref().take(count.parse().unwrap_or(0)).collect();
        all.insert(name.to_owned(), Values { ty: ty.to_owned(), components });
    }
    all
}

/// The state while the lines of `[test]` are read.
#[derive(Default)]
struct Run {
    uniforms: BTreeMap<String, Values>,
    draws: Vec<(Area, BTreeMap<String, Values>)>,
    cases: Vec<Case>,
}

impl Run {
    fn line(&mut self, line: &str) -> Result<()> {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["uniform", ty, name, ref components @ ..] if !components.is_empty() => {
                let components = components.iter().map(|c| (*c).to_owned()).collect();
                self.uniforms.insert(name.to_owned(), Values { ty: ty.to_owned(), components });
                Ok(())
            }
            ["draw", "rect", "ortho", ref area @ ..] => {
                let area = self::area(&numbers(&area.join(" "))?)?;
                self.draw(area)
            }
            ["draw", "rect" | "arrays", ..] | ["compute", ..] => self.draw(EVERYWHERE),
            ["clear", ..] | ["texture" | "image" | "fb", ..] => Ok(()),
            ["probe", ref rest @ ..] => self.probe(rest),
            _ => bail!("this command is not known"),
        }
    }

    fn draw(&mut self, area: Area) -> Result<()> {
        self.draws.push((area, self.uniforms.clone()));
        Ok(())
    }

    fn probe(&mut self, words: &[&str]) -> Result<()> {
        let (area, components, values) = match words {
            ["all", components, rest @ ..] => (EVERYWHERE, components, numbers(&rest.join(" "))?),
            ["rect", components, rest @ ..] => {
                let all = numbers(&rest.join(" "))?;
                let (place, values) = all.split_at_checked(4).context("four numbers tell the place")?;
                (area(place)?, components, values.to_vec())
            }
            [components, rest @ ..] => {
                let all = numbers(&rest.join(" "))?;
                let (place, values) = all.split_at_checked(2).context("two numbers tell the place")?;
                (Area { x: place[0], y: place[1], width: 1.0, height: 1.0 }, components, values.to_vec())
            }
            [] => bail!("nothing is probed"),
        };
        let count = match *components {
            "rgb" => 3,
            "rgba" => 4,
            _ => bail!("`{components}` is not known"),
        };
        let color = values.get(..count).context("too few numbers")?.iter().map(|&v| v as f32).collect();
        // The last draw over the place gives the color.
        let (x, y) = if area == EVERYWHERE { (0.0, 0.0) } else { (area.x, area.y) };
        let mut draws = self.draws.iter().rev();
        let (_, uniforms) = draws.find(|(drawn, _)| drawn.has(x, y)).context("nothing is drawn there")?;
        self.cases.push(Case { uniforms: uniforms.clone(), color });
        Ok(())
    }
}

/// Numbers between spaces, commas and brackets.
fn numbers(text: &str) -> Result<Vec<f64>> {
    let separators = |c: char| c.is_whitespace() || matches!(c, ',' | '(' | ')');
    text.split(separators).filter(|w| !w.is_empty()).map(|w| w.parse().context("a number is expected")).collect()
}

fn area(numbers: &[f64]) -> Result<Area> {
    let &[x, y, width, height] = numbers else { bail!("four numbers tell the place") };
    Ok(Area { x, y, width, height })
}
