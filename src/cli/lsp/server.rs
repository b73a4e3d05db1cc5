//! The state of the server and its loop.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use base::diagnostic::Diagnostic;
use base::text::SourceFile;
use lint::{Config, Input};
use ls_types::Uri;
use lsp::{Encoding, UnitCache, Workspace};
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use serde_json::{Value, json};

use super::Event;
use super::commands::{Finished, Running, asked, start};
use super::options::Options;
use super::project::{Project, load, name_of};
use super::requests::{Context, answer, error, path_of};
use super::shown::Shown;
use super::transport::{Incoming, Outgoing};
use super::views::Views;
use crate::cli::lint::config::FILE_NAME;
use crate::cli::lint::files::has_known_ending;

/// How long nothing is typed before all files are linted again.
const PAUSE: Duration = Duration::from_millis(500);

/// Files that were linted.
pub(super) struct Checked {
    /// The change after which it began.
    revision: u64,
    /// The files; none for all of them.
    only: Option<BTreeSet<String>>,
    found: Found,
    /// Which files belong together, where all were looked at.
    related: Option<HashMap<String, BTreeSet<String>>>,
}

/// What came of a run of the linter.
enum Found {
    /// All that there is.
    All(Vec<Diagnostic>),
    /// It was stopped: a text changed.
    Stopped,
    /// A defect of the linter.
    Failed,
}

struct Document {
    uri: Uri,
    version: i64,
    file: SourceFile,
}

pub(super) struct Server {
    events: Sender<Event>,
    out: Sender<Outgoing>,
    options: Options,
    roots: Vec<PathBuf>,
    open: BTreeMap<String, Document>,
    project: Arc<Project>,
    inputs: Vec<Input>,
    cache: Arc<UnitCache>,
    context: Option<Context>,
    revision: u64,
    /// Files that changed and were not linted since, with their neighbours.
    dirty: BTreeSet<String>,
    checking: bool,
    /// Stops the run over all files that goes on, if any.
    checking_all: Option<Arc<AtomicBool>>,
    check_all_at: Option<Instant>,
    reload_at: Option<Instant>,
    related: HashMap<String, BTreeSet<String>>,
    /// The change after which what is shown for a file was found.
    stamps: HashMap<String, u64>,
    shown: Shown,
    /// The last change of each file.
    touched: HashMap<String, u64>,
    views: Views,
    told: BTreeSet<String>,
    pending: BTreeSet<String>,
    running: HashMap<String, Running>,
    numbers: u64,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Before `initialize`.
    New,
    Serving,
    /// After `shutdown`.
    ShutDown,
}

impl Server {
    pub fn new(events: Sender<Event>, out: Sender<Outgoing>) -> Self {
        let project = load(&[], &BTreeMap::new(), &crate::cli::lint::LintArgs::default(), &[]);
        Self {
            events,
            out,
            options: Options::default(),
            roots: Vec::new(),
            open: BTreeMap::new(),
            project: Arc::new(project),
            inputs: Vec::new(),
            cache: Arc::default(),
            context: None,
            revision: 0,
            dirty: BTreeSet::new(),
            checking: false,
            checking_all: None,
            check_all_at: None,
            reload_at: None,
            related: HashMap::new(),
            stamps: HashMap::new(),
            shown: Shown::default(),
            touched: HashMap::new(),
            views: Views::default(),
            told: BTreeSet::new(),
            pending: BTreeSet::new(),
            running: HashMap::new(),
            numbers: 0,
            state: State::New,
        }
    }

    /// Serves until the client ends it; true when it did so as the protocol wants.
    pub fn run(mut self, incoming: &Receiver<Event>) -> bool {
        let clean = loop {
            let wait = [self.check_all_at, self.reload_at].into_iter().flatten().min();
            let wait = wait.map_or(Duration::from_secs(3600), |at| at.saturating_duration_since(Instant::now()));
            let first = match incoming.recv_timeout(wait) {
                Ok(event) => Some(event),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => break false,
            };
            // All that is there already, so that one look serves several keys.
            let mut end = None;
            for event in first.into_iter().chain(std::iter::from_fn(|| incoming.try_recv().ok())) {
                end = self.take(event);
                if end.is_some() {
                    break;
                }
            }
            if let Some(clean) = end {
                break clean;
            }
            self.work();
        };
        self.running.values().for_each(Running::stop);
        clean
    }

