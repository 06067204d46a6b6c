//! A view that goes on while the terrain is worked on: it is drawn from what has arrived, and asks for what it lacks.
//!
//! A window owns one, tells it the events of a [`Session`](crate::session::Session), draws with it when it likes, and passes on what it
//! [asks for](LiveView::wanted). No frame waits for a page.

mod known;
#[cfg(test)]
mod tests;

use std::collections::HashSet;
use std::sync::mpsc::{Receiver, channel};

use glam::DVec3;
use orogeny_field::SampleRect;
use orogeny_geomip::material::{ResolvedSet, SurfaceTexture};
use orogeny_geomip::{
    Camera, FrameReport, Mode, Overlay, PagePlace, PageRelief, Ray, Renderer, Targets, pick,
};
use orogeny_gpu::Gpu;

use self::known::Known;
use super::scene::SceneMaker;
use super::{MAX_MASKS, Materials, ViewRequest, full_colour_m, higher_m, materials};
use crate::session::{Event, PageRequest, Status};
use crate::{Error, Result};

/// Pages that are asked for at once: as many as are worked out before one would want to see something of them.
const PAGES_AT_ONCE: usize = 16;

/// Textures of a material set, on their way.
type Surfaces = Result<(ResolvedSet, Vec<Vec<SurfaceTexture>>)>;

/// Draws a terrain that may change.
#[derive(Debug)]
pub struct LiveView {
    gpu: Gpu,
    renderer: Renderer,
    targets: Targets,
    size_px: [u32; 2],
    is_resized: bool,
    scenes: SceneMaker,
    known: Known,
    /// What the last frame lacked, the most urgent first.
    missing: Vec<PagePlace>,
    /// What was asked for and has not come yet.
    awaited: Vec<PagePlace>,
    /// What was asked for and could not be had, until something changes.
    unreadable: HashSet<PagePlace>,
    /// The set that is there, or on its way.
    materials: Option<Materials>,
    surfaces: Option<Receiver<Surfaces>>,
    has_surfaces: bool,
    /// Masks that the material set asks for.
    masks_of_materials: Vec<String>,
    /// What the masks that came with pages are where nothing was painted.
    unpainted_masks: [f32; 4],
    /// Of how the terrain was, its height where nothing was painted, metres, as far as that has come.
    unpainted_earlier_m: Option<f32>,
    /// Whether pages are drawn as they were.
    shows_earlier: bool,
    /// Whether the pages that are there have the difference over them.
    shows_difference: bool,
}

impl LiveView {
    /// For a terrain whose pages may take so many bytes, drawn on a device.
    ///
    /// # Errors
    /// [`Error::Gpu`] when there is no memory for it.
    pub fn new(gpu: &Gpu, status: &Status, page_budget_in_bytes: u64) -> Result<Self> {
        let size_px = [64, 64];
        Ok(Self {
            gpu: gpu.clone(),
            renderer: Renderer::new(
                gpu,
                status.grid,
                status.layout,
                status.unpainted_m,
                page_budget_in_bytes,
            )?,
            targets: Targets::new(gpu, size_px)?,
            size_px,
            is_resized: true,
            scenes: SceneMaker::default(),
            known: Known::new(status),
            missing: Vec::new(),
            awaited: Vec::new(),
            unreadable: HashSet::new(),
            materials: None,
            surfaces: None,
            has_surfaces: false,
            masks_of_materials: Vec::new(),
            unpainted_masks: [0.0; 4],
            unpainted_earlier_m: None,
            shows_earlier: false,
            shows_difference: false,
        })
    }

    /// Takes what a session tells.
    ///
    /// # Errors
    /// [`Error::Gpu`] when there is no memory for masks.
    pub fn take(&mut self, event: &Event) -> Result<()> {
        match event {
            Event::Status(status) => {
                self.known.take_status(status);
                self.set_unpainted_m();
            }
            Event::Changed { rects, is_settled } => {
                self.known.note_changed(rects.as_deref(), *is_settled);
                self.unreadable.clear();
            }
            Event::Pages(pages) => {
                let awaited = std::mem::take(&mut self.awaited);
                if pages.is_empty() {
                    self.unreadable.extend(awaited);
                }
                let is_compared = self.shows_earlier || self.shows_difference;
                let mut on_device = Vec::new();
                for data in pages {
                    self.unpainted_masks = data.unpainted_masks.unwrap_or(self.unpainted_masks);
                    let Some((page, first, num)) = self.known.take(data) else { continue };
                    let is_part = !is_compared && data.masks.is_none() && self.renderer.holds(data.place);
                    match data.on_device.as_ref().filter(|plane| plane.gpu == self.gpu) {
                        Some(plane) if is_part => on_device.push((data.place, first, num, plane)),
                        // What is drawn in another way is asked for as a whole.
                        _ if data.heights.is_empty() => {}
                        _ if is_part => self.renderer.upload_part(data.place, page, first, num),
                        _ => self.upload(data.place, data.masks.as_deref())?,
                    }
                    if let Some(earlier) = &data.earlier {
                        self.unpainted_earlier_m = Some(earlier.unpainted_m);
                        self.set_unpainted_m();
                    }
                }
                self.renderer.copy_parts(&on_device);
                let renderer = &self.renderer;
                self.known.retain(|place| renderer.holds(*place));
            }
            Event::Surveyed { .. } | Event::Progress { .. } | Event::Done { .. } | Event::Failed { .. } => {}
        }
        Ok(())
    }

