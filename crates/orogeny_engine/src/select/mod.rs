//! Changes of the selection: which pages may change (`extent`, pure), what a shape selects (`shape`), and what becomes of the
//! selection, block by block.
//!
//! A block is worked out of the selection before the operation and of the shape, over its samples and as many around them as count.
//! Both are mirrored at the terrain's border, as all that is given is. What comes of a sample depends on those around it alone, so neither
//! blocks nor pages change a bit.

mod extent;
mod shape;
#[cfg(test)]
mod tests;

use orogeny_field::{Page, PageKey, Plane, SampleRect, SelectLengths, Selecting, TerrainGrid, mirrored};
use orogeny_reference::select::{combine, feather, grow};
use orogeny_store::{Layer, Recording};

use crate::Result;
use crate::composite::{self, Compositor, Look, Node, RecordingPages, Stored};
use crate::progress::report;
use crate::terrain::find_layer;
use crate::{LayerReference, Observer, resources};
use extent::{Pages, blocks};
use shape::Shape;

/// What is around a block is looked at as well, so it is so many times as long as what is around it, within limits.
const MARGINS_A_SIDE: u32 = 4;
/// The shortest side of a block, in samples.
const MIN_BLOCK_SIDE: u32 = 1024;
/// The longest side of a block. With the widest margins it is worked out of 8,192 x 8,192 samples: 256 MiB a plane, two or three
/// of which are in memory at once.
const MAX_BLOCK_SIDE: u32 = 2048;

/// A change of the selection, planned on a terrain.
struct Plan {
    selecting: Selecting,
    shape: Shape,
    lengths: SelectLengths,
    selection: Stored,
    /// Pages that are worked out together.
    blocks: Vec<Vec<PageKey>>,
}

/// The pages that fields have.
struct Painted {
    selection: Vec<PageKey>,
    /// Of the layer that is named.
    mask: Vec<PageKey>,
}

/// What is looked at: the terrain as it was before the operation, and its visible layers.
struct Ground<'a, 'pages> {
    look: Look<'pages>,
    compositor: &'a mut Compositor,
    nodes: &'a [Node],
}

/// Changes the selection. Gives the operation as it is recorded, and the pages that changed.
///
/// # Errors
/// As [`Plan::new`]; [`crate::Error::UnknownLayer`]; what a gate's picture cannot be read for; [`crate::Error::Cancelled`].
pub(crate) fn run(
    selecting: &Selecting,
    grid: TerrainGrid,
    recording: &mut Recording<'_>,
    compositor: &mut Compositor,
    observer: &mut dyn Observer,
) -> Result<(Selecting, Vec<PageKey>)> {
    let mut selecting = selecting.clone();
    if let Some(layer) = selecting.layer_mut() {
        *layer = LayerReference::Id(find_layer(recording.layers(), Some(layer))?.id);
    }
    if let Some(gate) = selecting.gate_mut() {
        resources::keep_image(gate, recording)?;
        orogeny_brush::resolve_gate(gate);
    }
    let selection = composite::selection(recording.selection()?);
    let layers = recording.layers().to_vec();
    let masked = selecting.layer().map(|layer| find_layer(&layers, Some(layer))).transpose()?;
    let painted = Painted {
        selection: recording.page_keys(selection.field)?,
        mask: masked.and_then(|layer| layer.mask).map_or(Ok(Vec::new()), |mask| recording.page_keys(mask))?,
    };
    let mut pages = RecordingPages::before(recording)?;
    let nodes = compositor.nodes(&layers, &mut pages)?;
    let plan = Plan::new(&selecting, &mut Look::new(grid, 0, &mut pages)?, &layers, selection, &painted)?;
    let mut written = Vec::new();
    let (mut done, total) = (0, plan.blocks.iter().map(Vec::len).sum::<usize>() as u64);
    report(observer, "selecting", done, total)?;
    for block in &plan.blocks {
        let mut pages = RecordingPages::before(recording)?;
        let look = Look::new(grid, 0, &mut pages)?;
        let changed = plan.work_out(&mut Ground { look, compositor, nodes: &nodes }, block)?;
        written.extend(changed.iter().map(|(key, _)| *key));
        recording.write_pages(changed)?;
        done += block.len() as u64;
        report(observer, "selecting", done, total)?;
    }
    Ok((selecting, written))
}

impl Plan {
    /// Plans a change that names layers by their ids and data by its content.
    ///
    /// # Errors
    /// [`crate::Error::Field`], naming the field; [`orogeny_brush::Error::TooManyPages`] for more than one operation may change.
    fn new(
        selecting: &Selecting,
        look: &mut Look<'_>,
        layers: &[Layer],
        selection: Stored,
        painted: &Painted,
    ) -> Result<Self> {
        let lengths = selecting.lengths(&look.grid)?;
        let shape = Shape::new(selecting, look, layers)?;
        let selected = Pages::new(look.layout, look.grid.bounds(), &painted.selection);
        let spread = grow::reach(lengths.grow) + feather::reach(lengths.feather);
        let changed = selected.changed(&shape.extent(&painted.mask), selecting, spread)?;
        let margin = margin(&lengths).unsigned_abs();
        let side = margin.saturating_mul(MARGINS_A_SIDE).clamp(MIN_BLOCK_SIDE, MAX_BLOCK_SIDE);
        let blocks = blocks(changed, selection.field, side.div_ceil(look.layout.size()));
        Ok(Self { selecting: selecting.clone(), shape, lengths, selection, blocks })
    }

