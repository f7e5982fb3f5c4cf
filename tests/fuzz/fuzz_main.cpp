// The entry of libFuzzer into the one target that is linked with it.
#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  groundloop::fuzz::set_up();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  groundloop::fuzz::run(groundloop::fuzz::targets().front(),
                        {reinterpret_cast<const std::byte*>(data), size});
  return 0;
}
