// Keeps CHOLMOD and BLAS to one thread, for the same bytes on every machine and thread count.
// CHOLMOD otherwise opens OpenMP regions of a fixed size around loops too short to gain by them,
// and loses half its time waiting where cores are shared.
#pragma once

namespace groundloop {

/// While it lives, OpenMP regions opened by this thread have one thread; BLAS has one from the
/// first use on.
class SingleThreadedAlgebra {
 public:
  SingleThreadedAlgebra();
  ~SingleThreadedAlgebra();
  SingleThreadedAlgebra(const SingleThreadedAlgebra&) = delete;
  SingleThreadedAlgebra& operator=(const SingleThreadedAlgebra&) = delete;

 private:
  int levels_;
};

}  // namespace groundloop
