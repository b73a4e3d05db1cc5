//! Which statements and branches of shaders were reached, counted by the interpreter, as LCOV
//! (<https://github.com/linux-test-project/lcov>, `man geninfo`).

use std::collections::BTreeMap;
use std::fmt::Write as _;

use base::text::{SourceFile, Span};
use base::value::Batch;
use program::Program;
use program::interp::{self, Binary32, FUEL, InterpError, Machine};
use syntax::ast::{ItemKind, StmtKind};
use syntax::{Shader, walk};

/// What was reached, file by file.
#[derive(Debug, Default)]
pub struct Coverage {
    files: BTreeMap<String, Hits>,
}

/// What was reached of a file.
#[derive(Debug)]
struct Hits {
    file: SourceFile,
    /// Invocations at each place, by its first and last byte.
    places: BTreeMap<(usize, usize), u64>,
    /// Invocations for which a choice was true, and for which it was false.
    choices: BTreeMap<(usize, usize), [u64; 2]>,
}

/// How much of something was reached.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// How much of it.
    pub reached: u64,
    /// All of it.
    pub all: u64,
}

impl Share {
    fn add(&mut self, count: u64) {
        self.all += 1;
        self.reached += u64::from(count > 0);
    }
}

/// A report.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lcov {
    /// The text of the file.
    pub text: String,
    /// Lines with statements.
    pub lines: Share,
    /// Functions.
    pub functions: Share,
    /// Ways out of choices.
    pub branches: Share,
}

impl Coverage {
    /// Runs a program and counts what it reaches.
    ///
    /// # Errors
    /// [`InterpError`] for a program that is not interpreted.
    pub fn run(&mut self, program: &Program, batch: &Batch) -> Result<(), InterpError> {
        let executable = interp::compile_covered(program)?;
        let mut machine = Machine::new(&executable, Binary32::default(), FUEL);
        let mut first = 0;
        while first < batch.invocation_count() {
            first += machine.run(batch, first).max(1);
        }
        // One statement of the text may be several of the module, and stands once for each call: the most counts.
        let (mut places, mut choices): (BTreeMap<Span, u64>, BTreeMap<Span, [u64; 2]>) = Default::default();
        for (reached, count) in machine.reached() {
            let Some(span) = interp::source_span(reached.span) else { continue };
            let own = match reached.branch {
                None => places.entry(span).or_default(),
                Some(branch) => &mut choices.entry(span).or_default()[usize::from(!branch)],
            };
            *own = count.max(*own);
        }
        for (span, count) in places {
            let (hits, key) = self.at(&program.file, span);
            *hits.places.entry(key).or_default() += count;
        }
        for (span, [yes, no]) in choices {
            let (hits, key) = self.at(&program.file, span);
            let own = hits.choices.entry(key).or_default();
            *own = [own[0] + yes, own[1] + no];
        }
        Ok(())
    }

    fn at(&mut self, file: &SourceFile, span: Span) -> (&mut Hits, (usize, usize)) {
        let (file, span) = file.origin(span);
        let new = || Hits { file: file.clone(), places: BTreeMap::new(), choices: BTreeMap::new() };
        (self.files.entry(file.name().to_owned()).or_insert_with(new), (span.start, span.end))
    }

    /// The report. `read` gives the tree of a file, and `is_wanted` says of a function of a file whether it counts; a file
    /// without such a function is left out. Functions that nothing reached count as well.
    pub fn lcov(&self, read: &dyn Fn(&SourceFile) -> Shader, is_wanted: &dyn Fn(&str, &str) -> bool) -> Lcov {
        let mut lcov = Lcov::default();
        for hits in self.files.values() {
            hits.write(&read(&hits.file), is_wanted, &mut lcov);
        }
        lcov
    }
}

