//! How heights are read: what is in the file, as a picture and in numbers, where they go, and what the file does not say.

use std::path::Path;

use egui::{Color32, ComboBox, DragValue, RichText, Ui, pos2, vec2};
use orogeny_engine::{
    ByteOrder, Direction, Flip, Format, ImportOptions, ImportPreview, ImportRequest, MAX_SAMPLES_PER_SIDE,
    NodataPolicy, SampleType, TerrainGrid,
};

use super::{FIRST, WARNING, compass};
use crate::editor::Editor;
use crate::previews::Previewed;

/// The side of the picture, in points of the screen.
const PICTURE_SIDE: f32 = 190.0;
/// What all of it takes at least, in points of the screen.
const MIN_HEIGHT: f32 = 510.0;
/// How long the arrow is that goes along a file's first row, in points of the screen.
const ROW_ARROW: f32 = 34.0;
/// Spacings that differ by less than this share are the same.
const SAME_SPACING: f64 = 1.0e-6;
/// Samples of files that do not say it themselves.
const RAW_SAMPLES: [(SampleType, &str); 4] = [
    (SampleType::U16, "16 bits, whole"),
    (SampleType::I16, "16 bits, signed"),
    (SampleType::U8, "8 bits, whole"),
    (SampleType::F32, "32 bits, floating"),
];

/// What is chosen so far.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Choice {
    at_m: [f64; 2],
    /// Takes samples as far apart as the terrain's, whatever the file says.
    is_as_terrain: bool,
    nodata: NodataPolicy,
    /// What whole samples stand for; `None`: each for a metre.
    range_m: Option<[f64; 2]>,
    sample: SampleType,
    is_big: bool,
    /// Samples each way of a file that does not say it; `None`: a square.
    size: Option<[u32; 2]>,
    /// How far it is turned clockwise, and which sides change places then.
    rotate_degrees: u16,
    flip: Flip,
}

impl Default for Choice {
    fn default() -> Self {
        Self {
            at_m: [0.0, 0.0],
            is_as_terrain: false,
            nodata: NodataPolicy::Refuse,
            range_m: None,
            sample: SampleType::U16,
            is_big: false,
            size: None,
            rotate_degrees: 0,
            flip: Flip::None,
        }
    }
}

impl Choice {
    fn options(&self, format: Option<Format>, spacing_m: f64, num_bytes: u64) -> ImportOptions {
        let is_headless = matches!(format, Some(Format::Raw | Format::R16 | Format::R32));
        let is_raw = format == Some(Format::Raw);
        // A .raw has to be told its size: a square, where nothing else is said.
        let square = || {
            let side = (num_bytes / u64::from(self.sample.bytes())).isqrt();
            u32::try_from(side).ok().map(|side| (side, side))
        };
        let size = self.size.map(Into::into).or_else(|| if is_raw { square() } else { None });
        ImportOptions {
            size: size.filter(|_| is_headless),
            sample: is_raw.then_some(self.sample),
            byte_order: (is_headless && self.is_big).then_some(ByteOrder::Big),
            range_m: self.range_m.map(Into::into).filter(|_| self.is_scaled(format)),
            nodata: self.nodata,
            spacing_m: self.is_as_terrain.then_some(spacing_m),
            rotate_degrees: self.rotate_degrees,
            flip: self.flip,
            ..ImportOptions::default()
        }
    }

    /// Whether samples are whole numbers that may stand for a range.
    const fn is_scaled(&self, format: Option<Format>) -> bool {
        match format {
            Some(Format::Png | Format::R16) => true,
            Some(Format::Raw) => self.sample.range_maximum().is_some(),
            _ => false,
        }
    }

    /// Turns what is seen by a quarter. Files are turned before they are mirrored, so mirrors change their axis.
    const fn turn(&mut self, is_clockwise: bool) {
        self.rotate_degrees = (self.rotate_degrees + if is_clockwise { 90 } else { 270 }) % 360;
        self.flip = match self.flip {
            Flip::EastWest => Flip::NorthSouth,
            Flip::NorthSouth => Flip::EastWest,
            other => other,
        };
    }

