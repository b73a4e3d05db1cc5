//! A file of host code, read as its language asks for: C and C++ by a syntax tree, others by their tokens.

use std::cell::RefCell;
use std::sync::{Arc, OnceLock};

use tree_sitter::{Node, Parser, Tree};

use std::collections::BTreeSet;

use crate::piece::{Origin, Place};
use crate::wrapper::Wrapper;
use base::text::{SourceFile, Span};

use crate::cpp::constants::Constants;
use crate::cpp::{Embedded, HostPrograms, Lookup, embedded, lookup, presets, programs, tree};
use crate::script::{self, Field, Script, Table, WebGpu};

/// A host file with its syntax tree.
pub struct HostFile {
    /// The text.
    pub file: SourceFile,
    /// False when the file is only there to be looked things up in.
    pub reported: bool,
    /// True when the file was named by itself, and not found in a folder.
    pub named: bool,
    /// Where the text stands when it is a part of a document.
    pub origin: Option<Origin>,
    /// Where it stands among the parts of the document.
    pub place: Option<Place>,
    /// Functions of the project that wrap those of OpenGL.
    wrappers: Vec<Wrapper>,
    tree: HostTree,
    /// What was read instead of a tree, in another language than C++.
    script: Option<Arc<Script>>,
    /// False for text that cannot feed shaders: most files of a project.
    concerned: bool,
    found: Arc<Found>,
}

/// What has been found in a host file: it follows from its text and the wrappers of its project.
#[derive(Default)]
pub struct Found {
    lookups: OnceLock<Vec<Lookup>>,
    embedded: OnceLock<Vec<Embedded>>,
    constants: OnceLock<Constants>,
    programs: OnceLock<HostPrograms>,
    fragment: OnceLock<bool>,
}

impl HostFile {
    /// Parses `file` as C++, of which the C that feeds shaders is a part. Text that cannot be read
    /// becomes error nodes, on which rules stay silent.
    pub fn new(file: &SourceFile, reported: bool) -> Self {
        Self::with_tree(file, reported, HostTree::default())
    }

    /// The same with a tree of this text that is there already.
    pub fn with_tree(file: &SourceFile, reported: bool, tree: HostTree) -> Self {
        Self {
            tree,
            concerned: concerns_shaders(file.text()),
            file: file.clone(),
            reported,
            named: false,
            origin: None,
            place: None,
            wrappers: Vec::new(),
            script: None,
            found: Arc::default(),
        }
    }

    /// A file of another language.
    pub fn script(file: &SourceFile, reported: bool) -> Self {
        Self::of_script(file, reported, Arc::new(Script::read(file)))
    }

    /// A file of another language that has been read already.
    pub fn of_script(file: &SourceFile, reported: bool, script: Arc<Script>) -> Self {
        let concerned = !script.lookups.is_empty()
            || !script.shaders.is_empty()
            || !script.tables.is_empty()
            || !script.webgpu.is_empty();
        Self { script: Some(script), concerned, ..Self::with_tree(file, reported, HostTree::default()) }
    }

    /// Objects with the values of the uniforms of a program.
    pub fn tables(&self) -> &[Table] {
        self.script.as_ref().map_or(&[], |s| &s.tables)
    }

    /// Fields of records of numbers, which arrays of attributes are made of.
    pub fn fields(&self) -> &[Field] {
        self.script.as_ref().map_or(&[], |s| &s.fields)
    }

    /// True for code whose shaders are of OpenGL ES: for the web, or for Android.
    pub fn is_of_es(&self) -> bool {
        let text = self.file.text();
        let android = || ["GLES20", "GLES30", "GLES31"].iter().any(|word| text.contains(word));
        self.is_script() && (crate::script::is_of_the_web(self.file.name()) || android())
    }

    /// True where the shaders of a script reach OpenGL as they stand, but for what its project has in strings.
    pub fn hands_on(&self, given: script::Given) -> bool {
        script::hands_on(self.origin.as_ref().map_or(&self.file, |origin| &origin.host), given)
    }

