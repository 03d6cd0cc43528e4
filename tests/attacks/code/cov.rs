pub fn cov(f: &[[f64; 2]; 2], p: &[[f64; 2]; 2], q: f64, y: &mut [[f64; 2]; 2]) {
    let mut t = [[0.0; 2]; 2];
    for i in 0..2 {
        for j in 0..2 {
            for k in 0..2 {
                t[i][j] += f[i][k] * p[k][j];
            }
        }
    }
    for i in 0..2 {
        for j in 0..2 {
            let mut s = 0.0;
            for k in 0..=1 { s += t[i][k] * f[j][k]; }
            y[i][j] = s + if i == j { q } else { 0.0 };
        }
    }
    let d = 4.0;
    y[0][0] *= d;
}
