//! Requests, each answered from the texts of the moment at which it came.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base::diagnostic::{Diagnostic, Safety};
use base::text::{SourceFile, Span};
use lint::Input;
use ls_types::{
    CodeAction, CodeActionKind, CodeActionParams, CompletionItem, HoverContents, Position, Range,
    TextDocumentPositionParams, Uri, WorkspaceEdit,
};
use lsp::{Place, Workspace};
use lsp_server::{ErrorCode, ResponseError};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::edits::{between, workspace_edit};
use super::options::Options;
use super::project::{Project, name_of};
use super::results::Found;

/// The kind of the action that repairs a whole file.
pub(super) const FIX_ALL: &str = "source.fixAll.shadercheck";

/// The texts of a moment.
#[derive(Clone)]
pub(super) struct Context {
    pub workspace: Workspace,
    pub project: Arc<Project>,
    pub inputs: Vec<Input>,
    pub options: Arc<Options>,
    /// Open documents as the client names them.
    pub open: Arc<HashMap<String, Uri>>,
    pub roots: Arc<[PathBuf]>,
}

type Answer = Result<Value, ResponseError>;

pub(super) fn answer(method: &str, params: Value, context: &Context) -> Answer {
    let workspace = &context.workspace;
    match method {
        "textDocument/hover" => {
            let (name, _, at) = context.place(params)?;
            let mut hover = workspace.hover(&name, at);
            if let Some(HoverContents::Markup(text)) = hover.as_mut().map(|h| &mut h.contents)
                && let Some(numbers) = numbers(workspace, &name, at)
            {
                text.value.push_str("\n\n");
                text.value.push_str(&numbers);
            }
            written(hover)
        }
        "textDocument/definition" | "textDocument/declaration" => {
            let (name, _, at) = context.place(params)?;
            written(context.locations(&workspace.definition(&name, at)))
        }
        "textDocument/references" => {
            let declarations = params["context"]["includeDeclaration"].as_bool().unwrap_or(true);
            let (name, _, at) = context.place(params)?;
            written(context.locations(&workspace.references(&name, at, declarations)))
        }
        "textDocument/documentHighlight" => {
            let (name, _, at) = context.place(params)?;
            written(workspace.highlights(&name, at))
        }
        "textDocument/prepareRename" => {
            let (name, _, at) = context.place(params)?;
            let place = workspace.renamed_at(&name, at).map_err(|why| context.failed(&why))?;
            let range = context.options.encoding.range(&place.file, place.span);
            Ok(json!({ "range": range, "placeholder": place.file.slice(place.span) }))
        }
        "textDocument/rename" => {
            let new = params["newName"].as_str().unwrap_or("").to_owned();
            let (name, _, at) = context.place(params)?;
            let edits = workspace.rename(&name, at, &new).map_err(|why| context.failed(&why))?;
            written(workspace_edit(&edits, context).map_err(|why| context.failed(&why))?)
        }
        "textDocument/completion" => {
            let (name, _, at) = context.place(params)?;
            let items = workspace.completion(&name, at).into_iter();
            let data = json!(name);
            let items: Vec<CompletionItem> = items.map(|i| CompletionItem { data: Some(data.clone()), ..i }).collect();
            written(items)
        }
        "completionItem/resolve" => {
            let item: CompletionItem = read(params)?;
            let name = item.data.as_ref().and_then(Value::as_str).unwrap_or("").to_owned();
            written(workspace.completion_details(&name, item))
        }
        "textDocument/signatureHelp" => {
            let (name, _, at) = context.place(params)?;
            written(workspace.signature_help(&name, at))
        }
        "textDocument/documentSymbol" => {
            let (name, _) = context.document(&params)?;
            Ok(workspace.document_symbols(&name))
        }
        "workspace/symbol" => {
            let query = params["query"].as_str().unwrap_or("");
            Ok(workspace.workspace_symbols(query, &|name| context.uri(name)))
        }
        "textDocument/foldingRange" => {
            let (name, _) = context.document(&params)?;
            written(workspace.folding(&name))
        }
        "textDocument/selectionRange" => {
            let (name, file) = context.document(&params)?;
            let positions: Vec<Position> = read(params["positions"].clone())?;
            let at = positions.into_iter().map(|p| context.options.encoding.offset(&file, p));
            written(at.filter_map(|at| workspace.selection(&name, at)).collect::<Vec<_>>())
        }
        "textDocument/semanticTokens/full" => {
            let (name, _) = context.document(&params)?;
            Ok(json!({ "data": flat(&workspace.semantic_tokens(&name, None)) }))
        }
        "textDocument/semanticTokens/range" => {
            let (name, span) = context.range(&params)?;
            Ok(json!({ "data": flat(&workspace.semantic_tokens(&name, Some(span))) }))
        }
        "textDocument/inlayHint" => {
            let (name, span) = context.range(&params)?;
            written(workspace.hints(&name, span, context.options.hints))
        }
        "textDocument/codeAction" => context.code_actions(read(params)?),
        "textDocument/codeLens" => {
            let (name, _) = context.document(&params)?;
            Ok(super::commands::lenses(&name, context))
        }
        _ => Err(error(ErrorCode::MethodNotFound, format!("`{method}` is not answered here"))),
    }
}

