//! Small pictures of brushes: each painted on a small terrain of its own, by a thread that does nothing else.

use std::collections::{HashMap, HashSet};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Builder;

use egui::{ColorImage, Context, TextureHandle, TextureOptions};
use orogeny_engine::{Picture, Preset};
use serde_json::{Map, Value};

use crate::editor::Wake;

/// Pixels along x.
const WIDTH_PX: u32 = 160;
/// Pictures that are kept at most.
const MAX_KEPT: usize = 200;

/// What came of a brush that was to be drawn.
enum Made {
    /// A later one was asked for before its turn came.
    Skipped,
    /// It lacks something, or makes nothing that could be drawn.
    Failed,
    Drawn(Picture),
}

/// What of brushes was drawn.
pub struct Thumbnails {
    /// By the brush object as text; `None`: it cannot be drawn.
    drawn: HashMap<String, Option<TextureHandle>>,
    /// What was asked for and is not there.
    awaited: HashSet<String>,
    /// The picture that was shown last, until the next one is there.
    last: Option<TextureHandle>,
    asked: Sender<(String, Map<String, Value>)>,
    made: Receiver<(String, Made)>,
}

impl std::fmt::Debug for Thumbnails {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Thumbnails").field("num_drawn", &self.drawn.len()).finish_non_exhaustive()
    }
}

impl Thumbnails {
    /// None yet. `wake` is called when there is one more.
    pub fn new(wake: Wake) -> Self {
        let (asked, to_draw) = channel();
        let (sender, made) = channel();
        // Without the thread there are no pictures, and nothing else is missing.
        Builder::new()
            .name("orogeny.thumbnails".to_owned())
            .spawn(move || draw_all(&to_draw, &sender, &*wake))
            .ok();
        Self { drawn: HashMap::new(), awaited: HashSet::new(), last: None, asked, made }
    }

    /// The picture of a brush; until it is drawn, the one before.
    pub fn of(&mut self, ctx: &Context, brush: &Map<String, Value>) -> Option<TextureHandle> {
        if let Some(texture) = self.known(ctx, brush) {
            self.last = texture;
        }
        self.last.clone()
    }

    /// The picture of a brush among many; `None` until it is drawn.
    pub fn of_list(&mut self, ctx: &Context, brush: &Map<String, Value>) -> Option<TextureHandle> {
        self.known(ctx, brush).flatten()
    }

    /// What is known of a picture, which is asked for if it was not yet; `Some(None)`: it cannot be drawn.
    fn known(&mut self, ctx: &Context, brush: &Map<String, Value>) -> Option<Option<TextureHandle>> {
        self.take_made(ctx);
        let key = Value::from(brush.clone()).to_string();
        let known = self.drawn.get(&key).cloned();
        if known.is_none()
            && self.awaited.insert(key.clone())
            && self.asked.send((key.clone(), brush.clone())).is_err()
        {
            // There is no one to draw it.
            self.awaited.remove(&key);
            self.drawn.insert(key, None);
        }
        known
    }

    /// Forgets what was drawn: the device that it was on is lost.
    pub fn forget(&mut self) {
        self.drawn.clear();
        self.last = None;
    }

    /// Whether one is to come.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        !self.awaited.is_empty()
    }

    fn take_made(&mut self, ctx: &Context) {
        for (key, made) in self.made.try_iter() {
            self.awaited.remove(&key);
            let texture = match made {
                Made::Skipped => continue,
                Made::Failed => None,
                Made::Drawn(picture) => {
                    let size = [picture.width_px as usize, picture.height_px as usize];
                    let image = ColorImage::from_rgb(size, &picture.rgb);
                    Some(ctx.load_texture("thumbnail", image, TextureOptions::LINEAR))
                }
            };
            if self.drawn.len() >= MAX_KEPT {
                self.drawn.clear();
            }
            self.drawn.insert(key, texture);
        }
    }
}

/// Draws what is asked for until no one can ask any more. While a slider is dragged only the last one counts.
fn draw_all(asked: &Receiver<(String, Map<String, Value>)>, made: &Sender<(String, Made)>, wake: &dyn Fn()) {
    while let Ok(mut next) = asked.recv() {
        while let Ok(later) = asked.try_recv() {
            let (skipped, _) = std::mem::replace(&mut next, later);
            made.send((skipped, Made::Skipped)).ok();
        }
        let (key, brush) = next;
        let picture = Preset::new("Thumbnail", brush).and_then(|preset| preset.draw_thumbnail(WIDTH_PX));
        if made.send((key, picture.map_or(Made::Failed, Made::Drawn))).is_err() {
            break;
        }
        wake();
    }
}
