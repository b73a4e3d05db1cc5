//! A shader of a run, as far as the front end could read it.

use std::collections::HashSet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use base::diagnostic::{Code, Diagnostic, Severity};
use base::text::{SourceFile, Span};
use syntax::ast::ItemKind;
use syntax::errors::Around;
use syntax::{Parsed, Shader, Stage, TokenPlace, errors};

use super::{Input, KnownHosts, Project, template};
use crate::Level;
use crate::composed::Composed;
use crate::prelude::{self, Between, Prelude, Wanted};
use crate::{conditions, dialect, es, included, open};
use analysis::flow::Flow;
use analysis::range::Observed;
use hosts::Origin;
use hosts::Place;
use hosts::document::Listing;
use hosts::script::{self, Given};
use hosts::{Embedded, HostFile, Literal, marks};

/// Readings of one text with names defined at most.
const MOST_VARIANTS: usize = 3;

/// Bytes of the longest text that is read again: preprocessed collections of everything take too long.
const LONGEST_VARIED: usize = 1 << 15;

/// What nothing is left open of where a text reaches its compiler as it stands.
const HANDED_ON: Around = Around::NAMES.union(Around::ENABLED).union(Around::STAGE);

/// A shader as rules see it.
pub struct ShaderFile {
    /// The text.
    pub file: SourceFile,
    /// False when the file is only there to be looked things up in.
    pub reported: bool,
    /// The shader, as far as the front end could read it.
    pub shader: Shader,
    /// Errors of the front end.
    pub front_end: Vec<Diagnostic>,
    /// Those of them that what the host puts around the text may take away.
    doubtful: Vec<(Code, Span)>,
    /// True when an `#if` or `#include` makes the interface depend on more than this text.
    pub conditional: bool,
    /// Where the text stands when it is a literal of a host file, or a part of a document.
    pub origin: Option<Origin>,
    /// Where it stands among the parts of a document.
    pub place: Option<Place>,
    /// The file that a document calls it.
    pub(super) called: Option<String>,
    /// True for a part of a text that lacks something.
    pub partial: bool,
    /// True when the file was named by itself, and not found in a folder.
    pub named: bool,
    /// What a host puts in front and behind, as parts of the text.
    around: [Span; 2],
    /// Errors that hold unless the host puts something around the text that is not seen.
    pub on_request: Vec<Diagnostic>,
    /// The text as it stands in its file, where what it imports or includes is joined with it.
    pub author: Option<SourceFile>,
    /// The text as its author wrote it, where it is a template: places are the same in both.
    pub template: Option<SourceFile>,
    /// Functions of which something is not known, and was taken for something.
    pub(super) taken: Vec<Span>,
    /// What a host puts around it is taken from the looks of the text: it may be another host.
    host_is_guessed: bool,
    /// What its host puts around it.
    pub prelude: Option<&'static Prelude>,
    /// A script puts it together of templates.
    pub(super) put_together: bool,
    /// What another reader of the language says of the text.
    pub refused: Vec<(Level, Diagnostic)>,
    /// Ranges of its expressions, found out when the first rule asks.
    observed: Mutex<Option<Arc<Observed>>>,
    flow: Mutex<Option<Arc<Flow>>>,
}

impl ShaderFile {
    pub(super) fn new(input: &Input, stage: Stage) -> Self {
        Self::read_as(input, stage, false)
    }

    /// A shader; of OpenGL ES where the host says so, and the text does not say what it is.
    fn read_as(input: &Input, stage: Stage, es: bool) -> Self {
        Self::read(input, Shader::parse_fitting(&input.file, stage, &input.defines, es))
    }

    /// A module in WGSL, or a template of one: of that, one text that its engine may write.
    pub(super) fn wgsl(input: &Input) -> Self {
        let Some(text) = template::filled(input.file.text()) else { return Self::module(input) };
        let mut shader = Self::module(&input.with_file(SourceFile::new(input.file.name(), text)));
        // What is missing here, the engine may bring.
        shader.front_end.clear();
        shader.on_request.clear();
        shader.refused.retain(|(_, d)| d.severity == Severity::Info);
        shader.template = Some(input.file.clone());
        shader
    }

