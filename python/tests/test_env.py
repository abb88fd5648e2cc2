# kaz.VectorEnv: Gymnasium's rules for vector environments, repeatability, and what each task rewards.
# SPDX-License-Identifier: Apache-2.0
import hashlib
import resource
import unittest

import numpy

import kaz


def played(engine="native", threads=1, seed=1, steps=110, mode="next_step", task="stand", env=None, **more):
    """A digest of observations, rewards and flags of random actions."""
    env = env or kaz.VectorEnv(task, num_envs=4, engine=engine, threads=threads, autoreset_mode=mode, **more)
    random = numpy.random.default_rng(5)

    def rows_of(observation):
        return list(observation.values()) if isinstance(observation, dict) else [observation]

    observation, _ = env.reset(seed=seed)
    rows = rows_of(observation)
    for _ in range(steps):
        observation, reward, ended, cut, _ = env.step(random.uniform(-1, 1, env.action_space.shape))
        rows += rows_of(observation) + [reward, ended, cut]
    return hashlib.sha256(b"".join(numpy.ascontiguousarray(row).tobytes() for row in rows)).hexdigest()


class Interface(unittest.TestCase):
    def setUp(self):
        self.env = kaz.VectorEnv("stand", num_envs=3, engine="none", episode_s=0.1)

    def test_shapes_and_types_are_those_of_the_spaces(self):
        observation, infos = self.env.reset(seed=3)
        self.assertIsInstance(infos, dict)
        for _ in range(4):
            self.assertEqual(observation.shape, self.env.observation_space.shape)
            self.assertEqual(observation.dtype, self.env.observation_space.dtype)
            self.assertTrue(self.env.observation_space.contains(observation))
            self.assertTrue(self.env.single_observation_space.contains(observation[0]))
            action = self.env.action_space.sample()
            self.assertEqual(action.shape, (3,) + self.env.single_action_space.shape)
            observation, reward, ended, cut, infos = self.env.step(action)
            for row, kind in ((reward, "f"), (ended, "b"), (cut, "b")):
                self.assertEqual(row.shape, (3,))
                self.assertEqual(row.dtype.kind, kind)
        self.assertEqual(self.env.metadata["autoreset_mode"], "next_step")

    def test_an_episode_that_is_cut_begins_again_with_the_next_step(self):
        self.env.reset(seed=3)
        zeros = numpy.zeros(self.env.action_space.shape)
        for k in range(4):
            *_, ended, cut, infos = self.env.step(zeros)
            self.assertFalse(cut.any() or ended.any(), k)
        *_, ended, cut, infos = self.env.step(zeros)
        self.assertTrue(cut.all())
        self.assertFalse(ended.any())
        numpy.testing.assert_allclose(infos["time_s"], 0.1)
        _, reward, ended, cut, infos = self.env.step(zeros)  # in which it is reset
        self.assertFalse(cut.any() or ended.any() or reward.any())
        self.assertFalse(infos["time_s"].any())

    def test_same_step_has_the_last_observation(self):
        env = kaz.VectorEnv("stand", num_envs=2, engine="none", episode_s=0.04, autoreset_mode="same_step")
        first, _ = env.reset(seed=1)
        actions = 0.5 * numpy.ones(env.action_space.shape)
        env.step(actions)
        observation, _, _, cut, infos = env.step(actions)
        self.assertTrue(cut.all() and infos["_final_obs"].all())
        self.assertTrue(numpy.abs(infos["final_obs"] - observation).max() > 0.05)
        numpy.testing.assert_allclose(observation, first, atol=0.02)

    def test_disabled_wants_a_reset_of_those_that_have_ended(self):
        env = kaz.VectorEnv("stand", num_envs=2, engine="none", episode_s=0.04, autoreset_mode="disabled")
        env.reset(seed=1)
        zeros = numpy.zeros(env.action_space.shape)
        env.step(zeros)
        env.reset(options={"reset_mask": numpy.array([True, False])})
        *_, cut, infos = env.step(zeros)
        self.assertEqual(cut.tolist(), [False, True])
        with self.assertRaises(kaz.UsageError):
            env.step(zeros)
        env.reset(options={"reset_mask": cut})
        env.step(zeros)

    def test_wrong_use_is_a_sentence(self):
        with self.assertRaises(kaz.UsageError):
            self.env.step(numpy.zeros(self.env.action_space.shape))  # before reset()
        self.env.reset(seed=[1, 2, 3])
        for wrong in (lambda: self.env.step(numpy.zeros((3, 2))), lambda: self.env.reset(seed=[1]),
                      lambda: self.env.reset(options={"reset_mask": [True]}), lambda: kaz.VectorEnv("fly"),
                      lambda: kaz.VectorEnv("stand", engine="paper"),
                      lambda: kaz.VectorEnv("stand", num_envs=0),
                      lambda: kaz.VectorEnv("stand", autoreset_mode="never")):
            with self.assertRaises(kaz.UsageError) as raised:
                wrong()
            self.assertTrue(str(raised.exception))
        with self.assertRaises(TypeError):
            kaz.VectorEnv("stand", wings=2)


