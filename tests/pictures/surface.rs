//! What the vertex shader makes is what the geometry on the CPU says; a picture after an edit is that of a terrain that was opened afresh.

use glam::DVec3;
use orogeny_geomip::{
    Camera, DetailRule, DrawnTile, Fog, Light, MIN_NEAR_M, Metric, Mode, PageRelief, Renderer, Scene, Sky,
    TILE_CELLS, Targets, indices, select,
};
use orogeny_gpu::Gpu;
use orogeny_tests::gpu;

use crate::ground::Ground;

const SIZE: [u32; 2] = [160, 120];

fn hills(x: u32, z: u32) -> f32 {
    let (x, z) = (x as f32, z as f32);
    40.0 * (x / 23.0).sin() * (z / 31.0).cos()
        + 6.0 * (x / 5.0).sin()
        + if x > z + 300.0 { 60.0 } else { 0.0 }
}

fn scene(mode: Mode, max_error_px: f64) -> Scene {
    Scene {
        mode,
        detail: DetailRule { metric: Metric::Roughness, max_error_px },
        sky: Sky::new(300.0, 35.0, 1.0),
        light: Light::default(),
        fog: Fog { density: 0.0, falloff: 0.001, base_m: 0.0 },
        water_level_m: None,
        range_m: [-50.0, 120.0],
        contour_m: 10.0,
        overlay_range: [0.0, 1.0],
        unpainted_overlay: [0.0; 4],
        cursors: Vec::new(),
    }
}

fn settled(renderer: &mut Renderer, ground: &Ground, camera: &Camera, scene: &Scene, targets: &Targets) {
    let relief = PageRelief::new(ground.grid, ground.layout, ground);
    for place in renderer.want(camera, scene, &relief) {
        renderer.upload(place, &ground.page(place), None).unwrap();
    }
    let report = renderer.draw(camera, scene, &relief, targets).unwrap();
    assert_eq!(report.num_missing, 0);
    assert!(report.num_tiles > 0 && report.num_triangles > 0, "{report:?}");
}

fn new_renderer(gpu: &Gpu, ground: &Ground) -> Renderer {
    Renderer::new(gpu, ground.grid, ground.layout, 0.0, 64 << 20).unwrap()
}

/// Distances before the eye, row by row; infinite where there is no ground.
fn depths_m(gpu: &Gpu, targets: &Targets) -> Vec<f64> {
    let [width, height] = SIZE;
    let row_bytes = (width * 4).next_multiple_of(256);
    let buffer = gpu
        .create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: u64::from(row_bytes * height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
        .unwrap();
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row_bytes), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(targets.depth().as_image_copy(), to, targets.depth().size());
    gpu.queue().submit([encoder.finish()]);
    let words = gpu.read_buffer(&buffer).unwrap();
    let rows = words.chunks_exact((row_bytes / 4) as usize);
    rows.flat_map(|row| &row[..width as usize])
        .map(|bits| MIN_NEAR_M / f64::from(f32::from_bits(*bits)))
        .collect()
}

/// The nearest distance before the eye at which a pixel's ray meets a triangle, as the CPU has them.
fn nearest_m(camera: &Camera, direction: DVec3, triangles: &[[DVec3; 3]]) -> f64 {
    let [_, _, backward] = camera.axes();
    let forward = direction.dot(-backward);
    let meets = |[a, b, c]: &[DVec3; 3]| {
        // Möller and Trumbore, 1997.
        let (first, second) = (*b - *a, *c - *a);
        let across = direction.cross(second);
        let determinant = first.dot(across);
        let from = camera.eye_m() - *a;
        let u = from.dot(across) / determinant;
        let around = from.cross(first);
        let v = direction.dot(around) / determinant;
        let distance = second.dot(around) / determinant;
        (determinant != 0.0 && u >= -1e-9 && v >= -1e-9 && u + v <= 1.0 + 1e-9 && distance > 0.0)
            .then_some(distance * forward)
    };
    triangles.iter().filter_map(meets).fold(f64::INFINITY, f64::min)
}

fn triangles(ground: &Ground, drawn: &[DrawnTile]) -> Vec<[DVec3; 3]> {
    let height_m = |level: u8, sample: [u32; 2]| ground.height_m(level, sample);
    let of_tile = |tile: &DrawnTile| {
        let vertex = |index: u16| {
            let row = TILE_CELLS + 1;
            tile.vertex_m([u32::from(index) % row, u32::from(index) / row], &ground.grid, &height_m)
        };
        indices(tile.step()).as_chunks::<3>().0.iter().map(|corners| corners.map(vertex)).collect::<Vec<_>>()
    };
    drawn.iter().flat_map(of_tile).collect()
}

