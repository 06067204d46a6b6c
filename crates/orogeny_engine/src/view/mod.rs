//! Pictures of a terrain as it is seen from somewhere, drawn on a GPU or a software driver.

mod flight;
mod live;
mod materials;
mod request;
mod scene;
mod source;

use std::collections::HashMap;

use glam::DVec3;
use orogeny_field::{Page, SampleRect};
use orogeny_geomip::{
    Camera, FrameReport, MAX_CURSORS, Mode, Overlay, PagePlace, PageRelief, PageSummaries as _, Renderer,
    Targets,
};
use orogeny_gpu::{AdapterChoice, AdapterDescription, Gpu};

pub use flight::Flight;
pub use live::LiveView;
pub use materials::{MaterialDescription, Materials, material_descriptions};
pub use request::{HeightAt, Place, ViewRequest};

use self::scene::SceneMaker;
use self::source::SELECTION;
pub(crate) use self::source::{CompositeSource, page_rect};
use crate::composite::Source;
use crate::ground::Ground;
use crate::picture::{Picture, check_size};
use crate::{Adapter, Error, Observer, Result, Settings, Terrain};

/// Bytes of pages for each pixel of a picture: pages of one sample a pixel, those above them, and as much again for what a pixel's width leaves unused.
const PAGE_BYTES_A_PIXEL: u64 = 64;
/// What pages may take for a small picture.
const MIN_PAGE_BYTES: u64 = 64 << 20;

/// What pages may take whatever their size: so many of them.
const MIN_PAGES: u64 = 64;

/// Bytes of pages that are on their way to the GPU at once.
const BYTES_AT_ONCE: u64 = 16 << 20;

/// How far the whole terrain is looked at from above: the tangent.
const OVERVIEW_TANGENT: f64 = 0.62;

/// Full colour stands for no less, metres: what comes to nothing is to look like nothing.
const MIN_DIFFERENCE_M: f32 = 1.0e-3;

/// Masks that a material set may ask for.
const MAX_MASKS: usize = 4;

/// How far an eye and what it looks at may be from the origin, metres, or in sides of the terrain, whichever is further.
const MAX_PLACE_M: f64 = 1.0e8;
const MAX_PLACE_SIDES: f64 = 16.0;

/// Draws pictures of one size of one terrain, which does not change meanwhile.
pub struct View<'a> {
    terrain: &'a Terrain,
    source: CompositeSource<'a>,
    gpu: Gpu,
    renderer: Renderer,
    targets: Targets,
    size_px: [u32; 2],
    /// The set whose textures are there.
    materials: Option<Materials>,
    masks_of_materials: Vec<String>,
    scenes: SceneMaker,
    /// What it is compared with.
    compared: Option<Compared>,
    /// Whether the pages that are there have the difference over them.
    shows_difference: bool,
}

/// What is known of how a terrain differs from an earlier state.
#[derive(Debug, Default)]
struct Compared {
    /// By how much it is higher now where nothing is painted, metres.
    unpainted_m: f32,
    /// The most, up or down, of each page that is there, metres.
    most_m: HashMap<PagePlace, f32>,
}

/// What a picture was drawn from.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// Where the eye was: metres to the east, up, to the south.
    pub eye_m: [f64; 3],
    /// What it looked at.
    pub target_m: [f64; 3],
    /// What it consisted of.
    pub report: FrameReport,
    /// In [`Mode::Difference`]: by how much the ground is higher where the colour is full red, and lower where it is full blue, metres.
    pub difference_m: Option<f32>,
    /// What could not be shown as it is, for people.
    pub notices: Vec<String>,
}

