// The matrix of roll, pitch and yaw, row by row.
pub fn euler_matrix(angles: &[f64; 3], r: &mut [f64; 9]) {
    let sr = angles[0].sin();
    let cr = angles[0].cos();
    let sp = angles[1].sin();
    let cp = angles[1].cos();
    let sy = angles[2].sin();
    let cy = angles[2].cos();
    r[0] = cp * cy;
    r[1] = sr * sp * cy - cr * sy;
    r[2] = cr * sp * cy + sr * sy;
    r[3] = cp * sy;
    r[4] = sr * sp * sy + cr * cy;
    r[5] = cr * sp * sy - sr * cy;
    r[6] = -sp;
    r[7] = sr * cp;
    r[8] = cr * cp;
}
