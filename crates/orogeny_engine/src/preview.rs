//! A raster before it is imported: its size, its heights, and a picture of it.

use std::path::Path;

use orogeny_formats::{Format, ImportOptions, SampleType};

use crate::ground::Ground;
use crate::map::shaded;
use crate::progress::report;
use crate::{Error, Observer, Picture, Result};

/// What an import would read.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportPreview {
    /// What the file is read as.
    pub format: Format,
    /// How it stores a sample.
    pub sample: SampleType,
    /// Samples from west to east.
    pub width: u32,
    /// Rows from north to south.
    pub depth: u32,
    /// Metres between samples; `None` where neither the file nor the options say.
    pub spacing_m: Option<f64>,
    /// The lowest and the highest height, metres.
    pub range_m: [f32; 2],
    /// The EPSG code of the file's coordinates, where it has one.
    pub epsg: Option<u16>,
    /// What is resampled, filled, assumed or left out, for people.
    pub notices: Vec<String>,
    /// It from above, north at the top, lit from the north-west.
    pub picture: Picture,
}

impl ImportPreview {
    /// Reads a file as an import would, with a picture of at most so many pixels each way.
    ///
    /// # Errors
    /// [`Error::Format`] where it cannot be read so; [`Error::PictureSize`]; [`Error::Cancelled`].
    pub fn read(
        path: &Path,
        options: &ImportOptions,
        max_side_px: u32,
        observer: &mut dyn Observer,
    ) -> Result<Self> {
        crate::picture::check_size([max_side_px; 2])?;
        let mut raster = orogeny_formats::open(path, options).map_err(Error::from)?;
        let info = raster.info().clone();
        let (width, depth) = (info.width, info.depth);
        let samples_per_px = width.max(depth).div_ceil(max_side_px).max(1);
        let [width_px, height_px] = [width, depth].map(|side| side.div_ceil(samples_per_px));
        let mut sums = vec![(0.0_f64, 0_u32); width_px as usize * height_px as usize];
        let mut row = vec![0.0_f32; width as usize];
        let mut range_m = [f32::INFINITY, f32::NEG_INFINITY];
        let mut num_rows = 0;
        while raster.read_rows(&mut row)? > 0 {
            let start = (num_rows / samples_per_px * width_px) as usize;
            let pixels = sums.get_mut(start..).unwrap_or_default();
            for (samples, (sum, count)) in row.chunks(samples_per_px as usize).zip(pixels) {
                for height_m in samples {
                    *sum += f64::from(*height_m);
                    *count += 1;
                    range_m = [range_m[0].min(*height_m), range_m[1].max(*height_m)];
                }
            }
            num_rows += 1;
            report(observer, "looking", num_rows.into(), depth.into())?;
        }
        let heights = sums.into_iter().map(|(sum, count)| (sum / f64::from(count.max(1))) as f32).collect();
        let spacing_m = (info.spacing_m.unwrap_or(1.0) * f64::from(samples_per_px)) as f32;
        let ground = Ground { width: width_px as usize, heights, spacing_m };
        let rgb = shaded(&ground, ground.range_m());
        Ok(Self {
            format: info.format,
            sample: info.sample,
            width,
            depth,
            spacing_m: info.spacing_m,
            range_m,
            epsg: info.georeference.and_then(|georeference| georeference.epsg),
            notices: info.notices,
            picture: Picture { width_px, height_px, rgb },
        })
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use orogeny_formats::{ExportOptions, create};

    use super::*;
    use crate::{Progress, Quiet};

    /// One bright hill in the north-east of 300 x 200 samples.
    fn file(folder: &Path) -> std::path::PathBuf {
        let path = folder.join("h.npy");
        let mut file = create(&path, &ExportOptions::default(), 300, 200).unwrap();
        for z in 0..200 {
            let row: Vec<f32> = (0..300).map(|x| if x > 250 && z < 40 { 90.0 } else { -5.0 }).collect();
            file.write_rows(&row).unwrap();
        }
        file.finish().unwrap();
        path
    }

    #[test]
    fn north_is_at_the_top_and_the_heights_are_those_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path());
        let preview = ImportPreview::read(&path, &ImportOptions::default(), 64, &mut Quiet).unwrap();
        assert_eq!((preview.width, preview.depth, preview.range_m), (300, 200, [-5.0, 90.0]));
        let Picture { width_px, height_px, rgb } = &preview.picture;
        assert_eq!((*width_px, *height_px, rgb.len()), (60, 40, 60 * 40 * 3));
        let pixel = |x: usize, y: usize| rgb[3 * (60 * y + x)..][..3].to_vec();
        assert_ne!(pixel(55, 3), pixel(3, 3));
        assert_eq!(pixel(55, 36), pixel(3, 36));
    }

    #[test]
    fn what_cannot_be_read_says_why_and_reading_can_be_given_up() {
        struct Stop;
        impl Observer for Stop {
            fn progress(&mut self, _progress: Progress) -> ControlFlow<()> {
                ControlFlow::Break(())
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path());
        let given_up = ImportPreview::read(&path, &ImportOptions::default(), 64, &mut Stop);
        assert!(matches!(given_up, Err(Error::Cancelled)));
        let raw = folder.path().join("h.raw");
        std::fs::copy(&path, &raw).unwrap();
        let err = ImportPreview::read(&raw, &ImportOptions::default(), 64, &mut Quiet).unwrap_err();
        assert!(err.to_string().contains("give width"), "{err}");
    }
}
