//! C and C++ host code: its syntax tree and the rules on it.

mod attach;
mod attributes;
mod creation;
mod embedded;
mod feeds;
mod group;
pub(super) mod h001;
pub(super) mod h002;
pub(super) mod h003;
pub(super) mod h004;
pub(super) mod h005;
pub(super) mod h006;
pub(super) mod h007;
pub(super) mod h008;
pub(super) mod h009;
pub(super) mod h010;
pub(super) mod h011;
pub(super) mod h013;
pub(super) mod h014;
pub(super) mod h015;
pub(super) mod h016;
pub(super) mod h019;
pub(super) mod h021;
pub(super) mod h022;
pub(super) mod h023;
pub(super) mod h029;
pub(super) mod h030;
mod index;
mod literal;
#[cfg(test)]
mod look_alikes;
mod lookup;
mod marks;
mod presets;
mod program;
mod programs;
mod setter;
mod settings;
mod stringized;
mod suggest;
pub(super) mod syntax;

use std::cell::RefCell;
use std::sync::OnceLock;

use tree_sitter::{Node, Parser, Tree};

use crate::lint::config::Wrapper;
use crate::text::{SourceFile, Span};

use embedded::Embedded;
use lookup::Lookup;
use programs::HostPrograms;

pub(super) use literal::Literal;
pub(super) use program::{ShaderRef, named_shaders};
pub(super) use suggest::{list, list_in_japanese, nearest};
pub(super) use syntax::quoted_includes;

/// A host file with its syntax tree.
pub struct HostFile {
    /// The text.
    pub file: SourceFile,
    /// False when the file is only there to be looked things up in.
    pub reported: bool,
    /// Functions of the project that wrap those of OpenGL.
    wrappers: Vec<Wrapper>,
    tree: HostTree,
    lookups: OnceLock<Vec<Lookup>>,
    embedded: OnceLock<Vec<Embedded>>,
    programs: OnceLock<HostPrograms>,
}

impl HostFile {
    /// Parses `file` as C++, of which the C that feeds shaders is a part. Text that cannot be read
    /// becomes error nodes, on which rules stay silent.
    pub fn new(file: &SourceFile, reported: bool) -> Self {
        Self::with_tree(file, reported, HostTree::new(file))
    }

    /// The same with a tree of this text that is there already.
    pub(super) fn with_tree(file: &SourceFile, reported: bool, tree: HostTree) -> Self {
        Self {
            tree,
            file: file.clone(),
            reported,
            wrappers: Vec::new(),
            lookups: OnceLock::new(),
            embedded: OnceLock::new(),
            programs: OnceLock::new(),
        }
    }

    /// The same file in a project with wrappers of its own.
    #[must_use]
    pub fn with_wrappers(mut self, wrappers: &[Wrapper]) -> Self {
        self.wrappers = wrappers.to_vec();
        self
    }

    /// The root of the tree; none when the parser gave up.
    pub fn root(&self) -> Option<Node<'_>> {
        self.tree.0.as_ref().map(Tree::root_node)
    }

    /// Text of a node.
    pub fn text(&self, node: Node<'_>) -> &str {
        self.file.slice(syntax::span(node))
    }

    /// All look-ups with a literal name, in the order of the text.
    fn lookups(&self) -> &[Lookup] {
        self.lookups.get_or_init(|| lookup::find(self))
    }

    /// The shaders in literals, in the order of the text.
    pub fn embedded(&self) -> &[Embedded] {
        self.embedded.get_or_init(|| embedded::find(self))
    }

    /// The programs that the file makes, and the shaders that it names.
    pub fn programs(&self) -> &HostPrograms {
        self.programs.get_or_init(|| programs::find(self))
    }

    /// Number of places that the parser could not read.
    pub fn error_count(&self) -> usize {
        self.root()
            .map_or(usize::MAX, |root| syntax::descendants(root).filter(|n| n.is_error() || n.is_missing()).count())
    }
}

/// Places of all comments, in the order of the text.
pub(super) fn comments(host: &HostFile) -> Vec<Span> {
    let nodes = host.root().into_iter().flat_map(syntax::descendants);
    nodes.filter(|n| n.kind() == "comment").map(syntax::span).collect()
}

/// A syntax tree; none when the parser gave up. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct HostTree(Option<Tree>);

impl HostTree {
    /// Parses a text as C++.
    pub fn new(file: &SourceFile) -> Self {
        thread_local! {
            // A parser keeps its memory from one text to the next.
            static PARSER: RefCell<Option<Parser>> = RefCell::new(parser());
        }
        Self(PARSER.with_borrow_mut(|parser| parser.as_mut()?.parse(file.text(), None)))
    }
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
    fn the_grammar_fits_the_parser() {
        let file = HostFile::new(&SourceFile::new("a.cpp", "int main() { return 0; } // 頂点"), true);
        assert_eq!(file.root().map(|r| r.kind()), Some("translation_unit"));
        assert_eq!(file.error_count(), 0);
        assert!(HostFile::new(&SourceFile::new("a.cpp", "int main( { return 0 }"), true).error_count() > 0);
    }
}
