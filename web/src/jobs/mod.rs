//! Jobs: commands of the program that run in processes of their own, one after the other, and go on when the page is closed.
//!
//! Each job has a folder with its inputs, its results and `job.json`. A server that starts again continues the jobs of its port: it
//! runs the same command in the same folder, where commands with a journal go on from it, and others begin again. The process of a job
//! holds a lock of the folder, and ends when its standard input does, which is when the server has ended, however it did.

mod command;
mod folder;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use papilio_formats::DataFile;
use papilio_scenario::MemoryFile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub(crate) use self::command::{COMMANDS, JobCommand};
pub(crate) use self::folder::JobFile;
use crate::fault::Fault;

/// Environment variable of the process of a job: the file that it locks. Such a process ends when its standard input does.
pub const LOCK_VARIABLE: &str = "PAPILIO_JOB_LOCK";

/// Environment variable: seconds between two lines of progress.
const PROGRESS_VARIABLE: &str = "PAPILIO_PROGRESS_SECONDS";

/// Maximum number of jobs that are stored.
const MOST_JOBS: usize = 50;

/// Maximum size of the results of a job, in bytes.
const MOST_BYTES: u64 = 4 << 30;

/// Time after which a process that was asked to end is killed.
const GRACE: Duration = Duration::from_secs(10);

/// Time between two looks at the process, and between two looks at the size of its results.
const LOOK: Duration = Duration::from_millis(100);
const LOOK_AT_SIZE: Duration = Duration::from_secs(3);

/// Maximum length of what a job has printed, in bytes.
const LONGEST_TEXT: usize = 64 << 10;

const REPORT: &str = "report.txt";
const MESSAGES: &str = "messages.txt";
const LOCK: &str = "lock";
const JOB: &str = "job.json";

/// How a server runs jobs.
#[derive(Debug, Clone)]
pub struct JobOptions {
    /// The program `papilio`.
    pub program: PathBuf,
    /// The folder of all jobs; those of each port have a folder in it.
    pub folder: PathBuf,
}

/// Where a job is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum JobPhase {
    /// Another one is running.
    Waiting,
    Running,
    Done,
    /// The user has cancelled it; results so far may be there.
    Cancelled,
    Failed,
}

/// A job.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub(crate) struct Job {
    /// Its name in requests.
    id: String,
    /// The command that it runs, as on the command line.
    line: String,
    /// The words of the command: `diffuser fit`.
    command: String,
    /// The title of the design.
    title: String,
    phase: JobPhase,
    /// When it was started, ms since 1970.
    started_ms: u64,
    /// Time for which it has run, s.
    seconds: f64,
    /// Why it has failed, or "".
    message: String,
    /// The arguments of the program.
    arguments: Vec<String>,
    /// Whether the user has cancelled it.
    #[serde(skip)]
    is_cancelled: bool,
    /// When its process was started.
    #[serde(skip)]
    since: Option<Instant>,
}

/// A job as it is listed.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct JobSeen {
    #[serde(flatten)]
    job: Job,
    /// What it does now: "34 % done, relative error 0.2 %".
    progress: String,
    /// What it has printed: its report, then its notes and warnings.
    report: String,
    notes: String,
    /// The files that it has written.
    files: Vec<JobFile>,
}

/// What is to be run.
#[derive(Debug)]
pub(crate) struct Wanted<'a> {
    pub(crate) command: &'a str,
    pub(crate) options: &'a BTreeMap<String, String>,
    pub(crate) scenario: &'a str,
    /// The name of the scenario's file.
    pub(crate) name: &'a str,
    pub(crate) title: &'a str,
    pub(crate) inputs: &'a [String],
    pub(crate) files: &'a BTreeMap<String, MemoryFile>,
}

/// The jobs of a server.
#[derive(Debug)]
pub(crate) struct Jobs {
    program: PathBuf,
    folder: PathBuf,
    all: Mutex<Vec<Job>>,
    changed: Condvar,
}

impl Jobs {
    /// Reads the jobs of a folder, and continues those that had not ended.
    pub(crate) fn open(options: JobOptions, port: u16) -> Arc<Self> {
        let folder = options.folder.join(port.to_string());
        let mut all: Vec<Job> = fs::read_dir(&folder)
            .into_iter()
            .flatten()
            .flatten()
            .filter_map(|entry| serde_json::from_slice(&fs::read(entry.path().join(JOB)).ok()?).ok())
            .collect();
        all.sort_by_key(|job| job.started_ms);
        for job in &mut all {
            if job.phase == JobPhase::Running {
                job.phase = JobPhase::Waiting;
            }
        }
        let jobs = Arc::new(Self {
            program: options.program,
            folder,
            all: Mutex::new(all),
            changed: Condvar::new(),
        });
        let runner = jobs.clone();
        std::thread::spawn(move || runner.run_all());
        jobs
    }

