//! How finely the ground is drawn, so that the window answers on slow machines too: coarse while something moves, fine when all is still.

use std::time::{Duration, Instant};

/// What a frame may take while something moves, and what one may when all is still.
const MOVING: Duration = Duration::from_millis(45);
const STILL: Duration = Duration::from_millis(1000);
/// How long nothing moves before fine frames are drawn.
const UNTIL_STILL: Duration = Duration::from_millis(350);
/// Steps of the picture's size: of so many, each way.
const FINEST: u32 = 8;
const COARSEST: u32 = 2;
/// Frames at the start that take long for other reasons: all that draws is made for them.
const NUM_FIRST: u32 = 4;

/// Chooses how many pixels are drawn.
#[derive(Debug)]
pub struct Quality {
    moving_step: u32,
    still_step: u32,
    last_motion: Instant,
    /// Whether the last frame was one of those of a still ground.
    was_still: bool,
    num_frames: u32,
}

impl Default for Quality {
    fn default() -> Self {
        Self {
            moving_step: FINEST,
            still_step: FINEST,
            last_motion: Instant::now(),
            was_still: false,
            num_frames: 0,
        }
    }
}

impl Quality {
    /// Something moves: camera, pointer or ground.
    pub fn note_motion(&mut self) {
        self.last_motion = Instant::now();
    }

    /// How long the last frame took, all of it. Tells whether the next one would be finer.
    pub fn note_frame(&mut self, elapsed: Duration) -> bool {
        self.num_frames += 1;
        if self.num_frames <= NUM_FIRST {
            return false;
        }
        let (step, budget) =
            if self.was_still { (&mut self.still_step, STILL) } else { (&mut self.moving_step, MOVING) };
        let before = *step;
        // What a frame of the next step takes at most, beside this one.
        let more = (f64::from(before + 1) / f64::from(before)).powi(2);
        *step = match elapsed.as_secs_f64() / budget.as_secs_f64() {
            over if over > 3.0 => (before / 2).max(COARSEST),
            over if over > 1.3 => (before - 1).max(COARSEST),
            over if over * more < 0.9 => (before + 1).min(FINEST),
            _ => before,
        };
        self.was_still && *step > before
    }

    /// Whether nothing has moved for a while.
    #[must_use]
    pub fn is_still(&self) -> bool {
        self.last_motion.elapsed() >= UNTIL_STILL
    }

    /// When to look again whether all is still; `None` where it was already.
    #[must_use]
    pub fn until_still(&self) -> Option<Duration> {
        UNTIL_STILL.checked_sub(self.last_motion.elapsed()).filter(|wait| !wait.is_zero())
    }

    /// Pixels to draw for a room of so many.
    pub fn size_px(&mut self, room: [u32; 2]) -> [u32; 2] {
        self.was_still = self.is_still();
        let step = if self.was_still { self.still_step } else { self.moving_step };
        room.map(|side| (side * step / FINEST).max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A machine on which a frame takes 20 ms and a second for 400,000 pixels.
    fn slow([width, height]: [u32; 2]) -> Duration {
        Duration::from_secs_f64(0.02 + f64::from(width * height) / 400_000.0)
    }

    #[test]
    fn slow_frames_are_drawn_coarsely_while_something_moves() {
        let mut quality = Quality::default();
        let room = [1000, 800];
        for _ in 0..20 {
            quality.note_motion();
            assert_eq!(quality.size_px(room), room, "a screen's own pace is no reason to be coarse");
            quality.note_frame(Duration::from_millis(16));
        }
        for _ in 0..20 {
            quality.note_motion();
            let size = quality.size_px(room);
            quality.note_frame(slow(size));
        }
        quality.note_motion();
        let [width, height] = quality.size_px(room);
        assert!(width <= 300 && height <= 240, "{width} {height}");
        quality.last_motion = Instant::now().checked_sub(Duration::from_secs(1)).unwrap();
        // Finer from frame to frame, until a frame takes what it may.
        for _ in 0..20 {
            let size = quality.size_px(room);
            quality.note_frame(slow(size));
        }
        let [still, _] = quality.size_px(room);
        assert!(quality.is_still() && still >= 2 * width && still < room[0], "{still}");
    }
}
