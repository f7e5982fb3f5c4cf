// Rays against the scenery near the sensor and the things that move there during one scan (Embree,
// two levels: a scene a chunk, and a scene of instances a scan). Chunks are built when first needed
// and dropped when left behind.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "frontend/core/pose.hpp"
#include "frontend/simulation/world.hpp"

namespace groundloop::simulation {

struct Ray {
  Eigen::Vector3f origin;     ///< in the world, relative to the centre given to prepare()
  Eigen::Vector3f direction;  ///< unit vector
  float time;                 ///< 0 at the start of the scan, 1 at its end
};

struct Hit {
  float range = -1.0F;  ///< negative: nothing within reach
  Material material = Material::asphalt;
  bool moving = false;
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit vector, towards either side
  std::uint64_t surface = 0;                         ///< of the triangle
};

/// Something that moves evenly from one pose (T_world_body) to another within the scan.
struct MovingBody {
  std::size_t shape = 0;  ///< index returned by add_shape
  Pose start, end;
};

class RayCaster {
 public:
  explicit RayCaster(const World& world);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// A shape that moving bodies may have, about its own origin.
  std::size_t add_shape(const Mesh& mesh);
  /// Makes everything within `reach` metres of `centre` ready. The scene holds until the next call.
  void prepare(const Vec3& centre, double reach, std::span<const MovingBody> bodies);
  /// Safe to call from several threads at once.
  [[nodiscard]] Hit cast(const Ray& ray, float max_range) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace groundloop::simulation
