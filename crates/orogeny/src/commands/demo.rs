//! `demo`: the main job in one go, on a real terrain that is part of the program.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::anyhow;
use clap::Args;
use orogeny_engine::{
    Applied, BrushType, Error, ExportOptions, ExportRequest, HeightAt, ImportRequest, MapRequest, Operation,
    Place, Presets, Recipe, Terrain, ViewRequest,
};
use serde::Serialize;

use crate::output::{Output, count, text_of};
use crate::progress::ProgressWatch;
use crate::session::Session;

pub(super) const RASTER: &[u8] = include_bytes!("../../../../assets/terrain/frazier_1024_int16.tif");
pub(super) const RASTER_NAME: &str = "frazier_1024_int16.tif";
const RECIPE: &str = include_str!("../../../../assets/demo/recipe.json");
/// Room for a pixel a sample.
const PICTURE_PX: [u32; 2] = [2048, 2048];
/// Pixels of the view.
const VIEW_PX: [u32; 2] = [960, 540];
/// A stroke that nobody wants, to be undone.
const MISTAKE: &str = r#"{"op": "stroke", "points": [[4000, 4000], [20000, 26000]],
    "brush": {"type": "raise", "radius": 2500, "strength": 3000}}"#;

/// What `demo` takes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The folder for what is made; files of an earlier demo in it are replaced
    #[arg(default_value = "orogeny-demo")]
    folder: PathBuf,
}

#[derive(Debug, Serialize)]
struct Report {
    backend: String,
    steps: Vec<Step>,
    operations: Vec<Applied>,
    files: Vec<String>,
    elapsed_s: f64,
}

#[derive(Debug, Serialize)]
struct Step {
    what: String,
    elapsed_s: f64,
}

/// Where the demo stands.
struct Demo<'a> {
    folder: &'a Path,
    output: Output,
    steps: Vec<Step>,
    files: Vec<String>,
    start_of_step: Instant,
}

/// Runs the demo.
///
/// # Errors
/// When the folder cannot be written.
pub fn run(arguments: &Arguments, session: &Session) -> anyhow::Result<()> {
    let start = Instant::now();
    let folder = arguments.folder.as_path();
    std::fs::create_dir_all(folder).map_err(|err| anyhow!("`{}` cannot be made: {err}", folder.display()))?;
    let mut demo =
        Demo { folder, output: session.output(), steps: Vec::new(), files: Vec::new(), start_of_step: start };

    let mut terrain = demo.import(session)?;
    let backend = terrain.backend_description()?;
    demo.output.line(&format!("this runs on {backend}"))?;
    let range_m = demo.draw(&terrain, "before.png", None)?;
    let operations = demo.paint(&mut terrain)?;
    demo.undo_a_mistake(&mut terrain)?;
    demo.draw(&terrain, "after.png", Some(range_m))?;
    demo.look(&terrain, "view.png")?;
    demo.export(&terrain)?;
    terrain.close()?;

    let Demo { steps, files, .. } = demo;
    let elapsed_s = start.elapsed().as_secs_f64();
    session.output().report(&Report { backend, steps, operations, files, elapsed_s })
}