    /// Hands over a page that has come, with what lies over it.
    fn upload(&mut self, place: PagePlace, masks: Option<&[[u8; 4]]>) -> Result<()> {
        let Some((page, earlier)) = self.known.page(place) else { return Ok(()) };
        let shown = earlier.filter(|_| self.shows_earlier).unwrap_or(page);
        if self.shows_difference {
            // Until it is known by how much, it is as it was.
            let higher_m = higher_m(page, earlier.unwrap_or(page));
            self.renderer.upload(place, shown, Some(Overlay::Difference(&higher_m)))?;
        } else {
            self.renderer.upload(place, shown, masks.map(Overlay::Masks))?;
        }
        Ok(())
    }

    /// Hands over again what has come: what of it is shown is another thing now.
    fn upload_all(&mut self) -> Result<()> {
        self.known.doubt_unknown();
        for place in self.known.places() {
            if self.renderer.holds(place) {
                self.upload(place, None)?;
            }
        }
        Ok(())
    }

    fn set_unpainted_m(&mut self) {
        let earlier_m = self.unpainted_earlier_m.filter(|_| self.shows_earlier);
        self.renderer.set_unpainted_m(earlier_m.unwrap_or(self.known.unpainted_m));
    }

    /// Whether the ground is drawn as it was, as far as that has come: where the session has a [past open](crate::session::Session::open_past).
    /// What is told of places is how it is.
    ///
    /// # Errors
    /// [`Error::Gpu`] when there is no memory for it.
    pub fn show_earlier(&mut self, is_earlier: bool) -> Result<()> {
        if std::mem::replace(&mut self.shows_earlier, is_earlier) != is_earlier {
            self.set_unpainted_m();
            self.upload_all()?;
        }
        Ok(())
    }

    /// In [`Mode::Difference`]: by how much the ground is higher where the colour is full red, and lower where it is full blue, metres, in a
    /// picture of this request; `None` until anything is known of how it was.
    #[must_use]
    pub fn difference_m(&self, request: &ViewRequest) -> Option<f32> {
        let most_m = self.known.difference_m(|place| self.renderer.is_shown(place))?;
        Some(full_colour_m(request, most_m.max(self.unpainted_difference_m().abs())))
    }

    fn unpainted_difference_m(&self) -> f32 {
        self.unpainted_earlier_m.map_or(0.0, |earlier_m| self.known.unpainted_m - earlier_m)
    }

    /// Draws from what is there. Of a request, eye, target, field of view and size are the camera's.
    ///
    /// # Errors
    /// [`Error::View`] for values out of range; [`Error::Gpu`]; [`Error::Material`] and others for a material set that cannot be used,
    /// which is then drawn plain.
    pub fn draw(&mut self, camera: &Camera, size_px: [u32; 2], request: &ViewRequest) -> Result<FrameReport> {
        request.check()?;
        if self.size_px != size_px {
            self.targets = Targets::new(&self.gpu, size_px)?;
            self.size_px = size_px;
            self.is_resized = true;
        }
        let surfaces = self.look_for_surfaces(request);
        let mut request = request.clone();
        if request.mode == Mode::Textured && !self.has_surfaces {
            request.mode = Mode::Shaded;
        }
        let shows_difference = request.mode == Mode::Difference;
        if std::mem::replace(&mut self.shows_difference, shows_difference) != shows_difference {
            // Masks come anew, where any are shown.
            self.renderer.forget_overlay()?;
            if shows_difference {
                self.upload_all()?;
            }
        }
        let heights_m = request.range_m.filter(|_| !shows_difference);
        let range_m = heights_m.unwrap_or_else(|| self.known.range_m());
        let mut scene = self.scenes.scene(&request, range_m, self.unpainted_masks);
        if shows_difference {
            let most_m = self.difference_m(&request).unwrap_or(1.0);
            scene.overlay_range = [-most_m, most_m];
            scene.unpainted_overlay = [self.unpainted_difference_m(), 0.0, 0.0, 0.0];
        }
        let relief = PageRelief::new(self.known.grid, self.known.layout, &self.known);
        self.missing = self.renderer.want(camera, &scene, &relief);
        let report = self.renderer.draw(camera, &scene, &relief, &self.targets)?;
        surfaces.map(|()| report)
    }