    /// Takes an event; gives how the server ends when it does.
    fn take(&mut self, event: Event) -> Option<bool> {
        match event {
            Event::Incoming(Incoming::End) => return Some(false),
            Event::Incoming(Incoming::Broken(why)) => self.write(Outgoing::ParseError(why)),
            Event::Incoming(Incoming::Message(Message::Request(request))) => self.request(request),
            Event::Incoming(Incoming::Message(Message::Notification(n))) if n.method == "exit" => {
                return Some(self.state == State::ShutDown);
            }
            Event::Incoming(Incoming::Message(Message::Notification(n))) => self.notification(&n),
            // What the client says to requests of ours needs no answer.
            Event::Incoming(Incoming::Message(Message::Response(_))) => {}
            Event::Checked(checked) => self.checked(checked),
            Event::Answered(response) => self.respond(response),
            Event::Finished(finished) => self.finished(finished),
        }
        None
    }

    fn write(&self, outgoing: Outgoing) {
        // No one reads any more: the end comes by the other way.
        drop(self.out.send(outgoing));
    }

    fn notify(&self, method: &str, params: Value) {
        self.write(Outgoing::Message(Notification { method: method.to_owned(), params }.into()));
    }

    fn ask(&mut self, method: &str, params: Value) {
        self.numbers += 1;
        let id = RequestId::from(format!("shadercheck-{}", self.numbers));
        self.write(Outgoing::Message(Request { id, method: method.to_owned(), params }.into()));
    }

    fn tell(&mut self, kind: ls_types::MessageType, message: &str) {
        if self.told.insert(message.to_owned()) {
            self.notify("window/showMessage", json!({ "type": kind, "message": message }));
        }
    }

    /// Sends an answer, unless the request was taken back.
    fn respond(&mut self, response: Response) {
        if self.pending.remove(&response.id.to_string()) {
            self.write(Outgoing::Message(response.into()));
        }
    }

    fn request(&mut self, request: Request) {
        let id = request.id.clone();
        let refuse = |code, why: &str| Err(error(code, why.to_owned()));
        self.pending.insert(id.to_string());
        let response_result = match (self.state, request.method.as_str()) {
            (State::New, "initialize") => Ok(self.initialize(&request.params)),
            (State::New, _) => refuse(ErrorCode::ServerNotInitialized, "`initialize` comes first"),
            (State::ShutDown, _) => refuse(ErrorCode::InvalidRequest, "after `shutdown` only `exit` is expected"),
            (State::Serving, "initialize") => refuse(ErrorCode::InvalidRequest, "`initialize` comes once"),
            (State::Serving, "shutdown") => {
                self.state = State::ShutDown;
                self.running.values().for_each(Running::stop);
                Ok(Value::Null)
            }
            (State::Serving, "workspace/executeCommand") => match self.execute(&id, &request.params) {
                Ok(()) => return,
                Err(why) => Err(why),
            },
            (State::Serving, _) => {
                let (context, events) = (self.context(), self.events.clone());
                std::thread::spawn(move || {
                    let answered = || answer(&request.method, request.params, &context);
                    let failed = || refuse(ErrorCode::InternalError, "a defect of shadercheck; please report it");
                    let response_result = catch_unwind(AssertUnwindSafe(answered)).unwrap_or_else(|_| failed());
                    drop(events.send(Event::Answered(Response { id: request.id, response_result })));
                });
                return;
            }
        };
        self.respond(Response { id, response_result });
    }

    fn initialize(&mut self, params: &Value) -> Value {
        self.state = State::Serving;
        let folders = params["workspaceFolders"].as_array().into_iter().flatten().filter_map(|f| f["uri"].as_str());
        let mut roots: Vec<PathBuf> = folders.filter_map(folder).collect();
        if roots.is_empty() {
            roots.extend(params["rootUri"].as_str().and_then(folder));
            roots.extend(params["rootPath"].as_str().filter(|_| roots.is_empty()).map(PathBuf::from));
        }
        self.roots = roots;
        let capabilities = &params["capabilities"];
        let offered = capabilities["general"]["positionEncodings"].clone();
        let encodings: Vec<ls_types::PositionEncodingKind> = serde_json::from_value(offered).unwrap_or_default();
        self.options.encoding = Encoding::agreed(&encodings);
        self.options.progress = capabilities["window"]["workDoneProgress"] == json!(true);
        self.options.shows = capabilities["window"]["showDocument"]["support"] == json!(true);
        self.options.watches = capabilities["workspace"]["didChangeWatchedFiles"]["dynamicRegistration"] == json!(true);
        self.configure(&params["initializationOptions"]);
        self.reload_at = Some(Instant::now());
        super::options::capabilities(self.options.encoding)
    }

