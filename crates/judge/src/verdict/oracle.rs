//! What a program means, ready to be asked: the interpreter and what bounds a lane.

use std::sync::Arc;

use crate::profile::Promises;
use crate::tape::{Cell, Fold, Glance, Literal, Model, Tape};
use base::value::Batch;
use program::Program;
use program::interp::group::Ran;
use program::interp::{self, Binary64, Executable, FUEL, InterpError, Machine, SLOTS};
use program::lane::Stage;

use super::edges::Watch;
use super::judge::Promise;
use super::literals::{self, Written};
use super::reading::{Reading, within_device};
use super::reference::Reference;
use super::rounded::{self, Literals, Rounded};

/// Rounds of loops of a sample that is watched: edges are sought with many samples.
const WATCHED: u32 = 1 << 12;

/// The meaning of a program.
#[derive(Clone, Debug)]
pub struct Oracle {
    pub(super) executable: Executable,
    /// Literals as their author wrote them, by the number of their site.
    pub(super) literals: Vec<Option<Literal>>,
    /// Their values alone; `None` when all are binary32 numbers.
    ideal: Option<Arc<[f64]>>,
    /// The module's binary32 in place of each of them, off by what its author wrote.
    rounded: Vec<Option<Literal>>,
    /// The same, off by what other front ends make of a constant expression.
    folded: Vec<Option<Literal>>,
    /// Literals that are known constants in few digits.
    pub(super) rounded_constants: Vec<Rounded>,
    /// The program with these constants; where there are any.
    pub(super) readings: Vec<Reading>,
    fuel: u32,
}

impl Oracle {
    /// Compiles a program for the interpreter. Every literal counts as it is written.
    ///
    /// # Errors
    /// [`InterpError`] for constructs that are not interpreted.
    pub fn new(program: &Program) -> Result<Self, InterpError> {
        Ok(Self::of(program, interp::compile(program)?, None))
    }

    /// The same for a lane on which `mediump` and `lowp` are less than binary32: of their operations it is held against
    /// what GLSL ES promises.
    ///
    /// # Errors
    /// [`InterpError`] for constructs that are not interpreted.
    pub fn lowered(program: &Program) -> Result<Self, InterpError> {
        Ok(Self::of(program, interp::compile_lowered(program)?, None))
    }

    /// The same, where literals that are known constants in few digits may stand for these.
    ///
    /// # Errors
    /// [`InterpError`] for constructs that are not interpreted.
    pub fn with_literals(program: &Program, literals: &Literals) -> Result<Self, InterpError> {
        let executable = interp::compile(program)?;
        let rounded_constants = rounded::find(program, literals);
        let read = |meant: &dyn Fn(f64) -> f64| Self::of(program, executable.clone(), Some(meant));
        let readings = Reading::all(&rounded_constants, &read);
        Ok(Self { rounded_constants, readings, ..Self::of(program, executable, None) })
    }

    /// The program with literals as they are meant.
    fn of(program: &Program, executable: Executable, meant: Option<&dyn Fn(f64) -> f64>) -> Self {
        let written = literals::written(program, &executable, meant);
        let literals: Vec<Option<Literal>> = written.iter().map(|w| w.and_then(Written::other)).collect();
        let value = |literal: &Option<Literal>| literal.map_or(f64::NAN, |literal| literal.value);
        let ideal = literals.iter().any(Option::is_some).then(|| literals.iter().map(value).collect());
        let rounded = written.iter().map(|w| w.map(as_rounded)).collect();
        let folded = written.iter().map(|w| w.filter(|w| w.spread > 0.0).map(as_folded)).collect();
        let (rounded_constants, readings) = (Vec::new(), Vec::new());
        Self { executable, literals, ideal, rounded, folded, rounded_constants, readings, fuel: FUEL }
    }

    /// The same with another number of rounds that loops may take.
    #[must_use]
    pub fn with_fuel(self, fuel: u32) -> Self {
        let read = |reading: Reading| Reading { oracle: reading.oracle.with_fuel(fuel), ..reading };
        let readings = self.readings.into_iter().map(read).collect();
        Self { fuel, readings, ..self }
    }

    /// Literals that are known constants in few digits, and may stand for these.
    pub fn rounded_constants(&self) -> &[Rounded] {
        &self.rounded_constants
    }

    /// The program with one of its literals as the constant that it stands for.
    pub(super) fn read(&self, program: &Program, one: &Rounded) -> Self {
        let literal = |v: f64| if v == one.written { one.meant } else { v };
        Self::of(program, self.executable.clone(), Some(&literal))
    }

    /// The program as the interpreter runs it.
    pub fn executable(&self) -> &Executable {
        &self.executable
    }

