//! Reading and writing heights, as files of other programs hold them.

use std::path::Path;
use std::sync::Arc;

use axum::Json;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use orogeny_engine::{ExportRequest, ExportSource, ImportRequest, LayerReference, Quiet};
use serde::Deserialize;
use serde_json::{Value, json};

use super::{Asked, Named, Service, author, bad_request};
use crate::reply::{Failure, Refusal, fault};
use crate::room::Room;

/// How heights are coded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Coding {
    #[default]
    R32,
    R16,
    Png,
    Npy,
}

impl Coding {
    /// The ending of such files.
    const fn ending(self) -> &'static str {
        match self {
            Self::R32 => "r32",
            Self::R16 => "r16",
            Self::Png => "png",
            Self::Npy => "npy",
        }
    }

    const fn media_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::R32 | Self::R16 | Self::Npy => "application/octet-stream",
        }
    }

    /// Whether its samples lie between two heights.
    const fn is_ranged(self) -> bool {
        matches!(self, Self::R16 | Self::Png)
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Read {
    #[serde(default)]
    x: Option<f64>,
    #[serde(default)]
    z: Option<f64>,
    #[serde(default)]
    width: Option<f64>,
    #[serde(default)]
    depth: Option<f64>,
    #[serde(default)]
    level: u8,
    #[serde(default)]
    format: Coding,
    #[serde(default)]
    low: Option<f64>,
    #[serde(default)]
    high: Option<f64>,
    #[serde(default)]
    layer: Option<String>,
    #[serde(default)]
    mask: Option<String>,
    #[serde(default)]
    selection: bool,
}

pub(super) async fn read(
    State(shared): Service,
    Named(room): Named,
    Asked(asked): Asked<Read>,
) -> Result<(HeaderMap, Vec<u8>), Failure> {
    let status = room.status().await?;
    let (grid, top) = (status.grid, status.root.0.level);
    if asked.level > top {
        return Err(bad_request(
            "unknown_level",
            format!("there is no level {}: the coarsest is {top}", asked.level),
        ));
    }
    let spacing_m = grid.spacing_m();
    let [width_m, depth_m] = [grid.width(), grid.depth()].map(|side| f64::from(side) * spacing_m);
    let (x_m, z_m) = (asked.x.unwrap_or(0.0), asked.z.unwrap_or(0.0));
    let region_m = [x_m, z_m, asked.width.unwrap_or(width_m - x_m), asked.depth.unwrap_or(depth_m - z_m)];
    let region = grid.samples_in_region(region_m).map_err(|err| bad_request("region", err.to_string()))?;
    let side = |samples: u32| (u64::from(samples) >> asked.level) + 1;
    let inside = region.intersection(&grid.bounds());
    let (num_samples, limit) =
        (side(inside.width()) * side(inside.depth()), shared.limits.samples_per_answer);
    if num_samples > limit {
        let message =
            format!("the region has about {num_samples} samples: ask for a smaller one, or a coarser level");
        return Err(Refusal::new("too_many_samples", message)
            .with_limit(limit)
            .with(StatusCode::PAYLOAD_TOO_LARGE));
    }
    let bounds = status.root.1.bounds;
    let (heights_m, shares) = ([bounds.min_m.into(), bounds.max_m.into()], [0.0, 1.0]);
    let (source, usual_range) = match (asked.layer, asked.mask, asked.selection) {
        (None, None, false) => (ExportSource::Composite, heights_m),
        (Some(name), None, false) => (ExportSource::Layer(LayerReference::Name(name)), heights_m),
        (None, Some(name), false) => (ExportSource::Mask(LayerReference::Name(name)), shares),
        (None, None, true) => (ExportSource::Selection, shares),
        _ => {
            return Err(bad_request(
                "query",
                "only one of `layer`, `mask` and `selection` can be read".to_owned(),
            ));
        }
    };
    let range_m = range(asked.format, asked.low, asked.high, Some(usual_range))?;
    // Each reader has the terrain open for itself, so that none of them waits for a stroke, nor a stroke for them.
    let readers = Arc::clone(&shared.readers);
    let place = readers.acquire_owned().await.map_err(fault)?;
    let coding = asked.format;
    let read = tokio::task::spawn_blocking(move || {
        // Whoever asked may hang up; the place is taken for as long as it is worked on.
        let _place = place;
        export(&room, coding, source, region_m, asked.level, range_m)
    });
    let (summary, bytes) = read.await.map_err(fault)??;
    let mut headers = HeaderMap::new();
    headers.insert(CONTENT_TYPE, HeaderValue::from_static(coding.media_type()));
    let mut tell = |name: &'static str, value: f64| {
        if let Ok(value) = HeaderValue::from_str(&value.to_string()) {
            headers.insert(HeaderName::from_static(name), value);
        }
    };
    tell("orogeny-x", summary.at_m[0]);
    tell("orogeny-z", summary.at_m[1]);
    tell("orogeny-width", summary.width.into());
    tell("orogeny-depth", summary.depth.into());
    tell("orogeny-spacing", summary.spacing_m);
    if let Some((low, high)) = range_m {
        tell("orogeny-low", low);
        tell("orogeny-high", high);
    }
    Ok((headers, bytes))
}

