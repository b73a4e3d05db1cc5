//! `shadercheck compare`: the same function in two texts, whatever language each is written in.

mod many;
mod twins;
mod version;

pub use many::{COMMAND as OF_TWINS, ShardResult as TwinsResult};

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::Context as _;
use clap::Args;
use serde::{Deserialize, Serialize};

use super::check::profile;
use super::check::shell_word;
use super::compose::{ComposeArgs, Given};
use super::fuzz::{Inputs, subjects};
use super::hosts::Hosts;
use super::includes::IncludedText;
use super::inputs::InputArgs;
use super::reported::{self, Reported};
use super::shard::{Printed, Printing, ShardArgs, Terminal};
use super::status::ExitStatus;
use super::waiting::Waiting;
use base::diagnostic::{Diagnostic, Lang};
use engine::compare::{self, Compared, Pairing, Request, SameBits, Unpaired};
use engine::fuzz::{Domain, Subject};
use engine::session::{At, Job, Join, Seen, Unlike};
use engine::shard::Identity;
use judge::profile::Profile;
use lanes::Lane;
use report::compare::{Summary, ci, json, text};

/// Samples of a pair, when none are asked for.
const SAMPLES: u64 = 1 << 14;

/// Arguments of `shadercheck compare`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Functions are paired by name and by the types of their parameters: `cubic2` of WGSL is the `cubic` of GLSL that \
takes a `vec2`. Parameters are matched by name, or by place if all types are the same. Both functions of a pair \
get the same inputs, those that the first is likely to get.

The report says whether the two mean the same in real numbers, with the smallest input if they do not; how far a \
conforming device may be off in each; and the results of lanes.

With --same-bits, it says for each output whether both have the same bits on every device that keeps the first profile: \
samples that have, samples that differ in strict binary32 already, and samples that are left to devices, with the operations \
that leave them open. Sums and products count as rounded to nearest.

