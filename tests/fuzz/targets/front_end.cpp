// Scans as no sensor makes them, straight into the front end: three bytes and a stamp for each scan
// (number of points, with times or without), then its points and times as they lie in the input.
#include <cmath>

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/pipeline.hpp"

GROUNDLOOP_FUZZ_TARGET(front_end) {
  Chooser chooser(input);
  std::vector<Scan> scans;
  while (!chooser.rest().empty() && scans.size() < 6) {
    Scan scan;
    const std::size_t count = chooser.get<std::uint16_t>() % 512U;
    const bool timed = (chooser.get<std::uint8_t>() & 1U) != 0;
    scan.stamp = chooser.get<Nanoseconds>();
    for (std::size_t i = 0; i < count && !chooser.rest().empty(); ++i) {
      const Eigen::Vector3f p(chooser.get<float>(), chooser.get<float>(), chooser.get<float>());
      const float time = timed ? chooser.get<float>() : 0.0F;
      // What readers drop.
      const float square = p.squaredNorm();
      if (!(square > 0.0F && square < 1e30F) || !(std::abs(time) < 60.0F)) continue;
      scan.points.push_back(p);
      if (timed) scan.times.push_back(time);
    }
    if (is_stamp(scan.stamp)) scans.push_back(std::move(scan));
  }
  for (const Scan& scan : scans) expect_sound(scan);
  process(scans);
}
