//! The GPU against the CPU on the same work, within section 10 of the kernel specification: any brush, every profile, page
//! sizes, budgets and terrains, strokes that cross borders and corners and that lie far outside.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::OnceLock;

use orogeny_brush::{CpuExecutor, Executor, GpuBudget, GpuExecutor};
use orogeny_field::{
    Brush, BrushType, Coverage, Curve, FieldId, PageLayout, PointerSample, PressureTarget, ProfileShape,
    SampleRect, Stroke, TerrainGrid,
};
use orogeny_gpu::Gpu;
use orogeny_pages::MemoryPages;
use orogeny_tests::{
    Agreement, Feed, Operation, Plane, Random, Reach, Split, apply, compare, gpu, paint, plan, terrain,
};

/// Each shape with the width of its slope over the radius; the first has a hard edge.
fn profiles() -> [(&'static str, ProfileShape, f64); 11] {
    let curve = vec![[0.0, 0.0], [0.2, 0.7], [0.6, 0.5], [1.0, 1.0]];
    [
        ("hard edge", ProfileShape::Linear, 0.0),
        ("linear", ProfileShape::Linear, 1.0),
        ("smooth", ProfileShape::Smooth, 0.7),
        ("sphere", ProfileShape::Sphere, 1.0),
        ("tip", ProfileShape::Tip, 0.6),
        ("gauss", ProfileShape::Gauss, 1.0),
        ("power 0.5", ProfileShape::Power { power: 0.5 }, 1.0),
        ("power 2", ProfileShape::Power { power: 2.0 }, 0.5),
        ("power 16", ProfileShape::Power { power: 16.0 }, 0.9),
        ("sigmoid 3", ProfileShape::Sigmoid { steepness: 3.0 }, 1.0),
        ("curve", ProfileShape::Curve(Curve::new("a test", curve).unwrap()), 0.8),
    ]
}

/// Whether a brush can be applied without a stroke.
fn can_fill(brush: &Brush) -> bool {
    let needs_stroke =
        matches!(brush.brush_type, BrushType::Ramp | BrushType::Stamp | BrushType::Smear | BrushType::Grab);
    !needs_stroke && brush.alpha.is_none()
}

/// Samples a side of a page, and a terrain of several of them, the last ones cut off by its edge.
const PAGES: [(u32, [u32; 2]); 3] = [(64, [170, 150]), (256, [290, 270]), (512, [520, 300])];

/// Pages that a budget holds, and layers of a texture array: one layer an array, two arrays of two, and all there is room for.
const BUDGETS: [(u64, u32); 3] = [(4, 1), (6, 2), (64, 256)];

/// Radii in samples: from where an instance is hardly seen to several pages.
const RADII: [f64; 6] = [0.6, 1.7, 7.3, 30.0, 90.0, 260.0];

/// A kind of terrain.
#[derive(Debug, Clone, Copy)]
pub enum Ground {
    Random,
    Extreme,
    Real,
}

/// One device for all: kernels take a software driver long to compile, and each is compiled once for a device. What a driver refuses then fails
/// the test that asks next.
fn shared_gpu() -> Gpu {
    static SHARED: OnceLock<Gpu> = OnceLock::new();
    SHARED.get_or_init(gpu).clone()
}

/// One device and its executors, each made when it is first needed.
struct BackEnds {
    gpu: Gpu,
    executors: HashMap<(usize, usize), (CpuExecutor, GpuExecutor)>,
}

impl BackEnds {
    fn of(&mut self, pages: usize, budget: usize) -> &mut (CpuExecutor, GpuExecutor) {
        self.executors.entry((pages, budget)).or_insert_with(|| {
            let layout = PageLayout::new(PAGES[pages].0).unwrap();
            let (num_pages, layers_per_array) = BUDGETS[budget];
            let budget_in_bytes = num_pages * layout.size_in_bytes();
            let cpu = CpuExecutor::new(layout, budget_in_bytes, Some(1)).unwrap();
            let budget = GpuBudget { budget_in_bytes, layers_per_array };
            (cpu, GpuExecutor::new(self.gpu.clone(), layout, budget).unwrap())
        })
    }
}

/// How often each brush meets each profile, on different pages, with different strokes.
const NUM_ROUNDS: usize = 2;

/// What came of the cases of one kind.
#[derive(Debug, Default)]
struct Figures {
    worst_share: f64,
    num_different: usize,
    num_reached: usize,
}

impl Figures {
    fn add(&mut self, compared: &Compared) {
        self.worst_share = self.worst_share.max(compared.agreement.worst.share());
        self.num_different += compared.agreement.num_different;
        self.num_reached += compared.num_reached;
    }
}

/// Which profiles each brush of a stage is tried with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profiles {
    /// All, and as a fill.
    All,
    /// One, a different one for each brush, and as a fill: for a kernel that takes a software driver long to compile, and whose
    /// profiles are those of the others.
    OneEach,
}

