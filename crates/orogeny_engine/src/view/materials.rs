//! A material set with its textures: made by the program, or from pictures beside the set's file.

use std::io::Cursor;
use std::path::{Path, PathBuf};

use orogeny_geomip::material::{
    DEFAULT_FACTORY_SET, LayerSurface, MaterialSet, ResolvedSet, SURFACE_SIZE, SurfaceFiles, SurfaceTexture,
    factory_set, factory_sets,
};
use rayon::prelude::*;

use crate::resources::read;
use crate::{Error, Result};

/// The longest side of a texture's picture, pixels.
const MAX_SIDE_PX: u32 = 8192;
/// The longest file of a set, and of a texture's picture, bytes.
const MAX_FILE_BYTES: u64 = 256 << 20;
/// What a surface is like whose pictures do not say it: as rough as dry ground.
const ROUGHNESS: u8 = 217;
/// A normal straight up.
const UPRIGHT: [u8; 2] = [128, 128];

/// A set that comes with the program, for people.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct MaterialDescription {
    /// What it is asked for by.
    pub name: String,
    /// What it is for.
    pub description: String,
    /// Its layers, the lowest first.
    pub layers: Vec<String>,
}

/// The sets that come with the program.
///
/// # Errors
/// [`Error::Material`] if one of them could not be read, which a test rules out.
pub fn material_descriptions() -> Result<Vec<MaterialDescription>> {
    let describe = |name: &str| {
        let MaterialSet { description, layers, .. } = factory_set(name)?;
        let layers = layers.into_iter().map(|layer| layer.name).collect();
        Ok(MaterialDescription { name: name.to_owned(), description, layers })
    };
    factory_sets().map(describe).collect()
}

/// Which materials a picture shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Materials {
    /// A set that comes with the program.
    Factory(String),
    /// A set of the user's.
    File(PathBuf),
}

impl Default for Materials {
    fn default() -> Self {
        Self::Factory(DEFAULT_FACTORY_SET.to_owned())
    }
}

impl Materials {
    /// From what a user types: the name of a set that comes with the program, or the path of a set's JSON file.
    #[must_use]
    pub fn from_name(name: &str) -> Self {
        // A name that is no path is that of a set, even of one that there is not: the error then says which there are.
        let is_path = name.contains(['.', '/', '\\']);
        if is_path { Self::File(PathBuf::from(name)) } else { Self::Factory(name.to_owned()) }
    }

    /// The set, as JSON that a user may start a set of their own from.
    ///
    /// # Errors
    /// When there is no such set, or its file cannot be read.
    pub fn to_json(&self) -> Result<String> {
        Ok(self.load()?.0.to_json()?)
    }

    /// The set, and the folder that its pictures are in.
    fn load(&self) -> Result<(MaterialSet, PathBuf)> {
        match self {
            Self::Factory(name) => Ok((factory_set(name)?, PathBuf::new())),
            Self::File(path) => {
                let bytes = read(path, MAX_FILE_BYTES)?;
                let text = String::from_utf8_lossy(&bytes);
                let set = MaterialSet::from_json(&text)
                    .map_err(|source| Error::MaterialFile { path: path.clone(), source: Box::new(source) })?;
                Ok((set, path.parent().unwrap_or(Path::new("")).to_owned()))
            }
        }
    }
}

/// The rules for a terrain of these heights, and each layer's texture with all its levels.
pub(super) fn resolve(
    materials: &Materials,
    [low_m, high_m]: [f32; 2],
) -> Result<(ResolvedSet, Vec<Vec<SurfaceTexture>>)> {
    let (set, folder) = materials.load()?;
    let resolved = set.resolved(low_m, high_m)?;
    let texture = |surface: &LayerSurface| -> Result<Vec<SurfaceTexture>> {
        let texture = match surface {
            LayerSurface::Procedural(surface) => {
                SurfaceTexture::generate(surface.surface, SURFACE_SIZE, surface.seed, surface.tint)?
            }
            LayerSurface::Files(files) => from_files(files, &folder)?,
        };
        let mips = texture.mips();
        Ok(std::iter::once(texture).chain(mips).collect())
    };
    let layers = set.layers.par_iter().map(|layer| texture(&layer.surface)).collect::<Result<_>>()?;
    Ok((resolved, layers))
}

