//! Presets of exports: what other programs want of a file of heights, and what has to be typed there.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use orogeny_formats::{ByteOrder, Direction, Format, MAX_SAMPLES_PER_SIDE, SampleType};

use super::{Presets, folder, name, preset};
use crate::{Error, Fit, Result, whole_file};

/// The most bytes of a preset's file.
const MAX_BYTES: u64 = 1 << 16;
/// The steps between the first and the last of 16 bits.
const STEPS_OF_16_BITS: f64 = 65_535.0;

/// The program that a file is for: what has to be typed there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExportProgram {
    /// Any.
    #[default]
    Any,
    /// Unreal's landscape.
    Unreal,
    /// Unity's terrain.
    Unity,
    /// Terrain3D in Godot.
    Terrain3d,
    /// HTerrain in Godot.
    Hterrain,
    /// Blender, as a displacement.
    Blender,
}

/// How many samples a side may have.
#[derive(Debug, Clone, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExportSizes {
    /// Any number.
    #[default]
    Any,
    /// One of these, the same both ways.
    Square(Vec<u32>),
}

/// What whole samples stand for.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ExportRange {
    /// The first and the last for the lowest and the highest height that is written: every step is used.
    #[default]
    Terrain,
    /// The same for heights in metres.
    Own([f64; 2]),
    /// Each for a metre.
    Metres,
}

/// What a program wants of a file.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExportPreset {
    /// What it is called.
    #[serde(rename = "export_preset")]
    pub name: String,
    /// What the file's name ends with, without a dot: it tells the format.
    pub ending: String,
    /// How samples are stored; `None`: as the format has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sample: Option<SampleType>,
    /// The byte order of formats without a header; `None`: the least significant first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub byte_order: Option<ByteOrder>,
    /// How many samples a side may have.
    #[serde(default)]
    pub sizes: ExportSizes,
    /// How they come about.
    #[serde(default)]
    pub fit: Fit,
    /// What whole samples stand for.
    #[serde(default)]
    pub range: ExportRange,
    /// Whether the southern row comes first.
    #[serde(default)]
    pub is_south_first: bool,
    /// What it is for.
    #[serde(default)]
    pub program: ExportProgram,
}

/// An export as it is going to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlannedExport {
    /// Samples along x and z.
    pub size: [u32; 2],
    /// Metres between them, along x and z.
    pub spacing_m: [f64; 2],
    /// What the first and the last whole sample stand for, metres; `None`: samples are metres.
    pub range_m: Option<[f64; 2]>,
    /// Bytes of samples, without what a format packs them into.
    pub num_bytes: u64,
    /// Which byte of a sample comes first, where the format leaves that open.
    pub byte_order: ByteOrder,
    /// Whether the southern row comes first.
    pub is_south_first: bool,
}

impl ExportSizes {
    /// The side that comes nearest to a number of samples, larger ones only where all are; `None`: any is right.
    #[must_use]
    pub fn nearest(&self, num_samples: u32) -> Option<u32> {
        let Self::Square(sides) = self else { return None };
        let below = sides.iter().filter(|side| **side <= num_samples).max();
        below.or_else(|| sides.iter().min()).copied()
    }

    /// The size that so many samples come nearest to; `None`: they are right as they are.
    #[must_use]
    pub fn nearest_size(&self, [width, depth]: [u32; 2]) -> Option<[u32; 2]> {
        let side = self.nearest(width.max(depth))?;
        Some([side; 2]).filter(|size| *size != [width, depth])
    }
}

impl ExportPreset {
    /// All samples of a terrain, over its own range, for no program alone.
    #[must_use]
    pub fn plain(name: &str, ending: &str) -> Self {
        Self {
            name: name.to_owned(),
            ending: ending.to_owned(),
            sample: None,
            byte_order: None,
            sizes: ExportSizes::default(),
            fit: Fit::default(),
            range: ExportRange::default(),
            is_south_first: false,
            program: ExportProgram::default(),
        }
    }

    /// Whether samples are whole numbers that a range can be given for.
    #[must_use]
    pub fn is_scaled(&self) -> bool {
        is_scaled(&self.ending, self.sample)
    }

