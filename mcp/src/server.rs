//! The server: its tools, each a thin door to what the other files do.

use crate::confine::Outside;
use crate::evaluation::{self, Evaluate, ReadResults};
use crate::project::{Draft, Failure, Project, SUITE};
use crate::queue::Queue;
use crate::transport::{Closing, Conversation};
use crate::weights::{self, Apply, Propose};
use crate::{ServeError, resources, session};
use msk_compiler::diagnostics::Report;
use msk_compiler::difference::Difference;
use msk_compiler::explain;
use msk_compiler::task::CompiledTask;
use rmcp::handler::server::router::tool::ToolRouter;
use rmcp::handler::server::wrapper::Parameters;
use rmcp::model::{
    CallToolResult, ContentBlock, Implementation, ListResourcesResult, PaginatedRequestParams, ReadResourceRequestParams,
    ReadResourceResponse, ReadResourceResult, ResourceContents, ServerCapabilities, ServerConfig,
};
use rmcp::service::{RequestContext, ServerInitializeError};
use rmcp::{ErrorData, RoleServer, ServerHandler, ServiceExt, tool, tool_handler, tool_router};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::{Value, json};
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;
use tokio::io::{AsyncRead, AsyncWrite};

/// Evaluations that may wait while one runs on each core.
pub const WAITING_EVALUATIONS: usize = 16;
/// Other calls that may wait while one runs on each core.
const WAITING_CALLS: usize = 64;

const INSTRUCTIONS: &str = "MSK tasks describe motor control as text: rewards are sums of weight times term. Begin with list_tasks and list_terms. Edits of weights are data: propose_weights shows what the rules for changes allow, apply_weights writes it (dry run unless dry_run is false). Paths are relative to the project and must stay in it. The resource msk://reference is the language.";

/// The server of one project.
#[derive(Clone)]
pub struct Server {
    project: Arc<Project>,
    evaluations: Queue,
    calls: Queue,
    closing: Closing,
    tool_router: ToolRouter<Self>,
}

/// Cancels waiting and running work.
struct Cancellation {
    request: RequestContext<RoleServer>,
    /// What ends by itself is still answered when the input has ended; what may take minutes is not.
    closing: Option<Closing>,
}

impl Cancellation {
    fn is_set(&self) -> bool {
        self.request.ct.is_cancelled() || self.closing.as_ref().is_some_and(Closing::is_set)
    }

    async fn wait(&self) {
        match &self.closing {
            Some(closing) => tokio::select! {
                () = self.request.ct.cancelled() => {}
                () = closing.wait() => {}
            },
            None => self.request.ct.cancelled().await,
        }
    }
}

/// A file of tasks.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct File {
    /// File with tasks, relative to the project; tasks.msk if it is left out.
    pub file: Option<String>,
}

/// A task.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Task {
    /// Name of the task.
    pub task: String,
    /// File with the task, relative to the project; tasks.msk if it is left out.
    pub file: Option<String>,
    /// Weights file to lay over it.
    pub overlay: Option<String>,
}

/// What `check` is asked: a text, or a file.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Check {
    /// The text of a task file, which is not written anywhere.
    pub text: Option<String>,
    /// A file of the project instead; with a text, the name under which the text is checked, so that it can use its neighbours.
    pub file: Option<String>,
}

/// What `diff` is asked.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Diff {
    /// Name of the task.
    pub task: String,
    /// File with the one version, relative to the project; tasks.msk if it is left out.
    pub file: Option<String>,
    /// Weights file over the one version.
    pub overlay: Option<String>,
    /// Name of the task in the other version, if it is another.
    pub other_task: Option<String>,
    /// File with the other version; the same if it is left out.
    pub other_file: Option<String>,
    /// Weights file over the other version.
    pub other_overlay: Option<String>,
}

#[tool_router(router = tool_router)]
impl Server {
    /// The server of the project in `root`.
    ///
    /// # Errors
    /// A folder that cannot be used.
    pub fn new(root: &Path) -> Result<Self, Outside> {
        let project = Project::new(root)?;
        let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
        Ok(Self {
            project: Arc::new(project),
            evaluations: Queue::new(cores, WAITING_EVALUATIONS),
            calls: Queue::new(cores, WAITING_CALLS),
            closing: Closing::default(),
            tool_router: Self::tool_router(),
        })
    }

