//! What becomes of each shader in each language: written or not and why, what the validators of the language say,
//! and whether it means what the shader means.

use std::collections::BTreeMap;
use std::io::Write;
use std::process::{Command, Stdio};

use base::value::{Batch, Record};
use judge::verdict::{Translations, Unread};
use program::{Language, Program, Role, TranslateError, Translation, contain, read_back};
use property::Stream;

/// Invocations on which meanings are compared.
const SAMPLES: usize = 64;

/// What is known about one translation.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Written {
    /// The language lacks something.
    Refused(String),
    /// The language has it, and the translator does not write it.
    Failed(String),
    /// It is written, and the validator says this; `None` where no validator is there.
    Text(Option<Result<(), String>>),
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Meant {
    Equal,
    /// The interpreter says that they differ.
    Differs(String),
    /// Nothing was compared.
    Unknown(String),
}

/// What became of one shader in one language.
pub struct Message {
    language: Language,
    written: Written,
    meant: Meant,
}

/// Every language, and naga's reading of the author's own text.
fn languages() -> impl Iterator<Item = Language> {
    Language::ALL.into_iter().chain([Language::NagaGlsl])
}

/// Translates a shader to every language.
pub fn examine(program: &Program) -> Vec<Message> {
    let meanings = contain(|| meanings(program))
        .unwrap_or_else(|panic| languages().map(|l| (l, Meant::Unknown(format!("panic: {panic}")))).collect());
    let one = |language| {
        let written = contain(|| written(program, language));
        let written = written.unwrap_or_else(|panic| Written::Failed(format!("panic: {panic}")));
        let meant = meanings.get(&language).cloned();
        Message { language, written, meant: meant.unwrap_or_else(|| Meant::Unknown("no reader".to_owned())) }
    };
    languages().map(one).collect()
}

fn written(program: &Program, language: Language) -> Written {
    match program.translate(language) {
        // A language is not found wanting because a translator stops.
        Err(TranslateError::Inexpressible { reason, .. }) if !reason.contains("panicked") => Written::Refused(reason),
        Err(error) => Written::Failed(error.to_string()),
        Ok(translation) => match read_back(&translation, language, &program.role) {
            Err(error) => Written::Failed(line(&error.to_string())),
            Ok(_) => Written::Text(validated(&translation, language, &program.role)),
        },
    }
}

fn meanings(program: &Program) -> BTreeMap<Language, Meant> {
    let translations = Translations::to(program, &[&Language::READ_BACK[..], &[Language::NagaGlsl]].concat());
    let unknown = |language: Language, why: &Unread| match why {
        Unread::Unsupported(why) => (language, Meant::Unknown(line(why))),
        Unread::Interface(why) => (language, Meant::Differs(format!("another interface: {}", line(why)))),
    };
    let mut all: BTreeMap<Language, Meant> = translations.unread().map(|(l, why)| unknown(l, why)).collect();
    match translations.compare(&batch(program)) {
        Ok(found) => all.extend(found.into_iter().map(|c| match c.first {
            Some(first) => (c.language, Meant::Differs(first.to_string())),
            None if c.agreed == 0 => (c.language, Meant::Unknown("no sample is determined".to_owned())),
            None => (c.language, Meant::Equal),
        })),
        Err(error) => {
            for language in languages() {
                all.entry(language).or_insert_with(|| Meant::Unknown(line(&error.to_string())));
            }
        }
    }
    all
}

/// Ordinary numbers.
fn batch(program: &Program) -> Batch {
    let (invocation, case) = (program.invocation_record(), program.case_record());
    let mut stream = Stream::new(1);
    let mut words = |record: &Record| -> Vec<u32> {
        let scalars = record.fields().iter().flat_map(|f| vec![f.shape.scalar; f.shape.words()]);
        scalars.map(|scalar| super::word(scalar, &mut stream)).collect()
    };
    let mut batch = Batch::with_capacity(invocation.into(), case.into(), 1, SAMPLES);
    for _ in 0..SAMPLES {
        batch.invocations.extend(words(&batch.invocation_record.clone()));
        batch.cases.extend(words(&batch.case_record.clone()));
    }
    batch
}