    /// What its range comes to for heights from the lowest to the highest that are written, metres; `None`: samples are metres.
    #[must_use]
    pub fn range_m(&self, [low_m, high_m]: [f64; 2]) -> Option<[f64; 2]> {
        match self.range {
            _ if !self.is_scaled() => None,
            // Flat ground has a range as well.
            ExportRange::Terrain => Some([low_m, if high_m > low_m { high_m } else { low_m + 1.0 }]),
            ExportRange::Own(range_m) => Some(range_m),
            ExportRange::Metres => None,
        }
    }

    /// Refuses a file of another format than its own.
    ///
    /// # Errors
    /// [`Error::Preset`], with the name to give instead; [`Error::Format`] for a name that tells no format.
    pub fn check_file(&self, file: &Path) -> Result<()> {
        let own = file.with_extension(&self.ending);
        if Format::from_path(file, Direction::Export)? == Format::from_path(&own, Direction::Export)? {
            return Ok(());
        }
        let detail = format!(
            "it is for .{} files, and `{}` is none: write `{}`",
            self.ending,
            file.display(),
            own.display()
        );
        Err(preset::unusable(format!("the export preset {:?}", self.name), detail))
    }

    /// What is wrong with it, for people.
    fn check(&self) -> Result<(), String> {
        name::check(&self.name)?;
        let file = PathBuf::from(format!("a.{}", self.ending));
        Format::from_path(&file, Direction::Export).map_err(|err| err.to_string())?;
        if let ExportSizes::Square(sides) = &self.sizes
            && (sides.is_empty() || sides.iter().any(|side| !(1..=MAX_SAMPLES_PER_SIDE).contains(side)))
        {
            return Err(format!("`sizes` needs sides of 1 to {MAX_SAMPLES_PER_SIDE} samples"));
        }
        if let ExportRange::Own([low_m, high_m]) = self.range
            && low_m.partial_cmp(&high_m) != Some(Ordering::Less)
        {
            return Err(format!("`range` is {low_m} to {high_m}: the first must be below the second"));
        }
        Ok(())
    }

    /// As the text of its file.
    ///
    /// # Errors
    /// [`Error::Preset`] for one that could not be read again.
    pub fn to_json_text(&self) -> Result<String> {
        let failed = |detail: String| preset::unusable(format!("the export preset {:?}", self.name), detail);
        self.check().map_err(failed)?;
        serde_json::to_string_pretty(self).map_err(|err| failed(err.to_string()))
    }
}

/// Whether whole samples of a file are scaled to a range.
fn is_scaled(ending: &str, sample: Option<SampleType>) -> bool {
    let format = Format::from_path(&PathBuf::from(format!("a.{ending}")), Direction::Export);
    matches!(format, Ok(Format::Png | Format::R16 | Format::Raw))
        && sample.is_none_or(|sample| sample.range_maximum().is_some())
}

