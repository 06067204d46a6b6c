//! Structs: names, offsets, sizes.

use std::collections::BTreeSet;

use orogeny_brush::filter::kernels::band::BandUniform;
use orogeny_brush::filter::kernels::channel::ChannelUniform;
use orogeny_brush::filter::kernels::combine::CombineUniform;
use orogeny_brush::filter::kernels::grab::GrabUniform;
use orogeny_brush::filter::kernels::resample::ResampleUniform;
use orogeny_brush::filter::kernels::sharpen::SharpenUniform;
use orogeny_brush::filter::kernels::shift::ShiftUniform;
use orogeny_brush::filter::kernels::{InputUniform, PlaneUniform, StepUniform};
use orogeny_brush::kernels::custom::CustomUniform;
use orogeny_brush::kernels::ledge::LedgeUniform;
use orogeny_brush::kernels::level::LevelUniform;
use orogeny_brush::kernels::mask::MaskUniform;
use orogeny_brush::kernels::noise::NoiseUniform;
use orogeny_brush::kernels::ramp::RampUniform;
use orogeny_brush::kernels::range_map::RangeUniform;
use orogeny_brush::kernels::roughen::RoughenUniform;
use orogeny_brush::kernels::stamp::StampUniform;
use orogeny_brush::kernels::terrace::TerraceUniform;
use orogeny_brush::{BrushUniform, Tile};
use orogeny_field::noise::{FrameOctave, LatticePoint, LatticeStep};
use orogeny_field::{Drag, Instance, Part, PhaseWeights, PipesKernel, Place, ThermalLayer};
use orogeny_geomip::material::LayerRule;
use orogeny_geomip::{FrameUniform, MaterialUniform, TileInstance};
use orogeny_shaders::{SHADERS, Shader, Struct};

/// A field of a struct: name, offset and size in bytes.
type Field = (String, u32, u32);

/// A Rust struct that is copied to the GPU as it lies in memory.
#[derive(Debug, Clone)]
struct Mirror {
    /// Of the WGSL struct.
    name: &'static str,
    size: u32,
    fields: Vec<Field>,
}

const fn size_of_field<Whole, Part>(_: fn(&Whole) -> &Part) -> usize {
    size_of::<Part>()
}

/// The layout of a Rust struct. All fields have to be named: the pattern has no `..`.
macro_rules! mirror {
    ($name:literal, $mirror:ident { $($field:ident),* $(,)? }) => {{
        const _: fn($mirror) = |whole| {
            let $mirror { $($field: _),* } = whole;
        };
        Mirror {
            name: $name,
            size: size_of::<$mirror>() as u32,
            fields: vec![$((
                stringify!($field).to_owned(),
                core::mem::offset_of!($mirror, $field) as u32,
                size_of_field(|whole: &$mirror| &whole.$field) as u32,
            )),*],
        }
    }};
}

/// What the brush executor counts with: a plain `u32` in memory.
#[repr(C)]
struct Counters {
    num_clamped: u32,
}

/// Structs that users' files declare, member by member: theirs is the layout of `f32`s one after another.
const OF_USERS: [(&str, &str); 1] = [("custom/brush", "Parameters")];