impl Profiles {
    /// Whether kind number `kind`, the last of which is the fill, is tried with a brush.
    fn has(self, kind: usize, brush: usize) -> bool {
        self == Self::All || kind == brush % profiles().len() || kind == profiles().len()
    }
}

/// Compares the back ends for each brush, with each profile as a stroke and as a fill, on one kind of ground.
pub fn assert_back_ends_agree(ground: Ground, brushes: &[(&str, Brush)], profiles_each: Profiles) {
    let mut back_ends = BackEnds { gpu: shared_gpu(), executors: HashMap::new() };
    let mut figures = BTreeMap::<String, Figures>::new();
    let profiles = profiles();
    let (mut num_cases, mut num_changed, mut num_over_pages) = (0, 0, 0);
    for _ in 0..NUM_ROUNDS {
        for (num_brushes, (name, brush)) in brushes.iter().enumerate() {
            for kind in (0..=profiles.len()).filter(|kind| profiles_each.has(*kind, num_brushes)) {
                let mut random = Random::new(num_cases as u64 * 3 + ground as u64);
                let profile = profiles.get(kind);
                // What needs a stroke is not filled with, but stroked once more.
                let profile = profile.or_else(|| (!can_fill(brush)).then_some(&profiles[0]));
                let operation = |place: &Place, random: &mut Random| match profile {
                    Some((_, shape, falloff_ratio)) => {
                        let brush = Brush { shape: shape.clone(), ..brush.clone() };
                        Operation::Stroke(stroke(&brush, *falloff_ratio, place, random))
                    }
                    None => fill(brush, place, random),
                };
                let is_for_masks = brush.brush_type.is_for_masks();
                let kind = format!("{name}, {}", profile.map_or("fill", |(profile, ..)| profile));
                let compared =
                    compare_once(&mut back_ends, ground, num_cases, &mut random, is_for_masks, operation)
                        .unwrap_or_else(|err| panic!("{kind}, {ground:?} ground, case {num_cases}: {err}"));
                num_changed += usize::from(compared.is_changed);
                num_over_pages += usize::from(compared.num_pages > 1);
                figures.entry(kind).or_default().add(&compared);
                num_cases += 1;
            }
        }
    }
    assert!(!brushes.is_empty());
    let num_kinds: usize = (0..brushes.len())
        .map(|brush| (0..=profiles.len()).filter(|kind| profiles_each.has(*kind, brush)).count())
        .sum();
    assert_eq!(num_cases, NUM_ROUNDS * num_kinds);
    // Some strokes lie beside the terrain, or move nothing; most do not, and many cross a border.
    assert!(num_changed * 2 > num_cases, "only {num_changed} of {num_cases} cases changed anything");
    assert!(num_over_pages * 3 > num_cases, "only {num_over_pages} of {num_cases} cases crossed a border");
    for (kind, Figures { worst_share, num_different, num_reached }) in figures {
        println!(
            "{ground:?}, {kind}: worst {worst_share:.3} of the tolerance, {num_different} of {num_reached} differ"
        );
    }
}

/// What one case showed.
struct Compared {
    agreement: Agreement,
    /// Samples that any instance acts on.
    num_reached: usize,
    num_pages: usize,
    is_changed: bool,
}

/// Where a case takes place.
struct Place {
    grid: TerrainGrid,
    page_size: u32,
}

