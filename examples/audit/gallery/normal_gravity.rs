// The mathematics of pyins commit 8fe2c4d: the root in the formula of Somigliana for normal gravity.
pub fn before(sin_lat: f64, equator: f64, factor: f64, e2: f64) -> f64 {
    let square = sin_lat.powi(2);
    let bulge = 1.0 - e2 * square;
    let gravity = equator * (1.0 + factor * square) / bulge;
    gravity
}

pub fn after(sin_lat: f64, equator: f64, factor: f64, e2: f64) -> f64 {
    let square = sin_lat.powi(2);
    let bulge = 1.0 - e2 * square;
    let gravity = equator * (1.0 + factor * square) / bulge.sqrt();
    gravity
}
