//! Texts in HLSL and Slang: a compiler that is found makes SPIR-V of them.

use std::env;
use std::path::{Path, PathBuf};

use base::diagnostic::{Diagnostic, Severity};
use base::text::{SourceFile, Span, decode};
use disk::read_source;
use lanes::compiler::{CompileError, Compiler, Kind, Message, PointStage, Source, named};
use program::{COMPILER, ModuleText, OWN, Outline, ProgramError, Written};
use syntax::{Looks, Stage, looks_like};

/// The variable that names a compiler.
const VARIABLE: &str = "SHADERCHECK_COMPILER";

/// How often a text is compiled at most, with fewer of its functions each time.
const MOST_ATTEMPTS: usize = 24;

/// What is asked of a text that a compiler reads.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// The entry point that is wanted, where one is named.
    pub entry: Option<String>,
    /// Its stage.
    pub stage: Option<Stage>,
    /// The compiler; the first that is found without it.
    pub compiler: Option<PathBuf>,
}

/// The compiler of a language.
///
/// # Errors
/// What to install where there is none.
pub fn compiler(written: Written, asked: Option<&Path>) -> Result<Compiler, String> {
    let variable = env::var_os(VARIABLE).filter(|value| !value.is_empty()).map(PathBuf::from);
    let paths: Vec<PathBuf> = env::var_os("PATH").iter().flat_map(env::split_paths).collect();
    let python: Vec<PathBuf> =
        ["VIRTUAL_ENV", "CONDA_PREFIX"].iter().filter_map(env::var_os).map(PathBuf::from).collect();
    let python: Vec<PathBuf> =
        python.into_iter().chain(paths.iter().filter_map(|p| Some(p.parent()?.to_owned()))).collect();
    of_these(written, asked.map(Path::to_owned).or(variable), &paths, &python)
}

fn of_these(
    written: Written,
    asked: Option<PathBuf>,
    paths: &[PathBuf],
    python: &[PathBuf],
) -> Result<Compiler, String> {
    let on_path = |name: &str| {
        let name = format!("{name}{}", env::consts::EXE_SUFFIX);
        paths.iter().map(|folder| folder.join(&name)).find(|path| path.is_file())
    };
    if let Some(program) = asked {
        let shown = program.display();
        let found = named(&program).ok_or_else(|| {
            format!("`{shown}` is no compiler that is known: name a `slangc`, `glslangValidator` or `glslang`")
        })?;
        if found.kind == Kind::Glslang && written == Written::Slang {
            return Err(format!("`{shown}` compiles HLSL and no Slang: name a `slangc`"));
        }
        let program = match program.components().count() {
            1 => on_path(&program.to_string_lossy()),
            _ => program.is_file().then(|| program.clone()),
        };
        let program = program.ok_or_else(|| format!("there is no compiler `{shown}`"))?;
        return Ok(Compiler { program, ..found });
    }
    let slang = on_path("slangc").or_else(|| python.iter().find_map(|prefix| wheel(prefix)));
    let hlsl = || on_path("glslangValidator").or_else(|| on_path("glslang"));
    let found = slang.or_else(|| hlsl().filter(|_| written == Written::Hlsl));
    found.as_deref().and_then(named).ok_or_else(|| {
        let others = match written {
            Written::Hlsl => ", or glslang (`apt-get install glslang-tools`)",
            _ => "",
        };
        format!(
            "{} needs a compiler, and none is found; install slangc (`pip install slangtorch` has one, as do the releases of \
             Slang){others}, or name one with `--compiler PATH` or {VARIABLE}",
            written.name()
        )
    })
}

/// `slangc` of the wheel `slangtorch`, in a Python environment.
fn wheel(prefix: &Path) -> Option<PathBuf> {
    let inside = |packages: PathBuf| {
        let program = packages.join("site-packages/slangtorch/bin").join(format!("slangc{}", env::consts::EXE_SUFFIX));
        program.is_file().then_some(program)
    };
    let mut versions: Vec<PathBuf> =
        std::fs::read_dir(prefix.join("lib")).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    versions.sort();
    versions.retain(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("python")));
    versions.into_iter().chain([prefix.join("Lib")]).find_map(inside)
}