class Repeatability(unittest.TestCase):
    def test_the_same_seed_gives_the_same_bytes_on_each_engine(self):
        for engine in ("none", "native", "h8"):
            with self.subTest(engine=engine):
                first = played(engine)
                self.assertEqual(first, played(engine))
                self.assertNotEqual(first, played(engine, seed=2))

    def test_and_for_any_number_of_threads(self):
        for engine in ("native", "h8"):
            self.assertEqual(played(engine, threads=1), played(engine, threads=3))

    def test_whatever_the_robots_did_before(self):
        for engine in ("none", "native", "h8"):
            with self.subTest(engine=engine):
                env = kaz.VectorEnv("stand", num_envs=4, engine=engine)
                first = played(env=env, steps=40)
                self.assertNotEqual(first, played(env=env, seed=7, steps=33))
                self.assertEqual(first, played(env=env, steps=40))

    def test_robots_differ_by_their_seeds_from_the_start(self):
        for sensors in ("nominal", "as-built"):
            env = kaz.VectorEnv("stand", num_envs=3, engine="native", sensors=sensors)
            observation, _ = env.reset(seed=[1, 2, 1])
            self.assertTrue((observation[0] == observation[2]).all())
            for part in (slice(0, 18), slice(18, 21)):  # potentiometers, inertial sensors
                self.assertFalse((observation[0, part] == observation[1, part]).all())
            # They stand in the posture as their own potentiometers measure it, as well as friction lets them.
            self.assertLess(numpy.abs(observation[:, :18]).max(), 0.05)

    def test_inertial_sensors_are_read_over_the_wire(self):
        angles = []
        for engine in ("none", "native", "h8"):
            env = kaz.VectorEnv("turn", num_envs=1, engine=engine)
            env.reset(seed=1)
            twist = numpy.zeros(env.action_space.shape)
            twist[0, [env.task.joints.index("l_hip_pitch"), env.task.joints.index("r_hip_pitch")]] = 0.5, -0.5
            rows = [env.step(twist)[0][0, 18:21] for _ in range(15)]
            angles.append(10 * numpy.array(rows))
        self.assertGreater(numpy.abs(angles[0]).max(axis=0).min(), 0.2)
        for k in (1, 2):  # later by the filter, and with noise
            self.assertGreater(numpy.abs(angles[k]).max(axis=0).min(), 0.1)

    def test_a_batch_gives_each_robot_what_it_has_alone(self):
        many = kaz.VectorEnv("stand", num_envs=3, engine="native")
        observations, _ = many.reset(seed=[4, 5, 6])
        alone = kaz.VectorEnv("stand", num_envs=1, engine="native")
        observation, _ = alone.reset(seed=[6])
        numpy.testing.assert_array_equal(observations[2], observation[0])

    def test_native_and_h8_measure_the_same_robot(self):
        # The engines sample within a tick of each other. A contact can amplify that: 0.04 rad for seed 1, at
        # most 0.01 for seeds 2 to 8. So the median over seeds is judged.
        largest = []
        for seed in range(1, 6):
            angles = []
            for engine in ("native", "h8"):
                env = kaz.VectorEnv("stand", num_envs=1, engine=engine)
                observation, _ = env.reset(seed=seed)
                for k in range(25):
                    wave = 0.5 * numpy.sin(0.3 * k) * numpy.ones(env.action_space.shape)
                    observation, *_ = env.step(wave)
                angles.append(observation[0, :18].copy())
            largest.append(numpy.abs(angles[0] - angles[1]).max())
        self.assertLess(numpy.median(largest), 0.01, largest)

    def test_memory_is_flat(self):
        env = kaz.VectorEnv("stand", num_envs=4, engine="native", episode_s=0.1)
        env.reset(seed=1)
        actions = numpy.zeros(env.action_space.shape)
        for _ in range(60):
            env.step(actions)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        for _ in range(600):  # 100 episodes of each
            env.step(actions)
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 4000)  # kB


