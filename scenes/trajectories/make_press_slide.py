#!/usr/bin/env python3
"""Writes press_slide.csv: a fingertip presses a surface, strokes it twice to and fro, and lifts.

Frame R: the surface is the plane z = 0, z points out of the tissue, x is the direction of the
strokes. Position is that of the centre of a tip of 8 mm radius, so z = 0.008 touches and
z = -0.007 is 15 mm deep. Units: s, m. Phases are minimum-jerk (Flash and Hogan 1985).

Usage: make_press_slide.py > press_slide.csv
"""
import math

RATE_HZ = 50
# Until t [s], the tip goes to x, z [m].
PHASES = [(3.0, -0.030, 0.008), (4.5, -0.030, -0.007), (8.0, 0.030, -0.007),
          (11.5, -0.030, -0.007), (13.0, 0.000, -0.007), (16.0, 0.000, 0.040)]
START = (-0.030, 0.040)
RIPPLE_M = 0.002       # the pressing finger feels its way: depth varies by this at 0.5 Hz
TILT_RAD = math.radians(10)  # about x, at 0.25 Hz


def minimum_jerk(s):
    return s ** 3 * (10 + s * (6 * s - 15))


def main():
    print("# A fingertip presses, strokes to and fro, lifts. Made by make_press_slide.py; s, m")
    print("t,x,y,z,qx,qy,qz,qw")
    begin, x0, z0 = 0.0, *START
    k = 0
    for end, x1, z1 in PHASES:
        while k <= end * RATE_HZ:
            t = k / RATE_HZ
            s = minimum_jerk((t - begin) / (end - begin))
            x, z = x0 + s * (x1 - x0), z0 + s * (z1 - z0)
            # The ripple comes and goes smoothly between 4.5 s and 13 s.
            inside = min(max((t - 4.5) / 8.5, 0), 1)
            z += RIPPLE_M * math.sin(math.pi * inside) ** 2 * math.sin(math.pi * t)
            tilt = TILT_RAD * math.sin(0.5 * math.pi * t) / 2
            print(f"{t:.2f},{x:.6f},0,{z:.6f},{math.sin(tilt):.6f},0,0,{math.cos(tilt):.6f}")
            k += 1
        begin, x0, z0 = end, x1, z1


if __name__ == "__main__":
    main()
