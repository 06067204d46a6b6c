//! The presets that come with the program.

use std::collections::BTreeMap;

use super::{KnownPreset, Preset, PresetOrigin, name};

/// Each file of `assets/presets`; a test holds the list against the folder.
macro_rules! files {
    ($($file:literal),+ $(,)?) => {
        [$(($file, include_str!(concat!("../../../../assets/presets/", $file)))),+]
    };
}

const FILES: [(&str, &str); 51] = files![
    "alpine-ridge.json",
    "badlands.json",
    "barchan-field.json",
    "boulders.json",
    "braided-river.json",
    "buttes.json",
    "canyonlands.json",
    "cinder-cones.json",
    "cliff-rock.json",
    "cobbles.json",
    "coral-reef.json",
    "cracked-ground.json",
    "crater-field.json",
    "crisp-ridges.json",
    "drumlins.json",
    "dunes.json",
    "eroded-hills.json",
    "even-out.json",
    "fjell.json",
    "flatten.json",
    "glacial-valley.json",
    "gorge.json",
    "gravel.json",
    "jagged-peaks.json",
    "karst-towers.json",
    "karst.json",
    "lava-flow.json",
    "long-rain.json",
    "meadow.json",
    "mesa.json",
    "mid-ocean-ridge.json",
    "moor.json",
    "plateau-edge.json",
    "pull-ground.json",
    "rain-gullies.json",
    "rice-paddies.json",
    "road-ramp.json",
    "rolling-hills.json",
    "salt-flat.json",
    "sand-ripples.json",
    "scree-slopes.json",
    "sea-floor.json",
    "sharp-peak.json",
    "slump-to-talus.json",
    "snow-drift.json",
    "soft-hill.json",
    "soften.json",
    "terraced-slope.json",
    "trench.json",
    "volcano.json",
    "wet-finger.json",
];

/// All of them, by what tells them apart.
pub(super) fn presets() -> BTreeMap<String, KnownPreset> {
    let read = |(file, text): (&str, &str)| match Preset::from_json_text(text) {
        Ok(preset) => Some((name::slug(&preset.name), KnownPreset { preset, origin: PresetOrigin::Factory })),
        Err(err) => {
            // A test reads them all, so this does not happen.
            tracing::error!("the preset {file} that comes with the program is left out: {err}");
            None
        }
    };
    FILES.into_iter().filter_map(read).collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::folder;
    use super::*;

    #[test]
    fn the_list_is_the_folder() {
        let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/presets");
        let files = folder::files(&assets).unwrap();
        let names: Vec<_> = files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(FILES.map(|(file, _)| file).as_slice(), names);
        for file in &files {
            // Also: each is called as its preset is.
            let preset = folder::read(file).unwrap();
            assert!(!preset.description.is_empty() && !preset.tags.is_empty(), "{}", file.display());
            assert_eq!(preset.thumbnail, None, "{}: a picture burdens the program", file.display());
        }
    }

    #[test]
    fn all_of_them_are_there() {
        assert_eq!(presets().len(), FILES.len());
    }
}
