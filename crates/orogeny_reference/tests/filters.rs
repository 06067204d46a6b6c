//! The filters of neighbourhood kernels against SciPy and OpenCV (`tests/fixtures/field/make_filters.py`).

#![allow(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that goes wrong is to fail"
)]

use orogeny_field::{
    PYRAMID_PHASES, PYRAMID_WEIGHTS, PhaseWeights, b_spline_phases, gaussian_weights, mirrored,
};
use orogeny_reference::field::{convolve, interpolate};

#[derive(Debug, Clone, PartialEq)]
struct Field {
    width: usize,
    depth: usize,
    samples: Vec<f32>,
}

impl Field {
    fn row(&self, z: i32) -> &[f32] {
        let z = mirrored(z, self.depth as u32) as usize;
        &self.samples[z * self.width..(z + 1) * self.width]
    }

    fn transposed(&self) -> Self {
        let samples =
            (0..self.width).flat_map(|x| (0..self.depth).map(move |z| self.samples[z * self.width + x]));
        Self { width: self.depth, depth: self.width, samples: samples.collect() }
    }
}

/// Along x by rows of x, along z by rows of z, with the field mirrored at its border.
fn convolved(field: &Field, weights: &[f32], stride: usize) -> Field {
    let radius = weights.len() as i32;
    let (width, depth) = (field.width.div_ceil(stride), field.depth.div_ceil(stride));
    let mut along_x = Field { width, depth: field.depth, samples: vec![f32::NAN; width * field.depth] };
    for (z, target) in along_x.samples.chunks_mut(width).enumerate() {
        let row = field.row(z as i32);
        let length = convolve::source_length(width, weights.len(), stride) as i32;
        let source: Vec<f32> =
            (-radius..length - radius).map(|x| row[mirrored(x, field.width as u32) as usize]).collect();
        convolve::row_along_x(target, &source, weights, stride);
    }
    let mut both = Field { width, depth, samples: vec![f32::NAN; width * depth] };
    for (z, target) in both.samples.chunks_mut(width).enumerate() {
        let centre = (z * stride) as i32;
        let rows: Vec<&[f32]> = (centre - radius..=centre + radius).map(|z| along_x.row(z)).collect();
        convolve::row_along_z(target, &rows, weights);
    }
    both
}

/// `sample(i)` is the coarse row at `i`, which may lie beyond the border.
fn interpolated_along_z(
    width: usize,
    depth: usize,
    phases: &[PhaseWeights],
    row: impl Fn(i32) -> Vec<f32>,
) -> Field {
    let mut field = Field { width, depth, samples: vec![f32::NAN; width * depth] };
    for (z, target) in field.samples.chunks_mut(width).enumerate() {
        let coarse = (z / phases.len()) as i32;
        let rows = [-1, 0, 1, 2].map(|away| row(coarse + away));
        let [a, b, c, d] = &rows;
        interpolate::row_along_z(target, [a, b, c, d], &phases[z % phases.len()]);
    }
    field
}

/// The same along x, by rows of x, from any column on.
fn interpolated_along_x(
    field: &Field,
    width: usize,
    phases: &[PhaseWeights],
    place: impl Fn(i32) -> usize,
) -> Field {
    let mut result = Field { width, depth: field.depth, samples: vec![f32::NAN; width * field.depth] };
    for (z, target) in result.samples.chunks_mut(width).enumerate() {
        let row = field.row(z as i32);
        let source: Vec<f32> =
            (-1..(width.div_ceil(phases.len()) + 2) as i32).map(|i| row[place(i)]).collect();
        interpolate::row_along_x(target, &source, phases, 0);
        // The second half once more, from where it begins.
        let first = width / 2;
        let (coarse, phase) = (first / phases.len(), first % phases.len());
        let mut half = vec![f32::NAN; width - first];
        interpolate::row_along_x(&mut half, &source[coarse..], phases, phase);
        assert_eq!(half, target[first..], "from column {first} on");
    }
    result
}

fn expanded(coarse: &Field, width: usize, depth: usize) -> Field {
    // A sample beyond the border lies where the finer field is mirrored.
    let place = |i: i32, length: usize| (mirrored(2 * i, length as u32) / 2) as usize;
    let row = |i: i32| coarse.row(place(i, depth) as i32).to_vec();
    let along_z = interpolated_along_z(coarse.width, depth, &PYRAMID_PHASES, row);
    interpolated_along_x(&along_z, width, &PYRAMID_PHASES, |i| place(i, width))
}