    /// Literals as their author wrote them, where that is another number than the module's.
    pub(super) fn written(&self) -> &[Option<Literal>] {
        &self.literals
    }

    /// The module's binary32 in place of each literal, off by what its author wrote.
    pub(super) fn rounded(&self) -> &[Option<Literal>] {
        &self.rounded
    }

    /// The module's binary32 in place of each literal, off by what other front ends make of a constant expression.
    pub(super) fn folded(&self) -> &[Option<Literal>] {
        &self.folded
    }

    /// True when some literal is no binary32 number.
    pub(super) fn has_rounded_literals(&self) -> bool {
        self.ideal.is_some()
    }

    /// A machine for the meaning of the module, with literals in binary32.
    pub(super) fn meaning(&self) -> Machine<'_, Binary64> {
        Machine::new(&self.executable, Binary64::default(), self.fuel)
    }

    /// A machine for what the author wrote; `None` when the module means just that.
    pub(super) fn ideal(&self) -> Option<Machine<'_, Binary64>> {
        let literals = self.ideal.clone()?;
        Some(Machine::new(&self.executable, Binary64::with_literals(literals), self.fuel))
    }

    /// A machine for what the author wrote, whether or not the module means just that.
    pub(super) fn ideal_or_meaning(&self) -> Machine<'_, Binary64> {
        self.ideal().unwrap_or_else(|| self.meaning())
    }

    /// A machine for what the author wrote that remembers what is asked of numbers.
    pub(super) fn watch(&self) -> Machine<'_, Watch> {
        let plain = self.ideal.clone().map_or_else(Binary64::default, Binary64::with_literals);
        Machine::new(&self.executable, Watch::new(plain), self.fuel.min(WATCHED))
    }

    /// A machine for what the author wrote, with bounds on the error of binary64.
    pub(super) fn ideal_tape(&self) -> Machine<'_, Tape<'_>> {
        Machine::new(&self.executable, Tape::new(Model::Binary64).with_literals(&self.literals), self.fuel)
    }

    /// A machine for the meaning of the module, on which the rounding of literals counts as an error and
    /// nothing else but binary64 does.
    pub(super) fn rounded_tape(&self) -> Machine<'_, Tape<'_>> {
        Machine::new(&self.executable, Tape::new(Model::Binary64).with_literals(&self.rounded), self.fuel)
    }

    /// A machine for what the author wrote, with bounds for devices that had the literals exactly.
    pub(super) fn ideal_device_tape<'p>(&'p self, model: Model<'p>) -> Machine<'p, Tape<'p>> {
        Machine::new(&self.executable, Tape::new(model).with_literals(&self.literals), self.fuel)
    }

    /// A machine with bounds for devices, measured from what the author wrote: the rounding of a literal
    /// counts as an error of its own.
    pub(super) fn authored_tape<'p>(&'p self, model: Model<'p>) -> Machine<'p, Tape<'p>> {
        Machine::new(&self.executable, Tape::new(model).with_literals(&self.rounded), self.fuel)
    }

    /// A machine with bounds for devices that knows at once how far outputs may surely be off.
    pub(super) fn moving_tape<'p>(&'p self, model: Model<'p>) -> Machine<'p, Tape<'p>> {
        Machine::new(&self.executable, Tape::new(model).with_literals(&self.folded).with_tangents(), self.fuel)
    }

    /// The same for a glance; `None` for a model that it does not know.
    pub(super) fn glance<'p>(&'p self, model: Model<'p>) -> Option<Machine<'p, Glance<'p>>> {
        Some(Machine::new(&self.executable, Glance::new(model, &self.folded)?, self.fuel))
    }

    /// What a large dispatch means: literals as their author wrote them.
    ///
    /// # Errors
    /// As of [`Executable::run_whole`].
    pub(super) fn plain_whole(&self, batch: &Batch, invocation: usize) -> Result<Ran<f64>, InterpError> {
        let plain = || self.ideal.clone().map_or_else(Binary64::default, Binary64::with_literals);
        self.executable.run_whole(batch, invocation, 0, plain)
    }

    /// The same with how far binary64 is from it.
    ///
    /// # Errors
    /// As of [`Executable::run_whole`].
    pub(super) fn ideal_whole(&self, batch: &Batch, invocation: usize) -> Result<Ran<Cell>, InterpError> {
        self.whole((Model::Binary64, &self.literals), false, batch, invocation)
    }

    /// A large dispatch with radii by a model, with something in the place of its literals; `bracketed` with what is known of
    /// a device that rounds to nearest. [`Passes`](super::Passes) runs each but once.
    ///
    /// # Errors
    /// As of [`Executable::run_whole`].
    pub(super) fn whole(
        &self,
        (model, literals): (Model<'_>, &[Option<Literal>]),
        bracketed: bool,
        batch: &Batch,
        invocation: usize,
    ) -> Result<Ran<Cell>, InterpError> {
        let tape = || {
            let tape = Tape::new(model).with_literals(literals).with_radii();
            if bracketed { tape.with_brackets() } else { tape }
        };
        self.executable.run_whole(batch, invocation, 0, tape)
    }

    /// A machine with bounds for devices.
    pub(super) fn tape<'p>(&'p self, model: Model<'p>) -> Machine<'p, Tape<'p>> {
        self.bounding(Tape::new(model))
    }

    /// The same for devices that are not told of `precise`.
    pub(super) fn tape_without_precise<'p>(&'p self, model: Model<'p>) -> Machine<'p, Tape<'p>> {
        self.bounding(Tape::new(model).without_precise())
    }

    /// The same for devices whose compiler leaves a pair of operations out.
    pub(super) fn tape_folding<'p>(&'p self, model: Model<'p>, fold: Fold) -> Machine<'p, Tape<'p>> {
        self.bounding(Tape::new(model).folding(fold))
    }

    fn bounding<'p>(&'p self, tape: Tape<'p>) -> Machine<'p, Tape<'p>> {
        Machine::new(&self.executable, tape.with_literals(&self.folded), self.fuel)
    }
}