class Pictures(unittest.TestCase):
    def test_are_in_the_observation_and_its_space(self):
        env = kaz.VectorEnv("look", num_envs=2, engine="native", pictures="ideal")
        observation, infos = env.reset(seed=1)
        self.assertEqual(sorted(observation), ["pictures", "state"])
        self.assertEqual(observation["pictures"].shape, (2, 2, 240, 320, 3))
        self.assertEqual(observation["pictures"].dtype, numpy.uint8)
        self.assertTrue(env.observation_space.contains(observation))
        self.assertTrue(env.observation_space.contains(env.observation_space.sample()))
        self.assertTrue(env.single_observation_space.contains({k: v[0] for k, v in observation.items()}))
        self.assertTrue(observation["pictures"].any(axis=(2, 3, 4)).all())  # none is black
        first, exposed = observation["pictures"].copy(), set()
        for k in range(20):
            kept = observation["pictures"]
            observation, *_, infos = env.step(numpy.full(env.action_space.shape, 0.5))
            age = infos["picture_age_s"][0]
            exposed.add(round(0.02 * k - age, 3))
            self.assertTrue(0.015 <= age <= 0.05, age)
        self.assertIn(len(exposed), (12, 13))  # 30 a second
        self.assertTrue((kept != observation["pictures"]).any())  # the arrays are the caller's
        self.assertTrue((first != observation["pictures"]).mean() > 0.1)  # the head has moved

    def test_same_step_keeps_the_last_ones(self):
        env = kaz.VectorEnv("look", num_envs=1, engine="native", pictures="ideal", episode_s=0.2,
                            autoreset_mode="same_step")
        first, _ = env.reset(seed=1)
        for _ in range(10):
            observation, *_, cut, infos = env.step(numpy.ones(env.action_space.shape))
        self.assertTrue(cut.all())
        moved = (infos["final_obs"]["pictures"] != observation["pictures"]).mean()
        again = (first["pictures"] != observation["pictures"]).mean()
        self.assertTrue(moved > 0.1 and again < 0.05, (moved, again))

    def test_are_the_same_bytes_for_any_number_of_threads(self):
        for eyes in ("ideal", "real"):
            one = played(threads=1, steps=12, task="look", pictures=eyes)
            self.assertEqual(one, played(threads=3, steps=12, task="look", pictures=eyes))
            self.assertNotEqual(one, played(steps=12, task="look", pictures=eyes, seed=2))

    def test_whatever_was_before(self):
        env = kaz.VectorEnv("look", num_envs=2, engine="native", pictures="real")
        first = played(env=env, steps=9)
        played(env=env, steps=4, seed=3)
        self.assertEqual(first, played(env=env, steps=9))

    def test_wrong_use_is_a_sentence(self):
        for wrong in (lambda: kaz.VectorEnv("look", engine="none", pictures="ideal"),
                      lambda: kaz.VectorEnv("look", pictures="painted")):
            with self.assertRaises(kaz.UsageError) as raised:
                wrong()
            self.assertIn("pictures", str(raised.exception))