fn spline(field: &Field, spacing: usize) -> Field {
    let phases = b_spline_phases(spacing as u32);
    let row = |i: i32| field.row(i * spacing as i32).to_vec();
    let along_z = interpolated_along_z(field.width, field.depth, &phases, row);
    interpolated_along_x(&along_z, field.width, &phases, |i| {
        mirrored(i * spacing as i32, field.width as u32) as usize
    })
}

#[test]
fn filters_are_those_of_scipy_and_opencv() {
    let text = include_str!("../../../tests/fixtures/field/filters.json");
    let document: serde_json::Value = serde_json::from_str(text).unwrap();
    let mut num_cases = std::collections::BTreeMap::<String, usize>::new();
    for case in document["cases"].as_array().unwrap() {
        let size = |name: &str| case[name].as_u64().unwrap() as usize;
        let values = |name: &str| -> Vec<f32> {
            case[name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap() as f32).collect()
        };
        let source = Field { width: size("width"), depth: size("depth"), samples: values("source") };
        let (width, depth) = (size("result_width"), size("result_depth"));
        let kind = case["kind"].as_str().unwrap();
        let found = match kind {
            "gaussian" => convolved(&source, &gaussian_weights(case["sigma"].as_f64().unwrap()), 1),
            "reduce" => convolved(&source, &PYRAMID_WEIGHTS, 2),
            "expand" => expanded(&source, width, depth),
            "spline" => spline(&source, size("spacing")),
            other => panic!("`{other}`"),
        };
        assert_eq!((found.width, found.depth), (width, depth), "{kind}");
        let expected = values("result");
        assert_eq!(expected.len(), found.samples.len());
        for (place, (expected, found)) in expected.iter().zip(&found.samples).enumerate() {
            // Heights of up to 400 m: some units in the last place after each pass.
            assert!((expected - found).abs() < 2.0e-4, "{kind}, sample {place}: {found} and not {expected}");
        }
        // A field and its mirror image in the diagonal are filtered alike, but for the order of the passes.
        if kind == "gaussian" || kind == "spline" {
            let other = match kind {
                "gaussian" => {
                    convolved(&source.transposed(), &gaussian_weights(case["sigma"].as_f64().unwrap()), 1)
                }
                _ => spline(&source.transposed(), size("spacing")),
            };
            let pairs = other.transposed();
            assert!(pairs.samples.iter().zip(&found.samples).all(|(a, b)| (a - b).abs() < 2.0e-4), "{kind}");
        }
        *num_cases.entry(kind.to_owned()).or_default() += 1;
    }
    let counts: Vec<_> = num_cases.into_iter().collect();
    assert_eq!(
        counts,
        [("expand", 7), ("gaussian", 4), ("reduce", 6), ("spline", 3)].map(|(k, n)| (k.to_owned(), n))
    );
}

/// Long rows take other ways through the code than short ones: the same values, bit for bit.
#[test]
fn a_long_row_has_the_bits_of_its_parts() {
    let source: Vec<f32> =
        (0..2000_u32).map(|i| 500.0 + 80.0 * orogeny_field::hash::uniform(i, 3, 9)).collect();
    for (stride, weights) in
        [(1, gaussian_weights(3.3)), (2, PYRAMID_WEIGHTS.to_vec()), (2, vec![0.01; 20]), (3, vec![0.2])]
    {
        let num_values = (source.len() - 2 * weights.len() - 1) / stride + 1;
        let mut whole = vec![f32::NAN; num_values];
        convolve::row_along_x(&mut whole, &source, &weights, stride);
        for (place, expected) in whole.iter().enumerate() {
            let mut one = [f32::NAN];
            convolve::row_along_x(&mut one, &source[place * stride..], &weights, stride);
            assert_eq!(one[0].to_bits(), expected.to_bits(), "stride {stride}, value {place}");
        }
    }
    for phases in [PYRAMID_PHASES.to_vec(), b_spline_phases(8)] {
        let mut whole = vec![f32::NAN; 1500];
        interpolate::row_along_x(&mut whole, &source, &phases, 1);
        for (place, expected) in whole.iter().enumerate() {
            let (coarse, phase) = ((place + 1) / phases.len(), (place + 1) % phases.len());
            let mut one = [f32::NAN];
            interpolate::row_along_x(&mut one, &source[coarse..], &phases, phase);
            assert_eq!(one[0].to_bits(), expected.to_bits(), "{} phases, value {place}", phases.len());
        }
    }
}
