//! `files`: import and export of 4096 x 4096 heights, beside what a script would take to read and write the same files: NumPy, Pillow, and GDAL
//! through rasterio. An import ends with a terrain on disk, with its levels; a script's ends with an array.
//!
//! And the peak of memory that each takes, in a process of its own, beside the size of the heights.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, bail, ensure};
use orogeny_engine::{
    Adapter, ExportOptions, ExportRequest, ImportOptions, ImportRequest, Operation, Quiet, Settings, Terrain,
    TerrainGrid,
};

use crate::measure::Times;
use crate::python;
use crate::report::{Figure, Report, Unit};
use crate::stores::scratch_folder;

const SIDE: u64 = 4096;
const NUM_SAMPLES: f64 = (SIDE * SIDE) as f64;
const RANGE_M: (f64, f64) = (-1000.0, 2000.0);
/// Of pages, for the peak of memory: less than the heights have.
const BUDGET_IN_BYTES: u64 = 32 << 20;
/// By which a process knows that it is the one whose memory is looked at.
const CHILD: &str = "OROGENY_BENCH_CHILD";

/// A file name and who reads and writes such files in Python.
const FORMATS: [(&str, &str); 4] =
    [("h.r16", "NumPy"), ("h.npy", "NumPy"), ("h.png", "Pillow"), ("h.tif", "GDAL")];

pub fn run(report: &mut Report, repeat: usize) -> Result<()> {
    let folder = scratch_folder()?;
    let python = python::interpreter(report);
    let source = folder.path().join("source.orogeny");
    let mut terrain = Terrain::create(&source, TerrainGrid::new(SIDE, SIDE, 1.0)?, 500.0, settings())?;
    let hills = r#"{"op": "fill", "brush": {"type": "noise", "strength": 300, "feature_size": 1500}}"#;
    terrain.apply(&[Operation::from_json_text(hills)?], &mut Quiet)?;
    for (file, theirs) in FORMATS {
        let path = folder.path().join(file);
        let (mut imports, mut exports) = (Times::default(), Times::default());
        let (mut their_imports, mut their_exports) = (Times::default(), Times::default());
        for round in 0..repeat {
            exports.measure(|| terrain.export(&export_of(&path), &mut Quiet))?;
            let made = folder.path().join(format!("made-{round}-{file}.orogeny"));
            let (new, _) =
                imports.measure(|| Terrain::from_raster(&made, &import_of(&path), settings(), &mut Quiet))?;
            new.close()?;
            std::fs::remove_file(&made)?;
            if let Some(python) = &python {
                let [import_s, export_s] = in_python(python, &path)?;
                their_imports.add(import_s);
                their_exports.add(export_s);
            }
        }
        let ending = file.trim_start_matches("h.");
        for (what, own, their_times) in
            [("import", imports, their_imports), ("export", exports, their_exports)]
        {
            let limit = (!their_times.is_empty()).then(|| NUM_SAMPLES / their_times.median_s());
            let mut add = |name: String, times: &Times, limit| {
                report.add(Figure::per_second(name, Unit::SamplesPerSecond, times, NUM_SAMPLES, limit));
            };
            add(format!("files {what} .{ending}"), &own, limit);
            if limit.is_some() {
                add(format!("files {what} .{ending}, {theirs}"), &their_times, None);
            }
        }
    }
    let png = folder.path().join("h.png");
    terrain.close()?;
    report.note(format!(
        "peaks of memory: heights of {} MiB, a page budget of {} MiB",
        (SIDE * SIDE * 4) >> 20,
        BUDGET_IN_BYTES >> 20
    ));
    for (what, input, output) in
        [("nothing", &png, "none"), ("import", &png, "peak.orogeny"), ("export", &source, "peak.png")]
    {
        let bytes = peak_of(what, input, &folder.path().join(output))?;
        report.add(Figure::size(format!("files peak of memory, {what}"), bytes));
    }
    Ok(())
}

fn settings() -> Settings {
    Settings { adapter: Adapter::Cpu, ..Settings::default() }
}

fn export_of(path: &Path) -> ExportRequest {
    let is_whole_numbers = path.extension().is_some_and(|ending| ending == "r16" || ending == "png");
    let options = ExportOptions { range_m: is_whole_numbers.then_some(RANGE_M), ..ExportOptions::default() };
    ExportRequest { options, ..ExportRequest::new(path) }
}

fn import_of(path: &Path) -> ImportRequest {
    let is_headless = path.extension().is_some_and(|ending| ending == "r16");
    let size = is_headless.then_some((SIDE as u32, SIDE as u32));
    let options = ImportOptions { size, spacing_m: Some(1.0), ..ImportOptions::default() };
    ImportRequest { file: path.to_owned(), options, layer: None, at_m: [0.0, 0.0] }
}

/// Seconds that reading the file and writing it again take.
fn in_python(python: &OsStr, path: &Path) -> Result<[f64; 2]> {
    const PROGRAM: &str = r"
import sys, time, numpy
path, side = sys.argv[1], int(sys.argv[2])
ending = path.rsplit('.', 1)[1]
def read():
    if ending == 'r16': return numpy.fromfile(path, numpy.uint16).reshape(side, side).astype(numpy.float32)
    if ending == 'npy': return numpy.load(path)
    if ending == 'png':
        from PIL import Image
        return numpy.asarray(Image.open(path)).astype(numpy.float32)
    import rasterio
    with rasterio.open(path) as file: return file.read(1)
def write(heights):
    target = path + '.' + ending
    if ending == 'r16': heights.astype(numpy.uint16).tofile(target)
    elif ending == 'npy': numpy.save(target, heights)
    elif ending == 'png':
        from PIL import Image
        Image.fromarray(heights.astype(numpy.uint16)).save(target)
    else:
        import rasterio
        with rasterio.open(target, 'w', driver='GTiff', width=side, height=side, count=1, dtype='float32', compress='deflate', num_threads='all_cpus') as file:
            file.write(heights, 1)
heights = read()
start = time.perf_counter(); heights = read(); print(time.perf_counter() - start)
start = time.perf_counter(); write(heights); print(time.perf_counter() - start)
";
    python::seconds(python, PROGRAM, &[path.display().to_string(), SIDE.to_string()])
}

/// The most memory that a process of this program ever had while it did one thing.
fn peak_of(what: &str, input: &Path, output: &Path) -> Result<f64> {
    let program = std::env::current_exe()?;
    let said = Command::new(program).env(CHILD, what).arg(input).arg(output).output()?;
    ensure!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    String::from_utf8(said.stdout)?.trim().parse().context("a peak is no number")
}

/// Does the one thing, where this process was started for that, and gives its peak of memory in bytes.
pub fn as_child() -> Result<Option<f64>> {
    let Some(what) = std::env::var_os(CHILD) else { return Ok(None) };
    let paths: Vec<_> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [input, output] = paths.as_slice() else { bail!("an input and an output are missing") };
    let settings = Settings { page_budget_in_bytes: BUDGET_IN_BYTES, ..settings() };
    match what.to_str() {
        Some("nothing") => {}
        Some("import") => Terrain::from_raster(output, &import_of(input), settings, &mut Quiet)?.0.close()?,
        Some("export") => {
            Terrain::open_to_read(input, settings)?.export(&export_of(output), &mut Quiet)?;
        }
        _ => bail!("there is no such task: {}", what.display()),
    }
    let status =
        std::fs::read_to_string("/proc/self/status").context("only Linux tells the peak of memory")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).context("there is no VmHWM")?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse()?;
    Ok(Some(kib * 1024.0))
}