/// What the validator of a language says; `None` where it is not installed.
fn validated(translation: &Translation, language: Language, role: &Role) -> Option<Result<(), String>> {
    let stage = match role {
        Role::Vertex => "vert",
        Role::Fragment => "frag",
        Role::Compute | Role::Geometry(_) | Role::Function { .. } => "comp",
    };
    let (program, arguments): (&str, Vec<&str>) = match language {
        Language::SpirV => ("spirv-val", vec!["--target-env", "vulkan1.1"]),
        Language::Glsl330 | Language::Glsl450 | Language::GlslEs310 => ("glslangValidator", vec!["-S", stage]),
        Language::Wgsl => ("tint", vec!["--format", "wgsl", "--allow-non-uniform-derivatives"]),
        Language::Msl | Language::Hlsl | Language::NagaGlsl => return None,
    };
    let suffix = if language == Language::Wgsl { ".wgsl" } else { ".txt" };
    let mut file = tempfile::Builder::new().suffix(suffix).tempfile().ok()?;
    file.write_all(&translation.clone().into_bytes()).ok()?;
    let mut command = Command::new(program);
    let output = command.args(arguments).arg(file.path()).stdin(Stdio::null()).output().ok()?;
    if output.status.success() {
        return Some(Ok(()));
    }
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said).replace(&*file.path().to_string_lossy(), "");
    let first = said.lines().find(|l| l.to_lowercase().contains("error")).or(said.lines().next()).unwrap_or_default();
    Some(Err(line(first)))
}

fn line(text: &str) -> String {
    text.lines().next().unwrap_or_default().chars().take(160).collect()
}

/// The table, and what stands in the way, most frequent first.
pub fn print<'a>(all: impl Iterator<Item = &'a [Message]> + Clone) {
    println!("language    shaders  refused   failed  written accepted rejected    equal  differs not compared");
    for language in languages() {
        let reported = || all.clone().flatten().filter(move |t| t.language == language);
        let count = |of: &dyn Fn(&Message) -> bool| reported().filter(|t| of(t)).count();
        let verdict = |ok: bool| move |t: &Message| matches!(&t.written, Written::Text(Some(v)) if v.is_ok() == ok);
        let text = |t: &Message| matches!(t.written, Written::Text(_));
        println!(
            "{:<12}{:>7}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>13}",
            language.name(),
            reported().count(),
            count(&|t| matches!(t.written, Written::Refused(_))),
            count(&|t| matches!(t.written, Written::Failed(_))),
            count(&text),
            count(&verdict(true)),
            count(&verdict(false)),
            count(&|t| text(t) && t.meant == Meant::Equal),
            count(&|t| text(t) && matches!(t.meant, Meant::Differs(_))),
            count(&|t| text(t) && matches!(t.meant, Meant::Unknown(_))),
        );
    }
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    for reported in all.flatten() {
        for reason in reported.reasons() {
            *reasons.entry(super::without_numbers(&super::short(&reason))).or_default() += 1;
        }
    }
    super::list(reasons.iter().map(|(reason, &count)| (reason.as_str(), count)).collect());
}

impl Message {
    /// What is not as it should be.
    pub fn reasons(&self) -> Vec<String> {
        let written = match &self.written {
            Written::Refused(why) => Some(format!("{} refused: {why}", self.language)),
            Written::Failed(why) => Some(format!("{} failed: {why}", self.language)),
            Written::Text(Some(Err(why))) => Some(format!("{} rejected: {why}", self.language)),
            Written::Text(_) => None,
        };
        let meant = match &self.meant {
            _ if !matches!(self.written, Written::Text(_)) => None,
            Meant::Equal => None,
            Meant::Differs(why) => Some(format!("{} differs: {why}", self.language)),
            Meant::Unknown(why) => Some(format!("{} not compared: {why}", self.language)),
        };
        written.into_iter().chain(meant).collect()
    }
}
