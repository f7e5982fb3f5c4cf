"""Offline LiDAR SLAM: recordings, odometry, closures, pose graphs and sessions as numpy arrays.

Points are (N, 3) float32 in metres, poses 4x4 float64, many poses (N, 4, 4), stamps int64 nanoseconds.
T_a_b maps coordinates of frame b to frame a. Input that cannot be used raises InputError, which names file,
place and remedy. Long work releases the interpreter's lock and ends at Ctrl-C.

    import groundloop
    recording = groundloop.open_recording("drive.mcap")
    run = groundloop.run_odometry(recording)
    closure = groundloop.close(run.maps[-1].points, run.maps[0].points)
"""
from ._groundloop import (  # noqa: F401
    Closure,
    InputError,
    LocalMap,
    Odometry,
    OdometryRun,
    PoseGraph,
    Recording,
    RegisteredScan,
    Scan,
    Session,
    SessionPart,
    __version__,
    close,
    load_session,
    open_recording,
    run_odometry,
)

__all__ = [
    "Closure",
    "InputError",
    "LocalMap",
    "Odometry",
    "OdometryRun",
    "PoseGraph",
    "Recording",
    "RegisteredScan",
    "Scan",
    "Session",
    "SessionPart",
    "close",
    "load_session",
    "open_recording",
    "run_odometry",
]