    fn configure(&mut self, given: &Value) {
        for wrong in self.options.state(given) {
            self.tell(ls_types::MessageType::WARNING, &format!("shadercheck: {wrong}"));
        }
    }

    fn notification(&mut self, n: &Notification) {
        if self.state != State::Serving {
            return;
        }
        let document = &n.params["textDocument"];
        let uri = || document["uri"].as_str()?.parse::<Uri>().ok();
        match n.method.as_str() {
            "initialized" if self.options.watches => {
                let watchers = json!([{ "globPattern": "**/*" }]);
                let options = json!({ "watchers": watchers });
                let one =
                    json!({ "id": "files", "method": "workspace/didChangeWatchedFiles", "registerOptions": options });
                self.ask("client/registerCapability", json!({ "registrations": [one] }));
            }
            "textDocument/didOpen" => {
                let (Some(uri), Some(text)) = (uri(), document["text"].as_str()) else { return };
                let Some(name) = path_of(&uri) else { return };
                let file = SourceFile::new(name.as_str(), text);
                let version = document["version"].as_i64().unwrap_or(0);
                let same = self.inputs.iter().any(|i| i.reported && i.file == file);
                self.open.insert(name.clone(), Document { uri, version, file });
                self.context = None;
                if same {
                    self.touch(&name);
                } else {
                    self.reload_at = Some(Instant::now());
                }
            }
            "textDocument/didChange" => {
                let Some(name) = uri().and_then(|u| path_of(&u)) else { return };
                let Some(open) = self.open.get_mut(&name) else { return };
                open.version = document["version"].as_i64().unwrap_or(open.version + 1);
                for change in n.params["contentChanges"].as_array().into_iter().flatten() {
                    open.file = changed(&open.file, change, self.options.encoding);
                }
                let file = open.file.clone();
                match self.inputs.iter_mut().find(|i| i.file.name() == name && i.reported) {
                    Some(input) => *input = input.with_file(file),
                    None => self.reload_at = Some(Instant::now()),
                }
                self.touch(&name);
            }
            "textDocument/didClose" => {
                let Some(name) = uri().and_then(|u| path_of(&u)) else { return };
                self.open.remove(&name);
                self.reload_at = Some(Instant::now());
            }
            "workspace/didChangeWatchedFiles" if !concerns_us(&n.params) => {}
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => {
                self.reload_at = self.reload_at.or(Some(Instant::now() + PAUSE));
            }
            "workspace/didChangeConfiguration" => {
                self.configure(&n.params["settings"]);
                self.reload_at = Some(Instant::now());
            }
            "workspace/didChangeWorkspaceFolders" => {
                let folders = |key: &str| -> Vec<PathBuf> {
                    let all = n.params["event"][key].as_array().into_iter().flatten();
                    all.filter_map(|f| f["uri"].as_str()).filter_map(folder).collect()
                };
                let removed = folders("removed");
                self.roots.retain(|root| !removed.contains(root));
                self.roots.extend(folders("added"));
                self.reload_at = Some(Instant::now());
            }
            "$/cancelRequest" => {
                let id = serde_json::from_value::<RequestId>(n.params["id"].clone());
                let Ok(id) = id else { return };
                if let Some(running) = self.running.values().find(|r| r.request == id) {
                    // Its answer says that it was stopped.
                    running.stop();
                } else {
                    let response_result = Err(error(ErrorCode::RequestCanceled, "taken back".to_owned()));
                    self.respond(Response { id, response_result });
                }
            }
            "window/workDoneProgress/cancel" => {
                let token = n.params["token"].as_str().unwrap_or("");
                self.running.get(token).into_iter().for_each(Running::stop);
            }
            // Others, `$/setTrace` among them, may be left aside.
            _ => {}
        }
    }

    /// Notes that a text changed.
    fn touch(&mut self, name: &str) {
        self.revision += 1;
        self.touched.insert(name.to_owned(), self.revision);
        self.shown.forget_results(name);
        self.context = None;
        self.dirty.insert(name.to_owned());
        self.dirty.extend(self.related.get(name).into_iter().flatten().cloned());
        self.check_all_at = Some(Instant::now() + PAUSE);
        self.stop_all();
    }

    /// Stops the run over all files: its texts are not those of now, and it takes the time that the next key needs.
    fn stop_all(&self) {
        self.checking_all.iter().for_each(|stop| stop.store(true, Ordering::Relaxed));
    }

