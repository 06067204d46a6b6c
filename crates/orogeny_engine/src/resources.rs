//! Data from outside that a brush names: read, kept with the terrain under the hash of its content, made ready for the kernels.

use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use orogeny_brush::{CustomProgram, Resources};
use orogeny_field::{Bitmap, Brush, DataSource, Gate};
use orogeny_shaders::custom::compile_custom;
use orogeny_store::{BlobHash, Recording, Store};

use crate::{Error, Result};

/// What ends the name of a file of heights that a brush brings with it; pictures and texts are told by their content.
pub(crate) const HEIGHTS_ENDING: &str = "npy";
/// The most bytes of a picture for a brush.
const MAX_PICTURE_BYTES: u64 = 64 << 20;
/// The most bytes of a custom brush's text.
const MAX_TEXT_BYTES: u64 = 1 << 20;

/// Reads what a brush names, keeps it with the operation that is recorded next, and gives the brush that names it by its
/// content.
///
/// # Errors
/// [`Error::Read`], [`Error::Format`], [`Error::Shader`] or [`Error::Store`], naming the file.
pub(crate) fn load(brush: &Brush, recording: &mut Recording<'_>) -> Result<(Brush, Resources)> {
    let mut brush = brush.clone();
    let mut resources = Resources::default();
    let alpha = brush.alpha.as_mut().map(|alpha| &mut alpha.source);
    resources.alpha = picture(alpha, recording)?;
    resources.gate_image = picture(image_of(brush.gate.as_deref_mut()), recording)?;
    resources.hardness_image = picture(image_of(brush.hardness.as_deref_mut()), recording)?;
    resources.roughness_image = picture(image_of(brush.noise.roughness.as_deref_mut()), recording)?;
    if let Some(custom) = &mut brush.custom {
        let data = Data::of(&custom.source, MAX_TEXT_BYTES, recording)?;
        resources.custom = Some(Arc::new(compile(data.bytes, &data.name, data.hash.clone())?));
        custom.source = DataSource::Blake3(data.hash);
    }
    Ok((brush, resources))
}

/// Reads the picture of a source, which names its content then.
fn picture(source: Option<&mut DataSource>, recording: &mut Recording<'_>) -> Result<Option<Arc<Bitmap>>> {
    let Some(source) = source else { return Ok(None) };
    let data = Data::of(source, MAX_PICTURE_BYTES, recording)?;
    let picture = orogeny_formats::read_bitmap(&data.bytes, &data.name)?;
    let bitmap = Bitmap::new(picture.width(), picture.height(), picture.into_values())?;
    *source = DataSource::Blake3(data.hash);
    Ok(Some(Arc::new(bitmap)))
}

/// Reads the picture of a gate that belongs to no brush, which names its content then.
///
/// # Errors
/// As [`load`].
pub(crate) fn keep_image(gate: &mut Gate, recording: &mut Recording<'_>) -> Result<()> {
    picture(image_of(Some(gate)), recording).map(drop)
}

pub(crate) fn image_of(gate: Option<&mut Gate>) -> Option<&mut DataSource> {
    Some(&mut gate?.image.as_mut()?.source)
}

/// Everything that a brush names.
pub(crate) fn sources(brush: &mut Brush) -> impl Iterator<Item = &mut DataSource> {
    let all = [
        brush.alpha.as_mut().map(|alpha| &mut alpha.source),
        brush.custom.as_mut().map(|custom| &mut custom.source),
        brush.cloning.source.data.as_mut(),
        image_of(brush.gate.as_deref_mut()),
        image_of(brush.hardness.as_deref_mut()),
        image_of(brush.noise.roughness.as_deref_mut()),
    ];
    all.into_iter().flatten()
}

/// Compiles the text of a custom brush.
pub(crate) fn compile(bytes: Vec<u8>, name: &str, identity: String) -> Result<CustomProgram> {
    let text = String::from_utf8(bytes).map_err(|err| Error::Operation {
        place: format!("the custom brush `{name}`"),
        detail: format!("it is no UTF-8 text from byte {} on", err.utf8_error().valid_up_to()),
    })?;
    Ok(CustomProgram { brush: compile_custom(&text, name)?, identity })
}