impl Demo<'_> {
    fn import(&mut self, session: &Session) -> anyhow::Result<Terrain> {
        let path = self.path("terrain.orogeny");
        for companion in ["", "-wal", "-shm", "-head"] {
            let mut old = path.clone().into_os_string();
            old.push(companion);
            remove_if_there(Path::new(&old))?;
        }
        let raster = self.path(RASTER_NAME);
        write(&raster, RASTER)?;
        write(&self.path("recipe.json"), RECIPE.as_bytes())?;
        let request = ImportRequest::new(raster);
        let (terrain, summary) =
            Terrain::from_raster(&path, &request, session.settings(), &mut ProgressWatch::new())?;
        for notice in &summary.notices {
            self.output.line(&format!("note: {notice}"))?;
        }
        let spacing_m = summary.spacing_m;
        let size = format!("{} x {} samples, one every {spacing_m:.2} m", summary.width, summary.depth);
        self.step(format!("imported {RASTER_NAME} into terrain.orogeny: {size}"))?;
        Ok(terrain)
    }

    fn draw(&mut self, terrain: &Terrain, name: &str, range_m: Option<[f32; 2]>) -> anyhow::Result<[f32; 2]> {
        let request = MapRequest { range_m, size_px: PICTURE_PX, ..MapRequest::new(self.path(name)) };
        let summary = terrain.draw_map(&request, &mut ProgressWatch::new())?;
        self.step(format!("drew {name}: {} x {} pixels", summary.width_px, summary.height_px))?;
        Ok(summary.range_m)
    }

    /// Draws the painted ridge as it is seen from the south-west, where there is something that draws.
    fn look(&mut self, terrain: &Terrain, name: &str) -> anyhow::Result<()> {
        let request = ViewRequest {
            size_px: VIEW_PX,
            eye: Some(Place { x_m: 9_500.0, height: HeightAt::AboveGround(1_300.0), z_m: 24_500.0 }),
            target: Some(Place { x_m: 14_500.0, height: HeightAt::AboveGround(0.0), z_m: 14_000.0 }),
            sun_azimuth_degrees: 270.0,
            sun_altitude_degrees: 24.0,
            ..ViewRequest::default()
        };
        let drawn =
            match terrain.view(VIEW_PX).and_then(|mut view| view.draw(&request, &mut ProgressWatch::new())) {
                Err(err @ Error::NothingDraws { .. }) => {
                    return self.output.line(&format!("note: no {name}: {err}"));
                }
                drawn => drawn?,
            };
        drawn.picture.write(&self.path(name))?;
        let [width, height] = VIEW_PX;
        self.step(format!("drew {name}: {width} x {height} pixels, {} triangles", drawn.report.num_triangles))
    }

    fn paint(&mut self, terrain: &mut Terrain) -> anyhow::Result<Vec<Applied>> {
        let recipe = Recipe::from_json_text(RECIPE, Presets::factory())?;
        let applied = terrain.apply(&recipe.operations, &mut ProgressWatch::new())?;
        self.step(format!("applied {} of recipe.json", count(applied.len() as u64, "operation")))?;
        for brush_type in BrushType::ALL {
            let by_it: Vec<_> = applied.iter().filter(|one| one.brush == Some(brush_type)).collect();
            if !by_it.is_empty() {
                let strokes = count(by_it.len() as u64, "stroke");
                let elapsed_s: f64 = by_it.iter().map(|one| one.elapsed_s).sum();
                self.output
                    .line(&format!("            {strokes} of {} ({elapsed_s:.3} s)", brush_type.name()))?;
            }
        }
        Ok(applied)
    }

    fn undo_a_mistake(&mut self, terrain: &mut Terrain) -> anyhow::Result<()> {
        terrain.apply(&[Operation::from_json_text(MISTAKE)?], &mut ProgressWatch::new())?;
        self.step("applied a stroke that nobody wants".to_owned())?;
        let changes = terrain.undo(1)?;
        let num_pages = changes.iter().map(|change| change.pages.len() as u64).sum();
        self.step(format!("undid it: {} back as they were, bit for bit", count(num_pages, "page")))
    }

    fn export(&mut self, terrain: &Terrain) -> anyhow::Result<()> {
        let heights = terrain.height_statistics(&mut ProgressWatch::new())?;
        let range_m = Some((f64::from(heights.min_m.floor()), f64::from(heights.max_m.ceil())));
        for (name, range_m) in [("terrain.tif", None), ("terrain.png", range_m), ("terrain.r16", range_m)] {
            let options = ExportOptions { range_m, ..ExportOptions::default() };
            let request = ExportRequest { options, ..ExportRequest::new(self.path(name)) };
            let summary = terrain.export(&request, &mut ProgressWatch::new())?;
            if range_m.is_some() {
                self.path(&format!("{name}.json"));
            }
            let coding = match range_m {
                Some((low_m, high_m)) => format!("16 bits for {low_m} to {high_m} m"),
                None => "32-bit metres".to_owned(),
            };
            self.step(format!("exported {name}: {} x {} samples, {coding}", summary.width, summary.depth))?;
        }
        Ok(())
    }

    /// Notes a file, and gives its path.
    fn path(&mut self, name: &str) -> PathBuf {
        let path = self.folder.join(name);
        self.files.push(text_of(&path));
        path
    }

    /// Notes and says what was just done.
    fn step(&mut self, what: String) -> anyhow::Result<()> {
        let elapsed_s = self.start_of_step.elapsed().as_secs_f64();
        self.output.line(&format!("{elapsed_s:>8.3} s  {what}"))?;
        self.steps.push(Step { what, elapsed_s });
        self.start_of_step = Instant::now();
        Ok(())
    }
}

fn write(path: &Path, content: &[u8]) -> anyhow::Result<()> {
    std::fs::write(path, content).map_err(|err| anyhow!("`{}` cannot be written: {err}", path.display()))
}

fn remove_if_there(path: &Path) -> anyhow::Result<()> {
    match std::fs::remove_file(path) {
        Err(err) if err.kind() != std::io::ErrorKind::NotFound => {
            Err(anyhow!("`{}` cannot be replaced: {err}", path.display()))
        }
        _ => Ok(()),
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "done in {:.2} s on {}; made", self.elapsed_s, self.backend)?;
        self.files.iter().try_for_each(|file| writeln!(f, "    {file}"))
    }
}
