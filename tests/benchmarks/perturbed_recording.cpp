#include "tests/benchmarks/perturbed_recording.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "frontend/core/error.hpp"

namespace groundloop {
namespace {

// Scans of another recording, in an order of its own.
class Selected : public Recording {
 public:
  Selected(std::unique_ptr<Recording> inner, std::vector<std::size_t> scans)
      : inner_(std::move(inner)), scans_(std::move(scans)) {}
  const RecordingInfo& info() const override { return inner_->info(); }
  std::size_t size() const override { return scans_.size(); }
  Nanoseconds stamp(std::size_t index) const override { return inner_->stamp(scans_.at(index)); }
  Scan read(std::size_t index) override { return inner_->read(scans_.at(index)); }
  // One pose a scan stays one a scan.
  Trajectory ground_truth() const override {
    const Trajectory truth = inner_->ground_truth();
    if (truth.size() != inner_->size()) return truth;
    Trajectory result;
    for (const std::size_t i : scans_) result.push_back(truth[i]);
    return result;
  }

 protected:
  std::unique_ptr<Recording> inner_;
  std::vector<std::size_t> scans_;
};

class Rounded final : public Selected {
 public:
  Rounded(std::unique_ptr<Recording> inner, std::vector<std::size_t> scans, double millimetres)
      : Selected(std::move(inner), std::move(scans)), step_(1e-3 * millimetres) {}
  Scan read(std::size_t index) override {
    Scan scan = Selected::read(index);
    for (Eigen::Vector3f& p : scan.points) {
      for (float& c : p) c = static_cast<float>(std::round(static_cast<double>(c) / step_) * step_);
    }
    return scan;
  }

 private:
  double step_;
};

class ShakenStamps final : public Selected {
 public:
  ShakenStamps(std::unique_ptr<Recording> inner, std::vector<std::size_t> scans)
      : Selected(std::move(inner), std::move(scans)) {
    std::vector<Nanoseconds> steps;
    for (std::size_t i = 1; i < size(); ++i)
      steps.push_back(Selected::stamp(i) - Selected::stamp(i - 1));
    if (steps.empty()) return;
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    const Nanoseconds shift = steps[steps.size() / 2] / 10;
    std::mt19937 random(1);
    for (std::size_t i = 0; i < size(); ++i) shifts_.push_back(random() % 2 == 0 ? shift : -shift);
  }
  Nanoseconds stamp(std::size_t index) const override {
    return Selected::stamp(index) + shifts_.at(index);
  }
  Scan read(std::size_t index) override {
    Scan scan = Selected::read(index);
    scan.stamp += shifts_.at(index);
    return scan;
  }
  Trajectory ground_truth() const override {
    Trajectory truth = Selected::ground_truth();
    for (std::size_t i = 0; i < truth.size() && truth.size() == size(); ++i)
      truth[i].stamp += shifts_[i];
    return truth;
  }

 private:
  std::vector<Nanoseconds> shifts_;
};

class Turned final : public Selected {
 public:
  Turned(std::unique_ptr<Recording> inner, std::vector<std::size_t> scans, unsigned seed)
      : Selected(std::move(inner), std::move(scans)) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    rotation_ = Eigen::Quaterniond(w, x, y, z).normalized();
  }
  Scan read(std::size_t index) override {
    Scan scan = Selected::read(index);
    const Eigen::Matrix3f R = rotation_.toRotationMatrix().cast<float>();
    for (Eigen::Vector3f& p : scan.points) p = R * p;
    return scan;
  }
  Trajectory ground_truth() const override {
    Trajectory truth = Selected::ground_truth();
    const Pose T_scan_turned(Eigen::Quaterniond(rotation_.conjugate()), Eigen::Vector3d::Zero());
    for (StampedPose& p : truth) p.pose = p.pose * T_scan_turned;
    return truth;
  }

 private:
  Eigen::Quaterniond rotation_;
};

// A sensor shaken in its mount: each scan seen from a head turned by a rotation of its own, whose
// angles about three axes are normally distributed.
class Shaken final : public Selected {
 public:
  Shaken(std::unique_ptr<Recording> inner, std::vector<std::size_t> scans, double degrees)
      : Selected(std::move(inner), std::move(scans)) {
    std::mt19937 random(7);
    std::normal_distribution<double> angle(0.0, degrees * M_PI / 180.0);
    for (std::size_t i = 0; i < size(); ++i) {
      const double x = angle(random), y = angle(random), z = angle(random);
      rotations_.push_back(exp_so3(Eigen::Vector3d(x, y, z)));
    }
  }
  Scan read(std::size_t index) override {
    Scan scan = Selected::read(index);
    const Eigen::Matrix3f R = rotations_.at(index).toRotationMatrix().transpose().cast<float>();
    for (Eigen::Vector3f& p : scan.points) p = R * p;
    return scan;
  }
  Trajectory ground_truth() const override {
    Trajectory truth = Selected::ground_truth();
    if (truth.size() != size()) return {};
    for (std::size_t i = 0; i < truth.size(); ++i)
      truth[i].pose = truth[i].pose * Pose(rotations_[i], Eigen::Vector3d::Zero());
    return truth;
  }

