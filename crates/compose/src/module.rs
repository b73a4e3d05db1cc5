//! One file on its way into the text: its directives, conditions and imports are done, and its declarations found.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use base::diagnostic::Diagnostic;
use base::text::{Assembly, SourceFile, Span};
use syntax::include::resolve_plain;
use syntax::{errors, plain};

use crate::condition::{self, node_end};
use crate::declaration::{Declaration, declarations};
use crate::import::{Import, imports};
use crate::token::{Token, behind_template, brackets, tokens};
use crate::{Library, NAME_ITS_FOLDER, Options, Problems, draft, template};

/// A file as the text takes it.
pub(crate) struct Module {
    /// What is left of the file behind directives, conditions and imports.
    pub file: SourceFile,
    /// The file itself.
    pub author: SourceFile,
    pub tokens: Vec<Token>,
    pub declarations: Vec<Declaration>,
    /// Declarations by their names.
    pub names: HashMap<String, usize>,
    pub imports: Vec<Placed>,
    /// The path by which the file says that it is known, with the place of the directive.
    pub says: Option<String>,
    /// Names that are declared in what conditions leave out, each with its condition.
    pub left_out: Vec<(String, String)>,
    /// Names that are declared in functions.
    pub locals: HashSet<String>,
    /// That the file is an early draft of the language, with the edits that repair it.
    pub draft: Option<Diagnostic>,
    /// What is assumed of values that nobody states.
    pub assumed: Vec<Diagnostic>,
    /// Files that a template put in.
    pub included: Vec<SourceFile>,
}

/// An import with the file and place that it stands at.
pub(crate) struct Placed {
    pub import: Import,
    pub file: SourceFile,
    /// Written as a directive.
    pub directive: bool,
}

impl Module {
    pub(crate) fn read(
        author: &SourceFile,
        defines: &[(String, String)],
        options: &Options,
        library: &mut dyn Library,
        problems: &mut Problems,
    ) -> Self {
        let template::Rendered { file, notes: mut assumed, left_out: branches, included } = match options.stand_ins {
            true => template::Rendered::of(template::stand_in(author, defines)),
            false => template::render(author, (defines, options.empty_lines), library, problems),
        };
        let (file, directives) = without_directives(&file, defines, options, library, problems, &mut assumed);
        let condition::Conditional { file, mut left_out } = condition::decide(&file, defines, problems);
        let mut found = Vec::new();
        let mut says = None;
        for (whole, directive) in &directives {
            let text = whole.slice(directive.rest);
            match directive.word.as_str() {
                "define_import_path" => {
                    says = text.split_whitespace().next().map(|p| p.trim_end_matches(';').to_owned())
                }
                _ => {
                    let part = shifted(tokens(text), directive.rest.start);
                    take(imports(whole, &part, Span::at(directive.rest.end)), whole, true, &mut found, problems);
                }
            }
        }
        let file = without_imports(&file, &mut found, problems);
        let draft::Current { file, note } = draft::modernise(&file, problems);
        let file = without_test_attributes(&file);
        let tokens = tokens(file.text());
        let behind = brackets(&tokens);
        let (declarations, locals) = declarations(&file, &tokens, &behind, problems);
        let mut names = HashMap::new();
        for (at, declaration) in declarations.iter().enumerate() {
            if let Some((name, _)) = &declaration.name {
                names.entry(name.clone()).or_insert(at);
            }
        }
        for (text, condition) in branches {
            let declared = declared_names(&SourceFile::new("", text)).into_iter();
            left_out.extend(declared.filter(|name| !names.contains_key(name)).map(|name| (name, condition.clone())));
        }
        if file.text().len() < author.text().len() && author.text().contains("#if") {
            let names = declared_names(author).into_iter().filter(|name| !names.contains_key(name));
            left_out.extend(names.map(|name| (name, "a directive such as `#ifdef`".to_owned())));
        }
        Self {
            file,
            author: author.clone(),
            tokens,
            declarations,
            names,
            imports: found,
            says,
            left_out,
            locals,
            draft: note,
            assumed,
            included,
        }
    }

    /// The text of a token.
    pub(crate) fn word(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", |token| self.file.slice(token.span))
    }
}

/// Attributes of the package `wgsl_test`, which the language does not have: runners of tests read them.
const OF_TESTS: [&str; 6] = ["test", "snapshot", "extent", "test_texture", "sampler", "buffer"];

/// A text without attributes of tests.
fn without_test_attributes(file: &SourceFile) -> SourceFile {
    let text = file.text();
    if !OF_TESTS.iter().any(|name| text.contains(&format!("@{name}"))) {
        return file.clone();
    }
    let tokens = tokens(text);
    let behind = brackets(&tokens);
    let word = |at: usize| tokens.get(at).map_or("", |token| file.slice(token.span));
    let (mut out, mut copied) = (Assembly::new(), 0);
    for at in 0..tokens.len() {
        if word(at) != "@" || !OF_TESTS.contains(&word(at + 1)) {
            continue;
        }
        let end = if word(at + 2) == "(" { behind[at + 2] } else { at + 2 };
        out.copy(file, Span::new(copied, tokens[at].span.start));
        copied = tokens[end - 1].span.end;
    }
    out.copy(file, Span::new(copied, text.len()));
    out.finish(file.name())
}

