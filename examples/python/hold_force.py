"""# A controller in the loop

Every period of deformation (4 ms) the controller reads the force and says how the probe moves: along the organ at 10 mm/s,
and in or out so that it presses with 0.3 N. `set_probe()` gives a pose and a velocity; the probe goes on at it until it is
set again, so that it moves smoothly from tick to tick.
"""
import matplotlib.pyplot as plt
import numpy as np
import palpate

WANTED = 0.3  # N
INTO, ALONG = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
session = palpate.Session(palpate.scene_path("stomach_probe"))
position, missing, log = np.array([0.02, -0.045, -0.03]), 0.0, []
while session.time < 5:
    pressing = -session.force() @ INTO
    touching = session.time > 1.5
    missing += (WANTED - pressing) * session.period if touching else 0
    velocity = np.clip(0.3 * (WANTED - pressing) + 0.6 * missing, -0.03, 0.03) * INTO + (0.01 * ALONG if touching else 0)
    session.set_probe(position, linear_velocity_m_per_s=velocity)
    session.step()
    position = position + velocity * session.period
    log.append((session.time, pressing, 1e3 * position[1]))

time, pressing, height = np.array(log).T
error = pressing[time > 2] - WANTED
print(f"while sliding: {WANTED + error.mean():.3f} N on average, off by {1e3 * np.sqrt((error**2).mean()):.1f} mN RMS")
figure, (above, below) = plt.subplots(2, sharex=True)
above.plot(time, pressing)
above.axhline(WANTED, linestyle=":", color="gray")
above.set_ylabel("force into the wall [N]")
below.plot(time, height)
below.set(xlabel="time [s]", ylabel="probe's y [mm]")
figure.savefig("hold_force.png")
