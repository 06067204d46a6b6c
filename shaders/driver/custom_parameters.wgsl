// Stands for the parameters that a user's brush declares, which take its place.

struct Parameters {
    unused: f32,
}

@group(1) @binding(8) var<uniform> parameters: Parameters;
