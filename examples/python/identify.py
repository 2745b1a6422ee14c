"""# Identification from a recording

What stiffness has the wall that was recorded? The recording gives where the probe was and what it felt (here with 5 mN of
noise); the model is a session whose probe is guided along the same way. SciPy's least squares gives the estimate with its
covariance.
"""
import matplotlib.pyplot as plt
import numpy as np
import palpate
from scipy.optimize import curve_fit

E, STIFFNESS = "organs[0].tissue.youngs_modulus_pa", 22e3
scene = palpate.Scene.load(palpate.scene_path("stomach_probe"))
scene["probes[0].device"] = {
    "scripted": {"start_m": [0.02, -0.04, 0.0], "moves": [{"to_m": [0.02, -0.01, 0.0], "duration_s": 0.8}]}
}

recorded = scene.copy()
recorded[E] = STIFFNESS
with palpate.Session(recorded, record="press.mcap", overwrite=True) as session:
    session.run(0.8)

recording = palpate.read("press.mcap", ["probe_state", "haptic_force"])
way = recording["probe_state"]["position_m"][::4]  # as often as deformation steps
noise = 5e-3
felt = -recording["haptic_force"]["force_n"][3::4, 1] + np.random.default_rng(1).normal(0, noise, len(way))


def forces(_, youngs_modulus):
    """What a wall of this stiffness lets the probe feel along the recorded way [N]."""
    scene[E] = youngs_modulus
    session, felt = palpate.Session(scene), []
    for i, position in enumerate(way):
        velocity = (way[min(i + 1, len(way) - 1)] - position) / session.period
        session.set_probe(position, linear_velocity_m_per_s=velocity)
        session.step()
        felt.append(-session.force()[1])
    return np.array(felt)


time = session.period * np.arange(len(way))
(estimate,), covariance = curve_fit(
    forces, time, felt, p0=[10e3], sigma=np.full(len(way), noise), absolute_sigma=True, bounds=(1e3, 1e5), diff_step=1e-2
)
deviation = np.sqrt(covariance[0, 0])
print(f"estimated {1e-3 * estimate:.2f} ± {1e-3 * deviation:.2f} kPa; recorded with {1e-3 * STIFFNESS:g} kPa")
plt.plot(time, felt, ".", markersize=3, label="recorded, with noise")
plt.plot(time, forces(time, estimate), label=f"{1e-3 * estimate:.1f} kPa")
plt.plot(time, forces(time, 10e3), ":", label="10 kPa, the first guess")
plt.xlabel("time [s]")
plt.ylabel("force [N]")
plt.legend()
plt.savefig("identify.png")