    /// Serves a client until its input ends, which cancels all that still runs.
    ///
    /// # Errors
    /// A client that does not speak the protocol.
    pub async fn converse<R, W>(self, input: R, output: W) -> Result<(), ServeError>
    where
        R: AsyncRead + Send + Unpin + 'static,
        W: AsyncWrite + Send + Unpin + 'static,
    {
        let conversation = Conversation::over(input, output, self.closing.clone());
        let running = match self.serve(conversation).await {
            Ok(running) => running,
            // There is no request.
            Err(ServerInitializeError::ConnectionClosed(_)) => return Ok(()),
            Err(error) => return Err(ServeError::Client(error.to_string())),
        };
        running.waiting().await.map_err(|error| ServeError::Client(error.to_string()))?;
        Ok(())
    }

    /// Does short work in its turn, where it does not block other requests.
    async fn answer(
        &self,
        request: RequestContext<RoleServer>,
        work: impl FnOnce(&Project) -> Result<Value, Failure> + Send + 'static,
    ) -> CallToolResult {
        self.in_turn(&self.calls, Cancellation { request, closing: None }, move |project, _| work(project)).await
    }

    /// Does `work` in its turn in `queue`. The work can query whether the request has been cancelled.
    async fn in_turn(
        &self,
        queue: &Queue,
        cancellation: Cancellation,
        work: impl FnOnce(&Project, &dyn Fn() -> bool) -> Result<Value, Failure> + Send + 'static,
    ) -> CallToolResult {
        let turn = tokio::select! {
            turn = queue.turn() => turn,
            () = cancellation.wait() => return CallToolResult::structured_error(json!({ "error": "cancelled before it started" })),
        };
        let turn = match turn {
            Ok(turn) => turn,
            Err(busy) => return CallToolResult::structured_error(json!({ "error": busy.to_string(), "busy": true })),
        };
        let project = self.project.clone();
        let work = move || {
            // Held until the work has really ended.
            let _turn = turn;
            work(&project, &|| cancellation.is_set())
        };
        match tokio::task::spawn_blocking(work).await {
            Ok(Ok(value)) => CallToolResult::structured(value),
            Ok(Err(Failure(failure))) => CallToolResult::structured_error(failure),
            Err(error) => CallToolResult::error(vec![ContentBlock::text(format!("the tool failed: {error}"))]),
        }
    }

    /// Lists tasks.
    #[tool(description = "List the tasks of a file or suite", annotations(read_only_hint = true))]
    pub async fn list_tasks(&self, Parameters(asked): Parameters<File>, request: RequestContext<RoleServer>) -> CallToolResult {
        self.answer(request, move |project| {
            let compilation = project.compile(asked.file.as_deref().unwrap_or(SUITE))?;
            let row = |task: &Arc<CompiledTask>| {
                json!({
                    "task": task.name, "family": task.family, "summary": task.summary, "horizon_steps": task.horizon,
                    "terms": task.terms.len(), "hash": task.hash,
                })
            };
            Ok(json!({ "tasks": compilation.tasks.iter().map(row).collect::<Vec<_>>() }))
        })
        .await
    }