    /// The pages of a block that change, as they become.
    fn work_out(&self, ground: &mut Ground<'_, '_>, block: &[PageKey]) -> Result<Vec<(PageKey, Page)>> {
        let layout = ground.look.layout;
        let page_rects = block.iter().map(|key| layout.page_rect(key));
        let rect = page_rects.fold(SampleRect::EMPTY, |rect, page| rect.bounds_with(&page));
        let becomes = self.becomes(ground, rect.intersection(&ground.look.grid.bounds()))?;
        let mut changed = Vec::new();
        for (key, before) in block.iter().zip(ground.look.pages.load(block)?) {
            // Beyond the terrain a page holds the field's constant.
            let page = composite::page_of(&becomes, layout, layout.page_rect(key), self.selection.constant);
            let is_same = match before {
                Some(before) => is_same(page.samples(), before.samples()),
                None => page.samples().iter().all(|value| value.to_bits() == 0),
            };
            if !is_same {
                changed.push((*key, page));
            }
        }
        Ok(changed)
    }

    /// What becomes of a rectangle of the selection, within the terrain.
    fn becomes(&self, ground: &mut Ground<'_, '_>, rect: SampleRect) -> Result<Plane> {
        let bounds = ground.look.grid.bounds();
        let window = rect.grown(margin(&self.lengths));
        let mut plane = self.joined(ground, within(&bounds, &window))?;
        let first = plane.samples().first().copied().unwrap_or_default();
        if plane.samples().iter().all(|value| *value == first) {
            // Nothing that follows changes what is the same all around.
            plane = Plane::constant(rect, first);
        } else {
            plane = mirrored_around(plane, &bounds, window);
            let SelectLengths { grow, shrink, feather } = self.lengths;
            if grow::reach(grow) > 0 {
                plane = grow::grown(&plane, grow);
            }
            if grow::reach(shrink) > 0 {
                plane = grow::shrunk(plane, shrink);
            }
            if feather::reach(feather) > 0 {
                plane = feather::feathered(&plane, feather);
            }
        }
        if self.selecting.is_inverted {
            plane.samples_mut().iter_mut().for_each(|value| *value = 1.0 - *value);
        }
        Ok(plane)
    }

    /// The shape joined with what was selected before, in rows of pages: neither is whole beside what comes of them.
    fn joined(&self, ground: &mut Ground<'_, '_>, rect: SampleRect) -> Result<Plane> {
        let mut joined = Plane::constant(rect, 0.0);
        let (width, size) = (rect.width() as usize, ground.look.layout.size().cast_signed());
        let mut rows = joined.samples_mut();
        let mut z = rect.z0;
        while z < rect.z1 {
            let end = ((z.div_euclid(size) + 1) * size).min(rect.z1);
            let band = SampleRect::new(rect.x0, z, rect.x1, end);
            let before = composite::stored(&mut ground.look, &self.selection, band)?;
            let shape = self.shape.plane(ground, &before)?;
            let (of_band, rest) =
                rows.split_at_mut_checked(width * band.depth() as usize).unwrap_or_default();
            of_band.copy_from_slice(before.samples());
            combine::row(of_band, shape.samples(), self.selecting.combine);
            (rows, z) = (rest, end);
        }
        Ok(joined)
    }
}

/// How many samples around a block count.
fn margin(lengths: &SelectLengths) -> i32 {
    let reach = grow::reach(lengths.grow) + grow::reach(lengths.shrink) + feather::reach(lengths.feather);
    reach.cast_signed()
}

/// The samples of the terrain that a rectangle shows, once the terrain is mirrored at its border.
fn within(bounds: &SampleRect, rect: &SampleRect) -> SampleRect {
    let along = |first: i32, end: i32, length: u32| {
        let (mut low, mut high) = (i32::MAX, i32::MIN);
        for place in first..end {
            let place = mirrored(place, length);
            (low, high) = (low.min(place), high.max(place));
        }
        (low, high.saturating_add(1))
    };
    let (x0, x1) = along(rect.x0, rect.x1, bounds.width());
    let (z0, z1) = along(rect.z0, rect.z1, bounds.depth());
    SampleRect::new(x0, z0, x1, z1)
}

/// A rectangle of the mirrored terrain, out of a plane that has what it shows.
fn mirrored_around(plane: Plane, bounds: &SampleRect, rect: SampleRect) -> Plane {
    if plane.rect() == rect {
        return plane;
    }
    let first = plane.rect().x0;
    let mut around = Plane::constant(rect, 0.0);
    for z in rect.z0..rect.z1 {
        let from = plane.row(mirrored(z, bounds.depth())).unwrap_or_default();
        let Some(to) = around.row_mut(z) else { continue };
        for (x, to) in (rect.x0..).zip(to) {
            let place = mirrored(x, bounds.width()).abs_diff(first) as usize;
            *to = from.get(place).copied().unwrap_or_default();
        }
    }
    around
}

fn is_same(a: &[f32], b: &[f32]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}