    fn module(input: &Input) -> Self {
        let mut alone = Shader::parse_wgsl(&input.file);
        let rewritten = dialect::declares_otherwise(input.file.text());
        if rewritten {
            alone.shader = alone.shader.varying();
        }
        let varies = alone.shader.wgsl().is_some_and(|module| module.varies);
        let joined = input.composer.as_ref().and_then(|composer| composer.join(&input.file));
        let mut shader = match joined {
            None => Self::read(input, alone),
            Some(Composed { file, refused }) => {
                // What reads the directives leaves none of them.
                let slip = |d: &&Diagnostic| d.code == errors::UNKNOWN_DIRECTIVE && file.is_assembled();
                let slips: Vec<Diagnostic> = alone.diagnostics.iter().filter(slip).cloned().collect();
                // A text that nothing was joined to is read already.
                let parsed = if file.is_assembled() { Shader::parse_wgsl(&file) } else { alone };
                let Parsed { shader, diagnostics } = parsed;
                let shader = if varies { shader.varying() } else { shader };
                let mut shader = Self::read(input, Parsed { shader, diagnostics });
                shader.front_end.extend(slips);
                shader.author = shader.file.is_assembled().then(|| input.file.clone());
                // Names are told as those of GLSL are: what stands around the text may declare them.
                let (names, refused): (Vec<_>, Vec<_>) =
                    refused.into_iter().partition(|(_, d)| errors::is_name(d.code));
                shader.refused = refused;
                // The other reader stops at the first error, and tells no place of many.
                if shader.front_end.iter().any(|d| errors::is_of_types(d.code)) {
                    shader.refused.retain(|(_, d)| d.severity != Severity::Error);
                }
                for (level, error) in names {
                    if level > Level::Default || open::declares_elsewhere(&shader.shader, &error) {
                        shader.doubtful.push((error.code, error.span));
                    }
                    shader.front_end.push(error);
                }
                if varies {
                    // The host may state other features, and no other language.
                    let holds = [errors::OTHER_LANGUAGE, errors::UNKNOWN_DIRECTIVE];
                    let (sure, asked) =
                        shader.front_end.into_iter().partition(|d: &Diagnostic| holds.contains(&d.code));
                    (shader.front_end, shader.on_request) = (sure, asked);
                    shader.refused.iter_mut().for_each(|(level, _)| *level = Level::Strict);
                }
                shader
            }
        };
        if rewritten {
            shader.on_request.append(&mut shader.front_end);
            shader.refused.iter_mut().for_each(|(level, _)| *level = Level::Strict);
        }
        shader.conditional = false;
        shader
    }

    /// True for a module in WGSL.
    pub fn is_wgsl(&self) -> bool {
        self.shader.wgsl().is_some()
    }

    pub(crate) fn read(input: &Input, parsed: Parsed) -> Self {
        let claimed = |d| crate::hlsl::claim(&parsed.shader, d);
        let front_end: Vec<Diagnostic> = parsed.diagnostics.into_iter().map(claimed).collect();
        Self {
            doubtful: Self::doubtful_of(&parsed.shader, &front_end, Around::empty()),
            file: parsed.shader.file().clone(),
            reported: input.reported,
            shader: parsed.shader,
            front_end,
            conditional: is_conditional(input.file.text()),
            origin: None,
            place: None,
            called: None,
            partial: false,
            named: input.named,
            around: [Span::default(); 2],
            on_request: Vec::new(),
            author: None,
            template: None,
            refused: Vec::new(),
            taken: Vec::new(),
            host_is_guessed: false,
            prelude: None,
            put_together: false,
            observed: Mutex::default(),
            flow: Mutex::default(),
        }
    }

