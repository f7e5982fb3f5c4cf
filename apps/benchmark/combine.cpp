#include <cmath>
#include <set>

#include "apps/benchmark/measures.hpp"

namespace groundloop::apps {
namespace {

std::optional<double> value_of(const Measure& measure, const std::vector<const Result*>& results) {
  if (measure.over == Measure::Over::pooled) {
    std::vector<const Detections*> detections;
    for (const Result* r : results) {
      if (r->detections) detections.push_back(&*r->detections);
    }
    return detections.empty() ? std::nullopt : measure.pool(detections);
  }
  double sum = 0.0;
  std::size_t count = 0;
  for (const Result* r : results) {
    const auto figure = r->figures.find(measure.name);
    if (figure == r->figures.end()) continue;
    sum += figure->second;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return measure.over == Measure::Over::sum ? sum : sum / static_cast<double>(count);
}

bool has(const Measure& measure, const Result& result) {
  return measure.over == Measure::Over::pooled ? result.detections.has_value()
                                               : result.figures.contains(measure.name);
}

std::vector<const Result*> those_with(const Measure& measure,
                                      const std::vector<const Result*>& results) {
  std::vector<const Result*> found;
  for (const Result* r : results) {
    if (has(measure, *r)) found.push_back(r);
  }
  return found;
}

std::vector<const Result*> without(const std::string& subject,
                                   const std::vector<const Result*>& results) {
  std::vector<const Result*> rest;
  for (const Result* r : results) {
    if (r->subject != subject) rest.push_back(r);
  }
  return rest;
}

std::set<std::string> subjects(const std::vector<const Result*>& results) {
  std::set<std::string> names;
  for (const Result* r : results) names.insert(r->subject);
  return names;
}

// Standard error of a statistic from its values with each recording left out.
std::optional<double> jackknife(const std::vector<double>& left_out) {
  if (left_out.size() < 2) return std::nullopt;
  const auto n = static_cast<double>(left_out.size());
  double mean = 0.0, squares = 0.0;
  for (const double v : left_out) mean += v / n;
  for (const double v : left_out) squares += (v - mean) * (v - mean);
  return std::sqrt((n - 1) / n * squares);
}

}  // namespace

Combined combine(const Measure& measure, const std::vector<const Result*>& results) {
  const std::vector<const Result*> found = those_with(measure, results);
  Combined combined{value_of(measure, found), std::nullopt, found.size()};
  if (!combined.value || measure.over == Measure::Over::sum) return combined;
  std::vector<double> left_out;
  for (const std::string& subject : subjects(found)) {
    const std::optional<double> value = value_of(measure, without(subject, found));
    if (value) left_out.push_back(*value);
  }
  combined.error = jackknife(left_out);
  return combined;
}

Combined combine_difference(const Measure& measure, const std::vector<const Result*>& before,
                            const std::vector<const Result*>& after) {
  const auto common = [&](const std::vector<const Result*>& of,
                          const std::vector<const Result*>& with) {
    const std::set<std::string> names = subjects(those_with(measure, with));
    std::vector<const Result*> found;
    for (const Result* r : those_with(measure, of)) {
      if (names.contains(r->subject)) found.push_back(r);
    }
    return found;
  };
  const std::vector<const Result*> a = common(before, after), b = common(after, before);
  const auto difference = [&](const std::vector<const Result*>& x,
                              const std::vector<const Result*>& y) -> std::optional<double> {
    const std::optional<double> u = value_of(measure, x), v = value_of(measure, y);
    if (!u || !v) return std::nullopt;
    return *v - *u;
  };
  Combined combined{difference(a, b), std::nullopt, b.size()};
  if (!combined.value) return combined;
  std::vector<double> left_out;
  for (const std::string& subject : subjects(a)) {
    const std::optional<double> d = difference(without(subject, a), without(subject, b));
    if (d) left_out.push_back(*d);
  }
  combined.error = jackknife(left_out);
  return combined;
}

}  // namespace groundloop::apps
