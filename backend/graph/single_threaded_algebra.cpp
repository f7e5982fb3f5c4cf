#include "backend/graph/single_threaded_algebra.hpp"

#include <omp.h>

// Only where BLAS is OpenBLAS.
extern "C" void openblas_set_num_threads(int) __attribute__((weak));

namespace groundloop {

SingleThreadedAlgebra::SingleThreadedAlgebra() : levels_(omp_get_max_active_levels()) {
  omp_set_max_active_levels(0);
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
}

SingleThreadedAlgebra::~SingleThreadedAlgebra() { omp_set_max_active_levels(levels_); }

}  // namespace groundloop
