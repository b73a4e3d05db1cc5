//! Values of one name in one block, which drafts allowed: each but the first gets a name of its own.

use super::Pass;
use crate::token::Kind;

/// What a block declares.
#[derive(Default)]
struct Scope {
    names: Vec<String>,
    /// Names with what stands for them from here on.
    renamed: Vec<(String, String)>,
}

impl Pass<'_> {
    /// Renames what is declared once more in its block, with its uses behind.
    pub(super) fn shadowed(&mut self) {
        let mut open: Vec<Scope> = Vec::new();
        // Parameters belong to the block of their function.
        let mut params: Vec<String> = Vec::new();
        let mut given: Vec<String> = Vec::new();
        // A declaration holds from its end: its value may be made of the one before.
        let mut pending: Option<(String, String)> = None;
        for at in 0..self.tokens.len() {
            match self.word(at) {
                "fn" if open.is_empty() => params = self.params(at),
                "{" => open.push(Scope { names: std::mem::take(&mut params), renamed: Vec::new() }),
                "}" => drop(open.pop()),
                ";" => {
                    if let (Some(renamed), Some(scope)) = (pending.take(), open.last_mut()) {
                        scope.renamed.retain(|(name, _)| *name != renamed.0);
                        scope.renamed.push(renamed);
                    }
                }
                _ if self.kind(at) != Some(Kind::Word) => {}
                word => {
                    let name = word.to_owned();
                    if at > 0 && self.word(at - 1) == "." {
                        continue;
                    }
                    let again = self.declares(at)
                        && open.last_mut().is_some_and(|scope| {
                            let again = scope.names.contains(&name);
                            scope.names.push(name.clone());
                            again
                        });
                    let stands = open.iter().rev().flat_map(|scope| &scope.renamed).find(|(own, _)| *own == name);
                    let mut new = stands.map(|(_, new)| new.clone());
                    if again {
                        let taken = |new: &String| given.contains(new) || self.is_a_word(new);
                        let Some(fresh) = (2..).map(|n| format!("{name}_{n}")).find(|new| !taken(new)) else {
                            continue;
                        };
                        given.push(fresh.clone());
                        pending = Some((name, fresh.clone()));
                        new = Some(fresh);
                    }
                    if let Some(new) = new {
                        self.change(self.tokens[at].span, new, "a name is declared once in a block");
                    }
                }
            }
        }
    }

    /// True for the name of a value or variable that belongs to the block it stands in.
    fn declares(&self, at: usize) -> bool {
        let word = |back: usize| at.checked_sub(back).map_or("", |k| self.word(k));
        matches!(word(1), "let" | "const" | "var") && !(word(2) == "(" && word(3) == "for")
    }

    fn kind(&self, at: usize) -> Option<Kind> {
        self.tokens.get(at).map(|token| token.kind)
    }

    fn is_a_word(&self, word: &str) -> bool {
        (0..self.tokens.len()).any(|at| self.word(at) == word)
    }

    /// The parameters of a function at `fn`.
    fn params(&self, at: usize) -> Vec<String> {
        let end = (at + 2..self.tokens.len()).find(|&k| self.word(k) == "{").unwrap_or(at);
        let is_name = |k: &usize| self.kind(*k) == Some(Kind::Word) && self.word(k + 1) == ":";
        (at + 2..end).filter(is_name).map(|k| self.word(k).to_owned()).collect()
    }
}
