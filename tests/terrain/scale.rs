//! Ten thousand strokes on a terrain of four thousand million samples, in little memory: the last cost what the first did.

use std::path::Path;
use std::process::Command;

use orogeny_field::{FieldId, Page, PageKey, PageLayout, TerrainGrid};
use orogeny_store::{Counters, NewLayer, NewTerrain, Store};
use orogeny_tests::Random;
use orogeny_tests::child::{acknowledge, acknowledged, as_child, child_arguments, child_path, is_long};

const TEST: &str = "scale::ten_thousand_strokes_cost_what_the_first_did";

/// The address space that the child may take, in KiB: twice what it takes, most of which is stacks and arenas of threads.
const LIMIT_KIB: u64 = 300_000;

const SIDE_SAMPLES: u64 = 65_536;
const PAGE_SIZE: u32 = 64;

/// Strokes whose costs are averaged, and the places that they go round: the same work in each.
fn window() -> u32 {
    if is_long() { 1000 } else { 500 }
}

fn num_strokes() -> u32 {
    if is_long() { 10_000 } else { 2_000 }
}

fn layout() -> PageLayout {
    PageLayout::new(PAGE_SIZE).unwrap()
}

/// A disc on the corner of four pages, of noise that differs from stroke to stroke.
fn disc(store: &Store, field: FieldId, corner: [u32; 2], seed: u64) -> Vec<(PageKey, Page)> {
    const RADIUS: i64 = 20;
    let mut random = Random::new(seed);
    let middle = corner.map(|pages| i64::from(pages * PAGE_SIZE));
    let keys = [[-1, -1], [0, -1], [-1, 0], [0, 0]].map(|[x, z]: [i32; 2]| {
        PageKey::full_resolution(field, corner[0].wrapping_add_signed(x), corner[1].wrapping_add_signed(z))
    });
    let painted = |key: PageKey| {
        let page = store.load_page(&key).unwrap();
        let mut page = page.map_or_else(|| Page::constant(layout(), 0.0), std::sync::Arc::unwrap_or_clone);
        let size = PAGE_SIZE as usize;
        for (index, height) in page.samples_mut().iter_mut().enumerate() {
            let x = i64::from(key.x * PAGE_SIZE) + (index % size) as i64 - middle[0];
            let z = i64::from(key.z * PAGE_SIZE) + (index / size) as i64 - middle[1];
            if x * x + z * z < RADIUS * RADIUS {
                *height = random.within(0.0, 100.0) as f32;
            }
        }
        (key, page)
    };
    keys.map(painted).to_vec()
}

fn difference(after: &Counters, before: &Counters) -> [u64; 5] {
    [
        after.num_queries - before.num_queries,
        after.num_pages_read - before.num_pages_read,
        after.num_pages_written - before.num_pages_written,
        after.bytes_read - before.bytes_read,
        after.bytes_written - before.bytes_written,
    ]
}

fn paint(path: &Path) {
    let grid = TerrainGrid::new(SIDE_SAMPLES, SIDE_SAMPLES, 1.0).unwrap();
    let layers = vec![NewLayer { name: "Base".to_owned(), constant_m: 0.0 }];
    let mut store = Store::create(path, &NewTerrain { grid, layout: layout(), layers }).unwrap();
    let field = store.layers()[0].heights;
    let mut random = Random::new(0x05ee_d006);
    let mut place = || 1 + (random.bits() % (SIDE_SAMPLES / u64::from(PAGE_SIZE) - 2)) as u32;
    let corners: Vec<[u32; 2]> = (0..window()).map(|_| [place(), place()]).collect();
    let mut costs = Vec::new();
    for number in 0..num_strokes() {
        let pages = disc(&store, field, corners[(number % window()) as usize], number.into());
        let before = store.counters();
        let mut transaction = store.begin().unwrap();
        transaction.write_pages(&pages).unwrap();
        transaction.commit(&format!("{{\"number\": {number}}}"), "child").unwrap();
        costs.push(difference(&store.counters(), &before));
    }
    let mean = |costs: &[[u64; 5]]| -> [f64; 5] {
        std::array::from_fn(|what| {
            costs.iter().map(|cost| cost[what] as f64).sum::<f64>() / costs.len() as f64
        })
    };
    let size = window() as usize;
    let (early, late) = (mean(&costs[size..2 * size]), mean(&costs[costs.len() - size..]));
    println!("of a stroke: queries, pages read, pages written, bytes read, bytes written");
    println!("strokes {size} to {}: {early:.1?}", 2 * size);
    println!("the last {size}: {late:.1?}");
    for (early, late) in early.iter().zip(&late) {
        assert!(*early > 0.0 && (late / early - 1.0).abs() <= 0.05, "{early} became {late}");
    }
    acknowledge(&format!("painted {}", costs.len()));

    let num_pages = store.page_keys(field).unwrap().len();
    println!("{num_pages} pages in {} bytes of file", store.file_size_in_bytes().unwrap());
    assert_eq!(store.undo(u32::MAX).unwrap().len(), costs.len());
    assert!(store.page_keys(field).unwrap().is_empty());
    acknowledge(&format!("undone {}", costs.len()));
    store.close().unwrap();
    acknowledge("closed");
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        let peaks = status.lines().filter(|line| line.starts_with("VmPeak") || line.starts_with("VmHWM"));
        println!("{}", peaks.collect::<Vec<_>>().join(", "));
    }
}

#[test]
fn ten_thousand_strokes_cost_what_the_first_did() {
    if let Some(path) = child_path() {
        return paint(&path);
    }
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new("sh");
    as_child(&mut command, &folder.path().join("t.orogeny"))
        .args(["-c", &format!("ulimit -v {LIMIT_KIB} && exec \"$0\" \"$@\"")])
        .arg(std::env::current_exe().unwrap())
        .args(child_arguments(TEST));
    // What threads reserve depends on the machine, and is not what this is about.
    command.env("RAYON_NUM_THREADS", "2").env("MALLOC_ARENA_MAX", "2");
    let output = command.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    println!("{}", text.lines().filter(|line| !line.starts_with("test ")).collect::<Vec<_>>().join("\n"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let count = num_strokes();
    let expected = [format!("painted {count}"), format!("undone {count}"), "closed".to_owned()];
    assert_eq!(acknowledged(&output.stdout), expected);
}
