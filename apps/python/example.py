#!/usr/bin/env python3
"""example.py RECORDING: odometry, closures between its local maps, and the graph of both solved."""
import sys

import numpy as np

import groundloop

recording = groundloop.open_recording(sys.argv[1])
print(recording.info["format"], len(recording), "scans,", recording.info["sensor"])
run = groundloop.run_odometry(recording)

graph = groundloop.PoseGraph()
for m in run.maps:
    graph.add_vertex(m.id, m.pose)
for a, b in zip(run.maps, run.maps[1:]):
    # A percent of 100 m, a degree: what odometry may err from map to map.
    sigma = np.array([1.0, 1.0, 1.0, 0.02, 0.02, 0.02])
    graph.add_edge(a.id, b.id, np.linalg.inv(a.pose) @ b.pose, np.diag(sigma**-2))
for query in run.maps:
    for reference in run.maps[: max(0, query.id - 3)]:
        closure = groundloop.close(query.points, reference.points)
        if closure is not None and closure.accepted:
            print(f"map {query.id} meets map {reference.id}: {closure.inliers} inliers, overlap {closure.overlap:.2f}")
            graph.add_edge(query.id, reference.id, closure.pose, closure.information, closure=True)
print(graph.optimize(robust=True))
