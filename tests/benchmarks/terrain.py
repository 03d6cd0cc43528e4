"""Terrain searches against named peers, measured alternately in one run.

``python tests/benchmarks/terrain.py`` prints, for a 2000-point position search and a 41 x 41 x 11 x 11
joint search over relief: milliseconds, and the ratios to ``scipy.ndimage.map_coordinates``, to a plain
compiled loop, to our own dense search and to the sequential algorithm. Times are CPU times of the
process (two threads: wall times), the best of several, so that a busy machine does not decide.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numba import njit

from navsym.terrain.heights import TerrainMap
from navsym.terrain.search import criteria, prepare, search_full, search_position
from navsym.terrain.sequential import search_sequential
from navsym.terrain.track import Hypotheses, Profile

CELL = 50.0


def relief(side: int = 900, seed: int = 0) -> TerrainMap:
    """A rough surface with the spectrum of hills: amplitudes fall with the 1.6th power of the wave number."""
    generator = np.random.default_rng(seed)
    kx, ky = np.meshgrid(np.fft.fftfreq(side), np.fft.fftfreq(side))
    wave = np.hypot(kx, ky)
    wave[0, 0] = 1.0
    spectrum = np.fft.fft2(generator.normal(size=(side, side))) / wave**1.6
    spectrum[wave < 1 / 300] = 0.0
    surface = np.fft.ifft2(spectrum).real
    return TerrainMap(400 + 180 * surface / surface.std(), 0, 0, CELL, CELL)


def flight(terrain: TerrainMap, n: int, seed: int = 1, drifting: bool = True) -> Profile:
    """A straight track at 40 m/s, 2 Hz, with errors on the grid and 12 m of noise."""
    generator = np.random.default_rng(seed)
    t = 0.5 * np.arange(n)
    x, y = 6000 + 30.0 * t, 6000 + 25.0 * t
    (i, j), (vx, vy) = generator.integers(-12, 13, 2), drifting * generator.integers(-3, 4, 2)
    h = terrain.height(x + 50 * i + vx * t, y + 50 * j + vy * t)
    return Profile(t, x, y, h + generator.normal(0, 12, n))


@njit(nogil=True, cache=True)
def plain_loop(  # type: ignore[no-untyped-def]
    H, bx, by, z, wx, wy, sx, sy, Mx, My, Mvx, Mvy, first, last, out
):
    """What one writes first: five loops and a bilinear formula; velocities ``first <= Vi < last``."""
    for Vi in range(first, last):
        for Vj in range(Mvy):
            for j in range(My):
                for i in range(Mx):
                    total = 0.0
                    for k in range(z.size):
                        u = bx[k] + (i - Mx // 2) * sx + (Vi - Mvx // 2) * wx[k]
                        w = by[k] + (j - My // 2) * sy + (Vj - Mvy // 2) * wy[k]
                        c, r = int(u), int(w)
                        f, g = u - c, w - r
                        h = (H[r, c] * (1 - f) + H[r, c + 1] * f) * (1 - g)
                        h += (H[r + 1, c] * (1 - f) + H[r + 1, c + 1] * f) * g
                        total += (z[k] - h) ** 2
                    out[Vi, Vj, j, i] = total


def plain(terrain: TerrainMap, track: Profile, grid: Hypotheses, threads: int = 2) -> np.ndarray:
    p = prepare(terrain, track, grid)
    Mx, My, Mvx, Mvy = p.counts
    out = np.empty((Mvx, Mvy, My, Mx))
    cuts = [(k * Mvx // threads, (k + 1) * Mvx // threads) for k in range(threads)]

    def part(cut: tuple[int, int]) -> None:
        plain_loop(*p.case, *p.steps, *p.counts, *cut, out)

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(part, cuts))
    return out


def by_scipy(terrain: TerrainMap, track: Profile, grid: Hypotheses) -> np.ndarray:
    """The position search with order-1 map_coordinates, one row of hypotheses at a time."""
    from scipy.ndimage import map_coordinates

    u, w = terrain.cells(track.x, track.y)
    across = (np.arange(grid.counts[0]) - grid.half_count[0]) * grid.step[0] / terrain.dx
    along = (np.arange(grid.counts[1]) - grid.half_count[1]) * grid.step[1] / terrain.dy
    out = np.empty((along.size, across.size))
    for j, shift in enumerate(along):
        columns = u[None, :] + across[:, None]
        rows = np.broadcast_to(w + shift, columns.shape)
        out[j] = ((track.h - map_coordinates(terrain.heights, [rows, columns], order=1)) ** 2).sum(axis=1)
    return out


def best_of(work: dict[str, Callable[[], object]], repeats: int, wall: bool = False) -> dict[str, float]:
    """Shortest time of each, in milliseconds, taking turns."""
    clock = time.perf_counter if wall else time.process_time
    times: dict[str, list[float]] = {name: [] for name in work}
    for call in work.values():
        call()
    for _ in range(repeats):
        for name, call in work.items():
            start = clock()
            call()
            times[name].append(1e3 * (clock() - start))
    return {name: min(values) for name, values in times.items()}


def position_part(terrain: TerrainMap, n: int, half: int, repeats: int) -> None:
    for step, drifting in ((CELL, False), (CELL, True), (37.0, False), (37.0, True)):
        track = flight(terrain, n, drifting=drifting)
        grid = Hypotheses((step, step), (half, half))
        found = best_of(
            {
                "ours": lambda g=grid, t=track: search_position(terrain, t, g, dense=True),
                "bounded": lambda g=grid, t=track: search_position(terrain, t, g),
                "scipy": lambda g=grid, t=track: by_scipy(terrain, t, g),
            },
            repeats,
        )
        name = ("step = cell" if step == CELL else "any step") + (", drifting" if drifting else "")
        print(
            f"position, {name}: all criteria {found['ours']:.2f} ms (ratio "
            f"{found['scipy'] / found['ours']:.0f}), minimum and runner-up {found['bounded']:.2f} ms "
            f"(ratio {found['scipy'] / found['bounded']:.0f}), scipy {found['scipy']:.1f} ms"
        )


def dense_part(terrain: TerrainMap, n: int, grid: Hypotheses, repeats: int) -> None:
    track = flight(terrain, n)
    prepared = prepare(terrain, track, grid)
    found = best_of(
        {"ours": lambda: criteria(prepared, threads=2), "plain": lambda: plain(terrain, track, grid)},
        repeats,
        wall=True,
    )
    print(
        f"dense joint, two threads: {found['ours']:.1f} ms, plain loop {found['plain']:.0f} ms, "
        f"ratio {found['plain'] / found['ours']:.1f}"
    )


def bounded_part(terrain: TerrainMap, n: int, grid: Hypotheses, repeats: int, flights: int) -> None:
    ratios = []
    for seed in range(flights):
        track = flight(terrain, n, seed)
        found = best_of(
            {
                "bounded": lambda t=track: search_full(terrain, t, grid),
                "dense": lambda t=track: criteria(prepare(terrain, t, grid)),
                "sequential": lambda t=track: search_sequential(terrain, t, grid),
                "offset-free": lambda t=track: search_full(terrain, t, grid, offset_free=True),
            },
            repeats,
        )
        share = search_full(terrain, track, grid).share
        ratios.append((found["dense"] / found["bounded"], found["bounded"] / found["sequential"]))
        print(
            f"exact joint, flight {seed}: {found['bounded']:.2f} ms, dense {found['dense']:.1f} ms "
            f"(ratio {ratios[-1][0]:.1f}), sequential {found['sequential']:.2f} ms "
            f"(ratio {ratios[-1][1]:.2f}), squares evaluated {100 * share:.1f} %, "
            f"without the height offset {found['offset-free']:.2f} ms"
        )
    faster, slower = np.median(ratios, axis=0)
    print(f"exact joint, median: {faster:.1f} times faster than dense, {slower:.2f} times the sequential")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tiny", action="store_true", help="small sizes, to see that it runs")
    parser.add_argument("--map", help="a map file (npz, hgt) instead of the made one")
    arguments = parser.parse_args()
    n, half, repeats, flights = (60, 3, 1, 1) if arguments.tiny else (1001, 20, 7, 5)
    terrain = relief(300 if arguments.tiny else 1500)
    if arguments.map:
        from navsym.terrain.maps import local_frame, read_map

        raster = local_frame(read_map(arguments.map))
        terrain = TerrainMap(raster.heights, 0, 0, CELL, CELL, nodata=raster.nodata)
        print(f"heights of {arguments.map} on cells of {CELL:g} m")
    velocities = 1 if arguments.tiny else 5
    grid = Hypotheses((CELL, CELL), (half, half), (1, 1), (velocities, velocities))
    position_part(terrain, 2 * n - 2, half, 3 * repeats)
    dense_part(terrain, n, grid, min(repeats, 3))
    bounded_part(terrain, n, grid, repeats, flights)
    coarse = Hypotheses((37.0, 37.0), (half, half), (1, 1), (velocities, velocities))
    print("step 37 m, cell 50 m:")
    bounded_part(terrain, n, coarse, repeats, min(flights, 2))


if __name__ == "__main__":
    main()
