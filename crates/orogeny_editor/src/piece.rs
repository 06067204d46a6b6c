//! A floating piece of ground: what was copied, on its way to where it is put down.

use std::path::{Path, PathBuf};

use orogeny_engine::session::Survey;
use serde_json::{Value, json};

/// How a piece goes over into the ground, as recipes call it and as people do.
pub const BLENDS: [(&str, &str); 4] = [
    ("laplacian", "Each scale over its own distance"),
    ("feathered", "Soft edges"),
    ("mean_shifted", "Detail without its height"),
    ("plain", "As it is"),
];
/// The least that a piece may be made smaller, and the most larger.
const SCALES: [f64; 2] = [0.05, 20.0];
/// How far beyond its edge the handle for turning is, in halves of its depth.
const TURN_AT: f64 = 1.3;

/// Lines that a floating piece is drawn with, each way.
pub const NUM_LINES: u32 = 12;

/// What was copied.
#[derive(Debug, Clone, PartialEq)]
pub struct Copied {
    /// The terrain that it was copied from.
    pub path: PathBuf,
    /// `[x, z, width, depth]` in metres.
    pub region_m: [f64; 4],
    /// How high it is where its lines cross, metres, row by row.
    net_m: Vec<f32>,
}

impl Copied {
    /// What is selected of a terrain, whose heights `height_m` tells; `None` where nothing is.
    #[must_use]
    pub fn selected(path: &Path, survey: &Survey, height_m: impl Fn([f64; 2]) -> f32) -> Option<Self> {
        survey.selected_m.map(|region_m| Self::of(path, region_m, height_m))
    }

    fn of(
        path: &Path,
        region_m @ [x_m, z_m, width_m, depth_m]: [f64; 4],
        height_m: impl Fn([f64; 2]) -> f32,
    ) -> Self {
        let share = |line: u32| f64::from(line) / f64::from(NUM_LINES);
        let crossing = |row, column| height_m([x_m + share(column) * width_m, z_m + share(row) * depth_m]);
        let rows = (0..=NUM_LINES).flat_map(|row| (0..=NUM_LINES).map(move |column| (row, column)));
        let net_m = rows.map(|(row, column)| crossing(row, column)).collect();
        Self { path: path.to_owned(), region_m, net_m }
    }
}

/// What of a piece is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Handle {
    /// All of it, this far from its middle: `[x, z]` in metres.
    Inside([f64; 2]),
    /// A corner, which makes it larger or smaller.
    Corner,
    /// What turns it.
    Turn,
    /// What lifts it.
    Lift,
}

/// A piece that floats.
#[derive(Debug, Clone, PartialEq)]
pub struct Piece {
    /// Where it was copied, `[x, z, width, depth]` in metres.
    pub region_m: [f64; 4],
    /// The terrain that it was copied from, where that is another one than it is put down in.
    pub from: Option<PathBuf>,
    /// How high it is where its lines cross, metres, row by row.
    net_m: Vec<f32>,
    /// Where its middle comes to lie, `[x, z]` in metres.
    pub to_m: [f64; 2],
    /// Turned from x towards z, degrees.
    pub rotation_degrees: f64,
    /// How much larger it becomes.
    pub scale: f64,
    /// Whether its left and right change places.
    pub is_mirrored: bool,
    /// What is added to its heights, metres.
    pub offset_m: f64,
    /// An index into the blends of the panel, in order.
    pub blend: usize,
}

impl Piece {
    /// What was copied, over a place of a terrain.
    #[must_use]
    pub fn new(copied: &Copied, terrain: &Path, to_m: [f64; 2]) -> Self {
        Self {
            region_m: copied.region_m,
            from: (copied.path != terrain).then(|| copied.path.clone()),
            net_m: copied.net_m.clone(),
            to_m,
            rotation_degrees: 0.0,
            scale: 1.0,
            is_mirrored: false,
            offset_m: 0.0,
            blend: 0,
        }
    }

    /// Half of its width and half of its depth as it was copied, metres.
    fn half_m(&self) -> [f64; 2] {
        let [.., width_m, depth_m] = self.region_m;
        [width_m / 2.0, depth_m / 2.0]
    }

    /// A place of it, -1 to 1 from edge to edge: where it was copied, and where it comes to lie; `[x, z]` in metres.
    #[must_use]
    pub fn place_m(&self, [across, down]: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let [x_m, z_m, ..] = self.region_m;
        let [half_width_m, half_depth_m] = self.half_m();
        let [x, z] = [across * half_width_m, down * half_depth_m];
        let from_m = [x_m + half_width_m + x, z_m + half_depth_m + z];
        let x = if self.is_mirrored { -x } else { x };
        let (sin, cos) = self.rotation_degrees.to_radians().sin_cos();
        let turned = [x * cos - z * sin, x * sin + z * cos].map(|along| along * self.scale);
        (from_m, [self.to_m[0] + turned[0], self.to_m[1] + turned[1]])
    }

    /// How high it was where lines of its net cross, which are counted from its north-western corner on, metres.
    #[must_use]
    pub fn net_m(&self, [column, row]: [u32; 2]) -> f32 {
        let index = row * (NUM_LINES + 1) + column;
        self.net_m.get(index as usize).copied().unwrap_or_default()
    }