/// Names behind the keywords of declarations, wherever they stand.
fn declared_names(file: &SourceFile) -> Vec<String> {
    let tokens = tokens(file.text());
    let word = |at: usize| tokens.get(at).map_or("", |token| file.slice(token.span));
    let keyword = |at: &usize| matches!(word(*at), "fn" | "struct" | "const" | "override" | "alias" | "var");
    let names = (0..tokens.len()).filter(keyword).map(|at| word(behind_template(&tokens, at + 1)).to_owned());
    names.filter(|name| name.starts_with(|c: char| c.is_alphabetic() || c == '_')).collect()
}

fn shifted(mut tokens: Vec<Token>, by: usize) -> Vec<Token> {
    for token in &mut tokens {
        token.span = Span::new(token.span.start + by, token.span.end + by);
    }
    tokens
}

/// Adds what an import brings, or tells what is wrong with it.
fn take(
    read: Result<Vec<Import>, (Span, String)>,
    file: &SourceFile,
    directive: bool,
    found: &mut Vec<Placed>,
    problems: &mut Problems,
) {
    match read {
        Ok(all) => found.extend(all.into_iter().map(|import| Placed { import, file: file.clone(), directive })),
        Err((span, message)) => {
            let help = "imports look like `import package::module::{item, other as name};`";
            problems.add(errors::SYNTAX, file, span, message, help);
        }
    }
}

type Directives = Vec<(SourceFile, plain::Foreign)>;

/// The text with the files that its directives take in, and without the directives.
fn without_directives(
    file: &SourceFile,
    defines: &[(String, String)],
    options: &Options,
    library: &mut dyn Library,
    problems: &mut Problems,
    assumed: &mut Vec<Diagnostic>,
) -> (SourceFile, Directives) {
    let directive = |line: &str| line.trim_start().starts_with('#');
    if !file.text().lines().any(directive) && !file.text().contains("#{") {
        return (file.clone(), Vec::new());
    }
    let included = resolve_plain(file, &mut |wanted| {
        // A module that says its name is imported, and not copied.
        library.include(wanted).filter(|found| !wanted.import || !says_its_name(found.text()))
    });
    for cycle in &included.cycles {
        problems.take(cycle.error());
    }
    let whole = included.file;
    let marked = whole.text().contains("#{") || says_its_name(whole.text()) || imports_modules(whole.text());
    let replacement = if marked { plain::Replacement::Marked } else { plain::Replacement::Names };
    let read = if options.open {
        let (read, notes) = template::assuming(&whole, defines, replacement);
        assumed.extend(notes);
        read
    } else {
        plain::plain(&whole, defines, replacement)
    };
    problems.found.extend(read.diagnostics);
    let mut kept = Vec::new();
    for foreign in read.directives {
        let missing = included.missing.iter().find(|w| {
            let (from, span) = whole.origin(foreign.span);
            w.from.name() == from.name() && w.span.touches(span) && !w.import
        });
        match foreign.word.as_str() {
            "import" | "define_import_path" => kept.push((whole.clone(), foreign)),
            "include" => {
                let path = missing.map_or(whole.slice(foreign.rest), |w| w.path.as_str());
                let message = format!("`{path}` is not found");
                problems.add(errors::IMPORT, &whole, foreign.span, message, NAME_ITS_FOLDER);
            }
            // What the host writes there stands in a prelude.
            _ if !options.preludes.is_empty() => {}
            word => {
                let message = format!("`#{word}` is a directive of the host");
                let help = "name a file with what it stands for with `--with FILE`";
                problems.add(errors::UNKNOWN_DIRECTIVE, &whole, foreign.span, message, help);
            }
        }
    }
    (read.file, kept)
}

/// True for a text that says by which path it is imported.
pub(crate) fn says_its_name(text: &str) -> bool {
    text.contains("#define_import_path")
}

fn imports_modules(text: &str) -> bool {
    text.lines().any(|line| line.trim_start().starts_with("#import") && line.contains("::"))
}

/// The text without `import` statements, which are added to `found`.
fn without_imports(file: &SourceFile, found: &mut Vec<Placed>, problems: &mut Problems) -> SourceFile {
    if !file.text().contains("import") {
        return file.clone();
    }
    let tokens = tokens(file.text());
    let behind = brackets(&tokens);
    let word = |at: usize| tokens.get(at).map_or("", |token| file.slice(token.span));
    let mut out = Assembly::new();
    let (mut at, mut copied) = (0, 0);
    while at < tokens.len() {
        let end = node_end(&tokens, &behind, file, at).max(at + 1);
        if word(at) == "import" {
            let close = Span::at(tokens[end - 1].span.end);
            take(imports(file, &tokens[at + 1..end], close), file, false, found, problems);
            out.copy(file, Span::new(copied, tokens[at].span.start));
            copied = close.start;
        }
        at = end;
    }
    out.copy(file, Span::new(copied, file.text().len()));
    out.finish(Arc::from(file.name()))
}