fn from_files(files: &SurfaceFiles, folder: &Path) -> Result<SurfaceTexture> {
    let square = |name: &String| Rgba::read(&folder.join(name)).map(|picture| picture.square(SURFACE_SIZE));
    let mut albedo_height = square(&files.albedo)?;
    let has_height = albedo_height.as_chunks::<4>().0.iter().any(|[.., alpha]| *alpha != u8::MAX);
    if !has_height {
        // Dark is deep: cracks and joints mostly are.
        for [red, green, blue, alpha] in albedo_height.as_chunks_mut::<4>().0 {
            *alpha = ((2 * u16::from(*red) + 5 * u16::from(*green) + u16::from(*blue)) / 8) as u8;
        }
    }
    let normals = files.normal.as_ref().map(square).transpose()?;
    let roughness = files.roughness.as_ref().map(square).transpose()?;
    let [x, y] = UPRIGHT;
    let mut normal_roughness = [x, y, ROUGHNESS, u8::MAX].repeat(albedo_height.len() / 4);
    let texels = normal_roughness.as_chunks_mut::<4>().0;
    if let Some(normals) = &normals {
        for (to, [x, y, ..]) in texels.iter_mut().zip(normals.as_chunks::<4>().0) {
            (to[0], to[1]) = (*x, *y);
        }
    }
    if let Some(roughness) = &roughness {
        for (to, [rough, ..]) in texels.iter_mut().zip(roughness.as_chunks::<4>().0) {
            to[2] = *rough;
        }
    }
    Ok(SurfaceTexture { size: SURFACE_SIZE, albedo_height, normal_roughness })
}

/// A picture of four channels.
struct Rgba {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
}

impl Rgba {
    fn read(path: &Path) -> Result<Self> {
        let wrong = |detail: String| Error::Texture { path: path.to_owned(), detail };
        let bytes = read(path, MAX_FILE_BYTES)?;
        let mut decoder = png::Decoder::new(Cursor::new(bytes));
        decoder
            .set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
        let mut reader = decoder.read_info().map_err(|err| wrong(err.to_string()))?;
        let (width, height) = (reader.info().width, reader.info().height);
        if width > MAX_SIDE_PX || height > MAX_SIDE_PX {
            return Err(wrong(format!("it has {width} x {height} pixels; a side may have {MAX_SIDE_PX}")));
        }
        let size = reader.output_buffer_size().ok_or_else(|| wrong("it is too large".to_owned()))?;
        let mut data = vec![0; size];
        let frame = reader.next_frame(&mut data).map_err(|err| wrong(err.to_string()))?;
        let channels = frame.color_type.samples();
        let texel = |texel: &[u8]| match texel {
            [grey, alpha] => [*grey, *grey, *grey, *alpha],
            [red, green, blue, alpha] => [*red, *green, *blue, *alpha],
            _ => [0, 0, 0, u8::MAX],
        };
        Ok(Self { width, height, texels: data.chunks_exact(channels).map(texel).collect() })
    }

    /// Made square: each texel is the mean of those that it covers, or the one that it lies in.
    fn square(&self, size: u32) -> Vec<u8> {
        let range = |place: u32, num: u32| {
            let at = |place: u32| (u64::from(place) * u64::from(num) / u64::from(size)) as u32;
            at(place)..at(place + 1).max(at(place) + 1)
        };
        let mean = |x: u32, z: u32| {
            let (columns, rows) = (range(x, self.width), range(z, self.height));
            let (mut sums, mut num) = ([0_u32; 4], 0);
            for (row, column) in rows.flat_map(|row| columns.clone().map(move |column| (row, column))) {
                let Some(texel) = self.texels.get((row * self.width + column) as usize) else { continue };
                for (sum, channel) in sums.iter_mut().zip(texel) {
                    *sum += u32::from(*channel);
                }
                num += 1;
            }
            sums.map(|sum| (sum / num.max(1)) as u8)
        };
        (0..size).flat_map(|z| (0..size).flat_map(move |x| mean(x, z))).collect()
    }
}