    /// Has textures made for the material set that is asked for, and takes them when they are there.
    fn look_for_surfaces(&mut self, request: &ViewRequest) -> Result<()> {
        if request.mode == Mode::Textured && self.materials.as_ref() != Some(&request.materials) {
            self.materials = Some(request.materials.clone());
            self.has_surfaces = false;
            let (sender, receiver) = channel();
            let (set, range_m) = (request.materials.clone(), self.known.range_m());
            self.surfaces = Some(receiver);
            std::thread::Builder::new()
                .name("orogeny.materials".to_owned())
                .spawn(move || {
                    // Whoever asked may be gone.
                    sender.send(materials::resolve(&set, range_m)).ok();
                })
                .map_err(|err| Error::Thread { detail: err.to_string() })?;
        }
        let Some(made) = self.surfaces.as_ref().and_then(|surfaces| surfaces.try_recv().ok()) else {
            return Ok(());
        };
        self.surfaces = None;
        let (set, layers) = made?;
        self.masks_of_materials.clone_from(&set.masks);
        self.renderer.set_materials(set, &layers)?;
        self.has_surfaces = true;
        Ok(())
    }

    /// The masks that have to come with pages for a picture, four at most.
    #[must_use]
    pub fn masks(&self, request: &ViewRequest) -> Vec<String> {
        match request.mode {
            Mode::Overlay => vec![request.mask.clone()],
            Mode::Textured => self.masks_of_materials.iter().take(MAX_MASKS).cloned().collect(),
            _ => Vec::new(),
        }
    }

    /// Whether the next frame would show more than the last one without an event: textures are on their way.
    #[must_use]
    pub const fn is_waiting(&self) -> bool {
        self.surfaces.is_some()
    }

    /// Whether the last frame was drawn from all the pages that it wanted, as they are now.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let is_there = |place: &PagePlace| self.unreadable.contains(place);
        self.awaited.is_empty()
            && self.missing.iter().all(is_there)
            && self.surfaces.is_none()
            && !self.known.has_stale(|place| self.renderer.is_shown(place))
    }

    /// What to ask the session for; nothing while something asked for has not come.
    pub fn wanted(&mut self) -> Vec<PageRequest> {
        if !self.awaited.is_empty() {
            return Vec::new();
        }
        let renderer = &self.renderer;
        // How it was comes with whole pages.
        let is_compared = self.shows_earlier || self.shows_difference;
        let mut requests: Vec<_> = self
            .known
            .take_stale(|place| renderer.is_shown(place))
            .into_iter()
            .map(|(place, rect)| PageRequest { place, rect: Some(rect).filter(|_| !is_compared) })
            .collect();
        let missing = self.missing.iter().filter(|place| !self.unreadable.contains(place));
        requests.extend(missing.take(PAGES_AT_ONCE).map(|place| PageRequest { place: *place, rect: None }));
        let unreadable = &self.unreadable;
        let is_summary_wanted = |place: &PagePlace| renderer.is_shown(*place) && !unreadable.contains(place);
        let stale = self.known.take_stale_summaries(is_summary_wanted);
        requests.extend(stale.into_iter().map(|place| PageRequest { place, rect: Some(SampleRect::EMPTY) }));
        self.awaited = requests.iter().map(|request| request.place).collect();
        requests
    }

    /// Bytes of pages, and of what lies over them, that went from memory to the device so far.
    #[must_use]
    pub const fn uploaded_bytes(&self) -> u64 {
        self.renderer.uploaded_bytes()
    }

    /// Whether the picture has come to lie in another texture since this was last asked.
    pub const fn take_is_resized(&mut self) -> bool {
        std::mem::replace(&mut self.is_resized, false)
    }

    /// The picture that was drawn last.
    #[must_use]
    pub fn picture_view(&self) -> wgpu::TextureView {
        self.targets.picture_view()
    }

    /// While a stroke is drawn, [`Self::pick`] and [`Self::ground`] tell the ground as it was when it began.
    pub fn hold_still(&mut self, is_still: bool) {
        self.known.hold_still(is_still);
    }

    /// Where a ray first meets the ground as far as it has arrived, metres.
    #[must_use]
    pub fn pick(&self, origin_m: DVec3, direction: DVec3) -> Option<DVec3> {
        let ray = Ray { origin_m, direction };
        pick(&ray, &self.known.grid, &self.known).map(|distance_m| origin_m + direction * distance_m)
    }

    /// The ground's height at a place, as far as it has arrived, and how steep it is there: metres and degrees. Beyond the border that of
    /// the border.
    #[must_use]
    pub fn ground(&self, place_m: [f64; 2]) -> (f32, f32) {
        let grid = &self.known.grid;
        let bounds = grid.bounds();
        let last = [f64::from(bounds.x1 - 1), f64::from(bounds.z1 - 1)];
        let [x, z] = grid.sample_from_world(place_m);
        let (x, z) = (x.clamp(0.0, last[0]), z.clamp(0.0, last[1]));
        let at = |x: f64, z: f64| self.known.height_at([x.clamp(0.0, last[0]), z.clamp(0.0, last[1])]);
        let along = |low: f32, high: f32| (high - low) / (2.0 * grid.spacing_m() as f32);
        let slope = along(at(x - 1.0, z), at(x + 1.0, z)).hypot(along(at(x, z - 1.0), at(x, z + 1.0)));
        (at(x, z), slope.atan().to_degrees())
    }

    /// Lowest and highest height of the terrain, metres.
    #[must_use]
    pub fn range_m(&self) -> [f32; 2] {
        self.known.range_m()
    }
}
