// Logarithm and exponential by range reduction and short series: built-in ones differ by driver.
// Twin: orogeny_reference::transcendental, where the error bounds are.

// ln(x) for a normal x > 0, exact to 2 units in the last place, near 1 as well.
fn natural_log(x: f32) -> f32 {
    let bits = bitcast<i32>(x);
    let exponent = (bits - 0x3f3504f3) >> 23u;
    let mantissa = bitcast<f32>(bits - (exponent << 23u));
    let f = mantissa - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let series = 1.0 + z * (0.33333333 + z * (0.2 + z * (0.14285715 + z * 0.11111111)));
    return f32(exponent) * 0.6931472 + 2.0 * s * series;
}

// exp(y) - 1, exact to 2 units in the last place, near 0 as well; y is bounded to +-87.
fn exp_minus_one(y: f32) -> f32 {
    let bounded = clamp(y, -87.0, 87.0);
    let n = floor(bounded * 1.442695 + 0.5);
    // ln 2 in two parts, the first with few enough bits that its product with n is exact.
    let f = (bounded - n * 0.6933594) - n * -2.1219444e-4;
    let tail = 0.0013888889 + f * (1.984127e-4 + f * 2.4801588e-5);
    let series = f + f * f * (0.5 + f * (0.16666667 + f * (0.041666668 + f * (0.008333334 + f * tail))));
    let two_to_n = bitcast<f32>((i32(n) + 127) << 23u);
    return two_to_n * series + (two_to_n - 1.0);
}
