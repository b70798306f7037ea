//! Saving the land and the last minute of contacts, beside the table's own work.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use super::table::Table;
use crate::export::OutDir;
use crate::live::Session;
use crate::settings::Settings;
use crate::sim::Checkpoint;

/// Writes a land into a folder of its own: as it is, or at final quality, which is long work. The command line has one:
/// what `replay` writes.
pub type SaveLand = Arc<dyn Fn(&SavedLand, &Path, Option<&LongWork>) -> Result<(), String> + Send + Sync>;

/// Work that takes a minute or two: somebody watches it, and may stop it.
#[derive(Debug, Default)]
pub struct LongWork {
    per_mille: AtomicU32,
    cancelled: AtomicBool,
}

impl LongWork {
    /// Says how much is done, 0–1. False when the work is to stop and leave nothing behind.
    pub fn goes_on(&self, done: f64) -> bool {
        self.per_mille.store((done * 1000.0) as u32, Ordering::Relaxed);
        !self.is_cancelled()
    }

    /// Whether somebody has asked it to stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// How much is done, 0–1.
    pub fn done(&self) -> f32 {
        self.per_mille.load(Ordering::Relaxed) as f32 / 1000.0
    }

    /// Asks the work to stop.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }
}

/// A session as it was when somebody asked for its land.
pub type SavedLand = Checkpoint;

/// Where lands and contacts are saved, below the folder the program was started in.
const FOLDER: &str = "orogen-out";
/// Most numbers tried for the name of a new folder or file.
const MOST_SAVED: u32 = 9999;
/// How long word of a save is shown, µs.
const NEWS_US: u64 = 6_000_000;

/// What is on its way.
enum Waiting {
    Land(Receiver<SavedLand>),
    Contacts(Receiver<Vec<u8>>),
    Written(Receiver<Result<PathBuf, String>>),
}

/// Saves, one thing after the other.
pub(super) struct Saver {
    save: SaveLand,
    waiting: Option<Waiting>,
    /// The final land that is on its way.
    long: Option<Arc<LongWork>>,
    notice: Option<(String, u64)>,
    now_us: u64,
}

impl Saver {
    pub(super) fn new(save: SaveLand) -> Self {
        Self {
            save,
            waiting: None,
            long: None,
            notice: None,
            now_us: 0,
        }
    }

    /// Asks for the land as it is. What is being saved is finished first.
    pub(super) fn ask(&mut self, session: &Session) {
        if self.waiting.is_none() {
            self.waiting = Some(Waiting::Land(session.save_world()));
        }
    }

    /// Asks for the final land. What is being saved is finished first.
    pub(super) fn ask_final(&mut self, session: &Session) {
        if self.waiting.is_none() {
            self.long = Some(Arc::default());
            self.ask(session);
        } else {
            self.say("another save is on its way");
        }
    }

    /// How much of a final land is done, 0–1; none while there is none.
    pub(super) fn final_done(&self) -> Option<f32> {
        self.long.as_ref().map(|work| work.done())
    }

    /// Nobody wants the final land any more.
    pub(super) fn cancel_final(&self) {
        if let Some(work) = &self.long {
            work.cancel();
        }
    }

    /// Takes the last minute of contacts, once it comes.
    pub(super) fn take_contacts(&mut self, bytes: Receiver<Vec<u8>>) {
        if self.waiting.is_none() {
            self.waiting = Some(Waiting::Contacts(bytes));
        }
    }

    /// Writes the settings into their file. Small enough not to keep anybody waiting.
    pub(super) fn settings(&mut self, settings: &Settings, path: Option<&Path>) {
        let done = match path {
            Some(path) => write_whole(path, settings.to_toml().as_bytes())
                .map(|()| path.to_owned())
                .map_err(|error| error.to_string()),
            None => {
                Err("the program was started without --settings FILE; they hold until it ends".to_owned())
            }
        };
        self.tell(done);
    }

    /// Word of something else than a save.
    pub(super) fn say(&mut self, text: &str) {
        self.notice = Some((text.to_owned(), self.now_us + NEWS_US));
    }

    /// Word of the last save, while it is news.
    pub(super) fn notice(&self) -> Option<&str> {
        let (text, until_us) = self.notice.as_ref()?;
        (self.now_us < *until_us).then_some(text)
    }