/// How far a device may be off at a place.
#[cfg(feature = "run")]
fn numbers(workspace: &Workspace, name: &str, at: usize) -> Option<String> {
    super::numbers::told(&workspace.probe(name, at)?)
}

/// The linter alone runs nothing.
#[cfg(not(feature = "run"))]
fn numbers(_: &Workspace, _: &str, _: usize) -> Option<String> {
    None
}

/// An error of the protocol.
pub(super) fn error(code: ErrorCode, message: String) -> ResponseError {
    ResponseError { code: code as i32, message, data: None }
}

fn read<T: DeserializeOwned>(params: Value) -> Result<T, ResponseError> {
    serde_json::from_value(params).map_err(|e| error(ErrorCode::InvalidParams, e.to_string()))
}

fn written<T: Serialize>(answer: T) -> Answer {
    serde_json::to_value(answer).map_err(|e| error(ErrorCode::InternalError, e.to_string()))
}

fn flat(tokens: &[ls_types::SemanticToken]) -> Vec<u32> {
    let numbers =
        |t: &ls_types::SemanticToken| [t.delta_line, t.delta_start, t.length, t.token_type, t.token_modifiers_bitset];
    tokens.iter().flat_map(numbers).collect()
}

/// The name of a document among the inputs; none for what is no file.
pub(super) fn path_of(uri: &Uri) -> Option<String> {
    let is_file = uri.as_str().get(..5).is_some_and(|s| s.eq_ignore_ascii_case("file:"));
    uri.to_file_path().filter(|_| is_file).map(|path| name_of(&path))
}

impl Context {
    /// How the client names a file.
    pub fn uri(&self, name: &str) -> Option<Uri> {
        self.open.get(name).cloned().or_else(|| Uri::from_file_path(Path::new(name)))
    }

    pub fn is_open(&self, name: &str) -> bool {
        self.open.contains_key(name)
    }

    /// True for a file that lies in a folder of the workspace, links followed.
    pub fn is_inside(&self, name: &str) -> bool {
        let real = |path: &Path| std::fs::canonicalize(path).ok();
        let Some(file) = real(Path::new(name)) else { return false };
        self.roots.iter().filter_map(|root| real(root)).any(|root| file.starts_with(root))
    }

    /// The document that parameters name, and its text.
    fn document(&self, params: &Value) -> Result<(String, SourceFile), ResponseError> {
        let uri: Uri = read(params["textDocument"]["uri"].clone())?;
        let name = path_of(&uri).unwrap_or_default();
        match self.workspace.file(&name) {
            Some(file) => Ok((name, file.clone())),
            None => Err(error(ErrorCode::InvalidParams, format!("{} is not open", uri.as_str()))),
        }
    }

    fn place(&self, params: Value) -> Result<(String, SourceFile, usize), ResponseError> {
        let (name, file) = self.document(&params)?;
        let place: TextDocumentPositionParams = read(params)?;
        let at = self.options.encoding.offset(&file, place.position);
        Ok((name, file, at))
    }

    fn range(&self, params: &Value) -> Result<(String, Span), ResponseError> {
        let (name, file) = self.document(params)?;
        let range: Range = read(params["range"].clone())?;
        Ok((name, self.options.encoding.span(&file, range)))
    }

    fn locations(&self, places: &[Place]) -> Vec<ls_types::Location> {
        places.iter().filter_map(|p| self.workspace.location(p, |name| self.uri(name))).collect()
    }

    /// A finding as the client knows it.
    pub fn shown(&self, found: &Diagnostic) -> ls_types::Diagnostic {
        let options = &self.options;
        let pages = options.rule_pages.as_deref();
        let mut shown = lsp::diagnostic(found, options.lang(), options.encoding, &|name| self.uri(name), pages);
        shown.message = self.shortened(shown.message);
        shown
    }

