#include "frontend/simulation/traffic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "frontend/simulation/random.hpp"
#include "frontend/simulation/scenery.hpp"

namespace groundloop::simulation {
namespace {

constexpr int car_shapes = 8, person_shapes = 6;
constexpr double beyond_range = 130.0;  ///< where bodies come and go, m
constexpr double follow_gap = 7.0;      ///< between the middles of two standing cars, m

/// A value of the way's points at each knot of the line, by arc length; where it changes from
/// street to street, it does so over some metres.
std::vector<double> by_knot(const Way& way, const std::vector<double>& values, const Line& line) {
  std::vector<double> exact;
  double arc = 0.0;
  std::size_t i = 0;
  for (double s = 0.0; s <= line.length() + 1e-9; s += Line::step) {
    while (i + 1 < way.points.size()) {
      const double d = (way.points[i + 1] - way.points[i]).norm();
      if (arc + d > s) break;
      arc += d;
      ++i;
    }
    exact.push_back(values[i]);
  }
  constexpr std::ptrdiff_t reach = 16;
  const auto n = static_cast<std::ptrdiff_t>(exact.size());
  std::vector<double> result;
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    const auto first = exact.begin() + std::max<std::ptrdiff_t>(0, k - reach);
    const auto last = exact.begin() + std::min(n, k + reach + 1);
    result.push_back(std::accumulate(first, last, 0.0) / static_cast<double>(last - first));
  }
  return result;
}

}  // namespace

Traffic::Traffic(const World& world, const Motion& motion, const Way& way,
                 const SimulationParameters& parameters, RayCaster& caster)
    : world_(world),
      motion_(motion),
      along_(by_knot(way, way.along, motion.line())),
      oncoming_(by_knot(way, way.oncoming, motion.line())),
      pavement_(by_knot(way, way.pavement, motion.line())),
      centre_(by_knot(way, way.centre, motion.line())) {
  for (int i = 0; i < car_shapes + person_shapes; ++i) {
    Mesh mesh;
    Random shape(key_of(parameters.seed, 70, i));
    if (i < car_shapes) {
      add_car(mesh, Place{}, shape);
    } else {
      add_person(mesh, Place{}, shape);
    }
    caster.add_shape(mesh);
  }
  Random random(key_of(parameters.seed, 71, parameters.route, parameters.change));
  const bool drives = parameters.carrier == "car";
  if (parameters.traffic == 0.0) return;
  const double gap = 1.0 / parameters.traffic;
  if (drives && way.cars) add_followers(motion.duration(), gap, random);
  if (way.cars) add_cars(motion.duration(), !drives, gap, random);
  add_people(gap, random);
}

void Traffic::add_followers(double end, double gap, Random& random) {
  const auto car = [&] { return static_cast<std::size_t>(random.below(car_shapes)); };
  for (double t = random.uniform(-20, 20); t < end;) {
    const double stays = random.uniform(65, 130);
    add({car(), Lane::carrier, 0, 0, 0, 0, t, t + stays, random.uniform(1.3, 2.6)});
    if (random.chance(0.4)) {
      add({car(), Lane::carrier, 0, 0, 0, 0, t, t + stays, -random.uniform(1.5, 2.5)});
    }
    t += stays + gap * random.uniform(0, 60);
  }
}

void Traffic::add_cars(double end, bool overtake, double gap, Random& random) {
  for (double t = random.uniform(0, 8); t < end; t += gap * random.uniform(4, 16)) {
    const auto shape = static_cast<std::size_t>(random.below(car_shapes));
    const double speed = random.uniform(5, 10), reach = beyond_range / speed;
    const bool along = overtake && random.chance(0.5);
    add({shape, along ? Lane::along : Lane::oncoming, motion_.distance(t), t,
         along ? speed : -speed, 0.0, t - 1.4 * reach, t + 1.4 * reach});
  }
}