/// Reads a text in HLSL or Slang whose includes are done; what it imports is looked for beside it and in `folders`.
///
/// # Errors
/// What the compiler says of the text, or that there is none; and as of [`ModuleText::read`].
pub fn read_compiled(
    file: &SourceFile,
    folders: &[PathBuf],
    defines: &[(String, String)],
    asked: &Asked,
) -> Result<(ModuleText, Compiler), ProgramError> {
    let written = Written::of(file);
    // Whoever asks names the file.
    let unable = |what: String| ProgramError::Unsupported { what };
    let compiler = compiler(written, asked.compiler.as_deref()).map_err(unable)?;
    let beside = Path::new(file.name()).parent().map(Path::to_owned);
    let beside = beside.map(|folder| if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder });
    let work = CompiledWork {
        file,
        text: without_line_directives(file.text()),
        written,
        compiler: &compiler,
        outline: Outline::read(file.text()),
        folders: beside.into_iter().chain(folders.iter().cloned()).collect(),
        defines,
    };
    let points = work.points(asked);
    let text = match compiler.kind {
        Kind::Slang => work.by_slangc(&points)?,
        Kind::Glslang => work.by_glslang(&points)?,
    };
    Ok((text, compiler))
}

/// `#line` would have the compiler name other lines than those of the text.
fn without_line_directives(text: &str) -> String {
    let is_line = |line: &str| {
        let directive = line.trim_start().strip_prefix('#').map(str::trim_start);
        directive.and_then(|rest| rest.strip_prefix("line")).is_some_and(|rest| rest.starts_with([' ', '\t']))
    };
    let blank = |line: &str| line.chars().map(|c| if matches!(c, '\n' | '\r') { c } else { ' ' }).collect::<String>();
    text.split_inclusive('\n').map(|line| if is_line(line) { blank(line) } else { line.to_owned() }).collect()
}

type Points = Vec<(String, PointStage)>;

struct CompiledWork<'a> {
    file: &'a SourceFile,
    text: String,
    written: Written,
    compiler: &'a Compiler,
    outline: Outline,
    folders: Vec<PathBuf>,
    defines: &'a [(String, String)],
}

