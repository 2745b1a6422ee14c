"""# An environment to learn in

`reset()` and `step()` in Gymnasium's signature; Gymnasium itself is not needed. An episode is a session of its own, made
in some ten milliseconds. The policy here is two lines by hand.
"""
import matplotlib.pyplot as plt
import numpy as np
import palpate


class Pressing:
    """Press until 0.2 N are felt, at a stiffness that differs from episode to episode.

    Action: speed into the wall [m/s], -0.05 … 0.05. Observation: depth [m], force [N].
    """

    wanted = 0.2

    def __init__(self):
        self.scene = palpate.Scene.load(palpate.scene_path("stomach_probe"))
        self.random = np.random.default_rng()

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            self.random = np.random.default_rng(seed)
        stiffness = self.random.uniform(10e3, 60e3)
        self.scene["organs[0].tissue.youngs_modulus_pa"] = stiffness
        self.session = palpate.Session(self.scene)
        self.position = np.array([0.02, -0.05, 0.0])
        self.session.set_probe(self.position)
        self.session.step()
        return self.observation(), {"stiffness_pa": stiffness}

    def step(self, action):
        velocity = np.array([0.0, np.clip(action, -0.05, 0.05), 0.0])
        self.session.set_probe(self.position, linear_velocity_m_per_s=velocity)
        self.session.step(5)
        self.position += 5 * self.session.period * velocity
        observation = self.observation()
        reward = -abs(observation[1] - self.wanted)
        return observation, reward, False, self.session.time > 2, {"guards": self.session.guards()}

    def observation(self):
        return np.array([self.position[1] + 0.05, -self.session.force()[1]])


env = Pressing()
for seed in range(6):
    (depth, force), info = env.reset(seed=seed)
    total, truncated, forces = 0.0, False, []
    while not truncated:
        (depth, force), reward, terminated, truncated, _ = env.step(0.15 * (env.wanted - force))
        total += reward
        forces.append(force)
    print(f"episode {seed}: {1e-3 * info['stiffness_pa']:.0f} kPa, return {total:.1f}, {force:.2f} N at {1e3 * depth:.0f} mm")
    plt.plot(0.02 * np.arange(len(forces)), forces, label=f"{1e-3 * info['stiffness_pa']:.0f} kPa")
plt.axhline(env.wanted, linestyle=":", color="gray")
plt.xlabel("time [s]")
plt.ylabel("force [N]")
plt.legend()
plt.savefig("environment.png")