fn compare_once(
    back_ends: &mut BackEnds,
    ground: Ground,
    case: usize,
    random: &mut Random,
    is_for_masks: bool,
    operation: impl Fn(&Place, &mut Random) -> Operation,
) -> Result<Compared, String> {
    // 11 profiles and a fill by 3, 3 and 6, shifted by the ground: each brush meets all of them.
    let (pages, budget) = (case % PAGES.len(), (case / PAGES.len() + ground as usize) % BUDGETS.len());
    let (page_size, [width, depth]) = PAGES[pages];
    let seed = random.bits();
    let before = match ground {
        Ground::Random => terrain::random(width, depth, seed),
        Ground::Extreme => terrain::extreme(width, depth, seed),
        Ground::Real => terrain::real(width, depth, (seed % 500) as u32, (seed >> 32) as u32 % 500),
    };
    let before = if is_for_masks { as_mask(&before) } else { before };
    let spacing_m = random.one_of(&[1.0, 0.37, 28.5]);
    let grid = TerrainGrid::new(width.into(), depth.into(), spacing_m).unwrap();
    let operation = operation(&Place { grid, page_size }, random);
    let layout = PageLayout::new(page_size).unwrap();
    let split = random.one_of(&[Split::Whole, Split::TwoHalves, Split::SampleBySample]);
    let feed = Feed { split, max_batch: random.one_of(&[1, 5, 64, usize::MAX]) };

    let (cpu, gpu) = back_ends.of(pages, budget);
    let on = |executor: &mut dyn Executor| {
        let painted = paint(&before, spacing_m, std::slice::from_ref(&operation), executor, layout, feed);
        painted.map(|painted| painted.plane).map_err(|err| format!("{err} ({operation:?}, {feed:?})"))
    };
    let (expected, found) = (on(cpu)?, on(gpu)?);
    back_ends.gpu.check().map_err(|err| err.to_string())?;

    let mut store = before.to_pages(layout, FieldId(0));
    let batches = plan(&operation, &grid, FieldId(0), &mut store, Feed::WHOLE).unwrap();
    let reach = Reach::of(&batches, &before);
    untouched(&before, &expected, &reach)?;
    let agreement =
        compare::within(&expected, &found, |x, z| reach.tolerance(x, z, before.at(x, z), expected.at(x, z)))
            .map_err(|mismatch| format!("{mismatch} ({operation:?}, pages of {page_size}, {feed:?})"))?;
    let pages: BTreeSet<_> =
        batches.iter().flat_map(|batch| batch.pages.iter().map(|work| work.key)).collect();
    Ok(Compared {
        agreement,
        num_reached: reach.num_reached(),
        num_pages: pages.len(),
        is_changed: compare::bit_equal(&before, &expected).is_err(),
    })
}

/// Heights as values of a mask.
pub fn as_mask(heights: &Plane) -> Plane {
    Plane::from_fn(heights.width(), heights.depth(), |x, z| (heights.at(x, z).abs() / 977.0).fract())
}

/// Whether what no instance reaches has kept its bits.
fn untouched(before: &Plane, after: &Plane, reach: &Reach) -> Result<(), String> {
    let only_outside = Plane::from_fn(before.width(), before.depth(), |x, z| {
        if reach.num_instances(x, z) == 0 { after.at(x, z) } else { before.at(x, z) }
    });
    let outside = compare::within(before, &only_outside, |x, z| {
        let tolerance = reach.tolerance(x, z, before.at(x, z), before.at(x, z));
        if reach.num_instances(x, z) == 0 { tolerance } else { orogeny_tests::Tolerance::EXACT }
    });
    outside.map(|_| ()).map_err(|mismatch| format!("outside all instances: {mismatch}"))
}

/// A stroke over a place.
fn stroke(brush: &Brush, falloff_ratio: f64, place: &Place, random: &mut Random) -> Stroke {
    let radius = random.one_of(&RADII);
    let spacing_m = place.grid.spacing_m();
    let size = [place.grid.width(), place.grid.depth()].map(f64::from);
    let page = f64::from(place.page_size);
    // As many steps as keep a software driver's time in bounds.
    let reach = (radius * 4.0).clamp(20.0, 150.0);
    let start = random.one_of(&[
        [page, page],                   // on a corner of four pages
        [page - 0.5, size[1] / 2.0],    // on a border
        [size[0] - 1.0, size[1] - 1.0], // on the terrain's last sample
        [-0.8 * radius, -0.3 * radius], // outside, reaching in
        [size[0] / 3.0, size[1] + radius * 0.9],
    ]);
    let mut position = start;
    let num_points = random.one_of(&[1, 2, 3, 5, 8]);
    let points = (0..num_points).map(|_| {
        let [x, z] = position;
        position = [x + random.within(-reach, reach) / 2.0, z + random.within(-reach, reach) / 2.0];
        PointerSample::at(x * spacing_m, z * spacing_m).with_pressure(random.within(0.2, 1.0) as f32)
    });
    let mut points: Vec<_> = points.collect();
    if brush.brush_type == BrushType::Ramp {
        // It leads somewhere.
        let [x, z] = [start[0] + 41.3, start[1] - 17.7];
        points.push(PointerSample::at(x * spacing_m, z * spacing_m));
    }
    let radius_m = radius * spacing_m;
    let targets =
        [PressureTarget::None, PressureTarget::Radius, PressureTarget::Strength, PressureTarget::Both];
    let brush = Brush {
        radius_m,
        falloff_m: radius_m * falloff_ratio,
        pressure: random.one_of(&targets),
        strength: strength(brush.brush_type, random),
        ..brush.clone()
    };
    Stroke { brush, seed: random.bits() as u32, points }
}

fn fill(brush: &Brush, place: &Place, random: &mut Random) -> Operation {
    let bounds = place.grid.bounds();
    let [x, z] = [random.within(-20.0, 60.0) as i32, random.within(-20.0, 60.0) as i32];
    let strength = strength(brush.brush_type, random);
    let brush = Brush { strength, height_m: brush.height_m.or(Some(412.5)), ..brush.clone() };
    Operation::Fill { brush, seed: 77, region: SampleRect::new(x, z, bounds.x1 - 30, bounds.z1 + 30) }
}