impl Terrain {
    /// Prepares to draw pictures of so many pixels.
    ///
    /// # Errors
    /// [`Error::PictureSize`]; [`Error::Gpu`] when there is nothing that could draw; [`Error::Store`].
    pub fn view(&self, size_px: [u32; 2]) -> Result<View<'_>> {
        check_size(size_px)?;
        let [width, height] = size_px;
        let store = self.settled()?;
        let gpu = drawing_gpu(self.settings())?;
        let least = MIN_PAGE_BYTES.max(MIN_PAGES * store.layout().size_in_bytes());
        let pages = (u64::from(width) * u64::from(height) * PAGE_BYTES_A_PIXEL).max(least);
        let budget = pages.min(self.settings().page_budget_in_bytes);
        let renderer = Renderer::new(&gpu, self.grid(), store.layout(), self.unpainted_height_m()?, budget)?;
        let targets = Targets::new(&gpu, size_px)?;
        Ok(View {
            terrain: self,
            source: CompositeSource::new(store, self.compositor()),
            gpu,
            renderer,
            targets,
            size_px,
            materials: None,
            masks_of_materials: Vec::new(),
            scenes: SceneMaker::default(),
            compared: None,
            shows_difference: false,
        })
    }
}

/// What draws: the adapter that was asked for; where that calculates on the CPU, the best there is.
///
/// # Errors
/// [`Error::NothingDraws`], [`Error::Gpu`].
pub fn drawing_gpu(settings: &Settings) -> Result<Gpu> {
    opened(settings, Gpu::open)
}

/// What draws in a window, and how: see [`window_gpu`].
#[derive(Debug)]
pub struct WindowGpu {
    /// The device: the adapter that was asked for; where that calculates on the CPU, the best that can draw in the window.
    pub gpu: Gpu,
    /// Its adapter.
    pub adapter: wgpu::Adapter,
    /// The window's surface.
    pub surface: wgpu::Surface<'static>,
}

/// The device for a window.
///
/// # Errors
/// [`Error::NothingDraws`], [`Error::Gpu`]; [`Error::NoSurface`] for a window that cannot be drawn in.
pub fn window_gpu(settings: &Settings, window: impl Into<wgpu::SurfaceTarget<'static>>) -> Result<WindowGpu> {
    let instance = orogeny_gpu::new_instance();
    let surface =
        instance.create_surface(window).map_err(|err| Error::NoSurface { detail: err.to_string() })?;
    let (gpu, adapter) = opened(settings, |choice| Gpu::open_for_surface(choice, &instance, &surface))?;
    Ok(WindowGpu { gpu, adapter, surface })
}

fn opened<T>(settings: &Settings, open: impl Fn(&AdapterChoice) -> orogeny_gpu::Result<T>) -> Result<T> {
    // A GPU that is there and cannot be opened is an error, not a picture that takes a hundred times as long.
    let best = || match open(&AdapterChoice::RealGpu) {
        Err(orogeny_gpu::Error::NoAdapter { .. }) => open(&AdapterChoice::Software),
        opened => opened,
    };
    Ok(match &settings.adapter {
        Adapter::Auto | Adapter::Cpu => best().map_err(|source| match source {
            orogeny_gpu::Error::NoAdapter { found, .. } => Error::NothingDraws { found },
            source => Error::Gpu(source),
        })?,
        Adapter::Software => open(&AdapterChoice::Software)?,
        Adapter::Named(name) => open(&AdapterChoice::Named(name.clone()))?,
        Adapter::Of(gpu) => open(&AdapterChoice::Named(gpu.description().name.clone()))?,
    })
}

impl<'a> View<'a> {
    /// Says what [`Mode::Difference`] shows the difference to: the same terrain as it was, from [`Terrain::open_to_read_at`].
    ///
    /// # Errors
    /// [`Error::Store`].
    pub fn compare_with(&mut self, earlier: &'a Terrain) -> Result<()> {
        let unpainted_m = self.terrain.unpainted_height_m()? - earlier.unpainted_height_m()?;
        self.source.compare_with(CompositeSource::new(earlier.settled()?, earlier.compositor()));
        self.compared = Some(Compared { unpainted_m, ..Compared::default() });
        self.renderer.forget(|_| true);
        Ok(())
    }