class Tasks(unittest.TestCase):
    def test_who_holds_still_stands_and_who_bends_the_knees_falls(self):
        env = kaz.VectorEnv("stand", num_envs=2, engine="native")
        env.task.impulse = (0, 0)
        env.reset(seed=1)
        fold = numpy.zeros(env.action_space.shape)
        fold[1, [env.task.joints.index("l_knee"), env.task.joints.index("r_knee")]] = 1
        fell, returns = numpy.zeros(2, bool), numpy.zeros(2)
        for _ in range(150):
            _, reward, ended, _, infos = env.step(fold)
            returns += reward
            fell |= infos["fell"]
            if fell[1]:
                break
        self.assertEqual(fell.tolist(), [False, True])
        self.assertGreater(returns[0], returns[1])

    def test_pushes_move_the_robot(self):
        env = kaz.VectorEnv("stand", num_envs=1, engine="none")
        env.task.impulse = (1.5, 1.5)
        env.reset(seed=1)
        fell = False
        for _ in range(200):
            *_, infos = env.step(numpy.zeros(env.action_space.shape))
            fell |= bool(infos["fell"][0])
        self.assertTrue(fell)

    def test_walk_and_turn_reward_what_is_left_less(self):
        for task in ("walk", "turn"):
            env = kaz.VectorEnv(task, num_envs=2, engine="none")
            observation, _ = env.reset(seed=1)
            far = numpy.array(env.task.left)
            total = numpy.zeros(2)
            for _ in range(20):
                observation, reward, *_ = env.step(numpy.zeros(env.action_space.shape))
                total += reward
            scale = 10 if task == "walk" else 5
            numpy.testing.assert_allclose(total, scale * (far - env.task.left), atol=1e-6)
            features = observation[:, -2:]
            size = env.task.left if task == "walk" else numpy.ones(2)
            numpy.testing.assert_allclose(numpy.linalg.norm(features, axis=1), size, rtol=1e-5)

    def test_look_is_paid_for_looking(self):
        env = kaz.VectorEnv("look", num_envs=1, engine="native")
        env.reset(seed=1)
        ahead, aside = 0, 0
        for k in range(40):
            _, reward, *_ = env.step(numpy.array([[0.65, 0.0]]))  # to where the ball is
            ahead = reward[0]
        for k in range(40):
            _, reward, *_ = env.step(numpy.array([[-1.0, 0.0]]))
            aside = reward[0]
        self.assertGreater(ahead, 0.8)
        self.assertLess(aside, ahead - 0.5)

    def test_catch_is_paid_for_approach_and_for_lifting_the_ball(self):
        env = kaz.VectorEnv("catch", num_envs=2, engine="none")
        env.reset(seed=1)
        far, total = numpy.array(env.task.left), numpy.zeros(2)
        self.assertTrue((0.3 < far).all() and (far < 0.7).all(), far)
        for _ in range(20):
            _, reward, *_ = env.step(numpy.zeros(env.action_space.shape))
            total += reward
        numpy.testing.assert_allclose(total, 5 * (far - env.task.left), atol=1e-6)
        # As if the first robot had lifted it.
        state, actions = env.batch.state(), numpy.zeros((2, 18))
        state["ball"][0, 2] += 0.021
        env.task.left = numpy.array([env.task._far(i, state["ball"][i], env) for i in range(2)])
        for k in range(25):
            reward, caught = env.task.judge(env, state, actions)
            self.assertEqual(caught.tolist(), [k == 24, False])
            numpy.testing.assert_allclose(reward, [10.1 if k == 24 else 0.1, 0], atol=1e-6)
        state["ball"][0, 2] -= 0.021
        env.task.judge(env, state, actions)
        self.assertEqual(env.task.held_s.tolist(), [0, 0])

    def test_catch_with_pictures_knows_what_the_eyes_see(self):
        env = kaz.VectorEnv("catch", num_envs=1, engine="native", pictures="ideal")
        observation, _ = env.reset(seed=1)
        self.assertEqual(observation["state"][0, -4:].tolist(), [0, 0, 0, 0])  # out of view
        aside = numpy.zeros(env.action_space.shape)
        aside[0, env.task.joints.index("neck_pan")] = -1
        for _ in range(60):
            observation, *_ = env.step(aside)
        eye, ball = env.batch.link_pose(0, "left_eye"), env.batch.state()["ball"][0]
        numpy.testing.assert_allclose(observation["state"][0, -4:-1], eye[:3, :3].T @ (ball - eye[:3, 3]),
                                      atol=0.03)
        self.assertEqual(observation["state"][0, -1], 1)


if __name__ == "__main__":
    unittest.main()