    fn all(&self) -> MutexGuard<'_, Vec<Job>> {
        self.all.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn folder_of(&self, id: &str) -> PathBuf {
        self.folder.join(id)
    }

    /// Returns all jobs, the newest first.
    pub(crate) fn list(&self) -> Vec<JobSeen> {
        let jobs = self.all().clone();
        jobs.into_iter().rev().map(|job| self.seen(job)).collect()
    }

    fn seen(&self, mut job: Job) -> JobSeen {
        let folder = self.folder_of(&job.id);
        let text = |name: &str| folder::tail(&folder.join(name), LONGEST_TEXT);
        let messages = text(MESSAGES);
        // Where the results are is known from their list.
        let lines = messages.lines().filter(|line| !line.starts_with("wrote "));
        let (progress, notes): (Vec<&str>, Vec<&str>) = lines.partition(|line| is_progress(line));
        let progress =
            if job.phase == JobPhase::Running { progress.last().map_or("", |line| *line) } else { "" };
        if let Some(since) = job.since.filter(|_| job.phase == JobPhase::Running) {
            job.seconds += since.elapsed().as_secs_f64();
        }
        let has_ended = !matches!(job.phase, JobPhase::Waiting | JobPhase::Running);
        let files = if has_ended { folder::results(&folder) } else { Vec::new() };
        let report = if has_ended { text(REPORT) } else { String::new() };
        JobSeen { progress: progress.trim().to_owned(), report, notes: notes.join("\n"), files, job }
    }

    /// Stores a job, which runs as soon as those before it have ended.
    pub(crate) fn start(&self, wanted: &Wanted<'_>) -> Result<JobSeen, Fault> {
        let command = command::find(wanted.command)?;
        let is_safe = |name: &String| folder::is_inside(name) && wanted.files.contains_key(name);
        if let Some(input) = wanted.inputs.iter().find(|name| !is_safe(name)) {
            return Err(Fault::unknown("file", input));
        }
        if let Some(name) = wanted.files.keys().find(|name| !folder::is_inside(name)) {
            return Err(Fault::malformed(format!("a job cannot use a file with the name {name}")));
        }
        let file = format!("{}.toml", plain(wanted.name));
        let (shown, hidden) = command.arguments(&file, wanted.inputs, wanted.options)?;
        if self.all().len() >= MOST_JOBS {
            return Err(Fault::too_much(
                format!("there are {MOST_JOBS} jobs"),
                "remove some that have ended",
            ));
        }
        let started_ms = now_ms();
        let id = unused(&self.folder, started_ms);
        let folder = self.folder_of(&id);
        let scenario = command.has_scenario().then_some((file.as_str(), wanted.scenario));
        folder::write(&folder, scenario, wanted.files)?;
        let job = Job {
            id,
            line: format!("papilio {}", shown.join(" ")),
            command: wanted.command.to_owned(),
            title: wanted.title.chars().take(200).collect(),
            phase: JobPhase::Waiting,
            started_ms,
            seconds: 0.0,
            message: String::new(),
            arguments: [shown, hidden].concat(),
            is_cancelled: false,
            since: None,
        };
        self.store(&job)?;
        self.all().push(job.clone());
        self.changed.notify_all();
        Ok(self.seen(job))
    }

    /// Ends a job; the results so far stay.
    pub(crate) fn cancel(&self, id: &str) -> Result<(), Fault> {
        let job = self.change(id, |job| {
            job.is_cancelled = true;
            if job.phase == JobPhase::Waiting {
                job.phase = JobPhase::Cancelled;
            }
        })?;
        self.store(&job)
    }

    /// Removes a job that has ended, with its results.
    pub(crate) fn remove(&self, id: &str) -> Result<(), Fault> {
        let job = self.change(id, |_| ())?;
        if matches!(job.phase, JobPhase::Running | JobPhase::Waiting) {
            return Err(Fault::too_much("the job is running", "cancel it first"));
        }
        self.all().retain(|job| job.id != id);
        fs::remove_dir_all(self.folder_of(id))
            .map_err(|error| Fault::internal(&format!("the results cannot be removed: {error}")))
    }

    /// Reads a result of a job.
    pub(crate) fn file(&self, id: &str, name: &str) -> Result<DataFile, Fault> {
        let job = self.change(id, |_| ())?;
        folder::read(&self.folder_of(&job.id), name)
    }

    /// Changes a job and returns it.
    fn change(&self, id: &str, change: impl FnOnce(&mut Job)) -> Result<Job, Fault> {
        let mut all = self.all();
        let job = all.iter_mut().find(|job| job.id == id).ok_or_else(|| Fault::unknown("job", id))?;
        change(job);
        Ok(job.clone())
    }

