// Stands for the file of a user's brush, whose text takes its place; its function `brush` is then called `apply`.
#include "driver/custom_parameters.wgsl"
#include "lib/custom.wgsl"

fn apply(at: BrushInput) -> f32 {
    return at.height_m + at.weight * parameters.unused;
}