    /// What is due.
    fn work(&mut self) {
        let now = Instant::now();
        if self.reload_at.is_some_and(|at| at <= now) {
            self.reload_at = None;
            self.reload();
        }
        if !self.checking && !self.dirty.is_empty() {
            let only = std::mem::take(&mut self.dirty);
            self.checking = true;
            self.check(Some(only));
        }
        if self.checking_all.is_none() && !self.checking && self.check_all_at.is_some_and(|at| at <= now) {
            self.check_all_at = None;
            self.check(None);
        }
    }

    fn reload(&mut self) {
        let open: BTreeMap<String, String> =
            self.open.iter().map(|(name, d)| (name.clone(), d.file.text().to_owned())).collect();
        let project = load(&self.roots, &open, &self.options.args, &self.inputs);
        for message in &project.messages {
            self.tell(ls_types::MessageType::WARNING, &format!("shadercheck: {message}"));
        }
        self.inputs = project.loaded.inputs.clone();
        self.project = Arc::new(project);
        let names: BTreeSet<&str> = self.inputs.iter().map(|i| i.file.name()).collect();
        self.cache.retain(|name| names.contains(name));
        self.revision += 1;
        self.context = None;
        self.dirty.extend(self.open.keys().cloned());
        self.check_all_at = Some(Instant::now());
        self.stop_all();
    }

    /// The texts of this moment.
    fn context(&mut self) -> Context {
        if self.reload_at.is_some_and(|at| at <= Instant::now()) {
            self.reload_at = None;
            self.reload();
        }
        if let Some(context) = &self.context {
            return context.clone();
        }
        let config: Config =
            self.inputs.first().map_or_else(Config::default, |i| self.project.groups.config(i.file.name()));
        let context = Context {
            workspace: Workspace::new(self.inputs.clone(), config, self.cache.clone(), self.options.encoding),
            project: self.project.clone(),
            inputs: self.inputs.clone(),
            options: Arc::new(self.options.clone()),
            open: Arc::new(self.open.iter().map(|(name, d)| (name.clone(), d.uri.clone())).collect()),
            roots: self.roots.clone().into(),
        };
        self.context.insert(context).clone()
    }

    /// Lints files in a thread of their own.
    fn check(&mut self, only: Option<BTreeSet<String>>) {
        let (context, events, revision) = (self.context(), self.events.clone(), self.revision);
        let stop = Arc::new(AtomicBool::new(false));
        if only.is_none() {
            self.checking_all = Some(stop.clone());
        }
        std::thread::spawn(move || {
            let groups = &context.project.groups;
            let run = || match &only {
                Some(only) => (groups.run_until(&context.inputs, |name| only.contains(name), &stop), None),
                None => {
                    let found = groups.run_until(&context.inputs, |_| true, &stop);
                    let related = found.as_ref().map(|_| context.workspace.related());
                    (found, related)
                }
            };
            let (found, related) = match catch_unwind(AssertUnwindSafe(run)) {
                Ok((Some(found), related)) => (Found::All(found), related),
                Ok((None, _)) => (Found::Stopped, None),
                Err(_) => (Found::Failed, None),
            };
            drop(events.send(Event::Checked(Checked { revision, only, found, related })));
        });
    }

    /// Shows what was found, as far as nothing newer is shown.
    fn checked(&mut self, Checked { revision, only, found, related }: Checked) {
        match only {
            // All files would take the time that the next key needs.
            Some(_) => {
                self.checking = false;
                self.check_all_at = self.check_all_at.map(|_| Instant::now() + PAUSE);
            }
            None => self.checking_all = None,
        }
        if let Some(related) = related {
            self.related = related;
        }
        let found = match found {
            Found::All(found) => found,
            // Whoever stopped it asked for another one.
            Found::Stopped => return,
            Found::Failed => {
                self.tell(ls_types::MessageType::ERROR, "shadercheck: a defect in the linter; please report it");
                return;
            }
        };
        let context = self.context();
        let mut by_file: BTreeMap<String, Vec<Value>> = BTreeMap::new();
        let names = only.unwrap_or_else(|| {
            let reported = self.inputs.iter().filter(|i| i.reported).map(|i| i.file.name().to_owned());
            reported.chain(self.shown.names().cloned()).collect()
        });
        for name in names.into_iter().filter(|n| self.stamps.get(n).is_none_or(|stamp| *stamp <= revision)) {
            by_file.insert(name, Vec::new());
        }
        for diagnostic in &found {
            if let Some(own) = by_file.get_mut(diagnostic.file.name()) {
                own.extend(serde_json::to_value(context.shown(diagnostic)));
            }
        }
        for (name, diagnostics) in by_file {
            self.stamps.insert(name.clone(), revision);
            self.shown.lint(&name, diagnostics);
            // Of a text that went on changing, the version is not the one that was looked at.
            self.publish(&context, &name, revision == self.revision);
        }
    }