impl CompiledWork<'_> {
    /// The entry points whose stage is known.
    fn points(&self, asked: &Asked) -> Points {
        let named = asked.entry.as_deref();
        let mut found: Points = Vec::new();
        for head in self.outline.functions.iter().filter(|head| Some(head.name.as_str()) == named) {
            let stage = asked.stage.and_then(point_stage);
            found.extend(stage.map(|stage| (head.name.clone(), stage)));
        }
        for (head, stage) in self.outline.points() {
            // The ending of a file that is called `a.vert.hlsl` or `a.ps.hlsl`, or what is asked for, says the rest.
            let stage =
                stage.or_else(|| (head.name == "main").then(|| asked.stage.or_else(|| by_name(self.file.name())))?);
            if let Some(stage) = stage.and_then(point_stage)
                && found.iter().all(|(name, _)| *name != head.name)
            {
                found.push((head.name.clone(), stage));
            }
        }
        found
    }

    fn compile(&self, text: &str, points: &Points) -> Result<Vec<u32>, CompileError> {
        self.compiler.compile(&Source {
            text,
            slang: self.written == Written::Slang,
            points,
            defines: self.defines,
            folders: &self.folders,
        })
    }

    /// glslang keeps functions that nothing calls, and takes one entry point at a time.
    fn by_glslang(&self, points: &Points) -> Result<ModuleText, ProgramError> {
        let keeper = vec![(OWN.to_owned(), PointStage::Fragment)];
        let mut modules = vec![self.told(self.compile(&format!("{}\nvoid {OWN}() {{}}\n", self.text), &keeper))?];
        for point in points {
            modules.push(self.told(self.compile(&self.text, &vec![point.clone()]))?);
        }
        let left_out: Vec<(usize, String)> = Vec::new();
        ModuleText::read_compiled(self.file, self.written, &modules, self.outline.clone(), &left_out)
    }

    /// slangc keeps what an entry point uses: one is put behind the text that calls each function. A function that cannot
    /// be called so is left out, with the reason.
    fn by_slangc(&self, points: &Points) -> Result<ModuleText, ProgramError> {
        let heads = &self.outline.functions;
        let is_point = |name: &str| points.iter().any(|(point, _)| point == name);
        let mut left_out: Vec<(usize, String)> = Vec::new();
        let mut kept: Vec<usize> = Vec::new();
        for (k, head) in heads.iter().enumerate().filter(|(_, head)| !is_point(&head.name)) {
            match &head.unfit {
                Some(why) => left_out.push((k, why.clone())),
                None => kept.push(k),
            }
        }
        let lines = self.text.split_inclusive('\n').count() + 1;
        let mut first_error = None;
        for attempt in 0..MOST_ATTEMPTS {
            let (whole, all_points) = self.with_keepers(&kept, points);
            let trouble: Vec<(Option<usize>, String)> = match self.compile(&whole, &all_points) {
                Ok(words) => {
                    let modules = [words];
                    match ModuleText::read_compiled(self.file, self.written, &modules, self.outline.clone(), &left_out)
                    {
                        Ok(text) => return Ok(text),
                        Err(ProgramError::Source(found)) if !kept.is_empty() => {
                            let at = |d: &Diagnostic| self.function_at(&kept, d.span.start);
                            let trouble = found.iter().map(|d| (at(d), d.message.to_string())).collect();
                            first_error.get_or_insert(ProgramError::Source(found));
                            trouble
                        }
                        Err(error) => return Err(error),
                    }
                }
                Err(CompileError::Refused(messages)) if !kept.is_empty() => {
                    let own = |m: &Message| m.file.is_none() && m.line < lines;
                    if attempt == 0 && messages.iter().any(own) {
                        // Whether the text is wrong shows without what is put behind it.
                        match self.compile(&self.text, points) {
                            Err(CompileError::Refused(found)) if !found.iter().all(is_nothing_to_do) => {
                                return Err(self.refused(&found));
                            }
                            _ => {}
                        }
                    }
                    let at = |m: &Message| match m.line.checked_sub(lines) {
                        Some(k) if m.file.is_none() => kept.get(k).copied(),
                        _ => self.function_at(&kept, self.span(m).start),
                    };
                    let trouble = messages.iter().map(|m| (at(m), m.text.clone())).collect();
                    first_error.get_or_insert_with(|| self.refused(&messages));
                    trouble
                }
                Err(error) => return self.told(Err(error)),
            };
            let before = kept.len();
            for (k, why) in trouble {
                let Some(k) = k.filter(|k| kept.contains(k)) else { continue };
                kept.retain(|other| *other != k);
                // A function that is not there, since the preprocessor leaves it out, is none.
                if !why.contains("undefined identifier") {
                    left_out.push((k, format!("{} cannot compile it alone: {why}", self.compiler.name())));
                }
            }
            if kept.len() == before {
                // Nobody knows which function it is: the entry points alone remain.
                let why = format!("{} cannot compile the functions of the text alone", self.compiler.name());
                left_out.extend(std::mem::take(&mut kept).into_iter().map(|k| (k, why.clone())));
                if points.is_empty() {
                    break;
                }
            }
        }
        Err(first_error.unwrap_or_else(|| ProgramError::Unsupported {
            what: format!("{} keeps none of its functions", self.compiler.name()),
        }))
    }

    fn with_keepers(&self, kept: &[usize], points: &Points) -> (String, Points) {
        let mut whole = self.text.clone();
        whole.push('\n');
        for k in kept {
            whole += &self.outline.functions[*k].keeper(*k);
            whole.push('\n');
        }
        let calls: String = kept.iter().map(|k| format!("sc_keep_{k}(); ")).collect();
        whole += &format!("void {OWN}() {{ {calls}}}\n");
        let own = (OWN.to_owned(), PointStage::Fragment);
        (whole, points.iter().cloned().chain([own]).collect())
    }

    /// Which of these functions stands at an offset.
    fn function_at(&self, kept: &[usize], offset: usize) -> Option<usize> {
        let heads = &self.outline.functions;
        let last = (0..heads.len()).filter(|k| heads[*k].span.start <= offset).max_by_key(|k| heads[*k].span.start)?;
        kept.contains(&last).then_some(last)
    }

    fn told<T>(&self, result: Result<T, CompileError>) -> Result<T, ProgramError> {
        result.map_err(|error| match error {
            CompileError::Refused(messages) => self.refused(&messages),
            CompileError::Failed(what) => ProgramError::Unsupported { what },
        })
    }

    /// What the compiler says, at the author's places.
    fn refused(&self, messages: &[Message]) -> ProgramError {
        let one = |message: &Message| {
            let (other, span) = match &message.file {
                None => (None, self.span(message)),
                Some(name) => {
                    let bytes = read_source(Path::new(name)).ok();
                    let file = bytes.and_then(|bytes| decode(name, &bytes).ok()).map(|decoded| decoded.file);
                    let span = file.as_ref().map_or(Span::at(0), |file| span_in(file, message));
                    (file, span)
                }
            };
            let file = other.as_ref().unwrap_or(self.file);
            let text = match (&message.file, &other) {
                (Some(name), None) => format!("{name}: {}", message.text),
                _ => message.text.clone(),
            };
            let found = Diagnostic::new(COMPILER, Severity::Error, file, span, text);
            let found = found.with_why(format!("{} says so", self.compiler.name()));
            match looks_like(self.file.text(), Looks::Hlsl) {
                Some((other, _)) => {
                    found.with_help(format!("the text looks like {}: give its file another ending", other.name()))
                }
                None => found,
            }
            .at_origin()
        };
        ProgramError::Source(messages.iter().map(one).collect())
    }

    fn span(&self, message: &Message) -> Span {
        span_in(self.file, message)
    }
}