fn strength(brush_type: BrushType, random: &mut Random) -> f64 {
    match brush_type.coverage() {
        Coverage::Additive => random.one_of(&[0.01, 3.0, 47.3, 4_000.0]),
        Coverage::Blending => random.one_of(&[0.03, 0.5, 0.9, 1.0]),
    }
}

/// Single dabs over a corner of four pages, at the origin of a terrain or a million samples from it.
pub struct Dabs {
    gpu: Gpu,
    cpu: CpuExecutor,
    on_gpu: GpuExecutor,
    layout: PageLayout,
}

impl Dabs {
    pub fn new() -> Self {
        let layout = PageLayout::new(64).unwrap();
        let gpu = shared_gpu();
        let budget = GpuBudget { budget_in_bytes: 8 * layout.size_in_bytes(), layers_per_array: 8 };
        let cpu = CpuExecutor::new(layout, 8 * layout.size_in_bytes(), None).unwrap();
        Self { on_gpu: GpuExecutor::new(gpu.clone(), layout, budget).unwrap(), gpu, cpu, layout }
    }

    /// The largest share of the tolerance that a dab of 20 samples' radius differs by.
    pub fn compare(&mut self, brush: &Brush, far: bool) -> Result<f64, String> {
        let side: u64 = if far { 1 << 20 } else { 256 };
        let grid = TerrainGrid::new(side, side, 2.0).unwrap();
        let corner = if far { (1 << 20) - 128 } else { 64 };
        let centre_m = 2.0 * f64::from(corner) - 0.6;
        let brush = Brush { radius_m: 40.0, falloff_m: 20.0, strength: 50.0, ..brush.clone() };
        let points = vec![PointerSample::at(centre_m, centre_m)];
        let operation = Operation::Stroke(Stroke { brush, seed: 21, points });
        let mut planes = Vec::new();
        for executor in [&mut self.cpu as &mut dyn Executor, &mut self.on_gpu] {
            let mut store = MemoryPages::new(self.layout, 10.0);
            apply(&operation, &grid, FieldId(1), executor, &mut store, Feed::WHOLE)
                .map_err(|err| err.to_string())?;
            let pages: BTreeMap<_, _> = store.pages_unsorted().iter().collect();
            if pages.len() != 4 {
                return Err(format!("{} pages instead of 4", pages.len()));
            }
            executor.forget(&pages.keys().map(|key| **key).collect::<Vec<_>>());
            planes.push(pages.values().flat_map(|page| page.samples().to_vec()).collect::<Vec<f32>>());
        }
        self.gpu.check().map_err(|err| err.to_string())?;
        let plane = |samples: &[f32]| Plane::new(64, 256, samples.to_vec());
        let (expected, found) = (plane(&planes[0]), plane(&planes[1]));
        let mut store = MemoryPages::new(self.layout, 10.0);
        let batches =
            plan(&operation, &grid, FieldId(1), &mut store, Feed::WHOLE).map_err(|err| err.to_string())?;
        let absolute_m = 50.0 * Reach::share(&batches[0]);
        let tolerance = orogeny_tests::Tolerance { ulps: 6.0, of_m: 100.0, absolute_m };
        let agreement =
            compare::within(&expected, &found, |_, _| tolerance).map_err(|err| err.to_string())?;
        if expected.samples().iter().all(|height| *height == 10.0) {
            return Err("nothing was painted".to_owned());
        }
        Ok(agreement.worst.share())
    }
}

/// The tests that both back ends agree on a stage's brushes, on each kind of ground.
macro_rules! back_ends_agree {
    ($brushes:path) => {
        $crate::agreement::back_ends_agree!($brushes, All);
    };
    ($brushes:path, $profiles:ident) => {
        #[test]
        fn back_ends_agree_on_random_ground() {
            $crate::agreement::assert_back_ends_agree(
                $crate::agreement::Ground::Random,
                &$brushes(),
                $crate::agreement::Profiles::$profiles,
            );
        }

        #[test]
        fn back_ends_agree_on_extreme_ground() {
            $crate::agreement::assert_back_ends_agree(
                $crate::agreement::Ground::Extreme,
                &$brushes(),
                $crate::agreement::Profiles::$profiles,
            );
        }

        #[test]
        fn back_ends_agree_on_real_ground() {
            $crate::agreement::assert_back_ends_agree(
                $crate::agreement::Ground::Real,
                &$brushes(),
                $crate::agreement::Profiles::$profiles,
            );
        }
    };
}

pub(crate) use back_ends_agree;