    fn publish(&mut self, context: &Context, name: &str, current: bool) {
        // A file that is open is told of each time: what is empty is an answer as well.
        if self.views.has(name) {
            return;
        }
        let open = self.open.get(name);
        let Some(diagnostics) = self.shown.all(name, open.is_some()) else { return };
        let Some(uri) = context.uri(name) else { return };
        let mut params = json!({ "uri": uri, "diagnostics": diagnostics });
        if let Some(document) = open.filter(|_| current) {
            params["version"] = document.version.into();
        }
        self.notify("textDocument/publishDiagnostics", params);
    }

    /// Shows what a command found: at its places, as far as these texts are still there, and as a view.
    fn finished(&mut self, Finished { token, mut response, title, results }: Finished) {
        let revision = self.running.remove(&token).map_or(0, |running| running.revision);
        self.progress(&token, json!({ "kind": "end" }));
        if let Some(results) = results {
            let context = self.context();
            let source = format!("shadercheck {}", title.split(' ').next().unwrap_or(""));
            let found = context.results(&source, &results.found, |name| {
                self.touched.get(name).is_none_or(|touched| *touched <= revision)
            });
            for name in self.shown.results(&source, found) {
                self.publish(&context, &name, true);
            }
            let text = context.shortened(results.text);
            if let Some(uri) = self.views.write(&title, results.ending, &text) {
                if let Ok(answer) = &mut response.response_result {
                    (answer["view"], answer["output"]) = (json!(uri), text.into());
                }
                if self.options.shows {
                    self.ask("window/showDocument", json!({ "uri": uri, "takeFocus": false }));
                }
            }
        }
        self.respond(response);
    }

    fn execute(&mut self, id: &RequestId, params: &Value) -> Result<(), lsp_server::ResponseError> {
        let command = params["command"].as_str().unwrap_or("");
        let given = params["arguments"].as_array().cloned().unwrap_or_default();
        let asked = asked(command, &given)?;
        self.numbers += 1;
        let token = match params["workDoneToken"].as_str() {
            Some(token) => token.to_owned(),
            None => format!("shadercheck-run-{}", self.numbers),
        };
        let events = self.events.clone();
        let title = format!("shadercheck {}", asked.title);
        let running = start((id.clone(), self.revision), asked, token.clone(), move |finished| {
            drop(events.send(Event::Finished(finished)));
        })?;
        self.running.insert(token.clone(), running);
        if self.options.progress && params["workDoneToken"].is_null() {
            self.ask("window/workDoneProgress/create", json!({ "token": token }));
        }
        self.progress(&token, json!({ "kind": "begin", "title": title, "cancellable": true }));
        Ok(())
    }

    fn progress(&self, token: &str, value: Value) {
        if self.options.progress {
            self.notify("$/progress", json!({ "token": token, "value": value }));
        }
    }
}

fn folder(uri: &str) -> Option<PathBuf> {
    let uri: Uri = uri.parse().ok()?;
    path_of(&uri).map(|path| PathBuf::from(name_of(path.trim_end_matches('/').as_ref())))
}

/// True when a file that is read is among those that changed: builds write many others.
fn concerns_us(params: &Value) -> bool {
    let uris = params["changes"].as_array().into_iter().flatten().filter_map(|c| c["uri"].as_str());
    let path = |uri: &str| path_of(&uri.parse().ok()?);
    uris.filter_map(path).any(|p| has_known_ending(p.as_ref()) || p.ends_with(FILE_NAME) || p.ends_with("ignore"))
}

/// A text after a change: of a range, or as a whole.
fn changed(file: &SourceFile, change: &Value, encoding: Encoding) -> SourceFile {
    let new = change["text"].as_str().unwrap_or("");
    let range = serde_json::from_value::<ls_types::Range>(change["range"].clone());
    let text = match range {
        Ok(range) => {
            let span = encoding.span(file, range);
            let mut text = file.text().to_owned();
            text.replace_range(span.range(), new);
            text
        }
        Err(_) => new.to_owned(),
    };
    SourceFile::new(file.name(), text)
}
