"""Learns robot_avoid by PPO of Stable-Baselines3, and writes a policy that NumPy alone runs.

    pip install 'simcompare[learn,mujoco]'
    python examples/robot_avoid/train.py --engine mujoco --sensors 0 --seed 1 policy.npz

The same seed learns the same policy, number for number, on the same machine. With --parallel each
of the eight environments has a process of its own.
"""

import argparse
import functools
import time
from pathlib import Path

import numpy as np
import stable_baselines3
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv, VecMonitor, VecNormalize

import simcompare
from simcompare.learning.policy import Policy
from simcompare.scenarios.robot_avoid.task import straight_on

ENVIRONMENTS, STEPS = 8, 60_000
HYPERPARAMETERS = {
    "n_steps": 256, "batch_size": 256, "n_epochs": 10, "learning_rate": 5e-4, "gamma": 0.98,
    "gae_lambda": 0.95, "ent_coef": 0.002,
}  # fmt: skip
LAYERS = [64, 64]
#: steps of each environment in which it first imitates what drives straight on, and how many times
#: it goes through them
IMITATED, ROUNDS = 250, 60
#: part of the steps, at their end, in which the learning rate falls to nothing
FALLING = 0.3
#: engine step while it learns: after 1.5 s the robot is where it is with 1 ms, to 0.7 mm in MuJoCo,
#: PyBullet, DART, ODE and Rapier
STEP_S = 0.01


def opened(engine, sensors, seed):
    """An environment whose episodes follow from a seed."""
    environment = simcompare.gym("robot_avoid", engine=engine, sensors=sensors, step=STEP_S)
    environment.reset(seed=seed)
    return environment


class Watch(BaseCallback):
    """Learns ever slower at its end, and tells how far it has come."""

    def __init__(self, steps):
        super().__init__()
        self.steps, self.next = steps, 0.0

    def _on_step(self):
        return True

    def _on_rollout_end(self):
        left = (self.steps - self.num_timesteps) / (FALLING * self.steps)
        rate = min(1.0, max(0.02, left)) * HYPERPARAMETERS["learning_rate"]
        self.model.lr_schedule = lambda _: rate
        if time.monotonic() < self.next or not self.model.ep_info_buffer:
            return
        self.next = time.monotonic() + 10
        ends = self.model.ep_info_buffer
        shares = (np.mean([end[what] for end in ends]) for what in ("is_success", "collided"))
        done = f"{self.num_timesteps} of {self.steps} steps"
        print(f"{done}: {{:.0%}} succeed, {{:.0%}} collide".format(*shares), flush=True)


def learn(engine, sensors, seed, steps, *, parallel=False):
    """Learns, and gives the policy."""
    torch.set_num_threads(1)
    # seeds of episodes stay below those that trials take
    makers = [
        functools.partial(opened, engine, sensors, 1000 * seed + k) for k in range(ENVIRONMENTS)
    ]
    several = SubprocVecEnv(makers) if parallel else DummyVecEnv(makers)
    scaled = VecNormalize(VecMonitor(several, info_keywords=("is_success", "collided")))
    model = PPO(
        "MlpPolicy", scaled, seed=seed, device="cpu", **HYPERPARAMETERS,
        policy_kwargs={"net_arch": {"pi": LAYERS, "vf": LAYERS}, "log_std_init": -0.5},
    )  # fmt: skip
    imitate(model, scaled)
    started = time.monotonic()
    model.learn(steps, callback=Watch(steps))
    recipe = {
        "scenario": "robot_avoid", "engine": engine, "sensors": sensors, "seed": seed,
        "steps": model.num_timesteps, "minutes": round((time.monotonic() - started) / 60, 1),
        "parallel": parallel, "environments": ENVIRONMENTS, "step_s": STEP_S,
        "algorithm": f"PPO of stable-baselines3 {stable_baselines3.__version__}",
        **HYPERPARAMETERS, "falling": FALLING, "imitated": IMITATED, "rounds": ROUNDS,
        "layers": LAYERS,
    }  # fmt: skip
    scaled.close()
    return as_policy(model, scaled, recipe)


def imitate(model, scaled):
    """Begins with what drives straight at the goal, which is better than nothing.

    The robot drives so, with actions about it, and the network learns to do the same.
    """
    rng, seen, done = np.random.default_rng(model.seed), [], []
    scaled.reset()
    for _ in range(IMITATED):
        seen.append(scaled.get_original_obs())
        done.append(np.array([straight_on(one) for one in seen[-1]]))
        scaled.step(np.clip(done[-1] + 0.3 * rng.standard_normal(done[-1].shape), -1, 1))
    inputs = torch.as_tensor(scaled.normalize_obs(np.concatenate(seen)), dtype=torch.float32)
    wanted = torch.as_tensor(np.concatenate(done), dtype=torch.float32)
    for _ in range(ROUNDS):
        for part in torch.randperm(len(inputs)).split(256):
            mean = model.policy.get_distribution(inputs[part]).distribution.mean
            model.policy.optimizer.zero_grad()
            ((mean - wanted[part]) ** 2).mean().backward()
            model.policy.optimizer.step()


def as_policy(model, scaled, recipe):
    """The mean action of a model, with what standardises its observations."""
    net = model.policy
    parts = [m for m in (*net.mlp_extractor.policy_net, net.action_net) if hasattr(m, "weight")]
    layers = [(m.weight.detach().numpy(), m.bias.detach().numpy()) for m in parts]
    deviation = np.sqrt(scaled.obs_rms.var + scaled.epsilon)
    return Policy(scaled.obs_rms.mean, deviation, layers, recipe)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--engine", default="mujoco")
    parser.add_argument("--sensors", type=float, default=0.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--parallel", action="store_true")
    asked = parser.parse_args()
    learnt = learn(asked.engine, asked.sensors, asked.seed, asked.steps, parallel=asked.parallel)
    learnt.save(asked.file)