    /// Mirrors what is seen. Two different mirrors are half a turn.
    fn mirror(&mut self, flip: Flip) {
        match self.flip {
            Flip::None => self.flip = flip,
            before => {
                self.rotate_degrees = (self.rotate_degrees + if before == flip { 0 } else { 180 }) % 360;
                self.flip = Flip::None;
            }
        }
    }

    /// What is asked of the engine.
    pub(super) fn request(&self, path: &Path, layer: Option<String>, grid: TerrainGrid) -> ImportRequest {
        let format = Format::from_path(path, Direction::Import).ok();
        let num_bytes = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
        let options = self.options(format, grid.spacing_m(), num_bytes);
        ImportRequest { options, layer, at_m: self.at_m, ..ImportRequest::new(path) }
    }
}

pub(super) fn show(editor: &mut Editor, ui: &mut Ui, choice: &mut Choice, path: &str) {
    // What is below does not move when the picture comes.
    ui.set_min_height(MIN_HEIGHT);
    let Some(document) = &editor.document else { return };
    let grid = document.status.grid;
    let layer = document.current_layer().map(|layer| layer.name.clone()).unwrap_or_default();
    let path = Path::new(path.trim());
    if !path.is_file() {
        ui.label("Choose a file: a picture of it, its size and its heights are shown here.");
        return;
    }
    let format = match Format::from_path(path, Direction::Import) {
        Ok(format) => format,
        Err(err) => {
            ui.colored_label(WARNING, err.to_string());
            return;
        }
    };
    // Above all that has another size once it is turned: what is pressed twice stays under the pointer.
    turns(ui, choice);
    let options = choice.request(path, None, grid).options;
    let previewed = editor.previews.of(ui.ctx(), path, &options);
    match &previewed {
        Previewed::Waiting => {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label("It is being read");
            });
        }
        Previewed::Wrong(wrong) => _ = ui.colored_label(WARNING, wrong),
        Previewed::Read(preview, texture) => {
            ui.horizontal_top(|ui| {
                picture(ui, preview, &options, texture);
                ui.vertical(|ui| facts(ui, preview));
            });
            fits(ui, choice, preview, grid);
            for notice in &preview.notices {
                ui.label(RichText::new(notice).weak());
            }
        }
    }
    ui.separator();
    ui.label(format!("It goes into the layer {layer}"));
    ui.horizontal(|ui| {
        ui.label("Its north-west sample goes to");
        for (place_m, name) in choice.at_m.iter_mut().zip(["x", "z"]) {
            let label = ui.label(name);
            ui.add(DragValue::new(place_m).suffix(" m").speed(grid.spacing_m())).labelled_by(label.id);
        }
    });
    what_it_does_not_say(ui, choice, format);
    ui.checkbox(&mut choice.is_as_terrain, format!("Take its samples as {:.4} m apart", grid.spacing_m()))
        .on_hover_text("As far as the terrain's, whatever the file says");
    gaps(ui, choice);
}

/// Buttons that turn and mirror it.
fn turns(ui: &mut Ui, choice: &mut Choice) {
    ui.horizontal(|ui| {
        for (title, is_clockwise) in [("Turn left", false), ("Turn right", true)] {
            if ui.button(title).on_hover_text("By a quarter, as the picture shows it").clicked() {
                choice.turn(is_clockwise);
            }
        }
        for (title, flip) in [("Mirror east-west", Flip::EastWest), ("Mirror north-south", Flip::NorthSouth)]
        {
            if ui.button(title).on_hover_text("These sides change places").clicked() {
                choice.mirror(flip);
            }
        }
    });
    let mirrored = match choice.flip {
        Flip::None | Flip::Both => "",
        Flip::EastWest => ", then mirrored east-west",
        Flip::NorthSouth => ", then mirrored north-south",
    };
    match (choice.rotate_degrees, choice.flip) {
        (0, Flip::None) => _ = ui.label("It lies as its file has it"),
        (degrees, _) => _ = ui.label(format!("Turned by {degrees}° clockwise{mirrored}")),
    }
}