impl ExportProgram {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Any, Self::Unreal, Self::Unity, Self::Terrain3d, Self::Hterrain, Self::Blender];

    /// What people call it.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Any => "any program",
            Self::Unreal => "Unreal",
            Self::Unity => "Unity",
            Self::Terrain3d => "Godot, Terrain3D",
            Self::Hterrain => "Godot, HTerrain",
            Self::Blender => "Blender",
        }
    }

    /// What has to be typed there so that an export lies as it lay, one line each.
    #[must_use]
    pub fn advice(self, planned: &PlannedExport) -> Vec<String> {
        let PlannedExport { size: [width, depth], spacing_m: [x_m, z_m], range_m, byte_order, .. } = *planned;
        let is_big = byte_order == ByteOrder::Big;
        let [low_m, high_m] = range_m.unwrap_or([0.0, STEPS_OF_16_BITS]);
        let span_m = high_m - low_m;
        let sides_m = [(width.max(1) - 1, x_m), (depth.max(1) - 1, z_m)].map(|(num, m)| f64::from(num) * m);
        let [width_m, depth_m] = sides_m;
        match self {
            Self::Any if range_m.is_some() => {
                vec![format!("Sample 0 is {low_m:.3} m, the last is {high_m:.3} m")]
            }
            Self::Any => vec!["Samples are metres".to_owned()],
            // Sample 32,768 is 0, and 128 samples are a centimetre at a scale of 1.
            Self::Unreal => {
                let scale_z = span_m * 100.0 * 128.0 / STEPS_OF_16_BITS;
                let zero_m = low_m + span_m * 32_768.0 / STEPS_OF_16_BITS;
                vec![
                    format!("Scale X {:.3}, Y {:.3}, Z {scale_z:.5}", x_m * 100.0, z_m * 100.0),
                    format!("Location Z {:.2} cm: what lies at 0 m here lies at 0 there", zero_m * 100.0),
                ]
            }
            // It divides by 65,536, one more than the last sample.
            Self::Unity => vec![
                format!(
                    "Resolution {width} x {depth}, Depth 16 bit, Byte Order {}, Flip Vertically {}",
                    if is_big { "Mac" } else { "Windows" },
                    if planned.is_south_first { "off" } else { "on" }
                ),
                format!(
                    "Terrain Size X {width_m:.2}, Y {:.3}, Z {depth_m:.2}; position Y {low_m:.3}",
                    span_m * 65_536.0 / STEPS_OF_16_BITS
                ),
            ],
            Self::Terrain3d => vec![
                format!("R16 Range {low_m:.3} to {high_m:.3}, R16 Size {width} x {depth}"),
                format!("Vertex Spacing {x_m:.4}"),
            ],
            Self::Hterrain => vec![
                format!(
                    "Min height {low_m:.3}, Max height {high_m:.3}, {} endian",
                    if is_big { "big" } else { "little" }
                ),
                format!("Map scale X {x_m:.4}, Z {z_m:.4}"),
            ],
            Self::Blender => vec![
                format!("A plane of {width_m:.2} m x {depth_m:.2} m; the picture's Color Space Non-Color"),
                format!("Displace: Strength {span_m:.3}, Midlevel 0; object Z {low_m:.3} m"),
            ],
        }
    }
}

/// Those that come with the program.
fn factory() -> Vec<ExportPreset> {
    let plain = ExportPreset::plain;
    let unreal = || ExportSizes::Square(vec![127, 253, 505, 1009, 2017, 4033, 8129]);
    let powers =
        |low: u32, high: u32| ExportSizes::Square((low..=high).map(|power| (1 << power) + 1).collect());
    let of = |program, sizes, preset| ExportPreset { program, sizes, ..preset };
    vec![
        plain("PNG, 16 bits", "png"),
        plain("TIFF, metres", "tif"),
        of(ExportProgram::Unreal, unreal(), plain("Unreal R16", "r16")),
        of(ExportProgram::Unreal, unreal(), plain("Unreal PNG", "png")),
        // Its first row is the southern one.
        ExportPreset {
            is_south_first: true,
            ..of(ExportProgram::Unity, powers(5, 12), plain("Unity RAW", "raw"))
        },
        of(ExportProgram::Terrain3d, ExportSizes::Any, plain("Godot Terrain3D R16", "r16")),
        of(ExportProgram::Hterrain, powers(6, 12), plain("Godot HTerrain RAW", "raw")),
        of(ExportProgram::Blender, ExportSizes::Any, plain("Blender PNG", "png")),
    ]
}

/// All presets of exports that there are.
#[derive(Debug, Default)]
pub struct ExportPresets {
    factory: Vec<ExportPreset>,
    own: BTreeMap<String, ExportPreset>,
    unusable: Vec<Error>,
    folder: Option<PathBuf>,
}

impl ExportPresets {
    /// Those beside the presets of brushes: in the folder `exports` of theirs.
    #[must_use]
    pub fn of(presets: &Presets) -> Self {
        Self::open(presets.folder().map(|folder| folder.join("exports")))
    }

    /// Those that come with the program and those in a folder, which need not be there.
    #[must_use]
    pub fn open(folder: Option<PathBuf>) -> Self {
        let mut presets = Self { factory: factory(), folder, ..Self::default() };
        let files = presets.folder.as_deref().map_or_else(|| Ok(Vec::new()), folder::files);
        match files {
            Ok(files) => {
                for file in files {
                    match read(&file) {
                        Ok(preset) => _ = presets.own.insert(name::slug(&preset.name), preset),
                        Err(err) => presets.unusable.push(err),
                    }
                }
            }
            Err(err) => presets.unusable.push(err),
        }
        presets
    }

