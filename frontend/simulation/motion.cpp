#include "frontend/simulation/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frontend/core/error.hpp"
#include "frontend/simulation/random.hpp"

namespace groundloop::simulation {
namespace {

std::vector<Vec2> resampled(const std::vector<Vec2>& points, double step) {
  std::vector<Vec2> result{points.front()};
  double left = step;
  for (std::size_t i = 1; i < points.size(); ++i) {
    Vec2 from = points[i - 1];
    double d = (points[i] - from).norm();
    while (d >= left) {
      from += (points[i] - from) * (left / d);
      result.push_back(from);
      d = (points[i] - from).norm();
      left = step;
    }
    left -= d;
  }
  return result;
}

std::vector<Vec2> smoothed(const std::vector<Vec2>& points, int reach) {
  std::vector<Vec2> result = points;
  const int n = static_cast<int>(points.size());
  for (int i = 0; i < n; ++i) {
    const int r = std::min({reach, i, n - 1 - i});
    Vec2 sum = Vec2::Zero();
    for (int k = i - r; k <= i + r; ++k) sum += points[static_cast<std::size_t>(k)];
    result[static_cast<std::size_t>(i)] = sum / (2 * r + 1);
  }
  return result;
}

/// A sum of three sines of incommensurable periods: in [-1, 1], about `frequency` hertz.
double sway(double seconds, double frequency, std::uint64_t key) {
  const double w = 2.0 * std::numbers::pi * frequency * seconds;
  const double p = 6.28 * unit(key_of(key, 1)), q = 6.28 * unit(key_of(key, 2)),
               r = 6.28 * unit(key_of(key, 3));
  return 0.5 * std::sin(w + p) + 0.3 * std::sin(0.618 * w + q) + 0.2 * std::sin(1.732 * w + r);
}

}  // namespace

Line::Line(const std::vector<Vec2>& points, double length) {
  check(points.size() > 1, "a way has two points");
  knots_ = resampled(smoothed(smoothed(resampled(points, step), 5), 5), step);
  if (length > 0.0) {
    knots_.resize(std::min(knots_.size(), static_cast<std::size_t>(length / step) + 1));
  }
  double last = 0.0;
  for (std::size_t i = 0; i < knots_.size(); ++i) {
    const Vec2 d = knots_[std::min(i + 1, knots_.size() - 1)] - knots_[i > 0 ? i - 1 : 0];
    const double heading = std::atan2(d.y(), d.x());
    last = i == 0 ? heading : last + std::remainder(heading - last, 2.0 * std::numbers::pi);
    headings_.push_back(last);
  }
}

Vec2 Line::point(double s) const {
  const double u = std::clamp(s / step, 0.0, static_cast<double>(knots_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(u), knots_.size() - 2);
  const double t = u - static_cast<double>(i);
  const Vec2& b = knots_[i];
  const Vec2& c = knots_[i + 1];
  const Vec2 a = i > 0 ? knots_[i - 1] : Vec2(2 * b - c);
  const Vec2 d = i + 2 < knots_.size() ? knots_[i + 2] : Vec2(2 * c - b);
  // Catmull-Rom.
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

double Line::heading(double s) const {
  const double u = std::clamp(s / step, 0.0, static_cast<double>(knots_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(u), knots_.size() - 2);
  const double t = u - static_cast<double>(i);
  return (1 - t) * headings_[i] + t * headings_[i + 1];
}

double Line::curvature(double s) const {
  return (heading(s + step) - heading(s - step)) / (2.0 * step);
}

Motion::Motion(const World& world, const Way& way, const SimulationParameters& parameters)
    : world_(world),
      line_(way.points, parameters.length),
      carrier_(parameters.carrier),
      key_(key_of(parameters.seed, 40, parameters.route, parameters.change)) {
  plan_speed(way, parameters);
}

void Motion::plan_speed(const Way& way, const SimulationParameters& parameters) {
  const bool car = carrier_ == "car";
  const double accelerate = car ? 1.8 : 0.5, brake = car ? 2.4 : 0.7, sideways = car ? 2.5 : 0.5;
  Random random(key_of(key_, 1));
  const double cruise = car                    ? random.uniform(10.0, 12.5)
                        : carrier_ == "walker" ? random.uniform(1.2, 1.5)
                                               : random.uniform(1.6, 2.4);
  const int n = static_cast<int>(line_.length() / Line::step) + 1;
  const std::uint64_t pace = key_of(parameters.seed, 41, parameters.route);
  std::vector<double> speed;
  for (int i = 0; i < n; ++i) {
    const double s = i * Line::step;
    const double wish = cruise * (1.0 + 0.2 * sway(s / 100.0, 1.0, pace));
    speed.push_back(
        std::min(wish, std::sqrt(sideways / std::max(1e-4, std::abs(line_.curvature(s))))));
  }
  std::vector<double> wait(speed.size(), 0.0);
  // Arc lengths of the way's points before it was smoothed: the same up to a metre or two.
  double s = 0.0;
  std::size_t next = 0;
  for (const std::size_t stop : way.stops) {
    for (; next < stop; ++next) s += (way.points[next + 1] - way.points[next]).norm();
    const auto k = static_cast<std::size_t>(s / Line::step);
    if (k + 2 < speed.size() && k > 4 && random.chance(car ? 0.22 : 0.1)) {
      speed[k] = 0.0;
      wait[k] = random.uniform(1.5, 5.0);
    }
  }
  speed.front() = std::min(speed.front(), car ? 3.0 : 0.5);
  for (std::size_t i = 1; i < speed.size(); ++i) {
    speed[i] =
        std::min(speed[i], std::sqrt(speed[i - 1] * speed[i - 1] + 2 * accelerate * Line::step));
  }
  for (std::size_t i = speed.size() - 1; i-- > 0;) {
    speed[i] = std::min(speed[i], std::sqrt(speed[i + 1] * speed[i + 1] + 2 * brake * Line::step));
  }
  double time = 0.0;
  for (std::size_t i = 0; i < speed.size(); ++i) {
    const double arc = Line::step * static_cast<double>(i);
    if (i > 0) time += 2 * Line::step / std::max(1e-3, speed[i] + speed[i - 1]);
    arc_.push_back(arc);
    speed_.push_back(speed[i]);
    time_.push_back(time);
    if (wait[i] > 0.0) {
      time += wait[i];
      arc_.push_back(arc);
      speed_.push_back(0.0);
      time_.push_back(time);
    }
  }
}

Motion::State Motion::state(double seconds) const {
  const double t = std::clamp(seconds, 0.0, duration());
  const auto upper = std::upper_bound(time_.begin() + 1, time_.end() - 1, t);
  const auto i = static_cast<std::size_t>(upper - time_.begin()) - 1;
  const double dt = time_[i + 1] - time_[i], u = t - time_[i];
  const double a = dt > 0.0 ? (speed_[i + 1] - speed_[i]) / dt : 0.0;
  return {arc_[i] + speed_[i] * u + 0.5 * a * u * u, speed_[i] + a * u, a};
}

double Motion::distance(double seconds) const { return state(seconds).s; }

Pose Motion::pose(double seconds) const {
  const State now = state(seconds);
  const bool car = carrier_ == "car", walker = carrier_ == "walker";
  Vec2 p = line_.point(now.s);
  double yaw = line_.heading(now.s);
  const double half_base = car ? 1.35 : 0.25, half_track = car ? 0.75 : 0.25;
  const Vec2 forward(std::cos(yaw), std::sin(yaw)), left(-forward.y(), forward.x());
  const double front = world_.ground(p + half_base * forward);
  const double rear = world_.ground(p - half_base * forward);
  const double port = world_.ground(p + half_track * left);
  const double starboard = world_.ground(p - half_track * left);
  double z = 0.25 * (front + rear + port + starboard);
  double pitch_up = std::atan2(front - rear, 2 * half_base);
  double roll = std::atan2(port - starboard, 2 * half_track);
  const std::uint64_t k = key_of(key_, 2);
  // Springs answer to speed: a standing car does not shake.
  const double going = std::min(1.0, now.v / (car ? 5.0 : 0.8));
  if (car) {
    z += 1.75 + 0.008 * going * sway(seconds, 1.3, key_of(k, 1));
    pitch_up += 0.004 * going * sway(seconds, 1.6, key_of(k, 2));
    roll += 0.004 * going * sway(seconds, 1.1, key_of(k, 3)) +
            0.006 * now.v * now.v * line_.curvature(now.s);
  } else if (walker) {
    // Carried in the hand: steps at 1.8 Hz, and slow swings that reach 30 degrees.
    constexpr double swing = 30.0 * std::numbers::pi / 180.0;
    z += 1.5 + 0.03 * going * std::sin(2 * std::numbers::pi * 1.8 * seconds);
    pitch_up = swing * sway(seconds, 0.45, key_of(k, 4)) +
               0.02 * going * std::sin(2 * std::numbers::pi * 1.8 * seconds + 0.7);
    roll = swing * sway(seconds, 0.35, key_of(k, 5));
    yaw += 0.35 * sway(seconds, 0.3, key_of(k, 6));
    p += 0.04 * going * std::sin(2 * std::numbers::pi * 0.9 * seconds) * left;
  } else {
    // Two wheels: it leans into its own acceleration and swings about the balance.
    z += 1.1;
    pitch_up = 0.14 * sway(seconds, 0.8, key_of(k, 7)) - 0.08 * now.a;
    roll *= 0.8;
  }
  const Eigen::Quaterniond q = Eigen::AngleAxisd(yaw, Vec3::UnitZ()) *
                               Eigen::AngleAxisd(-pitch_up, Vec3::UnitY()) *
                               Eigen::AngleAxisd(roll, Vec3::UnitX());
  return Pose(q, Vec3(p.x(), p.y(), z));
}

}  // namespace groundloop::simulation