impl Hits {
    fn write(&self, shader: &Shader, is_wanted: &dyn Fn(&str, &str) -> bool, lcov: &mut Lcov) {
        let name = self.file.name();
        let line = |at: usize| self.file.position(at).line;
        let (mut functions, mut lines, mut branches) = (String::new(), BTreeMap::<usize, u64>::new(), String::new());
        let (mut of_functions, mut of_lines, mut of_branches) = (Share::default(), Share::default(), Share::default());
        let all = counted(shader);
        for item in &shader.unit().items {
            let ItemKind::Function(function) = &item.kind else { continue };
            if function.body.is_none() || !is_wanted(name, &function.name.name) {
                continue;
            }
            let statements: Vec<Span> = all.iter().copied().filter(|own| item.span.contains(own.start)).collect();
            let counts = self.counts(&statements);
            let is_known = counts.iter().any(Option::is_some);
            let first = statements.iter().zip(&counts).filter_map(|(span, count)| Some((span.start, (*count)?)));
            let entered = first.min().map_or(0, |(_, count)| count);
            of_functions.add(entered);
            let _ = writeln!(functions, "FN:{},{}", line(function.name.span.start), function.name.name);
            let _ = writeln!(functions, "FNDA:{entered},{}", function.name.name);
            for (statement, count) in statements.iter().zip(counts) {
                // A statement for which nothing is computed, in a function that is known, is no place to be at.
                let Some(count) = count.or((!is_known).then_some(0)) else { continue };
                let own = lines.entry(line(statement.start)).or_default();
                *own = count.max(*own);
            }
            for (block, ((start, _), taken)) in
                self.choices.iter().filter(|(key, _)| item.span.contains(key.0)).enumerate()
            {
                let met = taken.iter().sum::<u64>() > 0;
                for (way, count) in taken.iter().enumerate() {
                    of_branches.add(*count);
                    let count = if met { count.to_string() } else { "-".to_owned() };
                    let _ = writeln!(branches, "BRDA:{},{block},{way},{count}", line(*start));
                }
            }
        }
        if of_functions.all == 0 {
            return;
        }
        lines.values().for_each(|count| of_lines.add(*count));
        let _ =
            write!(lcov.text, "TN:\nSF:{name}\n{functions}FNF:{}\nFNH:{}\n", of_functions.all, of_functions.reached);
        let _ = write!(lcov.text, "{branches}BRF:{}\nBRH:{}\n", of_branches.all, of_branches.reached);
        for (line, count) in &lines {
            let _ = writeln!(lcov.text, "DA:{line},{count}");
        }
        let _ = write!(lcov.text, "LF:{}\nLH:{}\nend_of_record\n", of_lines.all, of_lines.reached);
        for (all, own) in
            [(&mut lcov.lines, of_lines), (&mut lcov.functions, of_functions), (&mut lcov.branches, of_branches)]
        {
            (all.all, all.reached) = (all.all + own.all, all.reached + own.reached);
        }
    }

    /// For each statement how often it was reached; none where no statement of a module is known to be of it.
    fn counts(&self, statements: &[Span]) -> Vec<Option<u64>> {
        let mut counts = vec![None; statements.len()];
        for (&(start, _), &count) in &self.places {
            let around = statements.iter().enumerate().filter(|(_, span)| span.contains(start));
            if let Some((at, _)) = around.min_by_key(|(_, span)| span.len()) {
                counts[at] = Some(count.max(counts[at].unwrap_or(0)));
            }
        }
        counts
    }
}

/// The places of all statements of a file that do something.
fn counted(shader: &Shader) -> Vec<Span> {
    let mut found = Vec::new();
    walk::statements(shader, |statement| {
        let does = !matches!(
            statement.kind,
            StmtKind::Block(_)
                | StmtKind::Empty
                | StmtKind::Precision(_)
                | StmtKind::Qualified(_)
                | StmtKind::Case(_)
                | StmtKind::Default
                | StmtKind::Error
        );
        found.extend(does.then_some(statement.span));
    });
    found
}
