// Stands for the parameters that a user's brush declares, which take its place.

struct Parameters {
    unused: f32,
}

@group(1) @binding(11) var<uniform> parameters: Parameters;
