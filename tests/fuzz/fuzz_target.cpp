#include "tests/fuzz/fuzz_target.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include <spdlog/spdlog.h>

#include "frontend/core/error.hpp"
#include "frontend/core/parallel.hpp"

namespace groundloop::fuzz {
namespace {

std::vector<Target>& registered() {
  static std::vector<Target> all;
  return all;
}

}  // namespace

Registration::Registration(const Target& target) {
  std::vector<Target>& all = registered();
  const auto after = std::find_if(all.begin(), all.end(), [&](const Target& other) {
    return std::strcmp(other.name, target.name) > 0;
  });
  all.insert(after, target);
}

const std::vector<Target>& targets() { return registered(); }

void run(const Target& target, Input input) {
  try {
    target.run(input);
  } catch (const InputError&) {
  }
}

void set_up() {
  spdlog::set_level(spdlog::level::off);
  set_thread_count(1);
}

void broken_promise(const char* file, int line, const char* what) {
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) +
                         ": does not hold: " + what);
}

}  // namespace groundloop::fuzz