    /// Draws a picture, once all pages that it wants are there. Of a request its size is not looked at: it is the view's.
    ///
    /// # Errors
    /// [`Error::View`] for values out of range; [`Error::NothingToCompare`]; [`Error::Store`], [`Error::Gpu`]; [`Error::Cancelled`] by the
    /// observer.
    pub fn draw(&mut self, request: &ViewRequest, observer: &mut dyn Observer) -> Result<Drawn> {
        request.check()?;
        if request.mode == Mode::Difference && self.compared.is_none() {
            return Err(Error::NothingToCompare);
        }
        let (eye_m, target_m) = self.places(request)?;
        if request.mode == Mode::Textured && self.materials.as_ref() != Some(&request.materials) {
            let (set, layers) = materials::resolve(&request.materials, self.range_m())?;
            self.masks_of_materials.clone_from(&set.masks);
            self.renderer.set_materials(set, &layers)?;
            self.materials = Some(request.materials.clone());
        }
        self.show_masks(request)?;
        let shows_difference = request.mode == Mode::Difference;
        if std::mem::replace(&mut self.shows_difference, shows_difference) != shows_difference {
            self.renderer.forget(|_| true);
        }
        let camera = Camera::looking_at(eye_m, target_m, request.fov_degrees.to_radians(), self.size_px);
        let heights_m = request.range_m.filter(|_| !shows_difference);
        let mut scene = self.scenes.scene(
            request,
            heights_m.unwrap_or_else(|| self.range_m()),
            self.source.unpainted_masks(),
        );
        let (grid, layout) = (self.terrain.grid(), self.terrain.store()?.layout());
        let relief = PageRelief::new(grid, layout, &self.source);
        let missing = self.renderer.want(&camera, &scene, &relief);
        let total = missing.len() as u64;
        let pages_at_once = usize::try_from(BYTES_AT_ONCE / layout.size_in_bytes()).unwrap_or(1).max(1);
        for (chunk, done) in missing.chunks(pages_at_once).zip((0_u64..).step_by(pages_at_once)) {
            crate::progress::report(observer, "reading", done, total)?;
            for place in chunk {
                let heights = self.source.page(*place)?;
                let earlier = if shows_difference { self.source.earlier_page(*place)? } else { None };
                if let (Some(earlier), Some(compared)) = (earlier, &mut self.compared) {
                    let higher_m = higher_m(&heights, &earlier);
                    compared.most_m.insert(*place, most_m(&higher_m));
                    self.renderer.upload(*place, &heights, Some(Overlay::Difference(&higher_m)))?;
                } else {
                    let masks = self.source.masks_over(*place);
                    self.renderer.upload(*place, &heights, masks.as_deref().map(Overlay::Masks))?;
                }
            }
            // So that copies do not pile up.
            self.gpu.queue().submit([]);
            self.gpu.wait()?;
        }
        crate::progress::report(observer, "drawing", 0, 1)?;
        let difference_m = self.compared.as_ref().filter(|_| shows_difference).map(|compared| {
            let shown = compared.most_m.iter().filter(|(place, _)| self.renderer.is_shown(**place));
            let most_m = shown.map(|(_, most_m)| *most_m).fold(compared.unpainted_m.abs(), f32::max);
            scene.unpainted_overlay = [compared.unpainted_m, 0.0, 0.0, 0.0];
            full_colour_m(request, most_m)
        });
        if let Some(difference_m) = difference_m {
            scene.overlay_range = [-difference_m, difference_m];
        }
        let report = self.renderer.draw(&camera, &scene, &relief, &self.targets)?;
        let pixels = self.targets.read(&self.gpu)?;
        self.gpu.check()?;
        self.source.check()?;
        let rgb = pixels
            .as_chunks::<4>()
            .0
            .iter()
            .flat_map(|[red, green, blue, _]| [*red, *green, *blue])
            .collect();
        let [width_px, height_px] = self.size_px;
        let picture = Picture { width_px, height_px, rgb };
        Ok(Drawn {
            picture,
            eye_m: eye_m.to_array(),
            target_m: target_m.to_array(),
            report,
            difference_m,
            notices: self.source.notices(),
        })
    }