    /// The same text with names defined that an `#if` asks for: readings in which lines are active that no reading
    /// before has, each with the places of these lines. What is defined is `1`; a name that the code uses as a value is
    /// left alone.
    pub fn variants(&self) -> Vec<(Self, Vec<Span>)> {
        if !self.conditional || self.is_wgsl() || self.partial || self.file.text().len() > LONGEST_VARIED {
            return Vec::new();
        }
        let inactive = |shader: &Shader| -> Vec<Span> {
            shader.tokens().iter().filter(|t| t.place == TokenPlace::Inactive).map(|t| t.span).collect()
        };
        let mut open = inactive(&self.shader);
        let mut found = Vec::new();
        let input = Input::new(self.shader.file().clone()).with_reported(self.reported);
        let sets = if open.is_empty() { Vec::new() } else { conditions::definitions(&self.shader) };
        for mut defines in sets {
            if open.is_empty() || found.len() == MOST_VARIANTS {
                break;
            }
            defines.extend(self.shader.defines().iter().cloned());
            let parsed = Shader::parse_with(self.shader.file(), self.shader.stage(), &defines);
            let still: HashSet<usize> = inactive(&parsed.shader).iter().map(|s| s.start).collect();
            let (left, fresh): (Vec<Span>, Vec<Span>) = open.into_iter().partition(|s| still.contains(&s.start));
            open = left;
            if !fresh.is_empty() {
                found.push((Self::read(&input, parsed), fresh));
            }
        }
        found
    }

    /// The same text as a phone reads it, where that is another text: `GL_ES` is defined, and precisions have a meaning.
    pub fn on_es(&self) -> Option<Self> {
        if !self.conditional || self.file.text().len() > LONGEST_VARIED {
            return None;
        }
        let parsed = es::parsed(&self.shader)?;
        Some(Self::read(&Input::new(self.shader.file().clone()).with_reported(self.reported), parsed))
    }

    /// The same text as a device reads it that has no `highp` in fragment stages.
    pub fn without_highp(&self) -> Option<Self> {
        if !self.conditional || self.file.text().len() > LONGEST_VARIED {
            return None;
        }
        let parsed = es::without_highp(&self.shader)?;
        Some(Self::read(&Input::new(parsed.shader.file().clone()).with_reported(self.reported), parsed))
    }

    fn doubtful_of(shader: &Shader, found: &[Diagnostic], stated: Around) -> Vec<(Code, Span)> {
        let doubtful = open::doubtful(shader, found, stated);
        found.iter().zip(doubtful).filter(|(_, doubtful)| *doubtful).map(|(d, _)| (d.code, d.span)).collect()
    }

    /// A shader with the files that it includes; none where it includes nothing, and where the whole does not hold by itself:
    /// names that a host defines decide over it. A text that is whole may lack names.
    fn with_includes(input: &Input, stage: Stage) -> Option<Self> {
        if !syntax::include::may_include(input.file.text()) {
            return None;
        }
        let Composed { file, refused } = input.composer.as_ref()?.join(&input.file)?;
        let parsed = Shader::parse_fitting(&file, stage, &input.defines, false);
        let in_order = parsed.diagnostics.iter().all(open::leaves_in_order);
        if !in_order && !included::lacks_names_alone(&input.file, &parsed) {
            return None;
        }
        let shader = Self::read(&input.with_file(file), parsed);
        Some(Self { author: Some(input.file.clone()), refused, ..shader })
    }

    /// A shader in a file of its own, with what its host puts around it.
    pub(super) fn of_file(input: &Input, stage: Stage, known: KnownHosts) -> Self {
        let KnownHosts { wanted, given } = known;
        if prelude::recognised(input.file.text(), wanted).is_none() {
            let mut shader = Self::with_includes(input, stage).unwrap_or_else(|| Self::new(input, stage));
            // Whoever takes the file is in the project, and puts nothing in front that does not stand there.
            if given == Given::InSight && stage != Stage::Library && marks::has_main(input.file.text()) {
                shader.doubtful = Self::doubtful_of(&shader.shader, &shader.front_end, HANDED_ON);
            }
            return shader;
        }
        let whole = Literal::part(&input.file, Span::new(0, input.file.text().len()));
        match prelude::around(&whole, stage, wanted) {
            Some(between) => Self::between(input, stage, wanted, between, false),
            None => Self::new(input, stage),
        }
    }