    /// True for a file of another language than C and C++.
    pub fn is_script(&self) -> bool {
        self.script.is_some()
    }

    /// The same file in a project with wrappers of its own.
    #[must_use]
    pub fn with_wrappers(mut self, wrappers: &[Wrapper]) -> Self {
        self.wrappers = wrappers.to_vec();
        self.concerned |= wrappers.iter().any(|w| self.file.text().contains(&w.function));
        self
    }

    /// Adds the wrappers that the project defines; those that it names in its configuration go first.
    pub fn add_wrappers(&mut self, found: &[Wrapper]) {
        let new = found.iter().filter(|f| self.wrappers.iter().all(|w| w.function != f.function));
        let new: Vec<Wrapper> = new.cloned().collect();
        self.wrappers.extend(new);
    }

    /// The functions of the project that wrap those of OpenGL.
    pub fn wrappers(&self) -> &[Wrapper] {
        &self.wrappers
    }

    /// What has been found in this file, for another reading of the same text in the same project.
    pub fn found(&self) -> Arc<Found> {
        self.found.clone()
    }

    /// Takes over what another reading of the same text in the same project has found.
    pub fn take_found(&mut self, found: Arc<Found>) {
        self.found = found;
    }

    /// The root of the tree, which the first call makes; none when the parser gave up, and for other languages.
    pub fn root(&self) -> Option<Node<'_>> {
        if self.script.is_some() {
            return None;
        }
        self.tree.0.get_or_init(|| parse(&self.file)).as_ref().map(Tree::root_node)
    }

    /// True when the text can feed shaders. The trees of all others would take most of the time and memory of
    /// a run; only what such a file declares may be asked for.
    pub fn concerns_shaders(&self) -> bool {
        self.concerned
    }

    /// Text of a node.
    pub fn text(&self, node: Node<'_>) -> &str {
        self.file.slice(tree::span(node))
    }

    /// What it says of modules in WGSL; none for C and C++.
    pub fn webgpu(&self) -> Option<&WebGpu> {
        self.script.as_ref().map(|s| &s.webgpu)
    }

    /// All look-ups with a literal name, in the order of the text.
    pub fn lookups(&self) -> &[Lookup] {
        if let Some(script) = &self.script {
            return &script.lookups;
        }
        self.found.lookups.get_or_init(|| if self.concerned { lookup::find(self) } else { Vec::new() })
    }

    /// The shaders in literals, in the order of the text.
    pub fn embedded(&self) -> &[Embedded] {
        if let Some(script) = &self.script {
            return &script.shaders;
        }
        self.found.embedded.get_or_init(|| if self.concerned { embedded::find(self) } else { Vec::new() })
    }

    /// The shader files that its variables and macros hold.
    pub fn constants(&self) -> &Constants {
        self.found.constants.get_or_init(|| Constants::of(self))
    }

    /// The programs that the file makes, and the shaders that it names.
    pub fn programs(&self) -> &HostPrograms {
        if let Some(script) = &self.script {
            return &script.programs;
        }
        self.found.programs.get_or_init(|| if self.concerned { programs::find(self) } else { HostPrograms::default() })
    }

    /// The names that statements at file level declare, as a book prints them; none for a text that is a file of
    /// C or C++ by itself.
    pub fn statements(&self) -> Option<BTreeSet<String>> {
        let root = self.root()?;
        let outside = |n: &Node<'_>| tree::enclosing_function(*n).is_none();
        let is_statement = |n: Node<'_>| {
            let call = tree::callee(n, &self.file).is_some_and(|(name, _)| is_function_of_gl(name));
            call || matches!(n.kind(), "for_statement" | "while_statement")
        };
        tree::descendants(root).filter(|n| is_statement(*n)).find(outside)?;
        let declared = tree::descendants(root).filter(|n| n.kind() == "declaration").filter(outside);
        let top = declared.filter(|n| n.parent().is_some_and(|p| p.id() == root.id()));
        let names = top.flat_map(|n| {
            let mut cursor = n.walk();
            n.children_by_field_name("declarator", &mut cursor).collect::<Vec<_>>()
        });
        Some(names.filter_map(tree::declared_name).map(|n| self.text(n).to_owned()).collect())
    }

    /// True for statements at file level, as a book prints them.
    pub fn is_fragment(&self) -> bool {
        let whole = || self.root().is_some_and(|r| !r.has_error()) || self.place.is_some() || self.named;
        *self.found.fragment.get_or_init(|| self.concerned && whole() && self.statements().is_some())
    }

    /// Number of places that the parser could not read.
    pub fn error_count(&self) -> usize {
        self.root()
            .map_or(usize::MAX, |root| tree::descendants(root).filter(|n| n.is_error() || n.is_missing()).count())
    }
}

