#!/usr/bin/env python3
"""The Python module against closed forms and simulated truth. PYTHONPATH names the folder of the package; the environment
variable GROUNDLOOP the command, which simulates what is read."""
import os
import signal
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import groundloop


def turn(angle, x=0.0, y=0.0, z=0.0):
    """A pose: a rotation about z, and a translation."""
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    pose[:3, 3] = x, y, z
    return pose


def angle_of(pose):
    return np.arccos(np.clip((np.trace(pose[:3, :3]) - 1) / 2, -1, 1))


class Recordings(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = tempfile.TemporaryDirectory()
        folder = Path(cls.work.name)
        sim = "sim:town?sensor=spin16&length=130&seed=3"
        command = os.environ["GROUNDLOOP"]
        subprocess.run([command, "--quiet", "simulate", sim, "--layout", "folder", "--out", folder / "scans"], check=True)
        subprocess.run([command, "--quiet", "run", folder / "scans", "--out", folder / "session"], check=True)
        cls.recording = groundloop.open_recording(str(folder / "scans"))
        cls.odometry = groundloop.run_odometry(cls.recording)
        cls.session = groundloop.load_session(str(folder / "session"))

    @classmethod
    def tearDownClass(cls):
        cls.work.cleanup()

    def test_scans_are_arrays(self):
        scan = self.recording[0]
        self.assertEqual(scan.points.dtype, np.float32)
        self.assertEqual(scan.points.shape[1], 3)
        self.assertEqual(scan.times.shape, scan.points.shape[:1])
        self.assertEqual(self.recording.stamps[0], scan.stamp)
        self.assertTrue((np.diff(self.recording.stamps) > 0).all())
        self.assertEqual(self.recording[-1].stamp, self.recording.stamps[-1])

    def test_odometry_follows_the_truth(self):
        stamps, truth = self.recording.ground_truth()
        np.testing.assert_array_equal(stamps, self.odometry.stamps)
        true_end = np.linalg.inv(truth[0]) @ truth[-1]
        end = np.linalg.inv(self.odometry.poses[0]) @ self.odometry.poses[-1]
        # Of 130 m with 16 beams; another convention of frames would be tens of metres off.
        self.assertLess(np.linalg.norm(end[:3, 3] - true_end[:3, 3]), 5.0)
        self.assertGreater(np.linalg.norm(np.diff(truth[:, :3, 3], axis=0), axis=1).sum(), 100)

    def test_scan_by_scan_is_the_same_odometry(self):
        odometry = groundloop.Odometry()
        odometry.start(self.recording[0], self.recording[1])
        for i in range(5):
            scan = self.recording[i]
            pose = odometry.add(groundloop.Scan(scan.points, scan.stamp, scan.times)).pose
            np.testing.assert_array_equal(pose, self.odometry.poses[i])

    def test_maps_partition_the_scans(self):
        bounds = [(m.first_scan, m.last_scan) for m in self.odometry.maps]
        self.assertEqual(bounds[0][0], 0)
        self.assertEqual(bounds[-1][1], len(self.recording) - 1)
        for (_, last), (first, _) in zip(bounds, bounds[1:]):
            self.assertEqual(first, last + 1)

    def test_the_session_is_what_the_command_left(self):
        part = self.session.parts[0]
        self.assertEqual(part.poses.shape, (len(self.recording), 4, 4))
        np.testing.assert_array_equal(part.stamps, self.recording.stamps)
        np.testing.assert_allclose(part.odometry, self.odometry.poses, atol=1e-9)  # the same steps
        np.testing.assert_array_equal(part.map_scans[0], [self.odometry.maps[0].first_scan, self.odometry.maps[0].last_scan])
        self.assertEqual(self.session.map_points(0).shape, self.odometry.maps[0].points.shape)
        with self.assertRaises(IndexError):
            self.session.map_points(1000)

    def test_a_moved_cloud_is_found_where_it_is(self):
        points = self.odometry.maps[0].points
        moved = turn(0.5, 3.0, -2.0, 0.2)  # T_query_reference
        query = points @ moved[:3, :3].T.astype(np.float32) + moved[:3, 3].astype(np.float32)
        closure = groundloop.close(query, points)
        self.assertTrue(closure.accepted, closure.reason)
        error = np.linalg.inv(moved) @ closure.pose
        self.assertLess(np.linalg.norm(error[:3, 3]), 0.05)
        self.assertLess(angle_of(error), 0.002)
        self.assertGreater(closure.overlap, 0.8)

    def test_ctrl_c_ends_long_work(self):
        started = threading.Event()

        def progress(stage, done, total):
            started.set()

        def interrupt():
            started.wait()
            os.kill(os.getpid(), signal.SIGINT)

        threading.Thread(target=interrupt).start()
        with self.assertRaises(KeyboardInterrupt):
            groundloop.run_odometry(self.recording, progress)
            time.sleep(60)  # the signal may come after the last scan

    def test_other_threads_go_on(self):
        done = []
        thread = threading.Thread(target=lambda: groundloop.run_odometry(self.recording, lambda *a: done.append(a)))
        thread.start()
        ticks = 0
        while thread.is_alive():
            ticks += 1
            time.sleep(0.001)
        self.assertGreater(ticks, 1)
        self.assertEqual(len(done), len(self.recording))


class Input(unittest.TestCase):
    def test_errors_name_what_is_wrong(self):
        with self.assertRaisesRegex(groundloop.InputError, "nowhere"):
            groundloop.open_recording("nowhere")
        with self.assertRaisesRegex(groundloop.InputError, "did you mean 'voxel_size'"):
            groundloop.Odometry(voxelsize=1.0)
        with self.assertRaisesRegex(groundloop.InputError, "out of range"):
            groundloop.Odometry(voxel_size=-1.0)
        with self.assertRaisesRegex(groundloop.InputError, r"\(N, 3\)"):
            groundloop.close(np.zeros((4, 2)), np.zeros((4, 3)))
        with self.assertRaises(ValueError):  # what it derives from
            groundloop.open_recording("nowhere")

    def test_nothing_is_found_in_nothing(self):
        self.assertIsNone(groundloop.close(np.zeros((0, 3)), np.zeros((0, 3))))


class Graphs(unittest.TestCase):
    def square(self, false_closure):
        """Four sides of a square, each turned by two degrees too much, and what closes it."""
        graph = groundloop.PoseGraph()
        step = turn(np.pi / 2, 10.0)
        wrong = turn(np.pi / 2 + np.radians(2), 10.0)
        pose = np.eye(4)
        for i in range(8):
            graph.add_vertex(i, pose)
            pose = pose @ wrong
        for i in range(7):
            graph.add_edge(i, i + 1, wrong, np.eye(6))
        for i in range(4):
            graph.add_edge(i + 4, i, np.eye(4), 1e6 * np.eye(6), closure=True)
        if false_closure:
            graph.add_edge(7, 1, turn(0.0, 40.0), 1e6 * np.eye(6), closure=True)
        return graph, step

    def test_consistent_measurements_are_met(self):
        graph = groundloop.PoseGraph()
        true = [turn(0.3 * i, i, 0.1 * i * i) for i in range(6)]
        for i, pose in enumerate(true):
            graph.add_vertex(i, pose @ turn(0.05, 0.2) if i else pose, fixed=i == 0)
        for i in range(5):
            graph.add_edge(i, i + 1, np.linalg.inv(true[i]) @ true[i + 1], np.eye(6))
        summary = graph.optimize()
        np.testing.assert_allclose(graph.poses, true, atol=1e-5)
        self.assertLess(summary["cost_after"], 1e-9)
        self.assertEqual(graph.ids, list(range(6)))

    def test_a_false_closure_is_rejected(self):
        graph, _ = self.square(false_closure=True)
        rejected = graph.optimize(robust=True)["rejected_edges"]
        self.assertEqual(rejected, [11])

    def test_files_are_read_back(self):
        graph, _ = self.square(false_closure=False)
        with tempfile.TemporaryDirectory() as folder:
            file = str(Path(folder) / "graph.g2o")
            graph.write(file)
            again = groundloop.PoseGraph.read(file)
        np.testing.assert_allclose(again.poses, graph.poses, atol=1e-12)

    def test_bad_edges_are_named(self):
        graph = groundloop.PoseGraph()
        graph.add_vertex(0, np.eye(4))
        with self.assertRaisesRegex(groundloop.InputError, "no vertex 5"):
            graph.add_edge(0, 5, np.eye(4), np.eye(6))
        graph.add_vertex(5, np.eye(4))
        with self.assertRaisesRegex(groundloop.InputError, "positive semi-definite"):
            graph.add_edge(0, 5, np.eye(4), -np.eye(6))
        with self.assertRaisesRegex(groundloop.InputError, "no rotation"):
            graph.add_vertex(6, np.zeros((4, 4)))


if __name__ == "__main__":
    unittest.main()