 private:
  std::vector<Eigen::Quaterniond> rotations_;
};

// From a third of the way on, so many scans see nothing but what covers the sensor.
class Covered final : public Selected {
 public:
  Covered(std::unique_ptr<Recording> inner, std::vector<std::size_t> scans, std::size_t covered)
      : Selected(std::move(inner), std::move(scans)), first_(size() / 3), end_(first_ + covered) {}
  Scan read(std::size_t index) override {
    Scan scan = Selected::read(index);
    if (index < first_ || index >= end_) return scan;
    for (Eigen::Vector3f& p : scan.points)
      if (p.squaredNorm() > 0.0F) p *= 0.3F / p.norm();
    return scan;
  }

 private:
  std::size_t first_, end_;
};

class Reversed final : public Selected {
 public:
  using Selected::Selected;
  Nanoseconds stamp(std::size_t index) const override { return mirrored(Selected::stamp(index)); }
  Scan read(std::size_t index) override {
    Scan scan = Selected::read(index);
    scan.stamp = mirrored(scan.stamp);
    for (float& t : scan.times) t = -t;
    return scan;
  }
  Trajectory ground_truth() const override {
    Trajectory truth = Selected::ground_truth();
    for (StampedPose& p : truth) p.stamp = mirrored(p.stamp);
    return truth;
  }

 private:
  // The last scan keeps its stamp.
  Nanoseconds mirrored(Nanoseconds stamp) const { return 2 * Selected::stamp(0) - stamp; }
};

std::vector<std::size_t> every_scan(const Recording& recording) {
  std::vector<std::size_t> scans(recording.size());
  std::iota(scans.begin(), scans.end(), std::size_t{0});
  return scans;
}

}  // namespace

std::unique_ptr<Recording> perturb(std::unique_ptr<Recording> inner,
                                   const std::string& perturbation) {
  std::vector<std::size_t> scans = every_scan(*inner);
  if (perturbation == "none") return inner;
  if (perturbation == "drop10" || perturbation == "every2") {
    const std::size_t period = perturbation == "every2" ? 2 : 10;
    std::erase_if(scans, [&](std::size_t i) { return i % period == period - 1; });
    return std::make_unique<Selected>(std::move(inner), std::move(scans));
  }
  if (perturbation == "stamps")
    return std::make_unique<ShakenStamps>(std::move(inner), std::move(scans));
  if (perturbation == "reverse") {
    std::reverse(scans.begin(), scans.end());
    return std::make_unique<Reversed>(std::move(inner), std::move(scans));
  }
  const std::string digits = perturbation.substr(perturbation.find_last_not_of("0123456789") + 1);
  const std::string name = perturbation.substr(0, perturbation.size() - digits.size());
  if (!digits.empty() && digits.size() < 5 && name == "round")
    return std::make_unique<Rounded>(std::move(inner), std::move(scans), std::stod(digits));
  if (!digits.empty() && digits.size() < 5 && name == "turn") {
    return std::make_unique<Turned>(std::move(inner), std::move(scans),
                                    static_cast<unsigned>(std::stoul(digits)));
  }
  if (!digits.empty() && digits.size() < 5 && name == "shake")
    return std::make_unique<Shaken>(std::move(inner), std::move(scans), std::stod(digits));
  if (!digits.empty() && digits.size() < 5 && name == "cover")
    return std::make_unique<Covered>(std::move(inner), std::move(scans), std::stoul(digits));
  if (!digits.empty() && digits.size() < 5 && name == "gap") {
    const std::size_t first = scans.size() / 3, count = std::stoul(digits);
    std::erase_if(scans, [&](std::size_t i) { return i >= first && i < first + count; });
    return std::make_unique<Selected>(std::move(inner), std::move(scans));
  }
  throw InputError(perturbation +
                   ": not a perturbation; see tests/benchmarks/perturbed_recording.hpp");
}

}  // namespace groundloop