fn mirrors() -> Vec<Mirror> {
    vec![
        mirror!(
            "Instance",
            Instance {
                cell,
                fraction,
                inverse_radius,
                amplitude,
                reference_height_m,
                inverse_radius_m,
                axis,
                mirror,
                flow,
                segment,
                inverse_segment_squared,
                end_height_m,
                frame,
                frame_blend
            }
        ),
        mirror!(
            "Tile",
            Tile {
                page_origin,
                first,
                end,
                heights_layer,
                scratch_layer,
                gate_layer,
                first_index,
                end_index,
                first_lattice
            }
        ),
        mirror!("Brush", BrushUniform { inverse_falloff_ratio, falloff_exponent, falloff_scale }),
        mirror!(
            "FrameUniform",
            FrameUniform {
                clip_from_relative,
                ray_right,
                near_m,
                ray_up,
                eye_height_m,
                ray_forward,
                spacing_m,
                eye_sample,
                eye_offset_m,
                num_samples,
                page_size_log2,
                top_level,
                slots_a_side_log2,
                unpainted_m,
                slope_exaggeration,
                exposure,
                to_sun,
                ambient_occlusion,
                sun_light,
                fog_density,
                sky_light,
                fog_falloff,
                fog_base_m,
                water_level_m,
                low_m,
                high_m,
                contour_m,
                metre_px,
                overlay_low,
                overlay_high,
                num_cursors,
                num_cascades,
                pad_a,
                pad_b,
                unpainted_overlay,
                cascades,
                cascade_texel_m,
                windows,
                cursors
            }
        ),
        mirror!("TileInstance", TileInstance { place, level, detail, rim }),
        mirror!("LayerRule", LayerRule { height_m, slope_tangent, curvature, noise, look, ids }),
        mirror!(
            "MaterialUniform",
            MaterialUniform {
                blend_depth,
                blend_contrast,
                macro_per_m,
                macro_amount,
                num_layers,
                pad_a,
                pad_b,
                pad_c,
                layers,
                eye_repeats,
                eye_far_repeats
            }
        ),
        mirror!("Plane", PlaneUniform { origin, stride, channel_stride }),
        mirror!("Input", InputUniform { plane, periods, padding }),
        mirror!("Step", StepUniform { result, inputs, size, extent }),
        mirror!("Place", Place { cell, fraction }),
        mirror!("Resample", ResampleUniform { scale, offset_m }),
        mirror!("Cover", Part { first, last, inverse_feather, padding }),
        mirror!("Channel", ChannelUniform { number, from_value, inverse_width }),
        mirror!("Combine", CombineUniform { factors }),
        mirror!("Band", BandUniform { factor }),
        mirror!("Grab", GrabUniform { num_drags, num_steps, inverse_num_steps }),
        mirror!("Drag", Drag { cell, fraction, way, inverse_radius, padding }),
        mirror!("PhaseWeights", PhaseWeights { before, next, after_next }),
        mirror!("Sharpen", SharpenUniform { gain }),
        mirror!("Shift", ShiftUniform { cell, fraction }),
        mirror!("ThermalLayer", ThermalLayer { from_m, talus_m, half_rate }),
        mirror!(
            "Pipes",
            PipesKernel {
                rain_m,
                staying,
                flowing,
                acceleration,
                capacity,
                min_slope,
                dissolving,
                deposition,
                slope_scale
            }
        ),
        mirror!("Ledge", LedgeUniform { direction }),
        mirror!("Level", LevelUniform { target_height_m, only }),
        mirror!("Ramp", RampUniform { is_smooth, level_only }),
        mirror!("Roughen", RoughenUniform { seed }),
        mirror!(
            "Terrace",
            TerraceUniform { anchor, plane_m_per_sample, step_m, inverse_step, steepness, unused }
        ),
        mirror!("Range", RangeUniform { low_m, high_m, inverse_width, exponent }),
        mirror!("Stamp", StampUniform { scale_m }),
        mirror!("Mask", MaskUniform { value }),
        mirror!(
            "Noise",
            NoiseUniform {
                worley_weights,
                num_main,
                num_distortion,
                distortion_weight,
                main_gain,
                distortion_gain,
                elevation,
                offset,
                scale
            }
        ),
        mirror!("LatticePoint", LatticePoint { cell, unused0, fraction, unused1 }),
        mirror!("LatticeStep", LatticeStep { x, frequency, z, weight }),
        mirror!("FrameOctave", FrameOctave { cell, seed, fraction, direction }),
        mirror!("Counters", Counters { num_clamped }),
        mirror!("Custom", CustomUniform { spacing_m, radius_m, seed }),
    ]
}

/// How a struct differs from its mirror; empty where it does not.
fn differences(reflected: &Struct, mirror: &Mirror) -> Vec<String> {
    let mut differences = Vec::new();
    if reflected.size != mirror.size {
        differences.push(format!("{} has {} bytes, its mirror {}", mirror.name, reflected.size, mirror.size));
    }
    let members: Vec<Field> = reflected
        .members
        .iter()
        .map(|member| (member.name.to_string(), member.offset, member.size))
        .collect();
    for place in 0..members.len().max(mirror.fields.len()) {
        let (member, field) = (members.get(place), mirror.fields.get(place));
        if member != field {
            differences.push(format!("{}, field {place}: {member:?}, its mirror {field:?}", mirror.name));
        }
    }
    differences
}

/// The structs that a shader binds, by themselves, in arrays or in each other.
fn bound_structs(shader: &Shader) -> BTreeSet<String> {
    let declared: BTreeSet<_> = shader.structs.iter().map(|item| item.name.to_string()).collect();
    let named_in = |text: &str| -> Vec<String> {
        let words = text.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
        words.filter(|word| declared.contains(*word)).map(str::to_owned).collect()
    };
    let is_binding = |line: &&str| line.contains("@binding(");
    let bindings: Vec<_> = shader.wgsl.lines().filter(is_binding).collect();
    assert_eq!(bindings.len(), shader.bindings.len(), "{}: one binding a line", shader.stem);
    // What stands after the colon is the type.
    let mut open: Vec<String> =
        bindings.iter().flat_map(|line| named_in(line.rsplit(':').next().unwrap())).collect();
    let mut bound = BTreeSet::new();
    while let Some(name) = open.pop() {
        let members = shader.find_struct(&name).unwrap().members.iter();
        open.extend(
            members.flat_map(|member| named_in(&member.type_name)).filter(|name| !bound.contains(name)),
        );
        bound.insert(name);
    }
    bound
}