    /// A shader between the texts of its host.
    fn between(input: &Input, stage: Stage, wanted: Wanted, between: Between, es: bool) -> Self {
        let Between { literal, prelude, front, behind, whole } = between;
        // The text and the file that it stands in need two names.
        let name = format!("{} ({})", input.file.name(), prelude.name);
        let text = input.with_file(SourceFile::new(name, literal.text.as_str()));
        let of_fragments = stage == Stage::Library && !behind.is_empty();
        let mut shader = Self::read_as(&text, if of_fragments { Stage::Fragment } else { stage }, es);
        shader.around = [front, behind];
        shader.prelude = Some(prelude);
        shader.front_end.retain(|d| !front.contains(d.span.start) && !behind.contains(d.span.start));
        if matches!(wanted, Wanted::Recognised | Wanted::RecognisedOr(_)) {
            // Other parts of the text declare names, textures may have other types, and a name that is declared again, or that
            // does not fit what the host is taken to have, shows another host.
            let text = shader.file.text();
            let around = [&text[front.start..front.end], &text[behind.start..behind.end]];
            let of_host = |d: &Diagnostic| {
                let word = syntax::words::identifier(d.file.slice(d.span));
                let macros = errors::rests_on(d.code).contains(Around::MACROS) && !word.is_empty();
                macros && around.iter().any(|part| marks::has_word(part, word))
            };
            let of_another =
                |d: &Diagnostic| (!whole && open::is_about_a_name(d)) || open::is_of_another(d) || of_host(d);
            // A port of such a text states a version, and enables more.
            let stated = shader.shader.version().span.is_some_and(|v| front.contains(v.start));
            let mut open = if stated { Around::ENABLED | Around::TYPES } else { Around::empty() };
            // A text whose `main` the host writes is a piece, of which others may be meant to stand beside it.
            if !behind.is_empty() {
                open |= Around::all().difference(Around::TYPES | Around::VALUES);
            }
            let sure = |d: &Diagnostic| {
                let slip = open::is_slip(d);
                slip || (!of_another(d) && !open::rests(d).intersects(open))
            };
            let (sure, asked): (Vec<_>, Vec<_>) = shader.front_end.into_iter().partition(sure);
            (shader.front_end, shader.on_request) = (sure, asked);
            shader.host_is_guessed = true;
        }
        shader.origin = Some(Origin { host: input.file.clone(), literal });
        shader
    }

    /// A shader of a file that holds several.
    pub(super) fn part(input: &Input, (stage, literal): (Stage, Literal)) -> Self {
        // Two parts of a file need two names.
        let name = format!("{} ({})", input.file.name(), stage.name());
        let part = input.with_file(SourceFile::new(name, literal.text.as_str()));
        let origin = Some(Origin { host: input.file.clone(), literal });
        Self { origin, ..Self::new(&part, stage) }
    }

    /// A shader of a document.
    pub(super) fn of_document(input: &Input, listing: Listing, given: Given) -> Self {
        let text = input.with_file(SourceFile::new(listing.name, listing.literal.text.as_str()));
        // Pages know OpenGL ES alone.
        let read = || Self::read_as(&text, listing.stage, listing.whole);
        let mut shader = Self {
            origin: Some(Origin { host: input.file.clone(), literal: listing.literal }),
            place: Some(listing.place),
            called: listing.called,
            partial: listing.partial,
            ..Self::with_includes(&text, listing.stage).unwrap_or_else(read)
        };
        if listing.whole && !listing.partial && script::hands_on(&input.file, given) {
            shader.doubtful = Self::doubtful_of(&shader.shader, &shader.front_end, HANDED_ON);
        }
        shader
    }

    /// A shader in which a host fills in lines.
    pub(super) fn filled_in(input: &Input, (stage, literal): (Stage, Literal), wanted: Wanted) -> Self {
        let part = match prelude::around(&literal, stage, wanted) {
            Some(between) => Self::between(input, stage, wanted, between, false),
            None => Self::part(input, (stage, literal)),
        };
        let mut shader = Self { partial: true, ..part };
        shader.leave(|d| !open::rests(d).intersects(script::open(false, true)));
        shader
    }