    /// What draws, for people.
    #[must_use]
    pub const fn adapter(&self) -> &AdapterDescription {
        self.gpu.description()
    }

    /// Has the masks read that a picture needs.
    fn show_masks(&mut self, request: &ViewRequest) -> Result<()> {
        let names = match request.mode {
            Mode::Overlay => std::slice::from_ref(&request.mask),
            Mode::Textured => &self.masks_of_materials[..],
            _ => &[],
        };
        if names.len() > MAX_MASKS {
            return Err(view_error(
                "the number of masks of the material set",
                names.len() as f64,
                [0.0, MAX_MASKS as f64],
            ));
        }
        let mask = |name: &String| {
            self.source.mask(name).ok_or_else(|| {
                let layers = self.terrain.layers().unwrap_or_default().iter();
                let known: Vec<_> = layers.map(|layer| format!("`{}`", layer.name)).collect();
                Error::UnknownMask {
                    name: name.clone(),
                    known: format!("{} and `{SELECTION}`", known.join(", ")),
                }
            })
        };
        let masks = names.iter().map(mask).collect::<Result<Vec<_>>>()?;
        if self.source.show(masks) {
            self.renderer.forget(|_| true);
        }
        Ok(())
    }

    /// Lowest and highest height of the terrain.
    fn range_m(&self) -> [f32; 2] {
        let summary = self.source.summary(PagePlace::root(&self.terrain.grid(), self.source.layout()));
        [summary.bounds.min_m, summary.bounds.max_m]
    }

    /// The eye, and what it looks at.
    fn places(&self, request: &ViewRequest) -> Result<(DVec3, DVec3)> {
        let grid = self.terrain.grid();
        let along = |num: u32| f64::from(num - 1) * grid.spacing_m();
        let [width_m, depth_m] = [along(grid.width()), along(grid.depth())];
        let [low_m, high_m] = self.range_m().map(f64::from);
        let middle = DVec3::new(width_m / 2.0, f64::midpoint(low_m, high_m), depth_m / 2.0);
        let target = request.target.map(|place| self.place(&place)).transpose()?.unwrap_or(middle);
        let eye = match &request.eye {
            Some(place) => self.place(place)?,
            None => {
                // So far off that a ball around the terrain fills the picture's smaller side.
                let radius_m = DVec3::new(width_m, high_m - low_m, depth_m).length() / 2.0;
                let [width, height] = self.size_px.map(f64::from);
                let half = (request.fov_degrees.to_radians() / 2.0).tan() * (width / height).min(1.0);
                let distance_m = (0.8 * radius_m / half.atan().sin()).max(10.0 * grid.spacing_m());
                target + DVec3::new(-0.45, OVERVIEW_TANGENT, 0.89).normalize() * distance_m
            }
        };
        Ok((eye, target))
    }

    fn place(&self, Place { x_m, height, z_m }: &Place) -> Result<DVec3> {
        let height_m = match height {
            HeightAt::Absolute(height_m) => *height_m,
            HeightAt::AboveGround(above_m) => f64::from(self.ground_m([*x_m, *z_m])?) + above_m,
        };
        let place = DVec3::new(*x_m, height_m, *z_m);
        let grid = self.terrain.grid();
        let side_m = f64::from(grid.width().max(grid.depth())) * grid.spacing_m();
        let limit_m = MAX_PLACE_M.max(MAX_PLACE_SIDES * side_m);
        let outside = place.to_array().into_iter().find(|along| !(-limit_m..=limit_m).contains(along));
        match outside {
            None => Ok(place),
            Some(along) => Err(view_error("a place to look from or at (m)", along, [-limit_m, limit_m])),
        }
    }