    /// Lists terms.
    #[tool(
        description = "List the reward terms of a task: weight and its origin, bounds, the term's range and formula",
        annotations(read_only_hint = true)
    )]
    pub async fn list_terms(&self, Parameters(asked): Parameters<Task>, request: RequestContext<RoleServer>) -> CallToolResult {
        self.answer(request, move |project| {
            let task = project.task(asked.file.as_deref(), &asked.task, asked.overlay.as_deref())?;
            let terms: Vec<Value> = (0..task.terms.len()).map(|index| weights::term(&task, index)).collect();
            Ok(json!({ "task": task.name, "terms": terms }))
        })
        .await
    }

    /// Explains a task.
    #[tool(
        description = "Explain a task: formulas, weights, ranges, values at reset, inputs of each term, terminations, observation",
        annotations(read_only_hint = true)
    )]
    pub async fn explain(&self, Parameters(asked): Parameters<Task>, request: RequestContext<RoleServer>) -> CallToolResult {
        self.answer(request, move |project| {
            let task = project.task(asked.file.as_deref(), &asked.task, asked.overlay.as_deref())?;
            let episode = project.trial(task.clone())?.episode()?;
            Ok(json!({ "text": explain::text(&task, &explain::Options { reset: Some(episode.frame()) }) }))
        })
        .await
    }

    /// Checks a text.
    #[tool(
        description = "Check the text of a task file, or a file: errors and warnings with positions, what was expected and found, fixes",
        annotations(read_only_hint = true)
    )]
    pub async fn check(&self, Parameters(asked): Parameters<Check>, request: RequestContext<RoleServer>) -> CallToolResult {
        self.answer(request, move |project| {
            let file = asked.file.as_deref().unwrap_or("draft.msk");
            let compiled = match &asked.text {
                Some(text) => project.compile_with(file, &Draft { name: file, text, confined: &project.confined }),
                None => project.compile(asked.file.as_deref().unwrap_or(SUITE)),
            };
            Ok(match compiled {
                Ok(compilation) => {
                    let report = Report::new(compilation.sources.clone(), compilation.warnings.clone());
                    let tasks: Vec<&str> = compilation.tasks.iter().map(|task| task.name.as_str()).collect();
                    json!({ "ok": true, "tasks": tasks, "diagnostics": report.to_json()["diagnostics"], "rendered": report.to_string() })
                }
                Err(Failure(failure)) if failure["diagnostics"].is_array() => {
                    json!({ "ok": false, "diagnostics": failure["diagnostics"], "rendered": failure["rendered"] })
                }
                Err(failure) => return Err(failure),
            })
        })
        .await
    }

    /// Proposes weights.
    #[tool(
        description = "Project proposed weights onto the rules for changes: within a step of 20 %, the bounds of the source, signs and zeros kept, and a norm if one is given. Writes nothing",
        annotations(read_only_hint = true)
    )]
    pub async fn propose_weights(
        &self,
        Parameters(asked): Parameters<Propose>,
        request: RequestContext<RoleServer>,
    ) -> CallToolResult {
        self.answer(request, move |project| weights::propose(project, &asked)).await
    }

    /// Applies weights.
    #[tool(
        description = "Write weights within the bounds of the source: into the source, where only digits change, or into a weights \
                       file over it. A dry run unless dry_run is false",
        annotations(read_only_hint = false, destructive_hint = false, idempotent_hint = true)
    )]
    pub async fn apply_weights(
        &self,
        Parameters(asked): Parameters<Apply>,
        request: RequestContext<RoleServer>,
    ) -> CallToolResult {
        self.answer(request, move |project| weights::apply(project, &asked)).await
    }

    /// Runs episodes.
    #[tool(
        description = "Run a few episodes of a task under a built-in policy within a budget of steps and seconds, and summarise them. One runs on each core, a few are queued; further calls are answered with `busy: true`",
        annotations(read_only_hint = true)
    )]
    pub async fn evaluate(&self, Parameters(asked): Parameters<Evaluate>, request: RequestContext<RoleServer>) -> CallToolResult {
        let cancellation = Cancellation { request, closing: Some(self.closing.clone()) };
        self.in_turn(&self.evaluations, cancellation, move |project, cancelled| evaluation::evaluate(project, &asked, cancelled))
            .await
    }

    /// Compares two versions.
    #[tool(
        description = "The differences between two versions of a task: terms, weights, formulas, terminations, horizon; in another file, or under another weights file",
        annotations(read_only_hint = true)
    )]
    pub async fn diff(&self, Parameters(asked): Parameters<Diff>, request: RequestContext<RoleServer>) -> CallToolResult {
        self.answer(request, move |project| {
            let one = project.task(asked.file.as_deref(), &asked.task, asked.overlay.as_deref())?;
            let file = asked.other_file.as_deref().or(asked.file.as_deref());
            let other = project.task(file, asked.other_task.as_deref().unwrap_or(&asked.task), asked.other_overlay.as_deref())?;
            let named = asked.other_task.is_none();
            let difference =
                Difference::between(&one.snapshot(), &other.snapshot(), named).with_names(&one, &other).with_units(&other);
            Ok(json!({ "same": difference.is_empty(), "changes": difference.changes, "text": difference.to_string() }))
        })
        .await
    }

    /// Begins a session.
    #[tool(
        description = "Begin to control a body directly: an episode that waits for each of your actions. Writes a new session to a folder of the project and gives what is visible before the first decision: channels of the observation with units, names of the entries of an action, how long it is held",
        annotations(read_only_hint = false, destructive_hint = false)
    )]
    pub async fn session_init(
        &self,
        Parameters(asked): Parameters<session::Init>,
        request: RequestContext<RoleServer>,
    ) -> CallToolResult {
        let cancellation = Cancellation { request, closing: None };
        self.in_turn(&self.evaluations, cancellation, move |project, _| session::init(project, &asked)).await
    }

    /// Takes a decision.
    #[tool(
        description = "Give the next action of a session: a list with one number from -1 to 1 per entry, held until the next decision. Anything else is rejected with the first wrong entry and changes nothing. Gives what is visible before the next decision, or why the session has stopped",
        annotations(read_only_hint = false, destructive_hint = false)
    )]
    pub async fn session_submit(
        &self,
        Parameters(asked): Parameters<session::Submit>,
        request: RequestContext<RoleServer>,
    ) -> CallToolResult {
        let cancellation = Cancellation { request, closing: None };
        self.in_turn(&self.evaluations, cancellation, move |project, _| session::submit(project, &asked)).await
    }

    /// Tells how far a session is.
    #[tool(
        description = "How far a session is, and what is visible before its next decision; once it has stopped, how closely it followed the reference motion",
        annotations(read_only_hint = true)
    )]
    pub async fn session_status(
        &self,
        Parameters(asked): Parameters<session::Status>,
        request: RequestContext<RoleServer>,
    ) -> CallToolResult {
        self.answer(request, move |project| session::status(project, &asked)).await
    }

    /// Reads results.
    #[tool(
        description = "List folders of results, or read a file of one: summary, report, journal, rounds of a tuning session",
        annotations(read_only_hint = true)
    )]
    pub async fn read_results(
        &self,
        Parameters(asked): Parameters<ReadResults>,
        request: RequestContext<RoleServer>,
    ) -> CallToolResult {
        self.answer(request, move |project| evaluation::read_results(project, &asked)).await
    }
}