    /// A shader in a string of a script.
    pub(super) fn in_script(host: &HostFile, input: &Input, found: &Embedded, known: KnownHosts) -> Self {
        let KnownHosts { wanted, given } = known;
        let es = host.is_of_es();
        let mut shader = match prelude::around(&found.literal, found.stage, wanted) {
            Some(between) => {
                let literal = between.literal.clone();
                let shader = Self::between(input, found.stage, wanted, between, es);
                Self { origin: Some(Origin { host: host.file.clone(), literal }), ..shader }
            }
            None => Self {
                origin: Some(Origin { host: host.file.clone(), literal: found.literal.clone() }),
                ..Self::read_as(input, found.stage, es)
            },
        };
        shader.partial = found.partial;
        let lacks =
            shader.shader.has_unknown_names() || shader.shader.version().span.is_none_or(|v| shader.is_in_front(v));
        let shader_number = shader.shader.version().number;
        // No version for the web is newer than 3.00.
        let newest = es && shader_number == 300;
        // What stands in front may state 3.00, which has more functions.
        let held = open::holds_in_es(&shader.shader, &shader.front_end);
        let lost: Vec<Span> =
            shader.front_end.iter().zip(held).filter(|(_, held)| !held).map(|(d, _)| d.span).collect();
        let sure_of_es = |code: Code, span: Span| match code {
            errors::IMPLICIT_FLOAT => es && !lost.contains(&span),
            errors::RESERVED => es,
            errors::NEEDS_VERSION | errors::INITIALISER => newest,
            _ => false,
        };
        // Who gives its texts to OpenGL puts in front what stands in other strings of it, and nothing else.
        let handed_on = !found.partial && !shader.has_prelude() && host.hands_on(given);
        let stated = if handed_on { HANDED_ON } else { Around::empty() };
        let open = script::open(found.partial, lacks).difference(stated);
        // Browsers take it in the first version, with a warning (WebGL conformance test `global-variable-init`).
        let warned = |d: &Diagnostic| es && d.code == errors::INITIALISER && shader_number == 100;
        shader.leave(|d| (!open::rests(d).intersects(open) || sure_of_es(d.code, d.span)) && !warned(d));
        // Engines of the web declare names and precisions in front of all their texts.
        let of_engine = es && !handed_on && shader.shader.version().span.is_none();
        let supplied = |d: &Diagnostic| errors::is_name(d.code) || d.code == errors::PRECISION;
        shader.on_request.retain(|d| !(of_engine && supplied(d)));
        // What is filled in may have any type.
        let literal = shader.origin.as_ref().map(|o| o.literal.clone()).unwrap_or_default();
        let items = &shader.shader.unit().items;
        // What ends without a value may be given one by what is filled in.
        let about = |d: &Diagnostic| match items.iter().find(|i| i.span.contains(d.span.start)) {
            Some(item) if found.partial && d.code == errors::RETURN_TYPE => item.span,
            _ => d.span,
        };
        let filled_in: Vec<bool> = shader.front_end.iter().map(|d| literal.is_filled_in(about(d))).collect();
        let mut filled_in = filled_in.into_iter();
        shader.front_end.retain(|_| !filled_in.next().unwrap_or(false));
        let all: Vec<Diagnostic> = shader.front_end.iter().chain(&shader.on_request).cloned().collect();
        shader.doubtful = Self::doubtful_of(&shader.shader, &all, stated);
        shader.doubtful.retain(|(code, span)| !sure_of_es(*code, *span));
        // What stands behind `$` is a name of the template.
        let is_hook = |d: &Diagnostic| host.file.text()[..literal.to_host(d.span).start].ends_with('$');
        shader.on_request.retain(|d| !literal.is_filled_in(d.span) && !is_hook(d));
        shader
    }

    /// True for an error that other parts of the text take away, or another host than the one that is guessed.
    pub fn may_be_of_another_host(&self, error: &Diagnostic) -> bool {
        let of_host = open::is_about_a_name(error) || open::is_of_another(error);
        self.host_is_guessed && of_host && !open::is_slip(error)
    }

    /// Leaves to a request what does not hold for certain.
    fn leave(&mut self, holds: impl Fn(&Diagnostic) -> bool) {
        let (sure, asked): (Vec<_>, Vec<_>) = std::mem::take(&mut self.front_end).into_iter().partition(holds);
        self.front_end = sure;
        self.on_request.extend(asked);
    }

    /// True when the interface is known from this text alone: the front end found no error outside the bodies
    /// of functions, and nothing depends on an `#if` or `#include`.
    pub fn is_plain(&self) -> bool {
        let complete = self.shader.version().span.is_some() || !self.shader.has_unknown_names();
        complete && !self.partial && !self.conditional && self.front_end.iter().all(|d| self.is_inside(d))
    }