/// Makes relative file names relative to a folder.
pub(crate) fn resolve_files(sources: Vec<&mut DataSource>, folder: &Path) {
    for source in sources {
        if let DataSource::File(file) = source {
            let joined = folder.join(&*file).to_string_lossy().into_owned();
            *file = joined;
        }
    }
}

/// Makes file names that lie below a folder absolute, and refuses all others.
pub(crate) fn keep_files_below(sources: Vec<&mut DataSource>, folder: Option<&Path>) -> Result<()> {
    for source in sources {
        let DataSource::File(file) = source else { continue };
        let found = folder.and_then(|folder| {
            let folder = folder.canonicalize().ok()?;
            let found = folder.join(&*file).canonicalize().ok()?;
            (found.starts_with(&folder) && found.is_file()).then_some(found)
        });
        let Some(found) = found else {
            return Err(Error::FileNotAllowed { file: std::mem::take(file) });
        };
        *file = found.to_string_lossy().into_owned();
    }
    Ok(())
}

/// Writes what a recorded operation names into files of a folder, and lets it name them: for doing it again on another terrain.
///
/// # Errors
/// [`Error::Store`] for data that is not there, [`Error::Write`].
pub(crate) fn unpack(sources: Vec<&mut DataSource>, source: &Store, folder: &Path) -> Result<()> {
    for data in sources {
        let DataSource::Blake3(name) = data else { continue };
        let path = folder.join(&*name).with_extension(HEIGHTS_ENDING);
        let failed = |source| Error::Write { path: path.clone(), source };
        let mut file = std::fs::File::create(&path).map_err(failed)?;
        source.read_blob(&hash_of(name)?, &mut file)?;
        file.sync_all().map_err(failed)?;
        *data = DataSource::File(path.to_string_lossy().into_owned());
    }
    Ok(())
}

pub(crate) fn hash_of(name: &str) -> Result<BlobHash> {
    BlobHash::from_hex(name).ok_or_else(|| Error::Operation {
        place: "the operation".to_owned(),
        detail: format!("`blake3` is `{name}`, it must be 64 hexadecimal digits"),
    })
}

/// Bytes, where they are from, and the hash of their content.
struct Data {
    bytes: Vec<u8>,
    name: String,
    hash: String,
}

impl Data {
    fn of(source: &DataSource, limit: u64, recording: &mut Recording<'_>) -> Result<Self> {
        match source {
            DataSource::File(file) => {
                let bytes = read(Path::new(file), limit)?;
                let (bytes, hash) = recording.with_transaction(move |transaction| {
                    let hash = transaction.keep_blob(&mut bytes.as_slice())?;
                    Ok((bytes, hash))
                })?;
                Ok(Self { bytes, name: file.clone(), hash: hash.to_string() })
            }
            DataSource::Blake3(name) => {
                let hash = hash_of(name)?;
                let size =
                    recording.with_transaction(move |transaction| transaction.keep_known_blob(&hash))?;
                if size > limit {
                    return Err(Error::TooLong { path: PathBuf::from(name), limit });
                }
                let bytes = recording.with_transaction(move |transaction| {
                    let mut bytes = Vec::new();
                    transaction.read_blob(&hash, &mut bytes)?;
                    Ok(bytes)
                })?;
                Ok(Self { bytes, name: name.clone(), hash: hash.to_string() })
            }
        }
    }
}

/// The bytes of data that the terrain keeps, or of a file.
///
/// # Errors
/// [`Error::TooLong`], [`Error::Store`], [`Error::Read`].
pub(crate) fn kept(source: &DataSource, limit: u64, recording: &mut Recording<'_>) -> Result<Vec<u8>> {
    Ok(Data::of(source, limit, recording)?.bytes)
}

/// Reads a file that is not too long.
pub(crate) fn read(path: &Path, limit: u64) -> Result<Vec<u8>> {
    let failed = |source| Error::Read { path: path.to_owned(), source };
    let file = std::fs::File::open(path).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > limit {
        return Err(Error::TooLong { path: PathBuf::from(path), limit });
    }
    Ok(bytes)
}