    /// Passes on what has arrived. Never waits.
    pub(super) fn step(&mut self, now_us: u64) {
        self.now_us = now_us;
        let next = match self.waiting.take() {
            None => None,
            Some(Waiting::Land(land)) => match land.try_recv() {
                Ok(land) => {
                    let (save, long) = (Arc::clone(&self.save), self.long.clone());
                    let name = if long.is_some() { "final-" } else { "table-" };
                    self.write(move || {
                        let path = free_name(name, "")?;
                        save(&land, &path, long.as_deref())?;
                        Ok(path)
                    })
                }
                Err(TryRecvError::Empty) => Some(Waiting::Land(land)),
                Err(TryRecvError::Disconnected) => None,
            },
            Some(Waiting::Contacts(bytes)) => match bytes.try_recv() {
                Ok(bytes) => self.write(move || {
                    let path = free_name("contacts-", ".gesture.jsonl")?;
                    write_whole(&path, &bytes).map_err(|error| error.to_string())?;
                    Ok(path)
                }),
                Err(TryRecvError::Empty) => Some(Waiting::Contacts(bytes)),
                Err(TryRecvError::Disconnected) => None,
            },
            Some(Waiting::Written(done)) => match done.try_recv() {
                Ok(Err(_)) if self.long.as_ref().is_some_and(|work| work.is_cancelled()) => {
                    tracing::info!("a final land was given up");
                    self.say("final land: given up");
                    None
                }
                Ok(done) => {
                    self.tell(done);
                    None
                }
                Err(TryRecvError::Empty) => Some(Waiting::Written(done)),
                Err(TryRecvError::Disconnected) => {
                    self.tell(Err("the writer stopped".to_owned()));
                    None
                }
            },
        };
        self.waiting = next;
        if self.waiting.is_none() {
            self.long = None;
        } else if let Some(work) = &self.long {
            self.say(&format!("final land: {:.0} %", 100.0 * work.done()));
        }
    }

    fn write(&mut self, work: impl FnOnce() -> Result<PathBuf, String> + Send + 'static) -> Option<Waiting> {
        let (done, written) = channel();
        let started = thread::Builder::new()
            .name("orogen-save".to_owned())
            .spawn(move || {
                // A table that was closed meanwhile wants no answer.
                let _ = done.send(work());
            });
        match started {
            Ok(_) => Some(Waiting::Written(written)),
            Err(error) => {
                self.tell(Err(error.to_string()));
                None
            }
        }
    }

    fn tell(&mut self, done: Result<PathBuf, String>) {
        let text = match done {
            Ok(path) => {
                tracing::info!("saved {}", path.display());
                path.display().to_string()
            }
            Err(why) => {
                tracing::error!("not saved: {why}");
                format!("not saved: {why}")
            }
        };
        self.notice = Some((text, self.now_us + NEWS_US));
    }
}

/// What staff save of the table.
impl Table {
    /// The land is to be saved.
    pub(super) fn save(&mut self) {
        self.saver.ask(self.worlds.session());
    }

    /// The land is to be saved at final quality.
    pub(super) fn save_final(&mut self) {
        self.saver.ask_final(self.worlds.session());
    }

    /// How much of a final land is done, 0–1.
    pub(super) fn final_done(&self) -> Option<f32> {
        self.saver.final_done()
    }

    /// Nobody wants the final land any more.
    pub(super) fn cancel_final(&self) {
        self.saver.cancel_final();
    }

    /// The last minute of contacts is to be saved.
    pub(super) fn save_contacts(&mut self) {
        self.saver.take_contacts(self.worlds.ring_file());
    }

    /// Writes the settings, if there is a file for them.
    pub(super) fn save_settings(&mut self, settings: &Settings, path: Option<&Path>) {
        self.saver.settings(settings, path);
    }
}

/// The first name with a number that nothing has yet.
fn free_name(start: &str, end: &str) -> Result<PathBuf, String> {
    (1..=MOST_SAVED)
        .map(|number| Path::new(FOLDER).join(format!("{start}{number:03}{end}")))
        .find(|path| !path.exists())
        .ok_or_else(|| format!("{FOLDER} is full"))
}

/// Writes a file whole or not at all.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    use std::io::{Error, Write as _};
    let name = path
        .file_name()
        .ok_or_else(|| Error::other("expected a file name"))?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let out = OutDir::create(folder.unwrap_or(Path::new("."))).map_err(Error::other)?;
    out.write(&name.to_string_lossy(), |file| file.write_all(bytes))
        .map(drop)
        .map_err(Error::other)
}
