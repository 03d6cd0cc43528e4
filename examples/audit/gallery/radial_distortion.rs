// The mathematics of open_vins commit 9f4d3e9: a power in the derivative of a radial distortion.
pub fn before(x: &[f64; 2], k: &[f64; 2], d: &mut [f64; 1], j: &mut [f64; 2]) {
    let s = x[0] * x[0] + x[1] * x[1];
    d[0] = x[0] * (1.0 + k[0] * s + k[1] * s * s);
    j[0] = 1.0 + k[0] * s + k[1] * s * s + 2.0 * k[0] * x[0] * x[0] + 4.0 * k[1] * x[0] * x[0] * s.sqrt();
    j[1] = 2.0 * k[0] * x[0] * x[1] + 4.0 * k[1] * x[0] * x[1] * s;
}

pub fn after(x: &[f64; 2], k: &[f64; 2], d: &mut [f64; 1], j: &mut [f64; 2]) {
    let s = x[0] * x[0] + x[1] * x[1];
    d[0] = x[0] * (1.0 + k[0] * s + k[1] * s * s);
    j[0] = 1.0 + k[0] * s + k[1] * s * s + 2.0 * k[0] * x[0] * x[0] + 4.0 * k[1] * x[0] * x[0] * s;
    j[1] = 2.0 * k[0] * x[0] * x[1] + 4.0 * k[1] * x[0] * x[1] * s;
}
