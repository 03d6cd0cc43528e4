const L: f64 = 0.35;
fn wrap(a: f64) -> f64 { a.sin().atan2(a.cos()) }
pub fn wheel(x: &[f64; 3], u: &[f64; 2], dt: f64, y: &mut [f64; 3], j: &mut [[f64; 3]; 3]) {
    let (s, c) = (x[2].sin(), x[2].cos());
    let (v, w) = ((u[0] + u[1]) / 2.0, (u[1] - u[0]) / L);
    y[0] = x[0] + v * c * dt;
    y[1] = x[1] + v * s * dt;
    y[2] = wrap(x[2] + w * dt);
    for i in 0..3 {
        for k in 0..3 {
            j[i][k] = if i == k { 1.0 } else { 0.0 };
        }
    }
    j[0][2] = -v * s * dt;
    j[1][2] = v * c * dt;
}