/// A literal as the module has it, with how far that may be from what was meant.
fn as_rounded(written: Written) -> Literal {
    let Written { module, literal, spread } = written;
    Literal { value: module, slack: (literal.value - module).abs() + literal.slack + spread }
}

/// A literal as the module has it, with how far that may be from what another front end makes of the same expression.
fn as_folded(written: Written) -> Literal {
    Literal { value: written.module, slack: written.spread }
}

/// Everything that a verdict on a lane needs.
#[derive(Clone, Copy)]
pub struct JudgeContext<'a> {
    /// What the program means.
    pub oracle: &'a Oracle,
    /// What the formula says.
    pub reference: &'a Reference,
    /// What the lane is held against.
    pub promises: &'a Promises,
    /// The stage in which the lane ran.
    pub stage: Stage,
}

impl<'a> JudgeContext<'a> {
    /// The same context for each reading of the program's literals as the constants that they round.
    pub fn readings(&self) -> Vec<Self> {
        let oracle: &'a Oracle = self.oracle;
        oracle.readings.iter().map(|reading| JudgeContext { oracle: &reading.oracle, ..*self }).collect()
    }

    /// For each invocation of a batch, whether one of its [`JudgeContext::readings`] may take the place of what is written.
    pub fn may_read(&self, reading: &JudgeContext<'_>, batch: &Batch) -> Vec<bool> {
        let invocations: Vec<usize> = (0..batch.invocation_count()).collect();
        let precise = |known: &&Reading| std::ptr::eq(&known.oracle, reading.oracle);
        if self.oracle.readings.iter().find(precise).is_some_and(|known| known.precise) {
            return vec![true; invocations.len()];
        }
        invocations.chunks(SLOTS).flat_map(|some| within_device(self, reading.oracle, batch, some)).collect()
    }

    /// What may be allowed to a lane, the strictest first.
    pub(super) fn tiers(&self) -> Vec<(Promise, Model<'a>)> {
        let Promises { text, conformance, measured: _ } = self.promises;
        let stage = self.stage;
        let device = |profile, rearranged| Model::Device { profile, stage, rearranged };
        let mut tiers = vec![(Promise::Text, device(*text, false))];
        tiers.extend(conformance.map(|profile| (Promise::Conformance, device(profile, false))));
        let lenient = self.promises.lenient();
        if lenient.rearrangement {
            tiers.push((Promise::Rearranged, device(lenient, true)));
        }
        tiers.extend(self.measured().map(|model| (Promise::Measured, model)));
        tiers
    }

    /// What the device was measured to keep.
    pub(super) fn measured(&self) -> Option<Model<'a>> {
        let profile = self.promises.measured.as_ref()?;
        Some(Model::Device { profile, stage: self.stage, rearranged: profile.rearrangement })
    }

    /// The tightest bounds there are, for the order in which sums and products are written.
    pub(super) fn as_written(&self) -> Model<'a> {
        match self.measured().unwrap_or(self.lenient()) {
            Model::Device { profile, stage, .. } => Model::Device { profile, stage, rearranged: false },
            Model::Binary64 => Model::Binary64,
        }
    }

    /// The most that any promise allows.
    pub(super) fn lenient(&self) -> Model<'a> {
        let profile = self.promises.lenient();
        Model::Device { profile, stage: self.stage, rearranged: profile.rearrangement }
    }
}