/// slangc says so of a text without entry points that is right.
fn is_nothing_to_do(message: &Message) -> bool {
    message.line == 0 && (message.text.contains("no exported symbols") || message.text.contains("entry point"))
}

/// The place of a message: a word, or the line where no column is known.
fn span_in(file: &SourceFile, message: &Message) -> Span {
    let Some(line) = message.line.checked_sub(1) else { return Span::at(0) };
    let text = file.text();
    let Some(found) = text.split_inclusive('\n').nth(line) else { return Span::at(text.len()) };
    let start = found.as_ptr() as usize - text.as_ptr() as usize;
    let indent = found.len() - found.trim_start().len();
    let Some(column) = message.column.checked_sub(1) else {
        return Span::new(start + indent, start + found.trim_end().len().max(indent));
    };
    let byte = found.char_indices().nth(column).map_or(found.trim_end().len(), |(byte, _)| byte);
    let word = found[byte..].find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(found.len() - byte);
    Span::new(start + byte, start + byte + word.max(usize::from(byte < found.trim_end().len())))
}

/// The stage that the name of a file says in front of its ending: `a.vert.hlsl`, `a.ps.hlsl`.
fn by_name(name: &str) -> Option<Stage> {
    let stem = name.rsplit_once('.')?.0;
    let stage = stem.rsplit(['.', '_', '-']).next()?.to_ascii_lowercase();
    match stage.as_str() {
        "vert" | "vs" | "vertex" => Some(Stage::Vertex),
        "frag" | "ps" | "pixel" | "fragment" | "fs" => Some(Stage::Fragment),
        "comp" | "cs" | "compute" => Some(Stage::Compute),
        _ => None,
    }
}

fn point_stage(stage: Stage) -> Option<PointStage> {
    match stage {
        Stage::Vertex => Some(PointStage::Vertex),
        Stage::Fragment => Some(PointStage::Fragment),
        Stage::Compute => Some(PointStage::Compute),
        Stage::Geometry | Stage::TessControl | Stage::TessEvaluation | Stage::Library => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compiler_is_found_on_the_path_and_in_python_and_what_to_install_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let none = of_these(Written::Hlsl, None, &[], &[]).unwrap_err();
        assert!(none.contains("pip install slangtorch") && none.contains("glslang-tools"), "{none}");
        assert!(!of_these(Written::Slang, None, &[], &[]).unwrap_err().contains("glslang"));
        let put = |path: &Path| {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, "").unwrap();
        };
        let glslang = at("bin").join(format!("glslangValidator{}", env::consts::EXE_SUFFIX));
        put(&glslang);
        let (paths, python) = ([at("bin")], [at("venv")]);
        let found = of_these(Written::Hlsl, None, &paths, &python).unwrap();
        assert_eq!((found.kind, found.program), (Kind::Glslang, glslang.clone()));
        assert!(of_these(Written::Slang, None, &paths, &python).is_err());
        let refused = of_these(Written::Slang, Some(glslang.clone()), &paths, &python).unwrap_err();
        assert!(refused.contains("no Slang"), "{refused}");
        let slangc =
            at("venv/lib/python3.12/site-packages/slangtorch/bin").join(format!("slangc{}", env::consts::EXE_SUFFIX));
        put(&slangc);
        for written in [Written::Hlsl, Written::Slang] {
            assert_eq!(of_these(written, None, &paths, &python).unwrap().program, slangc);
        }
        let named = of_these(Written::Hlsl, Some("glslangValidator".into()), &paths, &python).unwrap();
        assert_eq!(named.program, glslang);
        assert!(
            of_these(Written::Hlsl, Some(at("slangc")), &paths, &python).unwrap_err().contains("there is no compiler")
        );
        assert!(
            of_these(Written::Hlsl, Some(at("fxc")), &paths, &python)
                .unwrap_err()
                .contains("no compiler that is known")
        );
    }

    #[test]
    fn lines_stay_where_they_are_without_their_directives() {
        assert_eq!(without_line_directives("a\n # line 7 \"b\"\nc #line\n"), "a\n             \nc #line\n");
    }

    #[test]
    fn the_name_of_a_file_says_its_stage() {
        let stages = ["a.vert.hlsl", "b_ps.hlsl", "light.cs.slang", "noise.hlsl"].map(by_name);
        assert_eq!(stages, [Some(Stage::Vertex), Some(Stage::Fragment), Some(Stage::Compute), None]);
    }
}
