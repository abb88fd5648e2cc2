# kaz.Env and kaz.VectorEnv by the rules that Gymnasium's check_env has for environments.
# SPDX-License-Identifier: Apache-2.0
"""Gymnasium is not in Debian: its rules (gymnasium.utils.env_checker, passive_env_checker, version 1.0) are
written here in our words. Where it is installed its own check_env runs, too."""

import inspect
import unittest
import warnings

import numpy

import kaz

TASKS = ("stand", "walk", "turn", "look", "catch")


def same(a, b):
    if type(a) is not type(b):
        return False
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[name], b[name]) for name in a)
    if isinstance(a, numpy.ndarray):
        return a.dtype == b.dtype and numpy.array_equal(a, b)
    return a == b


class Rules(unittest.TestCase):
    def all_environments(self):
        for task in TASKS:
            yield f"{task}, none", kaz.Env(task, engine="none")
        yield "stand, native", kaz.Env("stand", engine="native")
        yield "walk, h8", kaz.Env("walk", engine="h8")
        yield "look, native, pictures", kaz.Env("look", engine="native", pictures="ideal")

    def test_environments_obey(self):
        for name, env in self.all_environments():
            with self.subTest(name), env:
                self.spaces(env)
                self.resets(env)
                self.steps(env)

    def spaces(self, env):
        self.assertEqual(env.metadata["render_modes"], [])
        self.assertIsNone(env.render_mode)
        self.assertIs(env.unwrapped, env)
        self.assertFalse(callable(getattr(env, "seed", None)), "reset has the seed")
        action = env.action_space
        self.assertEqual(len(action.shape), 1)
        self.assertTrue(numpy.array_equal(action.low, -numpy.ones(action.shape)))
        self.assertTrue(numpy.array_equal(action.high, numpy.ones(action.shape)))
        for space in (action, env.observation_space):
            for _ in range(3):
                self.assertIn(space.sample(), space)
            space.seed(4)
            first = space.sample()
            space.seed(4)
            self.assertTrue(same(first, space.sample()))
            self.assertNotIn(numpy.zeros((2, 2, 2), numpy.float32), space)
            self.assertNotIn("no number", space)

    def resets(self, env):
        parameters = inspect.signature(env.reset).parameters
        for name in ("seed", "options"):
            self.assertIs(parameters[name].default, None)
            self.assertIs(parameters[name].kind, inspect.Parameter.KEYWORD_ONLY)
        self.assertNotIn("return_info", parameters)
        made = env.reset()
        self.assertIsInstance(made, tuple)
        self.assertEqual(len(made), 2)
        self.assertIn(made[0], env.observation_space)
        self.assertIsInstance(made[1], dict)
        env.reset(options={})
        first, infos = env.reset(seed=123)
        state = env.np_random.bit_generator.state
        self.assertIn(first, env.observation_space)
        second, infos_again = env.reset(seed=123)
        self.assertTrue(same(first, second) and same(infos, infos_again))
        self.assertEqual(env.np_random.bit_generator.state, state)
        other, _ = env.reset(seed=456)
        self.assertIn(other, env.observation_space)
        another = env.np_random.bit_generator.state
        self.assertNotEqual(another, state)
        env.reset()
        self.assertNotEqual(env.np_random.bit_generator.state, another, "without a seed it goes on")

    def steps(self, env):
        env.action_space.seed(7)
        action = env.action_space
        actions = [action.sample() for _ in range(5)] + [action.low, action.high]
        runs = []
        for _ in range(2):
            env.reset(seed=9)
            run = []
            for action in actions:
                kept = action.copy()
                made = env.step(action)
                self.assertTrue(same(kept, action), "the action is the caller's")
                self.assertIsInstance(made, tuple)
                self.assertEqual(len(made), 5)
                observation, reward, terminated, truncated, infos = made
                self.assertIn(observation, env.observation_space)
                state = observation["state"] if isinstance(observation, dict) else observation
                self.assertEqual(state.dtype, numpy.float32)
                self.assertTrue(numpy.isfinite(state).all())
                self.assertIs(type(reward), float)
                self.assertTrue(numpy.isfinite(reward))
                self.assertIs(type(terminated), bool)
                self.assertIs(type(truncated), bool)
                self.assertIsInstance(infos, dict)
                run.append(made)
            runs.append(run)
        for one, again in zip(*runs):
            self.assertTrue(all(same(a, b) for a, b in zip(one, again)), "the same seed and actions")
        # What was returned is not overwritten by later steps.
        env.reset(seed=9)
        self.assertTrue(same(env.step(actions[0])[0], runs[0][0][0]))

    def test_a_step_before_a_reset_after_an_end_or_after_closing_is_a_sentence(self):
        env = kaz.Env("stand", engine="none", episode_s=0.04)
        action = numpy.zeros(env.action_space.shape)
        with self.assertRaisesRegex(kaz.UsageError, "call reset"):
            env.step(action)
        env.reset(seed=1)
        env.step(action)
        self.assertTrue(env.step(action)[3])
        with self.assertRaisesRegex(kaz.UsageError, "episode has ended"):
            env.step(action)
        with self.assertRaisesRegex(kaz.UsageError, "not supported"):
            env.render()
        env.close()
        env.close()
        for act in (lambda: env.step(action), lambda: env.reset(seed=1)):
            with self.assertRaisesRegex(kaz.UsageError, "is closed"):
                act()
        with self.assertRaisesRegex(kaz.UsageError, "VectorEnv"):
            kaz.Env("stand", num_envs=3)

    def test_a_batch_of_robots_has_what_wrappers_read(self):
        env = kaz.VectorEnv("turn", num_envs=2, engine="none")
        for name in ("num_envs", "spec", "render_mode", "closed", "metadata", "single_action_space",
                     "single_observation_space", "action_space", "observation_space"):
            self.assertTrue(hasattr(env, name), name)
        self.assertIs(env.unwrapped, env)
        env.reset(seed=1)
        self.assertIs(env.np_random, env.randoms[0])
        self.assertFalse(env.closed)
        env.close()
        env.close()
        self.assertTrue(env.closed)

    def test_gymnasium_itself_agrees(self):
        try:
            from gymnasium.utils.env_checker import check_env
        except ImportError:
            self.skipTest("gymnasium is not installed")
        for name, env in self.all_environments():
            with self.subTest(name), warnings.catch_warnings():
                warnings.simplefilter("ignore")  # observations have no bounds
                check_env(env, skip_render_check=True)


if __name__ == "__main__":
    unittest.main()
