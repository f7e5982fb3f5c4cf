#include "frontend/simulation/simulation.hpp"

#include <cmath>

#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"
#include "frontend/simulation/motion.hpp"
#include "frontend/simulation/ray_caster.hpp"
#include "frontend/simulation/sensor.hpp"
#include "frontend/simulation/sensor_noise.hpp"
#include "frontend/simulation/traffic.hpp"
#include "frontend/simulation/world.hpp"

namespace groundloop {
namespace {

using namespace simulation;

constexpr Nanoseconds nanoseconds_per_scan = 100'000'000;

class TheSimulation final : public SimulatedRecording {
 public:
  explicit TheSimulation(const std::string& specification)
      : parameters_(parse_simulation(specification)),
        world_(make_world(parameters_)),
        way_(world_->plan(parameters_)),
        motion_(*world_, way_, parameters_),
        caster_(*world_),
        traffic_(*world_, motion_, way_, parameters_, caster_),
        sensor_(parameters_),
        noise_(sensor_, parameters_) {
    // Another day is another month.
    epoch_ = 1'700'000'000'000'000'000 + parameters_.change * 2'592'000'000'000'000;
    size_ = static_cast<std::size_t>(motion_.duration() / Sensor::period);
    info_.path = specification;
    info_.format = "sim";
    info_.sensor = sensor_.description();
    info_.point_times = "exact, seconds from the start of the scan";
    info_.stamp_source = "simulated, 10 Hz, start of the scan";
    info_.fields = {"x", "y", "z", "t"};
    info_.notes = {"Simulated: every ray is cast from the pose of its own time."};
  }

  const SimulationParameters& parameters() const override { return parameters_; }
  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return size_; }
  Nanoseconds stamp(std::size_t index) const override {
    return epoch_ + static_cast<Nanoseconds>(index) * nanoseconds_per_scan;
  }
  Pose pose_at(Nanoseconds time) const override {
    return motion_.pose(1e-9 * static_cast<double>(time - epoch_));
  }
  Trajectory ground_truth() const override { return ground_truth_at(ScanInstant::start); }
  Trajectory ground_truth_at(ScanInstant instant) const override {
    Trajectory result(size_);
    for (std::size_t i = 0; i < size_; ++i) {
      const Nanoseconds time = stamp(i) + static_cast<int>(instant) * (nanoseconds_per_scan / 2);
      result[i] = {time, pose_at(time)};
    }
    return result;
  }
  Scan read(std::size_t index) override { return simulate(index, nullptr); }
  Scan read_with_truth(std::size_t index, std::vector<PointTruth>& truth) override {
    truth.clear();
    return simulate(index, &truth);
  }

 private:
  Scan simulate(std::size_t index, std::vector<PointTruth>* truth);

  SimulationParameters parameters_;
  std::unique_ptr<World> world_;
  Way way_;
  Motion motion_;
  RayCaster caster_;
  Traffic traffic_;
  Sensor sensor_;
  NoiseModel noise_;
  RecordingInfo info_;
  Nanoseconds epoch_ = 0;
  std::size_t size_ = 0;
  // Kept from scan to scan for their memory alone.
  std::vector<SensorRay> shots_;
  std::vector<Ray> rays_;
  std::vector<Hit> hits_;
  std::vector<Echo> echoes_;
};

Scan TheSimulation::simulate(std::size_t index, std::vector<PointTruth>* truth) {
  if (index >= size_) {
    throw InputError(info_.path + ": scan " + std::to_string(index) + " of " +
                     std::to_string(size_) + " does not exist");
  }
  const double start = Sensor::period * static_cast<double>(index);
  const double end = start + Sensor::period;
  const Vec3 centre = motion_.pose(0.5 * (start + end)).translation;
  const double reach = sensor_.max_range() + 2.0;
  caster_.prepare(centre, reach, traffic_.bodies(start, end, reach));
  sensor_.fire(index, shots_);

  struct SlotPose {
    Eigen::Matrix3f rotation;
    Eigen::Vector3f origin;
  };
  std::vector<SlotPose> poses(static_cast<std::size_t>(sensor_.slots()));
  parallel_for(poses.size(), 64, [&](std::size_t slot) {
    const Pose T = motion_.pose(start + sensor_.slot_time(static_cast<int>(slot)));
    poses[slot] = {T.rotation_matrix().cast<float>(), (T.translation - centre).cast<float>()};
  });
  const auto max_range = static_cast<float>(sensor_.max_range());
  rays_.resize(shots_.size());
  hits_.resize(shots_.size());
  echoes_.resize(shots_.size());
  constexpr std::size_t block = 2048;
  parallel_for(shots_.size(), block, [&](std::size_t i) {
    const SlotPose& pose = poses[shots_[i].slot];
    const double time = sensor_.slot_time(shots_[i].slot) / Sensor::period;
    rays_[i] = {pose.origin, pose.rotation * shots_[i].direction, static_cast<float>(time)};
    hits_[i] = caster_.cast(rays_[i], max_range);
  });
  parallel_for(shots_.size(), block, [&](std::size_t i) {
    const std::size_t beside = std::min(i + sensor_.neighbour(), shots_.size() - 1);
    echoes_[i] = noise_.measure(index, i, shots_[i], rays_[i], hits_[i], hits_[beside], caster_);
  });

  Scan scan;
  scan.stamp = stamp(index);
  for (std::size_t i = 0; i < shots_.size(); ++i) {
    if (echoes_[i].range <= 0.0F) continue;
    scan.points.push_back(echoes_[i].range * shots_[i].reported);
    scan.times.push_back(static_cast<float>(sensor_.slot_time(shots_[i].slot)));
    if (truth != nullptr) {
      truth->push_back({hits_[i].surface, hits_[i].normal, hits_[i].range, hits_[i].moving,
                        echoes_[i].true_echo});
    }
  }
  return scan;
}

}  // namespace

std::unique_ptr<SimulatedRecording> open_simulation(const std::string& specification) {
  return std::make_unique<TheSimulation>(specification);
}

}  // namespace groundloop
