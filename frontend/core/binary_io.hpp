// Plain values to and from streams, for files that only groundloop reads on the kind of machine
// that wrote them.
#pragma once

#include <istream>
#include <ostream>
#include <type_traits>
#include <vector>

#include "frontend/core/error.hpp"

namespace groundloop {

template <typename T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

template <typename T>
void get(std::istream& in, T& value) {
  in.read(reinterpret_cast<char*>(&value), sizeof value);
}

template <typename T>
void put_all(std::ostream& out, const std::vector<T>& values) {
  put(out, static_cast<std::uint64_t>(values.size()));
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
}

/// Throws InputError where the stream holds less than it says.
template <typename T>
void get_all(std::istream& in, std::vector<T>& values) {
  std::uint64_t size = 0;
  get(in, size);
  const auto here = in.tellg();
  in.seekg(0, std::ios::end);
  const auto left = static_cast<std::uint64_t>(in.tellg() - here);
  in.seekg(here);
  if (!in || size > left / sizeof(T))
    throw InputError("the checkpoint is cut off; run again without --resume");
  values.resize(size);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(size * sizeof(T)));
}

}  // namespace groundloop