    /// Writes `job.json`, which is whole at every moment.
    fn store(&self, job: &Job) -> Result<(), Fault> {
        let write = || -> io::Result<()> {
            let folder = self.folder_of(&job.id);
            let next = folder.join("job.json.new");
            fs::write(&next, serde_json::to_vec_pretty(job)?)?;
            fs::rename(next, folder.join(JOB))
        };
        write().map_err(|error| Fault::internal(&format!("the job cannot be stored: {error}")))
    }

    /// Runs the jobs in their order, without end.
    fn run_all(&self) {
        loop {
            let next = {
                let mut all = self.all();
                loop {
                    if let Some(job) = all.iter_mut().find(|job| job.phase == JobPhase::Waiting) {
                        job.phase = JobPhase::Running;
                        job.since = Some(Instant::now());
                        break job.clone();
                    }
                    all = self.changed.wait(all).unwrap_or_else(PoisonError::into_inner);
                }
            };
            // What cannot be stored is lost with the server only.
            let _ = self.store(&next);
            let ended = self.run(&next);
            let ended = self.change(&next.id, |job| {
                job.seconds = ended.seconds;
                (job.phase, job.message) = match ended.result {
                    _ if job.is_cancelled => (JobPhase::Cancelled, String::new()),
                    Ok(()) => (JobPhase::Done, String::new()),
                    Err(message) => (JobPhase::Failed, message),
                };
            });
            let _ = ended.and_then(|job| self.store(&job));
        }
    }

    fn run(&self, job: &Job) -> Ended {
        let begun = Instant::now();
        let result = self.process(job);
        Ended { seconds: job.seconds + begun.elapsed().as_secs_f64(), result }
    }

    fn process(&self, job: &Job) -> Result<(), String> {
        let folder = self.folder_of(&job.id);
        let mut child =
            self.spawn(&folder, job).map_err(|error| format!("the program cannot be started: {error}"))?;
        let mut input = child.stdin.take();
        let (mut asked, mut looked) = (None::<Instant>, Instant::now());
        let mut is_large = false;
        loop {
            match child.try_wait() {
                Ok(Some(status)) if status.success() => return Ok(()),
                Ok(Some(_)) if is_large => {
                    return Err(format!("the results are larger than {} GiB", MOST_BYTES >> 30));
                }
                Ok(Some(status)) => {
                    let text = folder::tail(&folder.join(MESSAGES), LONGEST_TEXT);
                    let errors: Vec<&str> =
                        text.lines().skip_while(|line| !line.starts_with("error")).collect();
                    return Err(if errors.is_empty() {
                        format!("the program ended: {status}")
                    } else {
                        errors.join("\n")
                    });
                }
                Ok(None) => {}
                Err(error) => return Err(error.to_string()),
            }
            if looked.elapsed() > LOOK_AT_SIZE {
                looked = Instant::now();
                is_large |= folder::size(&folder) > MOST_BYTES;
            }
            let is_cancelled = self.all().iter().any(|one| one.id == job.id && one.is_cancelled);
            if (is_cancelled || is_large) && asked.is_none() {
                // The end of its input asks it to end with what is finished.
                drop(input.take());
                asked = Some(Instant::now());
            }
            if asked.is_some_and(|since| since.elapsed() > GRACE) {
                let _ = child.kill();
            }
            std::thread::sleep(LOOK);
        }
    }

    fn spawn(&self, folder: &Path, job: &Job) -> io::Result<Child> {
        let lock = folder.join(LOCK);
        File::create(&lock)?;
        Command::new(&self.program)
            .args(&job.arguments)
            .current_dir(folder.join(folder::DESIGNS))
            .env(LOCK_VARIABLE, &lock)
            .env(PROGRESS_VARIABLE, "0.5")
            .env("NO_COLOR", "1")
            .stdin(Stdio::piped())
            .stdout(File::create(folder.join(REPORT))?)
            .stderr(File::create(folder.join(MESSAGES))?)
            .spawn()
    }
}

/// How a process has ended.
struct Ended {
    seconds: f64,
    result: Result<(), String>,
}

/// Whether a line is one of progress: "34 % done, …" or "12 of 40 points, …".
fn is_progress(line: &str) -> bool {
    let mut words = line.trim_start().split(' ');
    let is_number = |word: Option<&str>| word.is_some_and(|word| word.parse::<u64>().is_ok());
    is_number(words.next()) && matches!(words.next(), Some("%" | "of"))
}

/// A name of a file without what shells and file systems treat specially.
fn plain(name: &str) -> String {
    let plain: String = name
        .chars()
        .filter(|letter| letter.is_ascii_alphanumeric() || "-_".contains(*letter))
        .take(80)
        .collect();
    if plain.is_empty() || plain.starts_with('-') { "design".to_owned() } else { plain }
}

fn now_ms() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_millis() as u64)
}

/// Returns the name of a folder that does not exist.
fn unused(folder: &Path, at_ms: u64) -> String {
    (0_u64..).map(|k| format!("{:x}", at_ms + k)).find(|id| !folder.join(id).exists()).unwrap_or_default()
}
