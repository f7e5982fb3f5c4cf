#include "apps/config/config.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <map>

#include <yaml-cpp/yaml.h>

#include "apps/config/presets.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/spelling.hpp"

namespace groundloop::apps {
namespace {

// A visitor that sets one field from text.
struct Setter {
  std::string section;
  std::string key;  // section.key
  const std::string& value;
  const std::string& place;
  bool& found;

  [[nodiscard]] bool matches(const char* name) const { return key == section + "." + name; }
  [[noreturn]] void fail(const std::string& expected) const {
    throw InputError(place + ": " + key + ": '" + value + "' is no " + expected);
  }
  void operator()(const char* name, double& field, const Range&, const char*, const char*) const {
    if (!matches(name)) return;
    found = true;
    if (!parse_double(value, field)) fail("number");
  }
  void operator()(const char* name, int& field, const Range&, const char*, const char*) const {
    if (!matches(name)) return;
    found = true;
    const auto result = std::from_chars(value.data(), value.data() + value.size(), field);
    if (result.ec != std::errc() || result.ptr != value.data() + value.size()) fail("whole number");
  }
  void operator()(const char* name, bool& field, const OnOff&, const char*, const char*) const {
    if (!matches(name)) return;
    found = true;
    if (value == "true" || value == "on" || value == "yes" || value == "1") {
      field = true;
    } else if (value == "false" || value == "off" || value == "no" || value == "0") {
      field = false;
    } else {
      fail("true or false");
    }
  }
  void operator()(const char* name, std::string& field, const Choices&, const char*,
                  const char*) const {
    if (!matches(name)) return;
    found = true;
    field = value;
  }
};

// Every field as text, with what is said of it.
struct Lister {
  std::string section;
  std::vector<ConfigEntry>& entries;
  static std::string text(double v) { return to_text(v); }
  static std::string text(int v) { return std::to_string(v); }
  static std::string text(bool v) { return v ? "true" : "false"; }
  static std::string text(const std::string& v) { return v; }
  static std::string range(const Range& r) { return to_text(r.min) + " to " + to_text(r.max); }
  static std::string range(const OnOff&) { return ""; }
  static std::string range(const Choices& choices) {
    std::string list;
    for (const std::string& choice : choices) list += (list.empty() ? "" : " | ") + choice;
    return list;
  }
  template <typename T, typename R>
  void operator()(const char* key, const T& value, const R& allowed, const char* unit,
                  const char* reason) const {
    entries.push_back({section, key, text(value), range(allowed), unit, reason});
  }
};

std::string yaml_line(const ConfigEntry& entry) {
  std::string line = "  " + entry.key + ": " + entry.value;
  line.resize(std::max<std::size_t>(line.size() + 1, 40), ' ');
  line += "# " + entry.unit + (entry.unit.empty() ? "" : "; ") + entry.reason;
  return line + (entry.allowed.empty() ? "" : " [" + entry.allowed + "]") + "\n";
}

std::string preset_text(const std::string& name) {
  for (const Preset& preset : kPresets) {
    if (name == preset.name) return preset.yaml;
  }
  return {};
}

}  // namespace

void set_option(Config& config, const std::string& key, const std::string& value,
                const std::string& place) {
  bool found = false;
  for_each_section(config, [&]<typename Options>(const char* section, Options& options) {
    Options::visit(options, Setter{section, key, value, place, found});
  });
  if (found) return;
  std::vector<std::string> keys;
  for (const ConfigEntry& entry : list_config(config))
    keys.push_back(entry.section + "." + entry.key);
  throw InputError(place + ": unknown key '" + key + "'; did you mean '" + nearest_word(key, keys) +
                   "'? 'groundloop config' lists all keys");
}

void read_config(Config& config, const std::string& file_or_preset) {
  std::string text = preset_text(file_or_preset);
  if (text.empty()) {
    if (!std::filesystem::exists(file_or_preset)) {
      std::string names;
      for (const std::string& name : preset_names()) names += (names.empty() ? "" : ", ") + name;
      throw InputError(file_or_preset + ": no such file, nor a preset (" + names + ")");
    }
    text = read_text(file_or_preset);
  }
  const auto place = [&](const YAML::Node& node) {
    return file_or_preset + ":" + std::to_string(node.Mark().line + 1);
  };
  try {
    const YAML::Node root = YAML::Load(text);
    if (root.IsNull()) return;
    if (!root.IsMap())
      throw InputError(file_or_preset + ": expected sections of 'key: value' lines");
    for (const auto& section : root) {
      const auto name = section.first.as<std::string>();
      if (section.second.IsNull()) continue;
      if (!section.second.IsMap()) {
        throw InputError(place(section.first) + ": '" + name +
                         "' is no section with 'key: value' lines below it");
      }
      for (const auto& entry : section.second) {
        if (!entry.second.IsScalar()) {
          throw InputError(place(entry.first) + ": " + name + "." + entry.first.as<std::string>() +
                           " wants one value");
        }
        set_option(config, name + "." + entry.first.as<std::string>(),
                   entry.second.as<std::string>(), place(entry.first));
      }
    }
  } catch (const YAML::Exception& e) {
    throw InputError(file_or_preset + ":" + std::to_string(e.mark.line + 1) +
                     ": no valid YAML: " + e.msg);
  }
}

Config effective_config(const std::string& file_or_preset,
                        const std::vector<std::string>& settings) {
  Config config;
  if (!file_or_preset.empty()) read_config(config, file_or_preset);
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos) {
      throw InputError("--set " + setting +
                       ": expected KEY=VALUE, e.g. --set odometry.voxel_size=0.5");
    }
    set_option(config, setting.substr(0, equals), setting.substr(equals + 1), "--set");
  }
  return config;
}

void validate_config(const Config& config) {
  for_each_section(config, []<typename Options>(const char* section, const Options& options) {
    validate(options, section);
  });
}

std::vector<ConfigEntry> list_config(const Config& config) {
  std::vector<ConfigEntry> entries;
  for_each_section(config, [&]<typename Options>(const char* section, const Options& options) {
    Options::visit(options, Lister{section, entries});
  });
  return entries;
}

std::string to_yaml(const Config& config) {
  std::string yaml;
  std::string section;
  for (const ConfigEntry& entry : list_config(config)) {
    if (entry.section != section) yaml += entry.section + ":\n";
    section = entry.section;
    yaml += yaml_line(entry);
  }
  return yaml;
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  names.reserve(std::size(kPresets));
  for (const Preset& preset : kPresets) names.emplace_back(preset.name);
  return names;
}

}  // namespace groundloop::apps
