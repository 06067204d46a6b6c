//! A way through a terrain: keys that the eye passes, and the pictures between them.

use serde::Deserialize;

use super::request::{HeightAt, Place, ViewRequest};
use crate::{Error, Result};

/// Pictures of one flight at most.
const MAX_FRAMES: u32 = 100_000;
/// Keys at most.
const MAX_KEYS: usize = 10_000;

/// A flight: so many pictures, the first at the first key, the last at the last.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flight {
    frames: u32,
    keys: Vec<Key>,
    /// Whether heights are above the ground.
    #[serde(default)]
    above_ground: bool,
}

/// Where the eye is at one time, and what it looks at.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Key {
    /// Metres to the east, up, to the south.
    eye: [f64; 3],
    target: [f64; 3],
}

impl Flight {
    /// From `{"frames": 120, "keys": [{"eye": [x, y, z], "target": [x, y, z]}, ...], "above_ground": false}`.
    ///
    /// # Errors
    /// [`Error::Operation`] for a text that is none: without keys or frames, with too many, or with numbers that are not finite.
    pub fn from_json(text: &str) -> Result<Self> {
        let wrong = |detail: String| Error::Operation { place: "the flight".to_owned(), detail };
        let flight: Self = serde_json::from_str(text).map_err(|err| wrong(err.to_string()))?;
        if !(1..=MAX_FRAMES).contains(&flight.frames) {
            return Err(wrong(format!("`frames` is {}; it may be 1 to {MAX_FRAMES}", flight.frames)));
        }
        if !(1..=MAX_KEYS).contains(&flight.keys.len()) {
            return Err(wrong(format!("it has {} keys; it may have 1 to {MAX_KEYS}", flight.keys.len())));
        }
        Ok(flight)
    }

    /// The pictures: `request`, but seen from along the way.
    pub fn frames<'a>(&'a self, request: &'a ViewRequest) -> impl Iterator<Item = ViewRequest> + 'a {
        let last_frame = self.frames.saturating_sub(1).max(1);
        let last_key = self.keys.len().saturating_sub(1);
        (0..self.frames).map(move |frame| {
            let at = f64::from(frame) / f64::from(last_frame) * last_key as f64;
            let (eye, target) = (self.between(at, |key| key.eye), self.between(at, |key| key.target));
            ViewRequest { eye: Some(self.place(eye)), target: Some(self.place(target)), ..request.clone() }
        })
    }

    const fn place(&self, [x_m, y_m, z_m]: [f64; 3]) -> Place {
        let height = if self.above_ground { HeightAt::AboveGround(y_m) } else { HeightAt::Absolute(y_m) };
        Place { x_m, height, z_m }
    }

    /// The Catmull-Rom spline through all keys; each takes as long as the next.
    fn between(&self, at: f64, value: impl Fn(&Key) -> [f64; 3]) -> [f64; 3] {
        let whole = at.floor();
        let (t, index) = (at - whole, whole as usize);
        let key = |index: usize| {
            let key = self.keys.get(index).or_else(|| self.keys.last());
            key.map(&value).unwrap_or_default()
        };
        let [before, from, to, after] =
            [key(index.saturating_sub(1)), key(index), key(index + 1), key(index + 2)];
        let mut place = [0.0; 3];
        for (((place, before), (from, to)), after) in
            place.iter_mut().zip(before).zip(from.into_iter().zip(to)).zip(after)
        {
            let (first, second) = ((to - before) / 2.0, (after - from) / 2.0);
            let square = 3.0 * (to - from) - 2.0 * first - second;
            let cube = 2.0 * (from - to) + first + second;
            *place = ((cube * t + square) * t + first) * t + from;
        }
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight(frames: u32) -> Flight {
        let keys = r#"[{"eye": [0, 10, 0], "target": [5, 0, 0]}, {"eye": [10, 10, 0], "target": [15, 0, 0]}, {"eye": [20, 30, 0], "target": [25, 0, 0]}]"#;
        Flight::from_json(&format!(r#"{{"frames": {frames}, "keys": {keys}}}"#)).unwrap()
    }

    fn eyes(flight: &Flight) -> Vec<[f64; 3]> {
        let request = ViewRequest::default();
        let eye = |request: ViewRequest| match request.eye {
            Some(Place { x_m, height: HeightAt::Absolute(y_m), z_m }) => [x_m, y_m, z_m],
            other => panic!("{other:?}"),
        };
        flight.frames(&request).map(eye).collect()
    }

    #[test]
    fn a_flight_passes_its_keys_and_goes_smoothly_between() {
        let way = eyes(&flight(201));
        assert_eq!((way[0], way[100], way[200]), ([0.0, 10.0, 0.0], [10.0, 10.0, 0.0], [20.0, 30.0, 0.0]));
        let steps: Vec<f64> = way.windows(2).map(|pair| pair[1][1] - pair[0][1]).collect();
        assert!(steps.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.02), "{steps:?}");
        assert_eq!(eyes(&flight(1)), [[0.0, 10.0, 0.0]]);
    }

    #[test]
    fn what_is_no_flight_is_refused() {
        for (text, expected) in [
            ("{}", "frames"),
            (r#"{"frames": 0, "keys": [{"eye": [0,0,0], "target": [0,0,1]}]}"#, "1 to"),
            (r#"{"frames": 3, "keys": []}"#, "keys"),
            (r#"{"frames": 3, "keys": [{"eye": [0,0], "target": [0,0,1]}]}"#, "length"),
            (r#"{"frames": 3, "keys": [{"eye": [0,0,0], "target": [0,0,1], "roll": 3}]}"#, "roll"),
        ] {
            let err = Flight::from_json(text).unwrap_err().to_string();
            assert!(err.contains(expected), "{text}: {err}");
        }
    }
}