Two folders or patterns ('glsl/**' 'wgsl/**') are compared file by file: twins have one path behind what the patterns begin \
with, or one name. Without files, the pairs are those of shadercheck.toml, where functions that are known to differ are \
left out:

  [compare]
  pairs = [{ first = \"glsl/**\", second = \"wgsl/**\", except = [\"hash\"] }]

Exit status: 0 all pairs mean the same; 1 some do not, or a text does not compile; 2 usage, or nothing could be \
compared.")]
pub struct CompareArgs {
    /// A shader file, or a version of it in git: `HEAD:shaders/light.glsl`; or a folder or pattern of files that have
    /// twins in SECOND [default: the pairs that shadercheck.toml states]
    #[arg(value_name = "FIRST", requires = "second")]
    pub first: Option<String>,
    /// Another shader file or version, in any language; or the folder or pattern of the twins
    #[arg(value_name = "SECOND")]
    pub second: Option<String>,
    /// Only functions of this name, or one overload by its types: `cubic(vec2)`; `NAME=OTHER` if the second text calls
    /// it differently; repeatable
    #[arg(long, value_name = "NAME")]
    pub function: Vec<String>,
    /// What is said of the files and their inputs
    #[command(flatten)]
    pub input: InputArgs,
    /// Value of a macro, or of an `override` constant of WGSL, only in the second text; repeatable
    #[arg(long, value_name = "NAME=VALUE", value_parser = super::definition::definition)]
    pub define_second: Vec<(String, String)>,
    /// What is stated about texts in WGSL that are parts of others.
    #[command(flatten)]
    pub compose: ComposeArgs,
    /// Only these lanes [default: all available]
    #[arg(long, value_name = "LANE", value_delimiter = ',')]
    pub lane: Vec<String>,
    /// Profile for bounds: a shipped one by name, or a file that `calibrate` wrote; repeatable. The first one decides
    /// which differences a device may hide
    #[arg(long, value_name = "PROFILE", default_value = "vulkan-1.4")]
    pub profile: Vec<String>,
    /// Ask also whether both have the same bits on every conforming device: the status is 1 if not
    #[arg(long)]
    pub same_bits: bool,
    /// Samples per pair
    #[arg(long, value_name = "N", default_value_t = SAMPLES, value_parser = clap::value_parser!(u64).range(1..))]
    pub samples: u64,
    /// Compare only this case, copied from the `reproduce` line of a report; needs --function
    #[arg(long, value_name = "INPUTS", requires = "function")]
    pub case: Option<String>,
    /// Write a page (`index.html`) to this folder, with charts of both functions, their difference and their bounds
    /// over each input, and the report in every format; of folders and patterns the report alone
    #[arg(long, value_name = "DIR")]
    pub report_dir: Option<PathBuf>,
    /// Which pairs of the run: pair `k` is done by shard `k` modulo N
    #[command(flatten)]
    pub sharing: ShardArgs,
    /// Format of the result
    #[arg(long, value_parser = reported::parser(), default_value = "text")]
    pub format: Reported,
}

impl CompareArgs {
    /// The two arguments, if there are any.
    fn two(&self) -> Option<[&str; 2]> {
        Some([self.first.as_deref()?, self.second.as_deref()?])
    }
}

/// The profiles that bounds are derived from.
fn profiles(args: &CompareArgs) -> anyhow::Result<Vec<Arc<Profile>>> {
    let profiles = args.profile.iter().map(|name| match profile::named(name)? {
        Some(profile) => Ok(profile),
        None => anyhow::bail!("--profile: a comparison needs bounds; `none` has none"),
    });
    profiles.collect()
}

/// Runs the command: the result goes to `out`, complaints to `err`.
///
/// # Errors
/// When a text cannot be read, a name is unknown, a domain or profile cannot be read, no lane is available, or output fails.
pub fn run(args: &CompareArgs, out: &mut dyn Write, err: &mut dyn Write, color: bool) -> anyhow::Result<ExitStatus> {
    let Some([first, second]) = args.two() else {
        return many::run(args, &twins::configured()?, (out, err), color);
    };
    if [first, second].into_iter().any(twins::means_several) {
        return many::run(args, &twins::of_arguments([first, second])?, (out, err), color);
    }
    let shard = args.sharing.shard()?;
    anyhow::ensure!(
        shard.is_none() || (args.case.is_none() && args.report_dir.is_none()),
        "--shard does a part of the pairs; --case and --report-dir are for a run without it"
    );
    let _waiting = Waiting::begin();
    let stage = args.input.stage();
    let second_defines = [&args.input.define[..], &args.define_second[..]].concat();
    let given = |defines| Given { defines, ..args.input.reading(Some(&args.compose), None) };
    let mut hosts = Hosts::default();
    let texts = [
        version::text(first, &given(&args.input.define), stage)?.assuming(&args.input.define, &mut hosts),
        version::text(second, &given(&second_defines), stage)?.assuming(&second_defines, &mut hosts),
    ];
    for note in texts.iter().flat_map(IncludedText::notes) {
        writeln!(err, "note: {note}")?;
    }
    let stated = args.input.domains()?;
    let profiles = profiles(args)?;
    let sides = [made(&texts[0], &args.input.define, err)?, made(&texts[1], &second_defines, err)?];
    if sides.iter().any(|(subjects, error)| is_broken(subjects, error.as_ref())) {
        return Ok(ExitStatus::Findings);
    }
    let [(firsts, _), (seconds, _)] = &sides;
    let Pairing { pairs, unpaired } =
        compare::pairing([firsts, seconds], &args.function).map_err(anyhow::Error::msg)?;
    let opened = super::lanes::opened(&args.lane, args.lane.is_empty())?;
    let lanes: Vec<&dyn Lane> = opened.iter().map(AsRef::as_ref).collect();
    let request = Request {
        samples: args.samples,
        seed: args.input.seed,
        case: args.case.clone(),
        profiles: profiles.iter().map(AsRef::as_ref).collect::<Vec<&Profile>>(),
        command: command(args, [first, second]),
        curves: args.report_dir.is_some(),
        same_bits: args.same_bits,
    };
    let names = texts.each_ref().map(|text| text.name.clone());
    let errors = sides.iter().filter_map(|(_, error)| error.clone()).collect();
    let part = ShardResult { texts: names, errors, unpaired, pairs: Vec::new(), page: args.report_dir.clone() };
    let key = |shards| identity(args, shards, &texts, &lanes);
    let texts = texts.each_ref();
    let mut pairs = Pairs { pairs, texts, lanes: &lanes, request, inputs: Inputs::new(&stated) };
    args.sharing.run(&mut pairs, part, key, &mut Terminal::new(args.format, color, out, err))
}

/// Everything that the result of a run depends on.
fn identity(args: &CompareArgs, shards: u64, texts: &[IncludedText], lanes: &[&dyn Lane]) -> Identity {
    let identity = Identity::new("compare", args.input.seed, shards)
        .with("command", command(args, args.two().unwrap_or_default()))
        .with("--function", args.function.join("; "))
        .with("--profile", args.profile.join(","))
        .with("--samples", args.samples)
        .on(lanes.iter().map(|lane| lane.description()));
    texts.iter().fold(identity, |all, text| all.of(&format!("file `{}`", text.name), text.file.text()))
}

/// The pairs of functions of a run.
struct Pairs<'a> {
    pairs: Vec<[&'a Subject; 2]>,
    texts: [&'a IncludedText; 2],
    lanes: &'a [&'a dyn Lane],
    request: Request<'a>,
    inputs: Inputs<'a>,
}

impl<'a> Job for Pairs<'a> {
    type Unit = ([&'a Subject; 2], Domain);
    type Part = ShardResult;
    type Error = anyhow::Error;
    type Event<'e> = Seen<'e>;

    fn unit(&mut self, number: u64, _: &mut At<'_, Self>) -> anyhow::Result<Option<Self::Unit>> {
        let Some(&pair) = self.pairs.get(number as usize) else {
            self.inputs.all_used()?;
            return Ok(None);
        };
        Ok(Some((pair, self.inputs.domain(pair[0])?)))
    }

    fn run(&mut self, (number, (pair, domain)): (u64, Self::Unit), at: &mut At<'_, Self>) -> anyhow::Result<()> {
        let compared = compare::run(pair, &domain, self.lanes, &self.request);
        let compared = compared.map_err(|why| anyhow::anyhow!("--case: {why}"))?;
        at.part.pairs.push((number, open(compared, pair, self.texts)));
        Ok(())
    }
}

/// True for a variable of a module that each invocation has for itself: 0 at first, until other functions write it.
fn is_private(text: &IncludedText, name: &str) -> bool {
    let text = text.file.text();
    let named = |rest: &str| syntax::words::identifier(rest.trim_start()) == name;
    text.match_indices("var<private>").any(|(at, mark)| named(&text[at + mark.len()..]))
}

/// What came of a pair, where a difference may lie in what stands for a name that one text lacks, or in a variable that
/// others write before: then nothing is known.
fn open(compared: Compared, pair: [&Subject; 2], texts: [&IncludedText; 2]) -> Compared {
    let inputs = pair.map(|subject| {
        let records = subject.ready.iter().flat_map(|ready| [&ready.kernel.invocation, &ready.kernel.case]);
        let names = records.flat_map(|record| record.fields()).map(|field| field.name.as_str());
        names.map(|name| name.rsplit(' ').next().unwrap_or(name)).collect::<Vec<&str>>()
    });
    let own = |side: usize| {
        let made_up = inputs[side].iter().find(|name| texts[side].makes_up(name) && !inputs[1 - side].contains(name));
        let of_macro = || texts[side].assumed().iter().find(|one| !texts[1 - side].assumed().contains(one));
        made_up.map(|name| (*name).to_owned()).or_else(|| of_macro().map(|(name, _)| name.clone()))
    };
    let private = || {
        let alone = inputs[0].iter().find(|name| !inputs[1].contains(name) && is_private(texts[1], name))?;
        Some(format!(
            "`{alone}` is an input of the first, and in {} a variable that others write before",
            texts[1].name
        ))
    };
    let made_up = own(0).map(|name| (name, 0)).or_else(|| own(1).map(|name| (name, 1)));
    let why =
        made_up.map(|(name, side)| format!("{} lacks `{name}`, and what stands for it differs", texts[side].name));
    match why.or_else(private) {
        Some(why) if compared.unlike.0 > 0 => Compared {
            not_compared: Some(why),
            equal: 0,
            unlike: (0, 0),
            smallest: None,
            same_bits: Vec::new(),
            ..compared
        },
        _ => compared,
    }
}

/// What came of some pairs, each with its number in the run.
#[derive(Debug, Serialize, Deserialize)]
pub struct ShardResult {
    texts: [String; 2],
    /// The first error of each text of which some functions do not compile.
    #[serde(default)]
    errors: Vec<String>,
    unpaired: [Vec<Unpaired>; 2],
    pairs: Vec<(u64, Compared)>,
    /// Where the page of a whole run goes.
    #[serde(skip)]
    page: Option<PathBuf>,
}

impl Join for ShardResult {
    fn join(&mut self, other: Self) -> Result<(), Unlike> {
        let same = self.texts == other.texts && self.unpaired == other.unpaired;
        Unlike::unless(same, "compared different texts")?;
        self.pairs.extend(other.pairs);
        self.pairs.sort_by_key(|(number, _)| *number);
        Ok(())
    }
}

impl Printed for ShardResult {
    fn print(self, mut to: Printing<'_>) -> anyhow::Result<ExitStatus> {
        let Self { texts, errors, unpaired, pairs, page: folder } = self;
        let broken = !errors.is_empty();
        let pairs = pairs.into_iter().map(|(_, compared)| compared).collect();
        let (seed, interrupted) = (to.identity.seed, to.interrupted);
        let summary = Summary { texts, seed, pairs, unpaired, errors, interrupted };
        if let Some(folder) = folder {
            page(&folder, &summary)?;
        }
        let printed = to.format.of(|| ci(&summary), || json(&summary))?.unwrap_or_else(|| text(&summary, to.color));
        to.out.write_all(printed.as_bytes())?;
        Ok(if let Some(status) = to.ended()? {
            status
        } else if !summary.pairs.iter().any(Compared::is_known) {
            writeln!(to.err, "error: nothing could be compared")?;
            ExitStatus::Error
        } else if broken
            || summary.pairs.iter().any(|pair| pair.unlike.0 > 0 || !pair.same_bits.iter().all(SameBits::holds))
        {
            ExitStatus::Findings
        } else {
            ExitStatus::Clean
        })
    }
}

/// The functions of a text, each ready to run or told why it is not, and its first error. All errors are printed.
fn made(
    text: &IncludedText,
    defines: &[(String, String)],
    err: &mut dyn Write,
) -> anyhow::Result<(Vec<Subject>, Option<String>)> {
    let (errors, subjects) = subjects((&[], defines), text, &mut Vec::new())?;
    for error in &errors {
        err.write_all(report::diagnostics::text(error, Lang::En, false).as_bytes())?;
    }
    let said = |error: &Diagnostic| {
        format!("error[{}] {}: {}", error.code, error.file.locate(error.span.start), error.message)
    };
    Ok((subjects, errors.first().map(said)))
}

/// True for a text that does not compile, and of which no function does.
fn is_broken(subjects: &[Subject], error: Option<&String>) -> bool {
    error.is_some() && !subjects.iter().any(|subject| subject.ready.is_ok())
}

/// Writes the page of a comparison, with its charts.
fn page(folder: &Path, summary: &Summary) -> anyhow::Result<()> {
    let site = report::html::comparison(summary).map_err(anyhow::Error::msg).context("cannot draw the page")?;
    super::check::write_site(folder, site)?;
    reported::write_all(folder, &ci(summary), &json(summary))
}

/// The command line up to the function.
fn command(args: &CompareArgs, [first, second]: [&str; 2]) -> String {
    let mut words = format!("shadercheck compare {} {}", shell_word(first), shell_word(second));
    words += &args.input.words();
    if args.same_bits {
        words.push_str(" --same-bits");
    }
    for (name, value) in &args.define_second {
        words = format!("{words} --define-second {}", shell_word(&format!("{name}={value}")));
    }
    words + &args.compose.words()
}