/// What is wrong between shaders and mirrors.
fn problems(shaders: &[Shader], mirrors: &[Mirror]) -> Vec<String> {
    let mut problems = Vec::new();
    let mut met = BTreeSet::new();
    for shader in shaders {
        for name in bound_structs(shader) {
            if OF_USERS.contains(&(&*shader.stem, name.as_str())) {
                continue;
            }
            match mirrors.iter().find(|mirror| mirror.name == name) {
                None => problems.push(format!("{}: `{name}` is bound, but has no mirror", shader.stem)),
                Some(mirror) => {
                    let found = differences(shader.find_struct(&name).unwrap(), mirror);
                    problems.extend(found.into_iter().map(|found| format!("{}: {found}", shader.stem)));
                }
            }
            met.insert(name);
        }
    }
    let unmet = mirrors.iter().filter(|mirror| !met.contains(mirror.name));
    problems.extend(unmet.map(|mirror| format!("no shader binds `{}`", mirror.name)));
    problems
}

#[test]
fn every_bound_struct_equals_its_mirror() {
    assert!(!SHADERS.is_empty());
    let problems = problems(SHADERS, &mirrors());
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn every_brush_kernel_binds_all_of_its_drivers_structs() {
    let kernels: Vec<_> = SHADERS.iter().filter(|shader| shader.stem.starts_with("brush/")).collect();
    assert!(kernels.len() >= 4);
    for kernel in kernels {
        let bound = bound_structs(kernel);
        for name in ["Brush", "Counters", "Instance", "Tile"] {
            assert!(bound.contains(name), "{}: {bound:?}", kernel.stem);
        }
    }
}

mod bad_mirrors {
    //! The comparison finds what it is there to find.

    use super::*;

    fn assert_found(change: impl FnOnce(&mut Vec<Mirror>), words: &[&str]) {
        let mut changed = mirrors();
        change(&mut changed);
        let found = problems(SHADERS, &changed).join("\n");
        assert!(!found.is_empty() && words.iter().all(|word| found.contains(word)), "{found}");
    }

    fn tile(mirrors: &mut [Mirror]) -> &mut Mirror {
        mirrors.iter_mut().find(|mirror| mirror.name == "Tile").unwrap()
    }

    #[test]
    fn swapped_fields_of_one_type() {
        assert_found(
            |mirrors| {
                let fields = &mut tile(mirrors).fields;
                let (layer, scratch) = (fields[3].0.clone(), fields[4].0.clone());
                fields[3].0 = scratch;
                fields[4].0 = layer;
            },
            &["Tile, field 3", "Tile, field 4", "heights_layer", "scratch_layer"],
        );
    }

    #[test]
    fn a_renamed_field() {
        assert_found(
            |mirrors| tile(mirrors).fields[2].0 = "stop".to_owned(),
            &["Tile, field 2", "stop", "end"],
        );
    }

    #[test]
    fn a_missing_field() {
        assert_found(|mirrors| drop(tile(mirrors).fields.pop()), &["Tile, field 8", "first_lattice", "None"]);
    }

    #[test]
    fn a_field_too_many() {
        let more = ("more".to_owned(), 48, 4);
        assert_found(|mirrors| tile(mirrors).fields.push(more), &["Tile, field 9", "None", "more"]);
    }

    #[test]
    fn a_moved_field_another_size_and_padding() {
        assert_found(|mirrors| tile(mirrors).fields[1].1 += 4, &["Tile, field 1"]);
        assert_found(|mirrors| tile(mirrors).fields[1].2 += 4, &["Tile, field 1"]);
        assert_found(|mirrors| tile(mirrors).size += 8, &["Tile has 48 bytes, its mirror 56"]);
    }

    #[test]
    fn a_struct_without_a_mirror_and_a_mirror_without_a_struct() {
        assert_found(
            |mirrors| mirrors.retain(|mirror| mirror.name != "Instance"),
            &["`Instance` is bound, but has no mirror"],
        );
        assert_found(|mirrors| tile(mirrors).name = "Tiles", &["no shader binds `Tiles`", "`Tile` is bound"]);
    }

    #[test]
    fn a_struct_inside_another_needs_a_mirror_too() {
        let outer = "struct Inner { a: f32 }\nstruct Outer { inner: array<Inner, 4> }\n\
                     @group(1) @binding(0) var<storage, read> all: array<Outer>;\n";
        let main = "@compute @workgroup_size(1)\nfn main() { _ = all[0].inner[0].a; }\n";
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(folder.path().join("brush")).unwrap();
        std::fs::write(folder.path().join("brush/nested.wgsl"), format!("// Owns nothing.\n{outer}{main}"))
            .unwrap();
        let shaders = orogeny_shaders::compile_dir(folder.path()).unwrap();
        let found = problems(&shaders, &[]).join("\n");
        assert!(found.contains("`Inner` is bound") && found.contains("`Outer` is bound"), "{found}");
    }
}