    /// True for an error of the front end that what the host puts around the text may take away.
    pub fn is_doubtful(&self, error: &Diagnostic) -> bool {
        self.doubtful.contains(&(error.code, error.span))
    }

    /// True for an error in the body of a function that does not keep the rest from being read.
    fn is_inside(&self, error: &Diagnostic) -> bool {
        let bodies = self.shader.unit().items.iter().filter_map(|i| match &i.kind {
            ItemKind::Function(f) => f.body.as_ref().map(|_| Span::new(f.head_span.end, i.span.end)),
            _ => None,
        });
        !errors::is_of_the_text(error.code) && bodies.into_iter().any(|b| b.contains(error.span.start))
    }

    /// Which values the operands of its calls and operators take, under the ranges that `project` states.
    pub fn observed(&self, project: &Project) -> Arc<Observed> {
        cached(&self.observed, || Observed::new(&self.shader, &project.config().ranges))
    }

    /// True when a host is known to put something around the text.
    pub fn has_prelude(&self) -> bool {
        self.around.iter().any(|part| !part.is_empty())
    }

    /// True for a place of which the author wrote the text, and not a reader of the file.
    pub fn is_written(&self, span: Span) -> bool {
        let same = |origin: &Origin| origin.host.slice(origin.literal.to_host(span)) == self.file.slice(span);
        self.origin.as_ref().is_none_or(same)
    }

    /// True where an extension that takes `#include` is on: the directive is a part of the language then.
    pub fn has_includes(&self) -> bool {
        let takes = ["GL_GOOGLE_include_directive", "GL_ARB_shading_language_include"];
        let mut extensions = self.shader.extensions().iter();
        extensions.any(|e| takes.contains(&e.name.as_str()) && e.behavior != "disable")
    }

    /// True for a place in what a host puts around the text.
    pub fn is_in_front(&self, place: Span) -> bool {
        self.around.iter().any(|part| part.contains(place.start))
    }

    /// True when the front end read the whole text without error, and it is all there.
    pub fn is_sound(&self) -> bool {
        // Names that WGSL imports do not hide which variables a function uses; what could not be read may.
        if let Some(module) = self.shader.wgsl() {
            let unread = |i: &syntax::ast::Item| i.kind == ItemKind::Error;
            let broken = self.shader.unit().items.iter().any(unread) || syntax::walk::has_errors(&self.shader);
            return !self.partial && !module.varies && !broken;
        }
        !self.partial && self.front_end.is_empty() && !self.shader.has_unknown_names()
    }

    /// True when the uses of every variable are seen, be it in text that a condition leaves out.
    pub fn shows_all_uses(&self) -> bool {
        self.is_sound()
            || self.shader.wgsl().is_some_and(|module| {
                let unread = self.shader.unit().items.iter().any(|i| i.kind == ItemKind::Error);
                !self.partial && !module.filled && !unread && !syntax::walk::has_errors(&self.shader)
            })
    }

    /// What happens to variables along the paths; nothing when the front end found errors.
    pub fn flow(&self) -> Arc<Flow> {
        cached(&self.flow, || if self.is_sound() { Flow::new(&self.shader, &self.file) } else { Flow::default() })
    }

    /// Forgets what has been worked out and can be worked out again: all of a project takes much memory.
    pub fn forget(&self) {
        *lock(&self.observed) = None;
        *lock(&self.flow) = None;
    }
}

fn lock<T>(cache: &Mutex<T>) -> MutexGuard<'_, T> {
    cache.lock().unwrap_or_else(PoisonError::into_inner)
}

fn cached<T>(cache: &Mutex<Option<Arc<T>>>, make: impl FnOnce() -> T) -> Arc<T> {
    lock(cache).get_or_insert_with(|| Arc::new(make())).clone()
}

fn is_conditional(text: &str) -> bool {
    text.lines().filter_map(|l| l.trim_start().strip_prefix('#')).any(|directive| {
        let word = directive.trim_start();
        word.starts_with("if") || word.starts_with("include")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conditional_text_is_noticed() {
        assert!(is_conditional("# ifdef A\n#endif") && is_conditional("  #include \"x\""));
        assert!(!is_conditional("#version 150\nvoid main() {}"));
    }
}