void Traffic::add_people(double gap, Random& random) {
  for (double s = 5.0; s < motion_.line().length(); s += gap * random.uniform(6, 40)) {
    const int person = car_shapes + random.below(person_shapes);
    const auto shape = static_cast<std::size_t>(person);
    const double speed = random.uniform(0.7, 1.7) * (random.chance(0.5) ? 1.0 : -1.0);
    const Lane lane = random.chance(0.5) ? Lane::left_pavement : Lane::right_pavement;
    const double t = time_at(s);
    const double from = std::max(time_at(s - beyond_range), t - 90.0);
    const double until = std::min(time_at(s + beyond_range), t + 90.0);
    add({shape, lane, s, t, speed, random.uniform(-0.6, 0.6), from, until});
  }
}

void Traffic::add(const Agent& agent) {
  constexpr double step = 0.2;  // in which nobody passes through anybody, s
  const bool person = agent.shape >= car_shapes;
  const double half_length = person ? 0.6 : 3.8, half_width = person ? 0.6 : 1.2;
  const double from = std::max(0.0, agent.from), until = std::min(motion_.duration(), agent.until);
  for (double t = from; t < until; t += step) {
    if (std::abs(along(agent, t) - motion_.distance(t)) > 2.0 * beyond_range) continue;
    const Vec3 d = pose(agent, t).inverse() * motion_.pose(t).translation;
    if (std::abs(d.x()) < half_length && std::abs(d.y()) < half_width) return;
  }
  agents_.push_back(agent);
}

double Traffic::time_at(double s) const {
  double low = 0.0, high = motion_.duration();
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (motion_.distance(middle) < s ? low : high) = middle;
  }
  return low;
}

double Traffic::along(const Agent& agent, double seconds) const {
  if (agent.lead == 0.0) return agent.s0 + agent.speed * (seconds - agent.t0);
  // The same drive some seconds sooner or later, and never on the carrier's bumper. It is caught up
  // with, and draws away at last.
  constexpr double ramp = 25.0, far = 12.0;
  const double edge = std::min(seconds - agent.from, agent.until - seconds);
  const double u = std::clamp(1.0 - edge / ramp, 0.0, 1.0);
  const double lead = std::abs(agent.lead) + far * u * u * (3.0 - 2.0 * u);
  return agent.lead > 0.0 ? motion_.distance(seconds + lead) + follow_gap
                          : motion_.distance(seconds - lead) - follow_gap;
}

Pose Traffic::pose(const Agent& agent, double seconds) const {
  const double s = along(agent, seconds);
  const Line& line = motion_.line();
  const auto k =
      std::min(static_cast<std::size_t>(std::max(0.0, s / Line::step)), oncoming_.size() - 1);
  double lateral = agent.lateral;
  const bool walks = agent.lane == Lane::left_pavement || agent.lane == Lane::right_pavement;
  if (agent.lane == Lane::along) lateral += along_[k];
  if (agent.lane == Lane::oncoming) lateral += oncoming_[k];
  if (walks) {
    lateral += centre_[k] + (agent.lane == Lane::left_pavement ? pavement_[k] : -pavement_[k]);
    // Who meets the carrier on the pavement steps aside.
    constexpr double aside = 0.9;
    if (std::abs(lateral) < aside) lateral = agent.lateral < 0.0 ? -aside : aside;
  }
  const double heading = line.heading(s);
  const Vec2 p = line.point(s) + lateral * Vec2(-std::sin(heading), std::cos(heading));
  const bool reversed = agent.lead == 0.0 && agent.speed < 0.0;
  const Eigen::AngleAxisd turn(heading + (reversed ? std::numbers::pi : 0.0), Vec3::UnitZ());
  return Pose(Eigen::Quaterniond(turn),
              Vec3(p.x(), p.y(), world_.ground(p) + (walks ? 0.12 : 0.0)));
}

std::vector<MovingBody> Traffic::bodies(double from, double to, double reach) const {
  std::vector<MovingBody> result;
  const double here = motion_.distance(from);
  for (const Agent& agent : agents_) {
    if (from < agent.from || to > agent.until) continue;
    const double s = along(agent, from);
    if (std::abs(s - here) > 2.0 * reach || s < 1.0 || s > motion_.line().length() - 1.0) continue;
    result.push_back({agent.shape, pose(agent, from), pose(agent, to)});
  }
  return result;
}

}  // namespace groundloop::simulation
