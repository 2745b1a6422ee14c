"""# A force–depth curve

The scene that comes with Palpate, as its file says it: a fingertip enters a stomach, slides through it and lets go,
20 s. `run()` gives every message of the topics that are asked for, as arrays; the curve is of the way in.
"""
import matplotlib.pyplot as plt
import numpy as np
import palpate

session = palpate.Session(palpate.scene_path("stomach_probe"))
said = session.run(20, keep=["probe_state", "haptic_force"])
force = np.linalg.norm(said["haptic_force"]["force_n"], axis=1)
touch, deepest = int(np.argmax(force > 0)), int(np.searchsorted(said["probe_state"].time, 4.0))
position = said["probe_state"]["position_m"][touch:deepest]
depth = np.linalg.norm(position - position[0], axis=1)
plt.plot(1e3 * depth, force[touch:deepest])

print(f"{session.time:g} s simulated; {force[deepest - 1]:.2f} N at {1e3 * depth[-1]:.1f} mm")
plt.xlabel("depth [mm]")
plt.ylabel("force [N]")
plt.savefig("force_depth.png")
