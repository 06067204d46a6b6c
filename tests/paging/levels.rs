//! Levels of a field as they lie on a device: the bits of what is on disk, once it is there.

use orogeny_brush::Executor;
use orogeny_field::{FieldId, HeightBounds, PageKey, PageLayout, Plane, SampleRect, TerrainGrid};
use orogeny_gpu::{DevicePlane, Gpu};
use orogeny_pages::{MemoryPages, PageStore as _};
use orogeny_reference::field::coarsen;
use orogeny_tests::{Feed, apply, gpu};

use crate::{LOOP, cpu_executor, gpu_executor, raise, roughen, stroke, wash};

const FIELD: FieldId = FieldId(4);
const NUM_LEVELS: u8 = 4;

/// All of a field.
fn field(grid: &TerrainGrid, store: &mut MemoryPages) -> Plane {
    let layout = store.layout();
    let mut plane = Plane::constant(grid.bounds(), store.constant(FIELD));
    for (x, z) in layout.pages_in(grid.bounds()) {
        let key = PageKey::full_resolution(FIELD, x, z);
        if let Some(page) = store.load(&key).unwrap() {
            plane.paste(&page, &layout.page_rect(&key), &grid.bounds());
        }
    }
    plane
}

/// The next level by the reference, with the border's samples beyond it.
fn above(below: &Plane, bounds: SampleRect) -> Plane {
    let rect = below.rect();
    let row = |z: i32| -> Vec<f32> {
        let row = below.row(z.clamp(0, rect.z1 - 1)).unwrap();
        (-1..=2 * bounds.x1).map(|x| row[x.clamp(0, rect.x1 - 1) as usize]).collect()
    };
    let mut plane = Plane::constant(bounds, f32::NAN);
    for z in bounds.z0..bounds.z1 {
        let [north, centre, south] = [-1, 0, 1].map(|away| row(2 * z + away));
        let num = 2 * bounds.width() as usize + 1;
        coarsen::row(plane.row_mut(z).unwrap(), &north[..num], &centre[..num], &south[..num]);
    }
    plane
}

fn read(gpu: &Gpu, plane: &DevicePlane) -> Vec<f32> {
    let size = plane.buffer.size();
    let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
    let buffer = gpu.create_buffer(&descriptor).unwrap();
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(&plane.buffer, 0, &buffer, 0, size);
    gpu.queue().submit([encoder.finish()]);
    gpu.read_buffer(&buffer).unwrap().into_iter().map(f32::from_bits).collect()
}

#[test]
fn levels_have_the_bits_of_those_on_disk_before_they_are_there() {
    let gpu = gpu();
    let mut num_compared = 0;
    for [width, depth] in [[200, 150], [193, 131]] {
        let layout = PageLayout::new(64).unwrap();
        let grid = TerrainGrid::new(width, depth, 1.0).unwrap();
        let mut executor = gpu_executor(&gpu, layout, 64);
        let mut store = MemoryPages::new(layout, -3.5);
        for brush in [raise(), roughen(), wash()] {
            let operation = stroke(brush, &LOOP);
            apply(&operation, &grid, FIELD, &mut executor, &mut store, Feed::WHOLE).unwrap();
            store.commit();
            let mut expected = vec![field(&grid, &mut store)];
            for level in 1..NUM_LEVELS {
                let next = above(expected.last().unwrap(), grid.bounds_at(level));
                expected.push(next);
            }
            for part in [grid.bounds(), SampleRect::new(37, 20, 150, 97), SampleRect::new(64, 64, 65, 70)] {
                let wanted: Vec<_> = (0..NUM_LEVELS)
                    .map(|level| {
                        let scale = |place: i32| place.div_euclid(1 << level);
                        let rect = SampleRect::new(
                            scale(part.x0),
                            scale(part.z0),
                            scale(part.x1) + 1,
                            scale(part.z1) + 1,
                        );
                        // Not of each.
                        if level == 2 { SampleRect::EMPTY } else { rect.intersection(&grid.bounds_at(level)) }
                    })
                    .collect();
                let levels = executor.levels(FIELD, &grid, &wanted, &mut store).unwrap().unwrap();
                assert_eq!(levels.planes.len(), wanted.len());
                let mut known: Option<HeightBounds> = None;
                for ((plane, rect), expected) in levels.planes.iter().zip(&wanted).zip(&expected) {
                    assert_eq!(plane.is_none(), rect.is_empty());
                    let Some(plane) = plane else { continue };
                    let samples = read(&gpu, plane);
                    for z in rect.z0..rect.z1 {
                        let first = plane.offset([rect.x0, z], [rect.width(), 1]).unwrap() as usize / 4;
                        let found = &samples[first..first + rect.width() as usize];
                        let from = rect.x0 as usize;
                        let expected = &expected.row(z).unwrap()[from..from + rect.width() as usize];
                        let bits =
                            |row: &[f32]| row.iter().map(|height| height.to_bits()).collect::<Vec<_>>();
                        assert!(bits(found) == bits(expected), "{width} x {depth}, {part:?}, row {z}");
                        let here = HeightBounds::of_row(expected).unwrap();
                        known = Some(known.map_or(here, |known| known.with(here)));
                        num_compared += found.len();
                    }
                }
                let (known, bounds) = (known.unwrap(), levels.bounds);
                assert!(bounds.min_m <= known.min_m && bounds.max_m >= known.max_m, "{bounds:?} {known:?}");
                if part == grid.bounds() {
                    assert_eq!(bounds, HeightBounds::of_row(expected[0].samples()).unwrap());
                }
            }
        }
    }
    assert!(num_compared > 100_000, "{num_compared}");
    gpu.check().unwrap();
}

#[test]
fn what_does_not_lie_on_a_device_is_not_given() {
    let layout = PageLayout::new(64).unwrap();
    let grid = TerrainGrid::new(200, 150, 1.0).unwrap();
    let gpu = gpu();
    let mut store = MemoryPages::new(layout, 0.0);
    let mut levels = |executor: &mut dyn Executor, wanted: &[SampleRect]| {
        executor.levels(FIELD, &grid, wanted, &mut store).unwrap()
    };
    assert_eq!(levels(&mut cpu_executor(layout, 64, 1), &[grid.bounds()]), None, "on the CPU");
    let mut executor = gpu_executor(&gpu, layout, 64);
    assert_eq!(levels(&mut executor, &[grid.bounds()]), None, "nothing is resident");
    assert_eq!(levels(&mut executor, &[]), None, "nothing is wanted");
    assert_eq!(
        levels(&mut executor, &[SampleRect::EMPTY, SampleRect::new(500, 500, 600, 600)]),
        None,
        "beyond"
    );
}
