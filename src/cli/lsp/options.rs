//! What a client states when it starts the server, and later: which rules run, and what is shown.

use std::fmt;

use base::diagnostic::Lang;
use lsp::{Encoding, Hints};
use serde_json::{Value, json};

use super::commands::COMMANDS;
use super::requests::FIX_ALL;
use crate::cli::lint::{LevelName, LintArgs};

/// Options of a client.
#[derive(Clone, Debug, Default)]
pub(super) struct Options {
    /// Rules to run, as `lint` takes them.
    pub args: LintArgs,
    /// Language of messages; that of `shadercheck.toml` or of the environment if `None`.
    pub lang: Option<crate::cli::LangName>,
    /// Which inlay hints are shown.
    pub hints: Hints,
    /// What the addresses of the rules' pages begin with.
    pub rule_pages: Option<String>,
    /// How columns are counted.
    pub encoding: Encoding,
    /// True when the client takes progress that the server begins.
    pub progress: bool,
    /// True when the client can be asked to show a file.
    pub shows: bool,
    /// True when the client can be asked to watch files.
    pub watches: bool,
}

/// What is wrong with the options.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct BadOption(String);

impl fmt::Display for BadOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Options {
    /// Takes over the options that are stated; gives what cannot be taken over.
    pub fn state(&mut self, given: &Value) -> Vec<BadOption> {
        let mut wrong = Vec::new();
        // Clients send settings under the name of their section as well.
        let given = given.get("shadercheck").unwrap_or(given);
        for (key, value) in given.as_object().into_iter().flatten() {
            let texts =
                || -> Option<Vec<String>> { value.as_array()?.iter().map(|v| v.as_str().map(str::to_owned)).collect() };
            let taken = match key.as_str() {
                "select" => texts().map(|t| self.args.select = t),
                "ignore" => texts().map(|t| self.args.ignore = t),
                "level" => level(value).map(|l| self.args.level = Some(l)),
                "prelude" => value.as_str().map(|p| self.args.prelude = Some(p.to_owned())),
                "lang" => lang(value).map(|l| self.lang = Some(l)),
                "rulePages" => value.as_str().map(|p| self.rule_pages = Some(p.to_owned())),
                "hints" => self.hints(value),
                // Those of the editor's extension.
                _ => Some(()),
            };
            if taken.is_none() {
                wrong.push(BadOption(format!("the option `{key}` cannot be {value}")));
            }
        }
        if let Err(error) = lint::Selection::new(&self.args.select, &self.args.ignore) {
            wrong.push(BadOption(error.to_string()));
            (self.args.select, self.args.ignore) = (Vec::new(), Vec::new());
        }
        wrong
    }

    fn hints(&mut self, value: &Value) -> Option<()> {
        for (key, shown) in value.as_object()? {
            match key.as_str() {
                "conversions" => self.hints.conversions = shown.as_bool()?,
                "offsets" => self.hints.offsets = shown.as_bool()?,
                _ => return None,
            }
        }
        Some(())
    }

    /// Language of messages: as stated, or that of the environment.
    pub fn lang(&self) -> Lang {
        crate::cli::lang(self.lang)
    }
}

/// What the server tells a client that it can do.
pub(super) fn capabilities(encoding: Encoding) -> Value {
    json!({
        "serverInfo": { "name": "shadercheck", "version": env!("CARGO_PKG_VERSION") },
        "capabilities": {
            "positionEncoding": encoding.kind(),
            "textDocumentSync": { "openClose": true, "change": 2, "save": { "includeText": false } },
            "hoverProvider": true,
            "definitionProvider": true,
            "declarationProvider": true,
            "referencesProvider": true,
            "documentHighlightProvider": true,
            "documentSymbolProvider": true,
            "workspaceSymbolProvider": true,
            "foldingRangeProvider": true,
            "selectionRangeProvider": true,
            "inlayHintProvider": true,
            "renameProvider": { "prepareProvider": true },
            "codeActionProvider": { "codeActionKinds": ["quickfix", FIX_ALL] },
            "codeLensProvider": { "resolveProvider": false },
            "completionProvider": { "triggerCharacters": [".", "\"", "'"], "resolveProvider": true },
            "signatureHelpProvider": { "triggerCharacters": ["(", ","] },
            "semanticTokensProvider": { "legend": lsp::legend(), "full": true, "range": true },
            "executeCommandProvider": { "commands": COMMANDS },
            "workspace": { "workspaceFolders": { "supported": true, "changeNotifications": true } },
        },
    })
}

fn level(value: &Value) -> Option<LevelName> {
    Some(match value.as_str()? {
        "default" => LevelName::Default,
        "strict" => LevelName::Strict,
        "heuristic" => LevelName::Heuristic,
        _ => return None,
    })
}

fn lang(value: &Value) -> Option<crate::cli::LangName> {
    Some(match value.as_str()? {
        "en" => crate::cli::LangName::En,
        "ja" => crate::cli::LangName::Ja,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_taken_over_is_named() {
        let mut options = Options::default();
        let given = json!({ "shadercheck": { "level": "strict", "ignore": ["T001"], "hints": { "offsets": false } } });
        assert_eq!(options.state(&given), []);
        assert_eq!((options.args.level, options.hints.offsets), (Some(LevelName::Strict), false));
        for (given, part) in
            [(json!({ "level": 3 }), "level"), (json!({ "select": ["Q9"] }), "Q9"), (json!({ "hints": 1 }), "hints")]
        {
            let wrong = options.state(&given);
            assert!(wrong.len() == 1 && wrong[0].to_string().contains(part), "{wrong:?}");
        }
        assert!(options.args.select.is_empty() && options.args.ignore.is_empty());
    }
}
