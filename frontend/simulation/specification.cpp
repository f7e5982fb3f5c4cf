#include <algorithm>
#include <charconv>
#include <numeric>
#include <set>
#include <string_view>

#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/spelling.hpp"
#include "frontend/simulation/simulation.hpp"

namespace groundloop {
namespace {

using Names = std::vector<std::string_view>;

const Names worlds{"town", "bridge", "park"};
const Names sensors{"spin16", "spin32", "spin64", "spin128", "raster", "rosette"};
const Names carriers{"car", "walker", "segway"};
const Names sides{"any", "west", "east"};
const Names ways{"there", "back"};
const Names keys{"sensor", "carrier", "length", "seed", "route", "change",
                 "noise",  "traffic", "fov",    "side", "way"};

std::string list(const Names& names) {
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

[[noreturn]] void refuse(const std::string& specification, const std::string& what) {
  throw InputError(specification + ": " + what);
}

std::string one_of(const std::string& specification, const std::string& key, std::string_view value,
                   const Names& names) {
  if (std::find(names.begin(), names.end(), value) == names.end()) {
    refuse(specification, key + " '" + std::string(value) + "' is unknown, did you mean '" +
                              nearest_word(value, names) + "'? Allowed are " + list(names));
  }
  return std::string(value);
}

double number(const std::string& specification, const std::string& key, std::string_view value,
              double low, double high) {
  double result = 0.0;
  if (!parse_double(value, result) || result < low || result > high) {
    refuse(specification, key + " '" + std::string(value) + "' must be a number from " +
                              to_text(low) + " to " + to_text(high));
  }
  return result;
}

std::uint64_t integer(const std::string& specification, const std::string& key,
                      std::string_view value, std::uint64_t high) {
  std::uint64_t result = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), result);
  if (error != std::errc() || end != value.data() + value.size() || result > high) {
    refuse(specification, key + " '" + std::string(value) + "' must be a whole number from 0 to " +
                              std::to_string(high));
  }
  return result;
}

void set(SimulationParameters& parameters, const std::string& specification, const std::string& key,
         std::string_view value) {
  constexpr std::uint64_t largest_seed = 0xffffffffU;
  if (key == "sensor") {
    parameters.sensor = one_of(specification, key, value, sensors);
  } else if (key == "carrier") {
    parameters.carrier = one_of(specification, key, value, carriers);
  } else if (key == "side") {
    parameters.side = one_of(specification, key, value, sides);
  } else if (key == "way") {
    parameters.way = one_of(specification, key, value, ways);
  } else if (key == "length") {
    parameters.length = number(specification, key, value, 10.0, 1e5);
  } else if (key == "seed") {
    parameters.seed = integer(specification, key, value, largest_seed);
  } else if (key == "route") {
    parameters.route = integer(specification, key, value, largest_seed);
  } else if (key == "change") {
    parameters.change = static_cast<int>(integer(specification, key, value, 1000000));
  } else if (key == "noise") {
    parameters.noise = number(specification, key, value, 0.0, 100.0);
  } else if (key == "traffic") {
    parameters.traffic = number(specification, key, value, 0.0, 10.0);
  } else if (key == "fov") {
    parameters.fov = number(specification, key, value, 290.0, 360.0);
    if (parameters.fov != 290.0 && parameters.fov != 360.0) {
      refuse(specification, "fov must be 360 or 290 (degrees)");
    }
  } else {
    refuse(specification, "key '" + key + "' is unknown, did you mean '" + nearest_word(key, keys) +
                              "'? Allowed are " + list(keys));
  }
}

}  // namespace

bool is_simulation(const std::string& path) { return path.rfind("sim:", 0) == 0; }

SimulationParameters parse_simulation(const std::string& specification) {
  if (!is_simulation(specification)) {
    refuse(specification, "a simulated recording is written sim:WORLD?key=value&...");
  }
  SimulationParameters parameters;
  std::string_view rest = std::string_view(specification).substr(4);
  const std::size_t question = rest.find('?');
  parameters.world = one_of(specification, "world", rest.substr(0, question), worlds);
  std::set<std::string> seen;
  while (question != std::string_view::npos) {
    rest = seen.empty() ? rest.substr(question + 1) : rest;
    const std::string_view item = rest.substr(0, rest.find('&'));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) {
      refuse(specification,
             "'" + std::string(item) + "' must be key=value; keys are " + list(keys));
    }
    const std::string key(item.substr(0, equals));
    set(parameters, specification, key, item.substr(equals + 1));
    if (!seen.insert(key).second) refuse(specification, "key '" + key + "' is given twice");
    if (item.size() == rest.size()) break;
    rest = rest.substr(item.size() + 1);
  }
  if (parameters.fov != 360.0 && parameters.sensor.rfind("spin", 0) != 0) {
    refuse(specification, "fov belongs to the spinning sensors; sensor is " + parameters.sensor);
  }
  if (parameters.side != "any" && parameters.world == "bridge") {
    refuse(specification, "side belongs to town and park; the bridge has its own two sides");
  }
  if (parameters.way != "there" && parameters.world == "bridge") {
    refuse(specification, "way belongs to town and park; the bridge is driven there and back");
  }
  return parameters;
}

}  // namespace groundloop
