#include "frontend/recordings/wrappers.hpp"

#include <algorithm>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/elevation_correction.hpp"

namespace groundloop::recordings {

namespace {

class Wrapped : public Recording {
 public:
  explicit Wrapped(std::unique_ptr<Recording> inner)
      : inner_(std::move(inner)), info_(inner_->info()) {}
  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return inner_->size(); }
  Nanoseconds stamp(std::size_t index) const override { return inner_->stamp(index); }
  Scan read(std::size_t index) override { return inner_->read(index); }
  Trajectory ground_truth() const override { return inner_->ground_truth(); }

 protected:
  std::unique_ptr<Recording> inner_;
  RecordingInfo info_;
};

class Slice final : public Wrapped {
 public:
  Slice(std::unique_ptr<Recording> inner, std::size_t first, std::size_t count)
      : Wrapped(std::move(inner)), first_(first), count_(count) {
    info_.first_scan = first_;
    info_.scans_in_all = inner_->size();
    info_.notes.push_back("Scans " + std::to_string(first_) + " to " +
                          std::to_string(first_ + count_ - 1) + " of " +
                          std::to_string(inner_->size()) + " are used.");
  }
  std::size_t size() const override { return count_; }
  Nanoseconds stamp(std::size_t index) const override { return inner_->stamp(first_ + index); }
  Scan read(std::size_t index) override { return inner_->read(first_ + index); }
  Trajectory ground_truth() const override {
    Trajectory all = inner_->ground_truth();
    if (all.size() != inner_->size()) return all;  // at a rate of its own: found by stamp
    return {all.begin() + static_cast<std::ptrdiff_t>(first_),
            all.begin() + static_cast<std::ptrdiff_t>(first_ + count_)};
  }

 private:
  std::size_t first_, count_;
};

class ElevationCorrected final : public Wrapped {
 public:
  ElevationCorrected(std::unique_ptr<Recording> inner, const std::string& reason)
      : Wrapped(std::move(inner)) {
    info_.notes.push_back("Elevation is corrected by +" + to_text(kKittiElevationCorrectionDeg) +
                          " degrees (" + reason + ").");
  }
  Scan read(std::size_t index) override {
    Scan scan = inner_->read(index);
    correct_elevation(scan.points, kKittiElevationCorrectionDeg);
    return scan;
  }
};

class Noted final : public Wrapped {
 public:
  Noted(std::unique_ptr<Recording> inner, const std::string& note) : Wrapped(std::move(inner)) {
    info_.notes.push_back(note);
  }
};

}  // namespace

std::unique_ptr<Recording> slice(std::unique_ptr<Recording> inner, std::size_t first,
                                 std::size_t count) {
  if (first >= inner->size()) {
    throw InputError(inner->info().path + ": has " + std::to_string(inner->size()) +
                     " scans, the first one asked for is " + std::to_string(first) +
                     "; choose a smaller --first");
  }
  if (count == 0) throw InputError("--count: 0 scans are asked for; at least 1 is needed");
  return std::make_unique<Slice>(std::move(inner), first, std::min(count, inner->size() - first));
}

std::unique_ptr<Recording> with_elevation_correction(std::unique_ptr<Recording> inner,
                                                     const std::string& reason) {
  return std::make_unique<ElevationCorrected>(std::move(inner), reason);
}

std::unique_ptr<Recording> with_note(std::unique_ptr<Recording> inner, const std::string& note) {
  return std::make_unique<Noted>(std::move(inner), note);
}

}  // namespace groundloop::recordings
