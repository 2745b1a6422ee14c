"""# A sweep on all cores

A press of 0.4 s at two hundred stiffnesses of the wall. Each worker is a process with a session of its own; threads would do as well, for a
session that steps lets other threads run. Keys of a scene are changed by their path, each change held to the
schema ([scenes](scene.md)).
"""
import os
from concurrent.futures import ProcessPoolExecutor

import matplotlib.pyplot as plt
import numpy as np
import palpate

PRESS = {"start_m": [0.02, -0.04, 0.0], "moves": [{"to_m": [0.02, -0.01, 0.0], "duration_s": 0.3}, {"wait_s": 0.1}]}


def pressed(youngs_modulus):
    """The force [N] at the end of a press, and the pressure [Pa] inside."""
    scene = palpate.Scene.load(palpate.scene_path("stomach_probe"))
    scene["organs[0].tissue.youngs_modulus_pa"] = youngs_modulus
    scene["probes[0].device"] = {"scripted": PRESS}
    with palpate.Session(scene) as session:
        session.run(0.4)
        return np.linalg.norm(session.force()), session.pressure()


def sweep(stiffnesses, workers):
    with ProcessPoolExecutor(workers) as pool:
        return np.array(list(pool.map(pressed, stiffnesses, chunksize=5)))


if __name__ == "__main__":
    stiffnesses = np.geomspace(5e3, 100e3, 200)
    force, pressure = sweep(stiffnesses, os.cpu_count()).T
    slope = np.polyfit(np.log(stiffnesses), np.log(force), 1)[0]
    print(f"force from {force[0]:.3f} to {force[-1]:.2f} N, pressure from {pressure[0]:.0f} to {pressure[-1]:.0f} Pa")
    print(f"force grows as the stiffness to the power of {slope:.2f}")
    plt.loglog(1e-3 * stiffnesses, force)
    plt.xlabel("Young's modulus of the wall [kPa]")
    plt.ylabel("force [N]")
    plt.savefig("sweep.png")
