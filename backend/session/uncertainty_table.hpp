// uncertainty.csv: how well the pose of every local map is known against the first map, or, in a
// merged session, against the first map of its frame.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "frontend/core/pose.hpp"

namespace groundloop {

/// Names of the upper triangle's columns, row by row: cov_tx_tx,cov_tx_ty,...,cov_rz_rz.
[[nodiscard]] std::string covariance_header();
/// Appends ",v" for each of them.
void append_covariance(std::string& text, const Matrix6d& covariance);

/// One row a map: its number, and the covariance of its pose, perturbed on the right, in the order
/// tx ty tz rx ry rz, metres and radians.
void write_uncertainty(const std::filesystem::path& file, const std::vector<Matrix6d>& of_maps);
/// Throws InputError naming file, line and column.
[[nodiscard]] std::vector<Matrix6d> read_uncertainty(const std::filesystem::path& file);

}  // namespace groundloop