/// It from above as it is going to lie, with the terrain's sides and where its file begins.
fn picture(ui: &mut Ui, preview: &ImportPreview, options: &ImportOptions, texture: &egui::TextureHandle) {
    let longest = preview.width.max(preview.depth).max(1) as f32;
    let size = vec2(preview.width as f32, preview.depth as f32) * (PICTURE_SIDE / longest);
    let (room, response) =
        ui.allocate_exact_size(size.max(vec2(8.0, 8.0)) + vec2(32.0, 32.0), egui::Sense::hover());
    let told = "The file from above, north at the top";
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, told));
    let rect = room.shrink(16.0);
    let whole = egui::Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture.id(), rect, whole, Color32::WHITE);
    let at = |place| {
        let [x, z] = options.turned(place);
        rect.lerp_inside(vec2(x as f32, z as f32))
    };
    let (first, next) = (at([0.0, 0.0]), at([1.0, 0.0]));
    compass(ui, room, first);
    let along = (next - first).normalized();
    ui.painter().arrow(first, along * ROW_ARROW, egui::Stroke::new(2.0, FIRST));
    let corner = |low: bool, names: [&'static str; 2]| if low { names[0] } else { names[1] };
    let [x, z] = options.turned([0.0, 0.0]);
    let (north, west) = (corner(z < 0.5, ["north", "south"]), corner(x < 0.5, ["west", "east"]));
    let towards = match (along.x.abs() > along.y.abs(), along.x + along.y > 0.0) {
        (true, true) => "east",
        (true, false) => "west",
        (false, true) => "south",
        (false, false) => "north",
    };
    response.on_hover_text(format!(
        "The file's first sample becomes the {north}-{west} corner; its rows run to the {towards}"
    ));
}

fn facts(ui: &mut Ui, preview: &ImportPreview) {
    let ImportPreview { format, sample, width, depth, spacing_m, range_m: [low_m, high_m], epsg, .. } =
        preview;
    ui.label(format!("{format}, {sample}"));
    ui.label(format!("{width} x {depth} samples"));
    match spacing_m {
        Some(spacing_m) => {
            let [x_km, z_km] = [width, depth].map(|side| f64::from(side.max(&1) - 1) * spacing_m / 1000.0);
            ui.label(format!("{spacing_m:.4} m apart"));
            ui.label(format!("{x_km:.2} km x {z_km:.2} km"));
        }
        None => _ = ui.label("It tells no spacing"),
    }
    ui.label(format!("{low_m:.2} to {high_m:.2} m high"));
    if let Some(epsg) = epsg {
        ui.label(format!("EPSG {epsg}"));
    }
}

/// What of it does not fit the terrain.
fn fits(ui: &mut Ui, choice: &Choice, preview: &ImportPreview, grid: TerrainGrid) {
    let terrain_m = grid.spacing_m();
    if let Some(raster_m) =
        preview.spacing_m.filter(|raster_m| (raster_m / terrain_m - 1.0).abs() > SAME_SPACING)
    {
        let text = format!(
            "Its samples are {raster_m:.4} m apart, the terrain's {terrain_m:.4} m: it would be refused. Take them as they are, below, \
             or make a terrain of it: orogeny import FILE TERRAIN"
        );
        ui.colored_label(WARNING, text);
    }
    let sides = [(preview.width, grid.width()), (preview.depth, grid.depth())];
    let covered = choice.at_m.into_iter().zip(sides).map(|(at_m, (side, terrain))| {
        let from = (at_m / terrain_m).round();
        let to = from + f64::from(side);
        ((to.min(f64::from(terrain)) - from.max(0.0)).max(0.0), from < 0.0 || to > f64::from(terrain))
    });
    let covered: Vec<_> = covered.collect();
    let num: f64 = covered.iter().map(|(num, _)| num).product();
    let share = 100.0 * num / (f64::from(grid.width()) * f64::from(grid.depth()));
    ui.label(format!("It covers {share:.1} % of the terrain"));
    if num <= 0.0 {
        ui.colored_label(WARNING, "It lies beyond the terrain, and would be refused");
    } else if covered.iter().any(|(_, is_beyond)| *is_beyond) {
        ui.colored_label(WARNING, "What lies beyond the terrain's edge is left out");
    }
}

