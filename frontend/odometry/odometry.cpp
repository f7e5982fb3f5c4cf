#include "frontend/odometry/odometry.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <istream>
#include <ostream>

#include <spdlog/spdlog.h>

#include "frontend/core/binary_io.hpp"
#include "frontend/odometry/scan_registration.hpp"

namespace groundloop {
namespace {

// Voxels out of range are dropped once the sensor has moved this far since the last time.
constexpr double kPruneDistance = 5.0;
// Updates that end the coarse registration, m and rad: the fine one goes on from there.
constexpr double kCoarseTranslation = 1e-2, kCoarseRotation = 1e-3;
// Neighbours are searched no farther than two voxels; a wider kernel has nothing more to weigh.
constexpr double kCoarseVoxels = 2.0;
// Over a gap the velocity is tried for so long, s.
constexpr double kLongestCoast = 5.0;
// Predictions whose turns differ by more, rad: at ten metres that is two voxels, as far as the
// coarse registration reaches, and where it begins decides where it ends.
constexpr double kDoubtfulTurn = 0.1;
// Share of a scan in the running mean of how many voxels scans fill.
constexpr double kUsualGain = 0.05;
// Scans that a sensor is taken to swing on for after its velocity changed: it rests at the turning
// points, and where its acceleration passes through zero. So many at the start are measured too:
// scans deskewed by a wrong velocity make a map that a swing cannot be seen against.
constexpr int kSwingScans = 20;
// The motion follows from the pose, the pose from points deskewed by it.
constexpr int kSwingRounds = 2;

double radians(double degrees) { return degrees * M_PI / 180.0; }

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Odometry::Odometry(const OdometryOptions& options)
    : options_(options),
      map_(static_cast<float>(options.voxel_size)),
      search_({options.search_scale, radians(options.search_turn_deg), options.search_poor,
               options.search_better},
              options.voxel_size),
      judge_({options.fine_threshold * options.voxel_size, kCoarseVoxels * options.voxel_size,
              options.point_to_point ? 1.0 : options.along_plane_weight, options.max_gap,
              kLongestCoast}),
      threshold_(options.initial_threshold, options.min_motion) {}

Odometry::Sweep Odometry::sweep_of(const Scan& scan) {
  if (scan.times.empty()) return {};
  const auto [min, max] = std::minmax_element(scan.times.begin(), scan.times.end());
  const double first = *min, last = *max;
  return {0.5 * (first + last), 0.5 * (last - first)};
}

std::size_t Odometry::points_within_range(const Scan& scan) const {
  return deskew_and_crop(scan, {}, 0.0, options_.min_range, options_.max_range).size();
}

void Odometry::start(const Scan& first, const Scan& second) {
  const auto enough = static_cast<std::size_t>(options_.min_points);
  if (points_within_range(first) < enough || points_within_range(second) < enough) return;
  Odometry trial(options_);
  // Two rounds: the velocity that the first finds deskews the second.
  for (int round = 0; round < 2; ++round) {
    Odometry next(options_);
    next.twist_ = trial.twist_;
    next.add(first, "first scan");
    next.add(second, "second scan");
    trial.twist_ = next.twist_;
  }
  twist_ = trial.twist_;
  T_world_middle_ = exp_se3(sweep_of(first).middle * twist_);
}

bool Odometry::blocked(std::size_t voxels) {
  const auto count = static_cast<double>(voxels);
  const bool few = scans_ > 0 && count < options_.blocked_share * usual_voxels_;
  if (few && blocked_ < options_.max_blocked) {
    ++blocked_;
    return true;
  }
  blocked_ = 0;
  // A view that stays narrow is the usual one from now on.
  usual_voxels_ += (few || scans_ == 0 ? 1.0 : kUsualGain) * (count - usual_voxels_);
  return false;
}

// Adapts the threshold to how far the prediction was off.
void Odometry::learn_deviation(const Pose& guess, const Pose& registered) {
  const Pose deviation = guess.inverse() * registered;
  threshold_.learn(deviation.translation.norm() +
                   2.0 * options_.max_range * std::sin(0.5 * rotation_angle(deviation.rotation)));
}

Odometry::DeskewedScan Odometry::deskew(const Scan& scan, const SensorMotion& motion,
                                        double middle) {
  DeskewedScan result;
  result.points = deskew_and_crop(scan, motion, middle, options_.min_range, options_.max_range);
  result.map_points = downsampler_(result.points, 0.5F * static_cast<float>(options_.voxel_size));
  return result;
}

RegistrationKernel Odometry::coarse_kernel() const {
  const double along = options_.point_to_point ? 1.0 : options_.along_plane_weight;
  return {std::min(threshold_.value(), kCoarseVoxels * options_.voxel_size),
          along,
          1.0,
          std::max(options_.stop_translation, kCoarseTranslation),
          std::max(radians(options_.stop_rotation_deg), kCoarseRotation),
          options_.max_iterations};
}

RegistrationKernel Odometry::fine_kernel() const {
  const auto voxel = static_cast<float>(options_.voxel_size);
  RegistrationKernel kernel = coarse_kernel();
  kernel.sigma = std::min(kernel.sigma, options_.fine_threshold * voxel);
  if (!options_.point_to_point) kernel.scatter_weight = options_.scatter_weight;
  kernel.stop_translation = options_.stop_translation;
  kernel.stop_rotation = radians(options_.stop_rotation_deg);
  return kernel;
}

bool Odometry::swings(const Sweep& sweep, const Vector6d& velocity) {
  const double departure = (velocity - twist_).tail<3>().norm() * sweep.half;
  if (departure > radians(options_.swing_deg)) {
    swinging_ = kSwingScans;
  } else if (swinging_ > 0) {
    --swinging_;
  }
  return swinging_ > 0 || scans_ < kSwingScans;
}

// The turn within the sweep is measured by the sweep itself, which has a sensor's faults in it: an
// axis askew looks like a turn, the same in each sweep. So the mean rate since the last scan is
// that of the poses, and the sweeps tell how it changed meanwhile.
SensorMotion Odometry::measure_swing(const Scan& scan, const Sweep& sweep, DeskewedScan& deskewed,
                                     double step, ScanRegistration& registration) {
  SweepPoints source;
  source.times = times_within(scan, options_.min_range, options_.max_range);
  for (float& t : source.times) {
    t = static_cast<float>((static_cast<double>(t) - sweep.middle) / sweep.half);
  }
  const auto voxel = static_cast<float>(options_.voxel_size);
  source.points =
      downsampler_(downsampler_(deskewed.points, 0.5F * voxel, source.times), voxel, source.times);
  const ScanRegistration turning = register_scan(map_, source, registration.pose, fine_kernel());

  const Eigen::Vector3d turn_rate = twist_.tail<3>() + turning.turn / sweep.half;
  SensorMotion motion;
  if (turn_rate_) motion.change.tail<3>() = (turn_rate - *turn_rate_) / step;
  registration.pose = turning.pose;
  for (int round = 0; round < kSwingRounds; ++round) {
    motion.velocity = log_se3(T_world_middle_.inverse() * registration.pose) / step;
    if (turn_rate_) {
      motion.velocity.tail<3>() += 0.5 * step * motion.change.tail<3>();
    } else {
      motion.velocity.tail<3>() = turn_rate;
    }
    deskewed = deskew(scan, motion, sweep.middle);
    const SweepPoints rigid{downsampler_(deskewed.map_points, voxel), {}};
    registration = register_scan(map_, rigid, registration.pose, fine_kernel());
  }
  turn_rate_ = turn_rate;
  return motion;
}

void Odometry::insert(const Points& map_points) {
  map_.insert(map_points, T_world_middle_);
  if (options_.search_scale > 0.0) search_.insert(map_points, T_world_middle_);
  const Eigen::Vector3d& position = T_world_middle_.translation;
  if ((position - pruned_at_).norm() <= kPruneDistance) return;
  const auto distance = static_cast<float>(options_.max_range);
  map_.remove_beyond(position, distance);
  search_.remove_beyond(position, distance);
  pruned_at_ = position;
}

RegisteredScan Odometry::predicted(const Pose& guess, const Sweep& sweep, double step) {
  ++predicted_scans_;
  turn_rate_.reset();
  T_world_middle_ = guess;
  RegisteredScan result;
  result.predicted = true;
  result.quality = judge_.predicted(step);
  result.T_world_scan = guess * exp_se3(-sweep.middle * twist_);
  return result;
}

bool Odometry::poor(std::size_t points, std::size_t voxels, const std::string& name) {
  // A sensor that swung a moment ago sees little where it looks at the ground or the sky, and its
  // velocity says nothing of the next scans.
  const bool predictable = swinging_ < kSwingScans / 2;
  const bool few = points < static_cast<std::size_t>(options_.min_points);
  if (few && few_++ == 0) {
    spdlog::warn(
        "{}: only {} points between {} and {} m, at least {} are needed to register a scan; its "
        "pose is predicted from the velocity",
        name, points, options_.min_range, options_.max_range, options_.min_points);
  }
  if (few) return true;
  few_ = 0;
  if (!predictable || !blocked(voxels)) return false;
  if (blocked_ == 1) {
    spdlog::warn(
        "{}: the view is blocked ({} voxels filled, {:.0f} are usual); its pose is "
        "predicted from the velocity",
        name, voxels, usual_voxels_);
  }
  return true;
}

std::vector<Pose> Odometry::other_predictions(double step) const {
  std::vector<Pose> others{T_world_middle_ * exp_se3(last_step_), T_world_middle_};
  if (step > options_.max_gap)
    others.push_back(T_world_middle_ * exp_se3(std::min(step, kLongestCoast) * twist_));
  return others;
}

PoseSearch::Found Odometry::register_to_map(const SweepPoints& source,
                                            const SweepPoints& fine_source,
                                            const Points& map_points, const Pose& guess,
                                            const std::vector<Pose>& others) {
  const RegistrationKernel coarse_settings = coarse_kernel(), fine_settings = fine_kernel();
  const PoseSearch::Stages stages{
      [&](const Pose& start) { return register_scan(map_, source, start, coarse_settings); },
      [&](const Pose& start) {
        return options_.second_registration ? register_scan(map_, fine_source, start, fine_settings)
                                            : register_scan(map_, source, start, coarse_settings);
      }};
  if (options_.search_scale <= 0.0 || scans_ == 0) return {stages.fine(stages.coarse(guess).pose)};
  const double apart = rotation_angle((guess.inverse() * others.front()).rotation);
  const bool doubtful = apart > kDoubtfulTurn;
  return search_.find(stages, map_, source.points, map_points, guess, others, T_world_middle_,
                      coarse_settings, doubtful);
}

ScanQuality Odometry::judge(const PoseSearch::Found& found, const Points& points, const Pose& guess,
                            const std::vector<Pose>& others, double step) {
  if (map_.empty()) return judge_.first();
  const Pose& pose = found.registration.pose;
  double jump = (pose.translation - guess.translation).norm();
  for (const Pose& other : others)
    jump = std::min(jump, (pose.translation - other.translation).norm());
  const double way = (pose.translation - T_world_middle_.translation).norm();
  return judge_.registered(
      {found.registration, points, found.fit, step, way, jump, guess.inverse() * pose});
}

RegisteredScan Odometry::add(const Scan& scan, const std::string& name) {
  const auto start = std::chrono::steady_clock::now();
  const Sweep sweep = sweep_of(scan);
  const Nanoseconds middle_stamp =
      scan.stamp + static_cast<Nanoseconds>(std::llround(sweep.middle * 1e9));
  const double step = static_cast<double>(middle_stamp - middle_stamp_) * 1e-9;
  // Across a gap, or where stamps do not advance, the velocity says little.
  const double trusted_step = scans_ == 0 ? 0.0 : std::clamp(step, 0.0, options_.max_gap);
  const bool followed = scans_ > 0 && step > 0.0 && step <= options_.max_gap;
  const Pose guess = T_world_middle_ * exp_se3(trusted_step * twist_);
  middle_stamp_ = middle_stamp;

  DeskewedScan deskewed = deskew(scan, {twist_}, sweep.middle);
  const auto voxel = static_cast<float>(options_.voxel_size);
  const SweepPoints source{downsampler_(deskewed.map_points, 1.5F * voxel), {}};
  if (poor(deskewed.points.size(), source.points.size(), name)) {
    if (scans_ > 0) ++scans_;
    RegisteredScan result = predicted(guess, sweep, scans_ > 0 ? step : 0.0);
    result.seconds = seconds_since(start);
    return result;
  }
  const SweepPoints fine_source{downsampler_(deskewed.map_points, voxel), {}};
  const std::vector<Pose> others = other_predictions(step);
  PoseSearch::Found found =
      register_to_map(source, fine_source, deskewed.map_points, guess, others);

  // What a gap brings says nothing of the steps after it.
  if (followed) learn_deviation(guess, found.registration.pose);
  last_step_ =
      scans_ > 0 ? log_se3(T_world_middle_.inverse() * found.registration.pose) : Vector6d::Zero();
  SensorMotion motion{twist_};
  if (followed) {
    motion.velocity = last_step_ / step;
    if (sweep.half > 0.0 && swings(sweep, motion.velocity)) {
      motion = measure_swing(scan, sweep, deskewed, step, found.registration);
    } else {
      turn_rate_.reset();
    }
  }
  RegisteredScan result;
  result.quality = judge(found, fine_source.points, guess, others, step);
  // Where a gap was too long, the map is that of another place: the scan begins one of its own.
  if (result.quality.doubt == Doubt::long_gap) {
    map_.clear();
    search_.clear();
  }
  twist_ = motion.velocity;
  T_world_middle_ = found.registration.pose;
  ++scans_;
  insert(deskewed.map_points);

  // From the middle of the sweep to the instant of the stamp, with the motion just measured.
  const Pose T_middle_scan = motion.after(-sweep.middle);
  result.T_world_scan = T_world_middle_ * T_middle_scan;
  result.points = std::move(deskewed.points);
  if (sweep.middle != 0.0) {
    const PoseF T_scan_middle(T_middle_scan.inverse());
    for (Eigen::Vector3f& p : result.points) p = T_scan_middle * p;
  }
  result.registration_points = source.points.size() + fine_source.points.size();
  result.iterations = found.registration.iterations;
  result.seconds = seconds_since(start);
  return result;
}

void Odometry::save(std::ostream& out) const {
  put(out, T_world_middle_.rotation.coeffs());
  put(out, T_world_middle_.translation);
  put(out, middle_stamp_);
  put(out, twist_);
  put(out, turn_rate_.has_value());
  put(out, turn_rate_.value_or(Eigen::Vector3d::Zero()));
  put(out, swinging_);
  put(out, last_step_);
  threshold_.save(out);
  put(out, scans_);
  put(out, usual_voxels_);
  put(out, blocked_);
  put(out, few_);
  put(out, predicted_scans_);
  put(out, pruned_at_);
  map_.save(out);
  search_.save(out);
  judge_.save(out);
}

void Odometry::load(std::istream& in) {
  get(in, T_world_middle_.rotation.coeffs());
  get(in, T_world_middle_.translation);
  get(in, middle_stamp_);
  get(in, twist_);
  bool has_turn_rate = false;
  Eigen::Vector3d turn_rate;
  get(in, has_turn_rate);
  get(in, turn_rate);
  turn_rate_ = has_turn_rate ? std::optional(turn_rate) : std::nullopt;
  get(in, swinging_);
  get(in, last_step_);
  threshold_.load(in);
  get(in, scans_);
  get(in, usual_voxels_);
  get(in, blocked_);
  get(in, few_);
  get(in, predicted_scans_);
  get(in, pruned_at_);
  map_.load(in);
  search_.load(in);
  judge_.load(in);
  const bool finite = T_world_middle_.translation.allFinite() && twist_.allFinite() &&
                      last_step_.allFinite() &&
                      std::abs(T_world_middle_.rotation.norm() - 1.0) < 1e-6;
  if (!finite) in.setstate(std::ios::failbit);
}

}  // namespace groundloop