    /// What a command found, as the client knows it, by file. A place counts only where the file is as it was when the
    /// command read it: on the disk as in the editor, and the text that was found still there.
    pub fn results(
        &self,
        source: &str,
        found: &[Found],
        unchanged: impl Fn(&str) -> bool,
    ) -> BTreeMap<String, Vec<Value>> {
        let mut by_file: BTreeMap<String, Vec<Value>> = BTreeMap::new();
        for one in found {
            let Some((name, line, column)) = one.place() else { continue };
            let name = name_of(Path::new(name));
            let Some(file) = self.workspace.file(&name).filter(|_| unchanged(&name)) else { continue };
            let saved = !self.is_open(&name) || std::fs::read_to_string(&name).is_ok_and(|disk| disk == file.text());
            let start = file.offset(base::text::Position { line, column });
            let rest = &file.text()[start..];
            let words = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            let length = one.text.as_ref().filter(|text| rest.starts_with(text.as_str())).map_or(words, String::len);
            if !saved {
                continue;
            }
            let range = self.options.encoding.range(file, Span::new(start, start + length));
            let mut shown = json!({
                "range": range, "severity": one.severity, "source": source, "message": self.shortened(one.message.clone()),
            });
            if let Some(replace) = &one.replace {
                shown["data"] = json!({ "text": file.slice(Span::new(start, start + length)), "replace": replace });
            }
            by_file.entry(name).or_default().push(shown);
        }
        by_file
    }

    /// Repairs out of what commands found, which the client hands back with its diagnostics.
    fn of_results(&self, file: &SourceFile, uri: &Uri, found: &[ls_types::Diagnostic]) -> Vec<CodeAction> {
        let action = |d: &ls_types::Diagnostic| {
            let data = d.data.as_ref()?;
            let (text, replace) = (data["text"].as_str()?, data["replace"].as_str()?);
            (file.slice(self.options.encoding.span(file, d.range)) == text).then_some(())?;
            let edit = ls_types::TextEdit { range: d.range, new_text: replace.to_owned() };
            Some(CodeAction {
                title: format!("Write `{replace}`"),
                kind: Some(CodeActionKind::QUICKFIX),
                diagnostics: Some(vec![d.clone()]),
                edit: Some(WorkspaceEdit {
                    changes: Some(HashMap::from([(uri.clone(), vec![edit])])),
                    ..WorkspaceEdit::default()
                }),
                ..CodeAction::default()
            })
        };
        found.iter().filter_map(action).collect()
    }

    /// A message with paths from the folders of the workspace.
    pub fn shortened(&self, message: String) -> String {
        let prefix = |root: &PathBuf| format!("{}/", name_of(root).trim_end_matches('/'));
        self.roots.iter().map(prefix).filter(|p| p.len() > 1).fold(message, |text, prefix| text.replace(&prefix, ""))
    }

    fn failed(&self, why: &lsp::RenameError) -> ResponseError {
        error(ErrorCode::RequestFailed, self.shortened(why.to_string()))
    }

    fn code_actions(&self, params: CodeActionParams) -> Answer {
        let uri = params.text_document.uri;
        let name = path_of(&uri).unwrap_or_default();
        let Some(file) = self.workspace.file(&name) else { return Ok(json!([])) };
        let span = self.options.encoding.span(file, params.range);
        let wanted = |kind: &str| {
            let within =
                |only: &CodeActionKind| kind == only.as_str() || kind.starts_with(&format!("{}.", only.as_str()));
            params.context.only.as_ref().is_none_or(|all| all.iter().any(within))
        };
        let found = self.project.groups.run_on(&self.inputs, |n| n == name);
        let own: Vec<&Diagnostic> = found.iter().filter(|d| d.file.name() == name).collect();
        let mut all: Vec<CodeAction> = Vec::new();
        if wanted("quickfix") {
            let lines = |s: Span| file.position(s.start).line..=file.position(s.end).line;
            let asked = lines(span);
            let touched =
                |d: &&&Diagnostic| d.span.touches(span) || (span.is_empty() && lines(d.span).contains(asked.start()));
            let here: Vec<_> = own.iter().filter(touched).map(|d| (*d, self.shown(d))).collect();
            all.extend(self.of_results(file, &uri, &params.context.diagnostics));
            all.extend(lsp::actions(&here, &uri, self.options.lang(), self.options.encoding));
        }
        let fixable = own.iter().any(|d| d.fix.as_ref().is_some_and(|f| f.safety == Safety::Safe));
        if wanted(FIX_ALL) && fixable {
            all.extend(self.fix_all(&name, &uri));
        }
        written(all)
    }

    /// What repairs all of a file that can be repaired without a change of meaning.
    fn fix_all(&self, name: &str, uri: &Uri) -> Option<CodeAction> {
        let outcome = self.project.groups.fix_on(&self.inputs, Safety::Safe, |n| n == name);
        let fixed = outcome.files.iter().find(|f| f.before.name() == name)?;
        let edits = between(&fixed.before, fixed.after.text(), self.options.encoding);
        let title = match self.options.lang() {
            base::diagnostic::Lang::En => "Fix all that is safe to fix in this file",
            base::diagnostic::Lang::Ja => "このファイルで安全に修正できるものをすべて修正",
        };
        Some(CodeAction {
            title: title.to_owned(),
            kind: Some(CodeActionKind::from(FIX_ALL)),
            edit: Some(WorkspaceEdit {
                changes: Some(HashMap::from([(uri.clone(), edits)])),
                ..WorkspaceEdit::default()
            }),
            ..CodeAction::default()
        })
    }
}
