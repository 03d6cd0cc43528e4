/* The mathematics of ardupilot pull request 12703: the inverse of an innovation variance in its place. */
void before(double P, double R, double H, double var[1])
{
    const double S = H * P * H + R;
    var[0] = 1.0 / S;
}

void after(double P, double R, double H, double var[1])
{
    const double S = H * P * H + R;
    var[0] = S;
}