/// What has to be said of files that do not say it.
fn what_it_does_not_say(ui: &mut Ui, choice: &mut Choice, format: Format) {
    if format == Format::Raw {
        let name = RAW_SAMPLES.iter().find(|(sample, _)| *sample == choice.sample).map(|(_, name)| *name);
        ComboBox::from_label("Samples").selected_text(name.unwrap_or_default()).show_ui(ui, |ui| {
            for (sample, name) in RAW_SAMPLES {
                ui.selectable_value(&mut choice.sample, sample, name);
            }
        });
    }
    if matches!(format, Format::Raw | Format::R16 | Format::R32) {
        ui.horizontal(|ui| {
            ui.checkbox(&mut choice.is_big, "Big endian").on_hover_text("The most significant byte first");
            let mut is_square = choice.size.is_none();
            if ui.checkbox(&mut is_square, "Square").changed() {
                choice.size = (!is_square).then_some([1, 1]);
            }
            for (side, name) in choice.size.iter_mut().flatten().zip(["wide", "deep"]) {
                let label = ui.label(name);
                ui.add(DragValue::new(side).range(1..=MAX_SAMPLES_PER_SIDE)).labelled_by(label.id);
            }
        });
    }
    if !choice.is_scaled(Some(format)) {
        return;
    }
    ui.horizontal(|ui| {
        let mut has_range = choice.range_m.is_some();
        let told = "What the first and the last whole sample stand for; without it each stands for a metre";
        if ui.checkbox(&mut has_range, "A range of heights").on_hover_text(told).changed() {
            choice.range_m = has_range.then_some([0.0, 1000.0]);
        }
        for (end, name) in choice.range_m.iter_mut().flatten().zip(["from", "to"]) {
            let label = ui.label(name);
            ui.add(DragValue::new(end).suffix(" m")).labelled_by(label.id);
        }
    });
}

/// What becomes of samples without a height.
fn gaps(ui: &mut Ui, choice: &mut Choice) {
    let policies = [
        (NodataPolicy::Refuse, "refuse the file"),
        (NodataPolicy::Fill, "fill them from around"),
        (NodataPolicy::Value(0.0), "a height"),
    ];
    let is_same = |one: NodataPolicy, other| std::mem::discriminant(&one) == std::mem::discriminant(&other);
    let title = policies.iter().find(|(policy, _)| is_same(*policy, choice.nodata)).map(|(_, title)| *title);
    ui.horizontal(|ui| {
        ComboBox::from_label("Samples without a height").selected_text(title.unwrap_or_default()).show_ui(
            ui,
            |ui| {
                for (policy, title) in policies {
                    if ui.selectable_label(is_same(policy, choice.nodata), title).clicked() {
                        choice.nodata = policy;
                    }
                }
            },
        );
        if let NodataPolicy::Value(height_m) = &mut choice.nodata {
            ui.add(DragValue::new(height_m).suffix(" m"));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is pressed acts on what is seen, whatever was pressed before: shares of the file's corners tell.
    #[test]
    fn buttons_turn_and_mirror_what_is_seen() {
        let corners = |choice: &Choice| {
            let options = choice.options(Some(Format::Npy), 1.0, 0);
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|corner| options.turned(corner))
        };
        type Button = fn(&mut Choice);
        type Expected = fn([f64; 2]) -> [f64; 2];
        let press: [(Button, Expected); 4] = [
            (|choice| choice.turn(true), |[x, z]| [1.0 - z, x]),
            (|choice| choice.turn(false), |[x, z]| [z, 1.0 - x]),
            (|choice| choice.mirror(Flip::EastWest), |[x, z]| [1.0 - x, z]),
            (|choice| choice.mirror(Flip::NorthSouth), |[x, z]| [x, 1.0 - z]),
        ];
        for order in 0..256 {
            let mut choice = Choice::default();
            for step in 0..4 {
                let (button, expected) = press[order >> (2 * step) & 3];
                let before = corners(&choice);
                button(&mut choice);
                assert_eq!(corners(&choice), before.map(expected), "{order} {step}");
            }
        }
    }
}