/// Places of all comments, in the order of the text.
pub fn comments(host: &HostFile) -> Vec<Span> {
    let nodes = host.root().into_iter().flat_map(tree::descendants);
    nodes.filter(|n| n.kind() == "comment").map(tree::span).collect()
}

/// The syntax tree of one text, once it has been asked for. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct HostTree(Arc<OnceLock<Option<Tree>>>);

fn parse(file: &SourceFile) -> Option<Tree> {
    thread_local! {
        // A parser keeps its memory from one text to the next.
        static PARSER: RefCell<Option<Parser>> = RefCell::new(parser());
    }
    PARSER.with_borrow_mut(|parser| parser.as_mut()?.parse(file.text(), None))
}

/// True when a word occurs that host code of shaders cannot do without.
pub fn concerns_shaders(text: &str) -> bool {
    const WORDS: [&str; 9] = ["hader", "niform", "ttribute", "gl_", "#version", ".vert", ".frag", ".glsl", "GLfloat"];
    let call =
        || text.match_indices("gl").any(|(at, _)| text.as_bytes().get(at + 2).is_some_and(u8::is_ascii_uppercase));
    // Loaders of OpenGL declare all its functions, at great length, and use none.
    let is_loader = || text.matches("PFNGL").nth(200).is_some();
    let found =
        WORDS.iter().any(|w| text.contains(w)) || call() || presets::PRESETS.iter().any(|p| text.contains(p.method));
    found && !is_loader()
}

/// True for the name of a function of OpenGL.
fn is_function_of_gl(name: &str) -> bool {
    name.strip_prefix("gl").is_some_and(|n| n.starts_with(|c: char| c.is_ascii_uppercase()))
}

fn parser() -> Option<Parser> {
    let mut parser = Parser::new();
    // The versions of grammar and parser fit: a test below holds this.
    parser.set_language(&tree_sitter_cpp::LANGUAGE.into()).ok()?;
    Some(parser)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_text_does_not_concern_shaders() {
        let file = |text: &str| HostFile::new(&SourceFile::new("a.cpp", text), true);
        assert!(!file("#include <glm/glm.hpp>\nglm::vec3 global(int angle) { return {}; }").concerns_shaders());
        for text in ["void f() { glEnd(); }", "Shader s(\"a\");", "s.setMat4(\"m\", m);", "load(\"a.vert\");"] {
            assert!(file(text).concerns_shaders(), "{text}");
        }
        let loader = "typedef void (APIENTRYP PFNGLCREATESHADERPROC)(GLenum type);\n".repeat(300);
        assert!(!file(&loader).concerns_shaders());
        let kind = crate::wrapper::Wrapped::SetUniform;
        let wrapper = Wrapper { function: "bindMatrix".into(), kind, argument: 0, sets: None };
        let calls = file("void f() { bindMatrix(\"m\"); }");
        assert!(!calls.concerns_shaders());
        assert!(calls.with_wrappers(&[wrapper]).concerns_shaders());
    }

    #[test]
    fn the_grammar_fits_the_parser() {
        let file = HostFile::new(&SourceFile::new("a.cpp", "int main() { return 0; } // 頂点"), true);
        assert_eq!(file.root().map(|r| r.kind()), Some("translation_unit"));
        assert_eq!(file.error_count(), 0);
        assert!(HostFile::new(&SourceFile::new("a.cpp", "int main( { return 0 }"), true).error_count() > 0);
    }
}