    /// Its corners where they come to lie, once around.
    #[must_use]
    pub fn corners_m(&self) -> [[f64; 2]; 4] {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|corner| self.place_m(corner).1)
    }

    /// Where the handle for turning lies.
    #[must_use]
    pub fn turn_m(&self) -> [f64; 2] {
        self.place_m([0.0, -TURN_AT]).1
    }

    /// Whether a place lies within it.
    #[must_use]
    pub fn contains(&self, [x_m, z_m]: [f64; 2]) -> bool {
        let [x, z] = [x_m - self.to_m[0], z_m - self.to_m[1]];
        let (sin, cos) = self.rotation_degrees.to_radians().sin_cos();
        let back = [x * cos + z * sin, z * cos - x * sin];
        let half_m = self.half_m();
        back.iter().zip(half_m).all(|(along, half_m)| along.abs() <= half_m * self.scale)
    }

    /// Takes what is held to a place on the ground.
    pub fn drag(&mut self, handle: Handle, [x_m, z_m]: [f64; 2]) {
        let [x, z] = [x_m - self.to_m[0], z_m - self.to_m[1]];
        match handle {
            Handle::Inside([from_x, from_z]) => self.to_m = [x_m - from_x, z_m - from_z],
            Handle::Corner => {
                let [half_width_m, half_depth_m] = self.half_m();
                let [least, most] = SCALES;
                self.scale = (x.hypot(z) / half_width_m.hypot(half_depth_m)).clamp(least, most);
            }
            // Unturned, the handle lies to the north.
            Handle::Turn => self.rotation_degrees = x.atan2(-z).to_degrees(),
            Handle::Lift => {}
        }
    }

    /// The operation that puts it down on a layer. Of another terrain all of the region is taken: the selection is that of this one.
    #[must_use]
    pub fn put_down_json(&self, layer: u32) -> Value {
        let (blend, _) = BLENDS.get(self.blend).copied().unwrap_or(BLENDS[0]);
        let mut operation = json!({
            "op": "fill",
            "layer": layer,
            "brush": {"type": "clone", "blend": blend, "source": {
                "region": self.region_m,
                "selection": true,
                "to": self.to_m,
                "rotation": self.rotation_degrees,
                "scale": self.scale,
                "mirrored": self.is_mirrored,
                "height_offset": self.offset_m,
            }},
        });
        let source = operation.pointer_mut("/brush/source").and_then(Value::as_object_mut);
        if let (Some(from), Some(source)) = (&self.from, source) {
            source.remove("selection");
            source.insert("file".to_owned(), from.display().to_string().into());
        }
        operation
    }
}

#[cfg(test)]
mod tests {
    use orogeny_engine::Operation;

    use super::*;

    fn piece() -> Piece {
        let path = Path::new("t.orogeny");
        let copied = Copied::of(path, [100.0, 200.0, 40.0, 60.0], |[x_m, z_m]| (x_m + 1000.0 * z_m) as f32);
        Piece::new(&copied, path, [500.0, 300.0])
    }

    fn is_near(a: [f64; 2], b: [f64; 2]) -> bool {
        (a[0] - b[0]).hypot(a[1] - b[1]) < 1.0e-9
    }

    #[test]
    fn it_lies_as_it_was_copied_until_it_is_turned() {
        let mut piece = piece();
        assert_eq!(piece.place_m([-1.0, 1.0]), ([100.0, 260.0], [480.0, 330.0]));
        piece.is_mirrored = true;
        assert_eq!(piece.place_m([-1.0, 1.0]), ([100.0, 260.0], [520.0, 330.0]));
        (piece.is_mirrored, piece.rotation_degrees, piece.scale) = (false, 90.0, 2.0);
        // What lay to the east lies to the south now, twice as far off.
        assert!(is_near(piece.place_m([1.0, 0.0]).1, [500.0, 340.0]));
        assert!(piece.contains([555.0, 338.0]) && !piece.contains([500.0, 345.0]));
    }

    #[test]
    fn handles_move_turn_and_scale_it() {
        let mut piece = piece();
        piece.drag(Handle::Inside([10.0, -5.0]), [510.0, 395.0]);
        assert_eq!(piece.to_m, [500.0, 400.0]);
        piece.drag(Handle::Turn, [600.0, 400.0]);
        assert_eq!(piece.rotation_degrees, 90.0);
        let turn_m = piece.turn_m();
        assert!(
            (turn_m[1] - 400.0).abs() < 1.0e-9 && turn_m[0] > 530.0,
            "the handle is under the hand: {turn_m:?}"
        );
        let corner = piece.corners_m()[2];
        piece.drag(Handle::Corner, corner);
        assert!((piece.scale - 1.0).abs() < 1.0e-9);
        piece.drag(Handle::Corner, [500.0 + 3.0 * (corner[0] - 500.0), 400.0 + 3.0 * (corner[1] - 400.0)]);
        assert!((piece.scale - 3.0).abs() < 1.0e-9);
    }

    #[test]
    fn its_net_is_as_high_as_it_was_copied() {
        let piece = piece();
        for (crossing, share) in [([0, 0], [-1.0, -1.0]), ([12, 0], [1.0, -1.0]), ([6, 12], [0.0, 1.0])] {
            let ([x_m, z_m], _) = piece.place_m(share);
            assert_eq!(f64::from(piece.net_m(crossing)), x_m + 1000.0 * z_m);
        }
        let source = piece.put_down_json(1)["brush"]["source"].clone();
        assert!(source["selection"] == true && source.get("file").is_none());
        let elsewhere = Piece { from: Some("u.orogeny".into()), ..piece };
        let source = elsewhere.put_down_json(1)["brush"]["source"].clone();
        assert!(source.get("selection").is_none() && source["file"] == "u.orogeny");
        Operation::from_json_text(&elsewhere.put_down_json(1).to_string()).unwrap();
    }

    #[test]
    fn every_blend_is_an_operation() {
        for blend in 0..BLENDS.len() {
            let piece = Piece { blend, rotation_degrees: -33.0, offset_m: 4.0, ..piece() };
            Operation::from_json_text(&piece.put_down_json(3).to_string()).unwrap();
        }
    }
}