    /// Those of the program, then the user's by their names.
    pub fn iter(&self) -> impl Iterator<Item = &ExportPreset> {
        self.factory.iter().chain(self.own.values())
    }

    /// Why files of the user's cannot be used.
    pub fn unusable(&self) -> impl Iterator<Item = &Error> {
        self.unusable.iter()
    }

    /// Whether one is the user's.
    #[must_use]
    pub fn is_own(&self, name: &str) -> bool {
        self.own.contains_key(&name::slug(name))
    }

    /// The one of a name; capitals and punctuation do not matter.
    ///
    /// # Errors
    /// [`Error::UnknownPreset`], with those that there are.
    pub fn get(&self, name: &str) -> Result<&ExportPreset> {
        let key = name::slug(name);
        let found =
            self.own.get(&key).or_else(|| self.factory.iter().find(|known| name::slug(&known.name) == key));
        found.ok_or_else(|| {
            let names: Vec<_> = self.iter().map(|known| format!("`{}`", known.name)).collect();
            let mut advice = format!("those for exports are {}", names.join(", "));
            // It may be in a file that could not be read.
            for err in &self.unusable {
                advice.push_str(&format!("; {err}"));
            }
            Error::UnknownPreset { name: name.to_owned(), advice }
        })
    }

    /// Writes one into the user's folder, in the place of one of its name; gives its file.
    ///
    /// # Errors
    /// [`Error::Preset`], also for a name of the program's; [`Error::NoPresetFolder`], [`Error::Write`].
    pub fn save(&mut self, preset: &ExportPreset) -> Result<PathBuf> {
        let text = preset.to_json_text()?;
        let key = name::slug(&preset.name);
        if self.factory.iter().any(|known| name::slug(&known.name) == key) {
            let detail = "one that comes with the program has that name: give it another".to_owned();
            return Err(preset::unusable(format!("the export preset {:?}", preset.name), detail));
        }
        let folder = self.folder.as_ref().ok_or(Error::NoPresetFolder)?;
        let failed = |source| Error::Write { path: folder.clone(), source };
        std::fs::create_dir_all(folder).map_err(failed)?;
        let file = folder.join(folder::file_name(&key));
        whole_file::write(&file, text.as_bytes())?;
        self.own.insert(key, preset.clone());
        Ok(file)
    }

    /// Removes one of the user's; gives its file.
    ///
    /// # Errors
    /// [`Error::UnknownPreset`], [`Error::FactoryPreset`], [`Error::NoPresetFolder`], [`Error::Write`].
    pub fn remove(&mut self, name: &str) -> Result<PathBuf> {
        self.get(name)?;
        let key = name::slug(name);
        if !self.own.contains_key(&key) {
            return Err(Error::FactoryPreset { name: name.to_owned() });
        }
        let file = self.folder.as_ref().ok_or(Error::NoPresetFolder)?.join(folder::file_name(&key));
        std::fs::remove_file(&file).map_err(|source| Error::Write { path: file.clone(), source })?;
        self.own.remove(&key);
        Ok(file)
    }
}

