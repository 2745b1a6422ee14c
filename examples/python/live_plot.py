"""# A live plot

A session of other processes, here `palpate run stomach_probe.yaml --headless --session press` in another terminal, heard
over DDS. `take()` gives what came since the last call. In a window the curve grows; without a display the last one is
saved all the same. Drawn while other programs kept both cores busy: processes that are called late give a rougher force than
the same way in process, above.
"""
import sys

import matplotlib.pyplot as plt
import numpy as np
import palpate

name, domain, seconds = sys.argv[1], int(sys.argv[2]), float(sys.argv[3])
with palpate.connect(name, domain) as live:
    scene = live.latest("scene", timeout_s=20)
    print(f"hearing scene {scene['name']}")
    figure, axes = plt.subplots()
    (curve,) = axes.plot([], [])
    axes.set(xlabel="time [s]", ylabel="force [N]", title=scene["name"])
    time, force = np.empty(0), np.empty(0)
    while not len(time) or time[-1] < seconds:
        plt.pause(0.04)
        new = live.take("haptic_force")
        if new.messages:
            time = np.concatenate([time, new.time])
            force = np.concatenate([force, np.linalg.norm(new["force_n"], axis=1)])
            curve.set_data(time, force)
            axes.relim()
            axes.autoscale_view()
    print(f"heard until {seconds:g} s; the strongest force was over 0.1 N: {force.max() > 0.1}")
    figure.savefig("live_plot.png")