fn export(
    room: &Room,
    coding: Coding,
    source: ExportSource,
    region_m: [f64; 4],
    level: u8,
    range_m: Option<(f64, f64)>,
) -> Result<(orogeny_engine::ExportSummary, Vec<u8>), Failure> {
    let folder = tempfile::tempdir().map_err(fault)?;
    let file = folder.path().join("heights").with_extension(coding.ending());
    let mut request = ExportRequest::new(&file);
    request.options.range_m = range_m;
    (request.source, request.region_m, request.level) = (source, Some(region_m), level);
    let summary = room.open_to_read()?.export(&request, &mut Quiet);
    let summary = summary.map_err(|err| without_folder(err.into(), folder.path()))?;
    let bytes = std::fs::read(&file).map_err(fault)?;
    Ok((summary, bytes))
}

/// Files on the way are no one's business.
fn without_folder(Failure(status, mut refusal): Failure, folder: &Path) -> Failure {
    refusal.message = refusal.message.replace(&format!("{}/", folder.display()), "");
    Failure(status, refusal)
}

/// The heights of the least and the greatest sample, for codings that have them.
fn range(
    coding: Coding,
    low: Option<f64>,
    high: Option<f64>,
    usual: Option<[f64; 2]>,
) -> Result<Option<(f64, f64)>, Failure> {
    if !coding.is_ranged() {
        return match (low, high) {
            (None, None) => Ok(None),
            _ => Err(bad_request(
                "range",
                "samples of this format are metres: leave `low` and `high` out".to_owned(),
            )),
        };
    }
    let missing =
        || bad_request("range", "`low` and `high` are missing: the heights of 0 and of 65,535".to_owned());
    let low = low.or(usual.map(|[low, _]| low)).ok_or_else(missing)?;
    let high = high.or(usual.map(|[_, high]| high)).ok_or_else(missing)?;
    // A flat terrain has a range all the same.
    let high = if high == low { low + 1.0 } else { high };
    if !(low.is_finite() && high.is_finite() && low < high) {
        return Err(bad_request(
            "range",
            format!("`low` is {low} and `high` {high}: `low` must be below `high`"),
        ));
    }
    Ok(Some((low, high)))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Write {
    #[serde(default)]
    x: f64,
    #[serde(default)]
    z: f64,
    #[serde(default)]
    width: Option<u32>,
    #[serde(default)]
    depth: Option<u32>,
    #[serde(default)]
    format: Coding,
    #[serde(default)]
    low: Option<f64>,
    #[serde(default)]
    high: Option<f64>,
    #[serde(default)]
    layer: Option<String>,
    #[serde(default)]
    author: Option<String>,
}

pub(super) async fn write(
    Named(room): Named,
    Asked(asked): Asked<Write>,
    body: Bytes,
) -> Result<Json<Value>, Failure> {
    let author = author(asked.author)?;
    let range_m = range(asked.format, asked.low, asked.high, None)?;
    let folder = tempfile::tempdir().map_err(fault)?;
    let file = folder.path().join("heights").with_extension(asked.format.ending());
    let mut request = ImportRequest::new(&file);
    request.options.range_m = range_m;
    if matches!(asked.format, Coding::R32 | Coding::R16) {
        let (Some(width), Some(depth)) = (asked.width, asked.depth) else {
            let message =
                "`width` and `depth` are missing: the samples along x and z of raw heights".to_owned();
            return Err(bad_request("size", message));
        };
        request.options.size = Some((width, depth));
    }
    request.options.spacing_m = Some(room.status().await?.grid.spacing_m());
    (request.layer, request.at_m) = (asked.layer, [asked.x, asked.z]);
    let path = file.clone();
    let written = tokio::task::spawn_blocking(move || std::fs::write(&path, &body));
    written.await.map_err(fault)?.map_err(fault)?;
    let done = room.ask(&author, "import".to_owned(), |participant| participant.import(request)).await;
    let done = done.map_err(|err| without_folder(err, folder.path()))?;
    Ok(Json(json!({ "revision": done.revision, "rect": done.rect_m, "entries": done.entries })))
}
