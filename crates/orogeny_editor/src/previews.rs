//! A file of heights before it is imported: read by a thread of its own, the last one that was asked for.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Builder;

use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use orogeny_engine::{ImportOptions, ImportPreview, Observer, Progress};

use crate::editor::Wake;

/// Pixels each way at most.
const MAX_SIDE_PX: u32 = 256;

/// A file and how it is to be read.
type Wanted = (PathBuf, ImportOptions);

/// What is known of a file.
#[derive(Clone)]
pub enum Previewed {
    /// It is being read.
    Waiting,
    /// It cannot be read so.
    Wrong(String),
    /// Here it is, with its picture.
    Read(Arc<ImportPreview>, TextureHandle),
}

/// The preview of the file that was asked for last.
pub struct Previews {
    wanted: Option<Wanted>,
    shown: Previewed,
    /// Which one is wanted now: reading any other is given up.
    number: Arc<AtomicU64>,
    asked: Sender<(u64, Wanted)>,
    read: Receiver<(u64, Result<ImportPreview, String>)>,
}

impl std::fmt::Debug for Previews {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Previews").field("wanted", &self.wanted).finish_non_exhaustive()
    }
}

/// Gives up what is no longer wanted.
struct WhileWanted<'a> {
    number: u64,
    wanted: &'a AtomicU64,
}

impl Observer for WhileWanted<'_> {
    fn progress(&mut self, _progress: Progress) -> ControlFlow<()> {
        let is_wanted = self.wanted.load(Ordering::Relaxed) == self.number;
        if is_wanted { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}

impl Previews {
    /// None yet. `wake` is called when one is there.
    pub fn new(wake: Wake) -> Self {
        let (asked, to_read) = channel();
        let (sender, read) = channel();
        let number = Arc::new(AtomicU64::new(0));
        let wanted = Arc::clone(&number);
        // Without the thread nothing is shown before it is imported, and nothing else is missing.
        Builder::new()
            .name("orogeny.previews".to_owned())
            .spawn(move || read_all(&to_read, &sender, &wanted, &*wake))
            .ok();
        Self { wanted: None, shown: Previewed::Waiting, number, asked, read }
    }

    /// What is known of a file, as it would be read.
    pub fn of(&mut self, ctx: &Context, path: &Path, options: &ImportOptions) -> Previewed {
        let is_wanted = self.wanted.as_ref().is_some_and(|(file, known)| file == path && known == options);
        if !is_wanted {
            let wanted = (path.to_owned(), options.clone());
            let number = self.number.fetch_add(1, Ordering::Relaxed) + 1;
            self.shown = match self.asked.send((number, wanted.clone())) {
                Ok(()) => Previewed::Waiting,
                Err(_) => Previewed::Wrong("it is not shown before it is imported".to_owned()),
            };
            self.wanted = Some(wanted);
        }
        self.take_read(ctx);
        self.shown.clone()
    }

    /// Nothing is wanted: the dialog is closed. What is read the next time may have changed.
    pub fn forget(&mut self) {
        if self.wanted.take().is_some() {
            self.number.fetch_add(1, Ordering::Relaxed);
            self.shown = Previewed::Waiting;
        }
    }

    /// Whether one is to come.
    #[must_use]
    pub const fn is_waiting(&self) -> bool {
        self.wanted.is_some() && matches!(self.shown, Previewed::Waiting)
    }

    fn take_read(&mut self, ctx: &Context) {
        for (number, read) in self.read.try_iter() {
            if number != self.number.load(Ordering::Relaxed) {
                continue;
            }
            self.shown = match read {
                Ok(preview) => {
                    let picture = &preview.picture;
                    let size = [picture.width_px as usize, picture.height_px as usize];
                    let image = ColorImage::from_rgb(size, &picture.rgb);
                    let texture = ctx.load_texture("preview", image, TextureOptions::LINEAR);
                    Previewed::Read(Arc::new(preview), texture)
                }
                Err(wrong) => Previewed::Wrong(wrong),
            };
        }
    }
}

/// Reads what is asked for until no one can ask any more.
fn read_all(
    asked: &Receiver<(u64, Wanted)>,
    read: &Sender<(u64, Result<ImportPreview, String>)>,
    wanted: &AtomicU64,
    wake: &dyn Fn(),
) {
    while let Ok((number, (path, options))) = asked.recv() {
        let mut observer = WhileWanted { number, wanted };
        let preview = ImportPreview::read(&path, &options, MAX_SIDE_PX, &mut observer);
        if read.send((number, preview.map_err(|err| err.to_string()))).is_err() {
            break;
        }
        wake();
    }
}