#[tool_handler(router = self.tool_router)]
impl ServerHandler for Server {
    fn get_info(&self) -> ServerConfig {
        let capabilities = ServerCapabilities::builder().enable_tools().enable_resources().build();
        ServerConfig::new(capabilities)
            .with_server_info(Implementation::new("msk", env!("CARGO_PKG_VERSION")))
            .with_instructions(INSTRUCTIONS)
    }

    async fn list_resources(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> Result<ListResourcesResult, ErrorData> {
        Ok(ListResourcesResult::with_all_items(resources::list()))
    }

    async fn read_resource(
        &self,
        request: ReadResourceRequestParams,
        _: RequestContext<RoleServer>,
    ) -> Result<ReadResourceResponse, ErrorData> {
        let (project, uri) = (self.project.clone(), request.uri.clone());
        let turn = self.calls.turn().await.map_err(|busy| ErrorData::internal_error(busy.to_string(), None))?;
        let work = move || {
            let _turn = turn;
            resources::read(&project, &uri)
        };
        match tokio::task::spawn_blocking(work).await {
            Ok(Ok(Some((text, kind)))) => {
                let contents = ResourceContents::text(text, request.uri).with_mime_type(kind);
                Ok(ReadResourceResult::new(vec![contents]).into())
            }
            Ok(Ok(None)) => Err(ErrorData::resource_not_found(format!("there is no resource `{}`", request.uri), None)),
            Ok(Err(Failure(failure))) => Err(ErrorData::internal_error(failure.to_string(), None)),
            Err(error) => Err(ErrorData::internal_error(error.to_string(), None)),
        }
    }
}
