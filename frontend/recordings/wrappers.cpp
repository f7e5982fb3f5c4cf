#include "frontend/recordings/wrappers.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/recordings/elevation_correction.hpp"
#include "frontend/recordings/source_tools.hpp"

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

// Times that are to begin, end or be in the middle at the stamp. What the first scans show is taken
// for all where they agree: a scan without returns at its beginning then keeps its place.
class Restamped final : public Wrapped {
 public:
  Restamped(std::unique_ptr<Recording> inner, const std::string& instant)
      : Wrapped(std::move(inner)), share_(share_of(instant)) {
    double shortest = 1e9, longest = -1e9, duration = 0.0;
    bool timed = false;
    for (const std::size_t index : spread_indices(size())) {
      const auto span = span_of(inner_->read(index));
      if (!span) continue;
      timed = true;
      shortest = std::min(shortest, instant_of(*span));
      longest = std::max(longest, instant_of(*span));
      duration = std::max(duration, span->second - span->first);
    }
    if (!timed) {
      info_.notes.push_back("--stamp " + instant +
                            " changes nothing: points have no times of their own.");
      return;
    }
    constant_ = longest - shortest < kAgree * duration;
    if (constant_) shift_ = 0.5 * (longest + shortest);
    info_.notes.push_back("Stamps are taken to name the " + instant + " of each scan (by option).");
  }
  Scan read(std::size_t index) override {
    Scan scan = inner_->read(index);
    const auto span = span_of(scan);
    if (!span) return scan;
    const auto shift = static_cast<float>(constant_ ? shift_ : instant_of(*span));
    for (float& time : scan.times) time -= shift;
    return scan;
  }

 private:
  static constexpr double kAgree = 0.1;  // of the duration
  using Span = std::pair<double, double>;

  static double share_of(const std::string& instant) {
    if (instant == "start") return 0.0;
    if (instant == "middle") return 0.5;
    if (instant == "end") return 1.0;
    throw InputError("--stamp: '" + instant + "' is unknown; allowed are start, middle, end");
  }
  static std::optional<Span> span_of(const Scan& scan) {
    if (scan.times.empty()) return std::nullopt;
    const auto [first, last] = std::minmax_element(scan.times.begin(), scan.times.end());
    return Span{static_cast<double>(*first), static_cast<double>(*last)};
  }
  [[nodiscard]] double instant_of(const Span& span) const {
    return span.first + share_ * (span.second - span.first);
  }

  double share_, shift_ = 0.0;
  bool constant_ = false;
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

std::unique_ptr<Recording> with_stamp_at(std::unique_ptr<Recording> inner,
                                         const std::string& instant) {
  return std::make_unique<Restamped>(std::move(inner), instant);
}

std::unique_ptr<Recording> with_note(std::unique_ptr<Recording> inner, const std::string& note) {
  return std::make_unique<Noted>(std::move(inner), note);
}

}  // namespace groundloop::recordings