    /// The ground's height between samples; beyond the border that of the border.
    fn ground_m(&self, place_m: [f64; 2]) -> Result<f32> {
        let bounds = self.terrain.grid().bounds();
        let [x, z] = self.terrain.grid().sample_from_world(place_m);
        let (x, z) = (x.clamp(0.0, f64::from(bounds.x1 - 1)), z.clamp(0.0, f64::from(bounds.z1 - 1)));
        let (x0, z0) = (x.floor() as i32, z.floor() as i32);
        let rect = SampleRect::new(x0, z0, (x0 + 2).min(bounds.x1), (z0 + 2).min(bounds.z1));
        let mut heights = vec![0.0; (rect.width() * rect.depth()) as usize];
        self.terrain.composite(Source::Composite, 0, rect)?.read_rows(&mut heights)?;
        let spacing_m = self.terrain.grid().spacing_m() as f32;
        let ground = Ground { width: rect.width() as usize, heights, spacing_m };
        Ok(ground.between([(x - f64::from(x0)) as f32, (z - f64::from(z0)) as f32]))
    }
}

/// By how much each sample of a page is higher than it was, metres.
fn higher_m(now: &Page, earlier: &Page) -> Vec<f32> {
    now.samples().iter().zip(earlier.samples()).map(|(now_m, earlier_m)| now_m - earlier_m).collect()
}

/// The most that a difference comes to, up or down.
fn most_m(higher_m: &[f32]) -> f32 {
    higher_m.iter().fold(0.0, |most_m, by_m| most_m.max(by_m.abs()))
}

/// The difference that has the full colour: what the request says, else the most that is looked at. As much up as down, so that nothing
/// has the colour in the middle but what is as it was.
fn full_colour_m(request: &ViewRequest, most_m: f32) -> f32 {
    let asked_for = request.range_m.map(|[low_m, high_m]| low_m.abs().max(high_m.abs()));
    asked_for.unwrap_or(most_m).max(MIN_DIFFERENCE_M)
}

fn view_error(what: &'static str, value: f64, [low, high]: [f64; 2]) -> Error {
    Error::View { what, value, low, high }
}

impl ViewRequest {
    /// Whether all numbers are within their ranges.
    ///
    /// # Errors
    /// [`Error::View`] for the first that is not.
    pub fn check(&self) -> Result<()> {
        let ranges = [
            ("the field of view (degrees)", self.fov_degrees, [1.0, 150.0]),
            ("the sun's azimuth (degrees)", self.sun_azimuth_degrees, [-360.0, 720.0]),
            ("the sun's altitude (degrees)", self.sun_altitude_degrees, [-5.0, 90.0]),
            ("the haze", self.haze, [0.0, 20.0]),
            ("the exaggeration of slopes", f64::from(self.slope_exaggeration), [0.0, 100.0]),
            ("the exposure (stops)", f64::from(self.exposure_stops), [-20.0, 20.0]),
            ("the error in pixels", self.max_error_px, [0.1, 100.0]),
            ("the step of contour lines (m)", f64::from(self.contour_m.unwrap_or(1.0)), [1.0e-4, 1.0e7]),
            (
                "the lowest height of the colours (m)",
                f64::from(self.range_m.unwrap_or_default()[0]),
                [-1.0e7, 1.0e7],
            ),
            (
                "the highest height of the colours (m)",
                f64::from(self.range_m.unwrap_or_default()[1]),
                [-1.0e7, 1.0e7],
            ),
            ("the number of brushes' rings", self.cursors.len() as f64, [0.0, MAX_CURSORS as f64]),
            ("the water's level (m)", f64::from(self.water_level_m.unwrap_or(0.0)), [-1.0e7, 1.0e7]),
        ];
        match ranges.into_iter().find(|(_, value, [low, high])| !(*low..=*high).contains(value)) {
            Some((what, value, range)) => Err(view_error(what, value, range)),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_out_of_range_is_named() {
        ViewRequest::default().check().unwrap();
        let too_high = ViewRequest { sun_altitude_degrees: 91.0, ..ViewRequest::default() };
        let err = too_high.check().unwrap_err().to_string();
        assert!(err.contains("altitude") && err.contains("91") && err.contains("-5 to 90"), "{err}");
        let nothing = ViewRequest { haze: f64::NAN, ..ViewRequest::default() };
        assert!(nothing.check().unwrap_err().to_string().contains("haze"));
    }
}
