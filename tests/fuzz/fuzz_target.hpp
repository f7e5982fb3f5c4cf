// One thing that reads what others wrote, fed with any bytes. A target is a file of targets/ with
//
//   GROUNDLOOP_FUZZ_TARGET(pcd) { ... `input` ... }
//
// It is run by libFuzzer (fuzz_main.cpp, one program a target), and by the tests and by hand on
// kept inputs and changes of them (replay.hpp, one program for all). Bad input may be answered by
// InputError alone: any other exception, a crash, or an allocation out of proportion to the input
// is a finding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace groundloop::fuzz {

using Input = std::span<const std::byte>;

struct Target {
  const char* name = nullptr;
  void (*run)(Input) = nullptr;
};

/// Targets linked into this program, by name.
[[nodiscard]] const std::vector<Target>& targets();

/// Adds a target before main(); used by the macro alone.
struct Registration {
  explicit Registration(const Target& target);
};

/// Runs a target; InputError is swallowed, all else comes through.
void run(const Target& target, Input input);

/// To be called once before the first run: one thread, no log.
void set_up();

[[nodiscard]] inline std::string_view text_of(Input input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

/// Throws std::logic_error, which nothing catches, with the place where a promise does not hold.
[[noreturn]] void broken_promise(const char* file, int line, const char* what);

/// Numbers and parts taken from the front of an input; zeros and nothing once it is used up.
class Chooser {
 public:
  explicit Chooser(Input input) : input_(input) {}
  template <typename T>
  T get() {
    T value{};
    const Input part = take(sizeof(T));
    auto* to = reinterpret_cast<std::byte*>(&value);
    for (std::size_t i = 0; i < part.size(); ++i) to[i] = part[i];
    return value;
  }
  Input take(std::size_t size) {
    size = size < input_.size() ? size : input_.size();
    const Input part = input_.first(size);
    input_ = input_.subspan(size);
    return part;
  }
  [[nodiscard]] Input rest() const { return input_; }

 private:
  Input input_;
};

}  // namespace groundloop::fuzz

#define GROUNDLOOP_FUZZ_TARGET(target)                                             \
  namespace groundloop::fuzz {                                                     \
  static void run_##target(Input input);                                           \
  static const Registration registration_##target(Target{#target, &run_##target}); \
  }                                                                                \
  void groundloop::fuzz::run_##target([[maybe_unused]] groundloop::fuzz::Input input)

#define FUZZ_PROMISE(condition)                                                           \
  do {                                                                                    \
    if (!(condition)) ::groundloop::fuzz::broken_promise(__FILE__, __LINE__, #condition); \
  } while (false)