#[test]
fn the_surface_is_where_the_cpu_says_at_every_detail() {
    let gpu = gpu();
    let mut num_compared = 0;
    // Fine and coarse, and tiles on their way between levels; pages of two sizes; a terrain that ends within a tile.
    for (page_size, max_error_px) in [(64, 0.5), (64, 6.0), (256, 3.0), (64, 25.0)] {
        let ground = Ground::new(700, 450, page_size, hills);
        let mut renderer = new_renderer(&gpu, &ground);
        let targets = Targets::new(&gpu, SIZE).unwrap();
        let eyes = [
            (DVec3::new(-150.0, 160.0, -120.0), DVec3::new(500.0, 0.0, 400.0)),
            (DVec3::new(700.0, 300.0, 880.0), DVec3::new(702.0, 0.0, 300.0)),
        ];
        for (eye_m, target_m) in eyes {
            let camera = Camera::looking_at(eye_m, target_m, 0.9, SIZE);
            let scene = scene(Mode::Shaded, max_error_px);
            settled(&mut renderer, &ground, &camera, &scene, &targets);
            let found = depths_m(&gpu, &targets);
            let relief = PageRelief::new(ground.grid, ground.layout, &ground);
            let drawn = select(&ground.grid, &camera, &scene.detail, &relief, usize::MAX);
            let triangles = triangles(&ground, &drawn);
            let (mut num_off, mut num) = (0, 0);
            for place in (0..SIZE[0] * SIZE[1]).step_by(67) {
                let [x, y] = [f64::from(place % SIZE[0]) + 0.5, f64::from(place / SIZE[0]) + 0.5];
                let expected = nearest_m(&camera, camera.direction_of_pixel([x, y]), &triangles);
                let found = found[place as usize];
                num += 1;
                // Where a ray passes an edge by less than a rounding, the two may see different sides of it.
                let is_same = (found.is_infinite() && expected.is_infinite())
                    || (found - expected).abs() <= 1.0e-3 * expected.max(1.0);
                num_off += u32::from(!is_same);
            }
            assert!(
                num_off * 100 <= num,
                "{num_off} of {num} differ: {page_size}, {max_error_px} px, {eye_m}"
            );
            num_compared += num;
        }
    }
    assert!(num_compared > 2_000, "{num_compared}");
    gpu.check().unwrap();
}

#[test]
fn after_an_edit_the_picture_is_that_of_a_terrain_opened_afresh() {
    let gpu = gpu();
    let before = Ground::new(700, 450, 64, hills);
    let raised = |x: u32, z: u32| {
        let away = (f64::from(x) - 350.0).hypot(f64::from(z) - 200.0);
        hills(x, z) + (30.0 * (1.0 - away / 60.0).max(0.0)) as f32
    };
    let after = Ground::new(700, 450, 64, raised);
    let targets = Targets::new(&gpu, SIZE).unwrap();
    let camera =
        Camera::looking_at(DVec3::new(600.0, 220.0, 900.0), DVec3::new(700.0, 0.0, 300.0), 0.9, SIZE);
    let scene = scene(Mode::Shaded, 2.0);
    let mut renderer = new_renderer(&gpu, &before);
    settled(&mut renderer, &before, &camera, &scene, &targets);
    let old = targets.read(&gpu).unwrap();
    // What the edit touched, on every level; the first sample of a page is the last of the cells before it.
    renderer.forget(|place| {
        before
            .page(*place)
            .samples()
            .iter()
            .zip(after.page(*place).samples())
            .any(|(a, b)| a.to_bits() != b.to_bits())
    });
    settled(&mut renderer, &after, &camera, &scene, &targets);
    let edited = targets.read(&gpu).unwrap();
    let mut fresh = new_renderer(&gpu, &after);
    settled(&mut fresh, &after, &camera, &scene, &targets);
    let opened = targets.read(&gpu).unwrap();
    assert!(edited != old, "the edit does not show");
    assert!(edited == opened, "the picture depends on what was drawn before");
    // Nor does it depend on where the camera was before.
    let elsewhere =
        Camera::looking_at(DVec3::new(100.0, 50.0, 100.0), DVec3::new(700.0, 0.0, 300.0), 0.9, SIZE);
    settled(&mut fresh, &after, &elsewhere, &scene, &targets);
    settled(&mut fresh, &after, &camera, &scene, &targets);
    assert!(targets.read(&gpu).unwrap() == opened);
    gpu.check().unwrap();
}
