// A vector turned by a quaternion (real part first), by two cross products.
pub fn turn_vector(q: &[f64; 4], v: &[f64; 3], y: &mut [f64; 3]) {
    let tx = 2.0 * (q[2] * v[2] - q[3] * v[1]);
    let ty = 2.0 * (q[3] * v[0] - q[1] * v[2]);
    let tz = 2.0 * (q[1] * v[1] - q[2] * v[0]);
    y[0] = v[0] + q[0] * tx + q[2] * tz - q[3] * ty;
    y[1] = v[1] + q[0] * ty + q[3] * tx - q[1] * tz;
    y[2] = v[2] + q[0] * tz + q[1] * ty - q[2] * tx;
}