fn read(file: &Path) -> Result<ExportPreset> {
    let bytes = crate::resources::read(file, MAX_BYTES)?;
    let failed = |detail: String| preset::unusable(format!("`{}`", file.display()), detail);
    let read: ExportPreset = serde_json::from_slice(&bytes).map_err(|err| failed(err.to_string()))?;
    read.check().map_err(failed)?;
    Ok(read)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_of_the_program_are_written_and_read_back() {
        let presets = ExportPresets::open(None);
        for preset in presets.iter() {
            let text = preset.to_json_text().unwrap();
            assert_eq!(serde_json::from_str::<ExportPreset>(&text).unwrap(), *preset);
            assert_eq!(presets.get(&preset.name.to_lowercase()).unwrap(), preset);
        }
        let err = presets.get("Unreal 5").unwrap_err().to_string();
        assert!(err.contains("`Unreal R16`"), "{err}");
    }

    #[test]
    fn sides_are_those_that_a_program_takes() {
        let presets = ExportPresets::open(None);
        let nearest = |name: &str, num| presets.get(name).unwrap().sizes.nearest(num);
        for (num, side) in [(8200, 8129), (8129, 8129), (1024, 1009), (100, 127)] {
            assert_eq!(nearest("Unreal R16", num), Some(side));
        }
        assert_eq!((nearest("Unity RAW", 20_000), nearest("Unity RAW", 2000)), (Some(4097), Some(1025)));
        assert_eq!(nearest("Blender PNG", 777), None);
    }

    /// What Unreal and Unity make of the first and the last sample, by the formulas of their own.
    #[test]
    fn what_is_to_be_typed_brings_heights_back() {
        let planned = PlannedExport {
            size: [1009, 1009],
            spacing_m: [2.0, 2.0],
            range_m: Some([-120.0, 640.0]),
            num_bytes: 0,
            byte_order: ByteOrder::Little,
            is_south_first: true,
        };
        let numbers = |line: &str| -> Vec<f64> {
            line.split([' ', ',', ';']).filter_map(|word| word.parse().ok()).collect()
        };
        let unreal = ExportProgram::Unreal.advice(&planned);
        let (scale, location_cm) = (numbers(&unreal[0]), numbers(&unreal[1])[0]);
        assert_eq!(scale[..2], [200.0, 200.0]);
        for (sample, height_m) in [(0.0, -120.0), (65_535.0, 640.0)] {
            let there_m = ((sample - 32_768.0) / 128.0 * scale[2] + location_cm) / 100.0;
            assert!((there_m - height_m).abs() < 0.01, "{sample}: {there_m}");
        }
        let unity = numbers(&ExportProgram::Unity.advice(&planned)[1]);
        let (size_y, position_y) = (unity[1], unity[3]);
        assert_eq!([unity[0], unity[2]], [2016.0, 2016.0]);
        for (sample, height_m) in [(0.0, -120.0), (65_535.0, 640.0)] {
            let there_m = position_y + sample / 65_536.0 * size_y;
            assert!((there_m - height_m).abs() < 0.001, "{sample}: {there_m}");
        }
    }

    #[test]
    fn what_is_to_be_typed_says_how_the_file_begins() {
        let planned = PlannedExport {
            size: [33, 33],
            spacing_m: [1.0, 1.0],
            range_m: Some([0.0, 1.0]),
            num_bytes: 0,
            byte_order: ByteOrder::Big,
            is_south_first: false,
        };
        let of = |program: ExportProgram| program.advice(&planned).join("\n");
        assert!(of(ExportProgram::Unity).contains("Byte Order Mac, Flip Vertically on"));
        assert!(of(ExportProgram::Hterrain).contains("big endian"));
    }

    #[test]
    fn the_user_s_own_are_kept_in_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("exports");
        let mut presets = ExportPresets::open(Some(path.clone()));
        let mut mine = presets.get("Unreal R16").unwrap().clone();
        assert!(presets.save(&mine).is_err(), "it is the program's");
        mine.name = "Our island".to_owned();
        mine.range = ExportRange::Own([0.0, 900.0]);
        presets.save(&mine).unwrap();
        std::fs::write(path.join("bad.json"), "{\"export_preset\": \"bad\", \"ending\": \"doc\"}").unwrap();
        let mut again = ExportPresets::open(Some(path));
        assert_eq!(again.get("our island").unwrap(), &mine);
        let wrong: Vec<_> = again.unusable().map(ToString::to_string).collect();
        assert!(wrong.len() == 1 && wrong[0].contains("bad.json"), "{wrong:?}");
        assert!(!again.remove("Our island").unwrap().exists());
        assert!(again.get("Our island").is_err());
        assert!(matches!(again.remove("Unity RAW"), Err(Error::FactoryPreset { .. })));
        let wrong = ExportPreset { range: ExportRange::Own([5.0, 5.0]), ..mine };
        assert!(presets.save(&wrong).is_err());
    }
}
