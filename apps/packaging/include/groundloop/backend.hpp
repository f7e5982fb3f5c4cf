// The public face of groundloop::backend: candidates verified by registration, pose graphs solved
// and judged, whole recordings run and merged, sessions read back, trajectories evaluated. See
// frontend.hpp for what is promised.
#pragma once

#include "backend/evaluation/trajectory_evaluation.hpp"
#include "backend/graph/g2o_file.hpp"
#include "backend/graph/pose_graph.hpp"
#include "backend/judging/optimizer.hpp"
#include "backend/map/point_cloud_export.hpp"
#include "backend/mapping/slam.hpp"
#include "backend/merging/session_merge.hpp"
#include "backend/registration/verification.hpp"
#include "backend/session/stored_session.hpp"
